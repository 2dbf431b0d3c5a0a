//! The hand-over of batches from the code that accepts them to the code that runs them.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use super::record::BatchRun;

/// The batches that are to be run.
#[derive(Debug, Default)]
pub struct Begun {
    runs: Mutex<VecDeque<BatchRun>>,
    came: Notify,
}

impl Begun {
    fn runs(&self) -> MutexGuard<'_, VecDeque<BatchRun>> {
        self.runs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a batch.
    pub fn put(&self, run: BatchRun) {
        self.runs().push_back(run);
        self.came.notify_one();
    }

    /// Takes the next batch, waiting until there is one. Only one caller may wait at a time.
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
