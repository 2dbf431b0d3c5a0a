//! The hand-over of batches from the code that accepts them to the code that runs them.

use std::collections::VecDeque;
use std::sync::Mutex;

use tokio::sync::Notify;

use super::record::BatchRun;
use crate::service::lock::lock;

/// The batches that are to be run.
#[derive(Debug, Default)]
pub struct Begun {
    runs: Mutex<VecDeque<BatchRun>>,
    came: Notify,
}

impl Begun {
    /// Adds a batch.
    pub fn put(&self, run: BatchRun) {
        lock(&self.runs).push_back(run);
        self.came.notify_one();
    }

    /// Takes the next batch, waiting until there is one. Only one caller may wait at a time.
    pub async fn next(&self) -> BatchRun {
        loop {
            let came = self.came.notified();
            let next = lock(&self.runs).pop_front();
            match next {
                Some(run) => return run,
                None => came.await,
            }
        }
    }
}
