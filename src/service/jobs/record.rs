//! The record of an accepted job.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::watch;

use crate::job::ResolvedLevel;
use crate::job::key::Key;
use crate::job::limits::Estimate;
use crate::output::Format;
use crate::service::computation::Timings;
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::peer::{Paid, Peer, Ticket};
use crate::service::pool::Lane;
use crate::service::store::Pin;
use crate::service::under_way::Interest;

/// Estimated bytes of a record besides its request: its counts per level, its map entries. Half of it is less than a
/// job of many levels takes; twice of it would hold half as many records in their share of memory.
const RECORD_BYTES: u64 = 8 << 10;
/// Estimated bytes of each output after the first: its name, its key, its result with a warning. Half of it is less
/// than an output with a long name takes; twice of it would refuse jobs of many outputs sooner.
const OUTPUT_BYTES: u64 = 1 << 10;

/// Maximum number of starts of a job without an end, because the process ended first. Half of it would fail jobs that
/// happened to run during two crashes caused by others; twice of it would let one job end the process twelve times.
pub(super) const MAX_STARTS: u32 = 6;
/// Seconds that a job with two starts and no end waits before it is queued again; doubled for each further start. Half
/// of it would suspect more of the jobs that run in a process that something else ends every second; twice of it would
/// make the last attempt wait for a quarter of a minute.
const FIRST_PAUSE_S: u64 = 1;

/// One output of a job.
#[derive(Debug, Clone)]
pub struct Product {
    /// Name of the output.
    pub name: String,
    /// Format of the output's bytes.
    pub format: &'static dyn Format,
    /// Key of the output's bytes.
    pub key: Key,
}

/// The predicted size and cost of a job.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Predicted {
    /// Number of points or vertices after the prefix, and after each level.
    pub vertices: Vec<u64>,
    /// Number of faces of the result.
    pub faces: u64,
    /// Memory during the computation in bytes.
    pub memory_bytes: u64,
    /// Time of one output on one core in milliseconds.
    pub time_ms: u64,
}

impl From<&Estimate> for Predicted {
    fn from(estimate: &Estimate) -> Self {
        let count = |n: u128| u64::try_from(n).unwrap_or(u64::MAX);
        let levels = &estimate.forecast.levels;
        Self {
            vertices: levels.iter().map(|level| count(level.vertices)).collect(),
            faces: levels.last().map_or(0, |level| count(level.faces)),
            memory_bytes: count(estimate.memory_bytes),
            time_ms: count(estimate.time_ms),
        }
    }
}

/// The description of a job without its input.
#[derive(Debug, Clone)]
pub struct JobSummary {
    /// The outputs of the job.
    pub products: Vec<Product>,
    /// The predicted size and cost.
    pub cost: Predicted,
    /// The level chosen for a requested tolerance, with the bound of the distance from the limit.
    pub reached: Option<ResolvedLevel>,
    /// Keys of further results that the outputs refer to.
    pub details: Vec<Key>,
    /// Keys of the uploads that the request names.
    pub blobs: Vec<Key>,
    /// The request as it was sent, from which the results can be made again at any time.
    pub request: Bytes,
}

impl JobSummary {
    /// Returns the estimated bytes of a record of this job.
    pub(super) fn record_bytes(&self) -> u64 {
        RECORD_BYTES + OUTPUT_BYTES * self.products.len().saturating_sub(1) as u64 + self.request.len() as u64
    }

    /// Returns the keys of the outputs and of the results that they refer to.
    pub(super) fn artifacts(&self) -> impl Iterator<Item = Key> + '_ {
        self.products.iter().map(|product| product.key).chain(self.details.iter().copied())
    }
}

/// The result of an output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutputResult {
    /// The output was made, or was stored already.
    Done {
        /// Length in bytes.
        bytes: u64,
        /// Warnings for the client.
        warnings: Vec<String>,
        /// Time that the output took.
        timings: Timings,
    },
    /// The output could not be made, for this reason.
    Failed(String),
}

/// The state of a job or a batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JobState {
    /// The job or batch waits for its turn, or is being computed.
    Active,
    /// All outputs were made.
    Done,
    /// Some output was not made, for this reason.
    Failed(String),
    /// The job or batch was cancelled.
    Cancelled,
}

