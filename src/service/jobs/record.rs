//! What is known of a job that was accepted.

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
