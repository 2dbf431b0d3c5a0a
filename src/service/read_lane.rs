//! Reading of requests in the lane for reading, for as long as their clients wait.

use super::computation::Failure;
use super::desk::Desk;
use super::peer::{Paid, Peer, QuotaKind};
use super::pool::{Busy, Lack, Lane};
use crate::watch::Watch;

impl Desk {
    /// Charges memory for the body of a request to its client.
    ///
    /// # Errors
    /// The share for bodies, or the part of it that one client may have, is taken.
    pub fn charge_body(&self, peer: Peer, bytes: u64) -> Result<Paid, Busy> {
        let paid = self.peers.charge(&self.account.bodies, QuotaKind::BodyBytes, peer, bytes);
        paid.map_err(|_| self.pool.busy(Lane::Reading, Lack::Bodies))
    }

    /// Charges memory for an answer to its client.
    ///
    /// # Errors
    /// The share for answers, or the part of it that one client may have, is taken.
    pub fn charge_answer(&self, peer: Peer, bytes: u64) -> Result<Paid, Busy> {
        let paid = self.peers.charge(&self.account.answers, QuotaKind::AnswerBytes, peer, bytes);
        paid.map_err(|_| self.pool.busy(Lane::Reading, Lack::Answers))
    }

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
