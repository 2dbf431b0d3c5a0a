//! What is known of a job that was accepted.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::watch;

use crate::job::Resolved;
use crate::job::key::Key;
use crate::job::limits::Estimate;
use crate::output::Format;
use crate::service::computation::Timings;
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::peer::{Paid, Peer, Ticket};
use crate::service::pool::Lane;
use crate::service::store::Pin;
use crate::service::under_way::Interest;

/// Charged for a record besides its request: its counts a level, its places in the maps.
/// Half of it is less than a job of many levels takes; twice of it holds half as many records in their share.
const RECORD_BYTES: u64 = 8 << 10;
/// Charged for each output beside the first: its name, its key, how it was made, with a warning.
/// Half of it is less than an output with a long name takes; twice of it refuses jobs of many outputs sooner.
const OUTPUT_BYTES: u64 = 1 << 10;

/// How often a job is begun that never comes to an end because the process ends before.
/// Half of it gives up jobs that two crashes of others have met; twice of it lets one job end the process twelve times.
pub(super) const MOST_STARTS: u32 = 6;
/// How long a job that was begun twice without an end waits after the next start, seconds; twice as long after each
/// further one. Half of it suspects more of the jobs that a process meets which is ended every second by something
/// else; twice of it makes the last attempt wait for a quarter of a minute.
const FIRST_PAUSE_S: u64 = 1;

/// One output of a job.
#[derive(Debug, Clone)]
pub struct Product {
    /// Its name.
    pub name: String,
    /// The format of its bytes.
    pub format: &'static dyn Format,
    /// The key of its bytes.
    pub key: Key,
}

/// What a job was predicted to come to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Predicted {
    /// Points or vertices after the prefix, and after each level.
    pub vertices: Vec<u64>,
    /// Faces of the result.
    pub faces: u64,
    /// Memory while it runs, bytes.
    pub memory_bytes: u64,
    /// Time of one output on one core, milliseconds.
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

/// What is known of a job without its input.
#[derive(Debug, Clone)]
pub struct JobSummary {
    /// Its outputs.
    pub products: Vec<Product>,
    /// What it was to come to.
    pub cost: Predicted,
    /// How close to the limit it comes, where a tolerance was asked for.
    pub reached: Option<Resolved>,
    /// Keys of the results to which its outputs refer.
    pub details: Vec<Key>,
    /// The uploads that its request names.
    pub blobs: Vec<Key>,
    /// The request as it was sent, from which its results can be made at any time.
    pub request: Bytes,
}

impl JobSummary {
    /// What a record of it takes.
    pub(super) fn record_bytes(&self) -> u64 {
        RECORD_BYTES + OUTPUT_BYTES * self.products.len().saturating_sub(1) as u64 + self.request.len() as u64
    }

    /// The keys of its outputs and of all that they refer to.
    pub(super) fn artifacts(&self) -> impl Iterator<Item = Key> + '_ {
        self.products.iter().map(|product| product.key).chain(self.details.iter().copied())
    }
}

/// What became of an output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Made {
    /// It was made, or was there.
    Done {
        /// Its length in bytes.
        bytes: u64,
        /// What the client should know about it.
        warnings: Vec<String>,
        /// How long it took.
        timings: Timings,
    },
    /// Why there is none.
    Failed(String),
}

/// Whether a job goes on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// It waits for its turn, or is being computed.
    Active,
    /// All outputs were made.
    Done,
    /// Some output was not made, or all were not; why.
    Failed(String),
    /// It was cancelled.
    Cancelled,
}

impl State {
    /// That of a job which seems to end the process whenever it is begun.
    pub(super) fn poisoned(starts: u32) -> Self {
        Self::Failed(format!(
            "it was begun {starts} times, and each time the process ended before it; look at the log and the memory of \
             the server, and send it again"
        ))
    }
}

impl Record {
    /// Returns how long the job waits after a start of the process before it gets into line again: a job that ends the
    /// process lets others come to their end, and one that only happened to run is not begun again by every process
    /// that is as short-lived.
    pub fn pause(&self) -> Duration {
        let doublings = self.starts.saturating_sub(2).min(MOST_STARTS);
        Duration::from_secs(if self.starts < 2 { 0 } else { FIRST_PAUSE_S << doublings })
    }

    /// Whether results of the job that are not kept may be made for whoever asks for them: it goes on, or it is done.
    pub fn may_be_made_again(&self) -> bool {
        matches!(self.state, State::Active | State::Done)
    }
}

/// Who wants a job of a tenant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// A client that has posted it.
    Client,
    /// A batch of the tenant.
    Batch(Key),
}

/// All who want a job of a tenant: a batch that is cancelled leaves the jobs that somebody has posted by themselves.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Whether a client has posted it.
    pub is_posted: bool,
    /// The batches.
    pub batches: BTreeSet<Key>,
}

impl Wanted {
    /// A job that one wants.
    pub(super) fn by(holder: Holder) -> Self {
        let mut wanted = Self::default();
        wanted.add(holder);
        wanted
    }

    /// One more wants it.
    pub(super) fn add(&mut self, holder: Holder) {
        match holder {
            Holder::Client => self.is_posted = true,
            Holder::Batch(batch) => {
                self.batches.insert(batch);
            }
        }
    }

    /// A batch wants it no more; true when nobody does now.
    pub(super) fn remove(&mut self, batch: &Key) -> bool {
        self.batches.remove(batch);
        self.batches.is_empty() && !self.is_posted
    }
}

/// One tenant's interest in the outputs of a job.
#[derive(Debug, Clone)]
pub struct Record {
    /// The job.
    pub job: JobKey,
    /// Its place among all records: later ones have larger numbers.
    pub number: u64,
    /// What the job is.
    pub summary: Arc<JobSummary>,
    /// How often it was queued.
    pub attempts: u32,
    /// How often it was begun in processes that ended before it.
    pub starts: u32,
    /// Who wants it.
    pub wanted: Wanted,
    /// What was said of its turn.
    pub terms: JobTerms,
    /// Whose turn it takes.
    pub peer: Peer,
    /// Whether it goes on.
    pub state: State,
    /// What became of each output.
    pub made: Vec<Option<Made>>,
    /// The output that is being computed.
    pub computing: Option<(usize, Arc<Interest>)>,
    /// When it was queued, by the clock of the service.
    pub queued: Duration,
    /// When its turn came.
    pub begun: Option<Duration>,
    /// When nothing more was to happen.
    pub settled: Option<Duration>,
    /// Comes true when nothing more will happen to this record.
    pub ended: Arc<watch::Sender<bool>>,
    pub(super) _memory: Arc<Paid>,
    /// Keeps the uploads that it needs.
    pub(super) pins: Vec<Arc<Pin>>,
    /// One of the jobs that its peer may have under way.
    pub(super) ticket: Option<Arc<Ticket>>,
}

impl Record {
    /// Whether it goes on.
    pub fn is_active(&self) -> bool {
        self.state == State::Active
    }

    /// The lane of its longest computation.
    pub fn lane(&self, lane_of: impl Fn(u128, u128) -> Lane) -> Lane {
        lane_of(self.summary.cost.time_ms.into(), self.summary.cost.memory_bytes.into())
    }
}
