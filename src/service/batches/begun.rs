//! Batches on their way from those who accept them to those who do them.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use super::record::BatchRun;

/// The batches that somebody has to do.
#[derive(Debug, Default)]
pub struct Begun {
    runs: Mutex<VecDeque<BatchRun>>,
    came: Notify,
}

impl Begun {
    fn runs(&self) -> MutexGuard<'_, VecDeque<BatchRun>> {
        self.runs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One more has to be done.
    pub fn put(&self, run: BatchRun) {
        self.runs().push_back(run);
        self.came.notify_one();
    }

    /// The next one, when there is one; for one who asks at a time.
    pub async fn next(&self) -> BatchRun {
        loop {
            let came = self.came.notified();
            let next = self.runs().pop_front();
            match next {
                Some(run) => return run,
                None => came.await,
            }
        }
    }
}
