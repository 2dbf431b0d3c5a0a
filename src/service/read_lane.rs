//! Reading of requests in the lane for reading, for as long as their clients wait.

use super::computation::Failure;
use super::desk::Desk;
use super::peer::Peer;
use super::pool::{Busy, Lane};
use crate::watch::Watch;

impl Desk {
    /// Runs work on a request in its turn, with `memory_bytes` of memory. If the future is dropped, the work is
    /// stopped.
    ///
    /// # Errors
    /// [`ReadRefusal`].
    pub async fn read<T: Send + 'static>(
        &self,
        peer: Peer,
        memory_bytes: u64,
        work: impl FnOnce(&Watch) -> T + Send + 'static,
    ) -> Result<T, ReadRefusal> {
        let waiting = self.pool.line_up(Lane::Reading, peer, memory_bytes.into()).map_err(ReadRefusal::Busy)?;
        let place = self.pool.compute_place(Lane::Reading, waiting).await;
        let start = self.clock.now();
        let watch = StopOnDrop(Watch::new());
        let watched = watch.0.clone();
        let reading = place.spawn(move || work(&watched));
        let read = tokio::time::timeout(self.terms.run_timeout, reading).await;
        self.pool.finished(Lane::Reading, self.clock.now().saturating_sub(start));
        match read {
            Ok(read) => {
                read.map_err(|_| ReadRefusal::Failed(Failure::Internal("reading a request panicked".to_owned())))
            }
            Err(_) => Err(ReadRefusal::Failed(Failure::TimedOut(self.terms.run_timeout))),
        }
    }
}

/// Stops the work of a watch when dropped.
#[derive(Debug)]
pub(super) struct StopOnDrop(pub(super) Watch);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.stop();
    }
}

/// The reason why a request was not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReadRefusal {
    /// Too many requests wait to be read.
    Busy(Busy),
    /// The work on the request failed.
    Failed(Failure),
}
