//! Reads from the disk, few at a time, so that a disk that hangs blocks only these few threads.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use super::disk_counts::{DiskCounts, count};
use super::store::StoreError;

/// Maximum number of concurrent reads. A solid-state disk gains little beyond four requests of a mebibyte each, and a
/// spinning one loses. Half as many would leave a solid-state disk idle; twice as many would gain little and hold twice
/// as many parts.
const MAX_CONCURRENT_READS: usize = 4;
/// Maximum time that a response or a job waits for its next part; after it the response is cut off, or the job fails.
/// It is less than most clients wait. Half of it would do so more often under load; twice of it is longer than some
/// clients wait.
pub(super) const PART_PATIENCE: Duration = Duration::from_secs(10);

/// The reading places of one disk.
#[derive(Debug)]
pub(super) struct Reads {
    places: Arc<Semaphore>,
    counts: Arc<DiskCounts>,
}

impl Reads {
    pub(super) fn new(counts: Arc<DiskCounts>) -> Self {
        Self { places: Arc::new(Semaphore::new(MAX_CONCURRENT_READS)), counts }
    }

    /// Runs a read on a thread that may block. Returns `None` if it fails, or if there is no place or no result within
    /// `patience`. A read that timed out keeps its place until the disk returns.
    pub(super) async fn read<T: Send + 'static>(
        &self,
        patience: Duration,
        work: impl FnOnce() -> Result<T, StoreError> + Send + 'static,
    ) -> Option<T> {
        let read = async {
            let place = self.places.clone().acquire_owned().await.expect("the semaphore is never closed");
            tokio::task::spawn_blocking(move || {
                let read = work();
                drop(place);
                read
            })
            .await
        };
        match tokio::time::timeout(patience, read).await {
            Ok(Ok(Ok(read))) => return Some(read),
            Ok(Ok(Err(error @ StoreError::Away { .. }))) => {
                count(&self.counts.reads_away);
                tracing::debug!(%error, "an artifact was not looked for");
                return None;
            }
            Ok(Ok(Err(error))) => tracing::warn!(%error, "an artifact could not be read"),
            Ok(Err(error)) => tracing::error!(%error, "reading an artifact panicked"),
            Err(_) => {
                count(&self.counts.reads_given_up);
                tracing::warn!(?patience, "the disk did not answer in time");
                return None;
            }
        }
        count(&self.counts.reads_failed);
        None
    }
}
