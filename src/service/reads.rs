//! Reads from the disk: few at a time, so that a disk that hangs holds these few threads and no more.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use super::disk_counts::{DiskCounts, count};
use super::store::StoreError;

/// Most reads at a time. A solid disk gains little beyond four requests of a mebibyte each, and a turning one loses.
/// Half of it leaves a solid disk idle; twice of it gains little and holds twice as many parts.
const PLACES: usize = 4;

/// The places of one disk.
#[derive(Debug)]
pub(super) struct Reads {
    places: Arc<Semaphore>,
    counts: Arc<DiskCounts>,
}

impl Reads {
    pub(super) fn new(counts: Arc<DiskCounts>) -> Self {
        Self { places: Arc::new(Semaphore::new(PLACES)), counts }
    }

    /// Reads on a thread that may block; `None` when it fails, or when no place and answer were had within `patience`.
    /// A read that is given up keeps its place until the disk lets go of it.
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
