//! The record of a batch.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::watch;

use super::layout::BatchLayout;
use crate::job::key::Key;
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::jobs::{JobState, OutputResult, Product};
use crate::service::peer::{Paid, Peer, Ticket};

/// Estimated bytes of a batch besides its text and its items. Half of it is less than its map entries take; twice of it
/// would hold fewer batches of few items.
const BATCH_BYTES: u64 = 4 << 10;
/// Estimated bytes of an item, and of each of its outputs: a key, a name, the result with a warning. Half of it is less
/// than an output with a long name takes; twice of it would hold half as many items.
const ITEM_BYTES: u64 = 512;

/// The request of a batch.
#[derive(Debug)]
pub struct ParsedBatch {
    /// The text of the batch as it was sent.
    pub text: Bytes,
    /// The positions of the jobs in the text.
    pub layout: BatchLayout,
    /// Total number of outputs of all jobs.
    pub n_outputs: u64,
}

impl ParsedBatch {
    /// Returns the number of jobs.
    pub fn n(&self) -> usize {
        usize::try_from(self.layout.n()).unwrap_or(usize::MAX)
    }

    /// Returns the estimated bytes of a record of this batch.
    pub fn bytes(&self) -> u64 {
        let n = (self.n() as u64).saturating_add(self.n_outputs);
        ITEM_BYTES.saturating_mul(n).saturating_add(BATCH_BYTES + self.text.len() as u64)
    }
}

/// The end of an item.
#[derive(Debug, Clone)]
pub struct Ending {
    /// The final state: whether all outputs were made, or why not.
    pub state: JobState,
    /// The outputs with their results; empty if the job was never read.
    pub outputs: Vec<(Product, Option<OutputResult>)>,
}

/// One job of a batch.
#[derive(Debug, Clone, Default)]
pub struct BatchItem {
    /// The id of the job, once the job was read.
    pub job: Option<Key>,
    /// Whether all results existed before the batch requested them.
    pub is_hit: bool,
    /// The end of the item, once it is reached.
    pub ending: Option<Arc<Ending>>,
}

/// The record of a batch of one tenant.
#[derive(Debug, Clone)]
pub struct Batch {
    /// The batch.
    pub batch: JobKey,
    /// Position among all batches; later batches have larger numbers.
    pub number: u64,
    /// The request.
    pub request: Arc<ParsedBatch>,
    /// Number of times that the batch was begun.
    pub attempts: u32,
    /// The priority and the time limits of the jobs.
    pub terms: JobTerms,
    /// The client whose turns the jobs take.
    pub peer: Peer,
    /// The state of the batch.
    pub state: JobState,
    /// The jobs of the batch.
    pub items: Vec<BatchItem>,
    /// Time at which the batch was begun, by the clock of the service.
    pub queued: Duration,
    /// Time at which the batch was settled.
    pub settled: Option<Duration>,
    /// Becomes true when nothing more will happen to this record.
    pub ended: Arc<watch::Sender<bool>>,
    pub(super) _memory: Arc<Paid>,
    /// The batch's share of the batches that its client may have under way.
    pub(super) ticket: Option<Arc<Ticket>>,
}

impl Batch {
    /// Returns whether the batch waits or runs.
    pub fn is_active(&self) -> bool {
        self.state == JobState::Active
    }

    /// Returns the jobs that were read and have not ended.
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
    /// The request.
    pub request: Arc<ParsedBatch>,
    /// The priority and the time limits of the jobs.
    pub terms: JobTerms,
    /// The client whose turns the jobs take.
    pub peer: Peer,
    /// The batch's share of the batches that its client may have under way.
    pub ticket: Ticket,
}

/// One attempt to run a batch.
#[derive(Debug, Clone)]
pub struct BatchRun {
    /// The batch.
    pub batch: JobKey,
    pub(super) number: u64,
    /// Becomes true when the attempt is over.
    pub ended: watch::Receiver<bool>,
}