impl JobState {
    /// Returns the state of a job during which the process has ended `starts` times, so that it seems to be the cause.
    pub(super) fn poisoned(starts: u32) -> Self {
        Self::Failed(format!(
            "it was begun {starts} times, and each time the process ended before it; look at the log and the memory of \
             the server, and send it again"
        ))
    }
}

/// One party that wants a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// A client that has posted the job.
    Client,
    /// A batch of the same tenant.
    Batch(Key),
}

/// All parties that want a job. When a batch is cancelled, jobs that a client has posted or another batch wants
/// continue.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Requesters {
    /// Whether a client has posted the job.
    pub is_posted: bool,
    /// The batches that want the job.
    pub batches: BTreeSet<Key>,
}

impl Requesters {
    /// Returns the set of one party.
    pub(super) fn by(holder: Holder) -> Self {
        let mut wanted = Self::default();
        wanted.add(holder);
        wanted
    }

    /// Adds a party.
    pub(super) fn add(&mut self, holder: Holder) {
        match holder {
            Holder::Client => self.is_posted = true,
            Holder::Batch(batch) => {
                self.batches.insert(batch);
            }
        }
    }

    /// Removes a batch; returns true if nobody wants the job any more.
    pub(super) fn remove(&mut self, batch: &Key) -> bool {
        self.batches.remove(batch);
        self.batches.is_empty() && !self.is_posted
    }
}

/// The record of one tenant's job.
#[derive(Debug, Clone)]
pub struct Record {
    /// The job.
    pub job: JobKey,
    /// Position among all records; later records have larger numbers.
    pub number: u64,
    /// The description of the job.
    pub summary: Arc<JobSummary>,
    /// Number of times that the job was queued.
    pub attempts: u32,
    /// Number of starts of the job in processes that ended before it did, plus one while it runs.
    pub starts: u32,
    /// The parties that want the job.
    pub wanted: Requesters,
    /// The priority and the time limits of the job.
    pub terms: JobTerms,
    /// The client whose turn the job takes.
    pub peer: Peer,
    /// The state of the job.
    pub state: JobState,
    /// The result of each output, once there is one.
    pub made: Vec<Option<OutputResult>>,
    /// The index of the output that is being computed, and this job's interest in the computation.
    pub computing: Option<(usize, Arc<Interest>)>,
    /// Time at which the job was queued, by the clock of the service.
    pub queued: Duration,
    /// Time at which the job's turn came.
    pub begun: Option<Duration>,
    /// Time at which the job was settled.
    pub settled: Option<Duration>,
    /// Becomes true when nothing more will happen to this record.
    pub ended: Arc<watch::Sender<bool>>,
    pub(super) _memory: Arc<Paid>,
    /// Pins on the uploads that the job needs.
    pub(super) pins: Vec<Arc<Pin>>,
    /// The job's share of the jobs that its client may have under way.
    pub(super) ticket: Option<Arc<Ticket>>,
}

impl Record {
    /// Returns how long the job waits after a start of the process before it is queued again. The pause lets other jobs
    /// finish before a job that ends the process, and spares an innocent job further starts in short-lived processes.
    pub fn pause(&self) -> Duration {
        let doublings = self.starts.saturating_sub(2).min(MAX_STARTS);
        Duration::from_secs(if self.starts < 2 { 0 } else { FIRST_PAUSE_S << doublings })
    }

    /// Returns whether results of the job that are no longer stored may be made again on request: the job is active or
    /// done.
    pub fn may_be_made_again(&self) -> bool {
        matches!(self.state, JobState::Active | JobState::Done)
    }

    /// Returns whether the job waits or runs.
    pub fn is_active(&self) -> bool {
        self.state == JobState::Active
    }

    /// Returns the lane of the job's longest computation; `lane_of` takes milliseconds and bytes.
    pub fn lane(&self, lane_of: impl Fn(u128, u128) -> Lane) -> Lane {
        lane_of(self.summary.cost.time_ms.into(), self.summary.cost.memory_bytes.into())
    }
}
