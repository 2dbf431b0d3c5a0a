//! What is known of a batch.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::watch;

use super::layout::Layout;
use crate::job::key::Key;
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::jobs::{Made, Product, State};
use crate::service::peer::{Paid, Peer, Ticket};

/// Charged for a batch besides its text and its items.
/// Half of it is less than its places in the maps take; twice of it holds fewer batches of few items.
const BATCH_BYTES: u64 = 4 << 10;
/// Charged for an item, and for each of its outputs: a key, a name, how it was made, with a warning.
/// Half of it is less than an output with a long name takes; twice of it holds half as many items.
const ITEM_BYTES: u64 = 512;

/// What a batch asks for.
#[derive(Debug)]
pub struct BatchRequest {
    /// The batch as it was sent.
    pub text: Bytes,
    /// Where its jobs stand in it.
    pub layout: Layout,
    /// How many outputs its jobs have together.
    pub n_outputs: u64,
}

impl BatchRequest {
    /// How many jobs there are.
    pub fn n(&self) -> usize {
        usize::try_from(self.layout.n()).unwrap_or(usize::MAX)
    }

    /// What a record of it takes.
    pub fn bytes(&self) -> u64 {
        BATCH_BYTES + ITEM_BYTES * (self.n() as u64 + self.n_outputs) + self.text.len() as u64
    }
}

/// How an item came to its end.
#[derive(Debug, Clone)]
pub struct Ending {
    /// Whether all its outputs were made.
    pub state: State,
    /// Its outputs, with what became of each; none where its job was never read.
    pub outputs: Vec<(Product, Option<Made>)>,
}

/// One job of a batch.
#[derive(Debug, Clone, Default)]
pub struct Item {
    /// The id of the job, once it was read.
    pub job: Option<Key>,
    /// Whether all its results were there before the batch asked for them.
    pub is_hit: bool,
    /// How it came to its end.
    pub ending: Option<Arc<Ending>>,
}

/// A batch of a tenant.
#[derive(Debug, Clone)]
pub struct Batch {
    /// The batch.
    pub batch: JobKey,
    /// Its place among all batches: later ones have larger numbers.
    pub number: u64,
    /// What it asks for.
    pub request: Arc<BatchRequest>,
    /// How often it was begun.
    pub attempts: u32,
    /// What was said of the turns of its jobs.
    pub terms: JobTerms,
    /// Whose turns they take.
    pub peer: Peer,
    /// Whether it goes on.
    pub state: State,
    /// Its jobs.
    pub items: Vec<Item>,
    /// When it was begun, by the clock of the service.
    pub queued: Duration,
    /// When nothing more was to happen.
    pub settled: Option<Duration>,
    /// Comes true when nothing more will happen to this record.
    pub ended: Arc<watch::Sender<bool>>,
    pub(super) _memory: Arc<Paid>,
    /// One of the batches that its peer may have under way.
    pub(super) ticket: Option<Arc<Ticket>>,
}

impl Batch {
    /// Whether it goes on.
    pub fn is_active(&self) -> bool {
        self.state == State::Active
    }

    /// The jobs that were read and have not come to their end.
    pub(super) fn under_way(&self) -> Vec<JobKey> {
        let going_on = self.items.iter().filter(|item| item.ending.is_none());
        going_on.filter_map(|item| Some(JobKey { tenant: self.batch.tenant, id: item.job? })).collect()
    }
}

/// A batch to be accepted.
#[derive(Debug)]
pub struct NewBatch {
    /// The batch.
    pub batch: JobKey,
    /// What it asks for.
    pub request: Arc<BatchRequest>,
    /// What is said of the turns of its jobs.
    pub terms: JobTerms,
    /// Whose turns they take.
    pub peer: Peer,
    /// Counts it as one of the batches that its peer may have under way.
    pub ticket: Ticket,
}

/// One attempt at a batch.
#[derive(Debug, Clone)]
pub struct BatchRun {
    /// The batch.
    pub batch: JobKey,
    pub(super) number: u64,
    /// Comes true when the attempt is over.
    pub ended: watch::Receiver<bool>,
}
