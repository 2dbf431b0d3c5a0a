//! One computation, shared by all requests and jobs that want its result.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::{Notify, watch};

use super::clock::Clock;
use super::job_key::Tenant;
use super::lock::lock;
use super::pool::Busy;
use super::store::{Manifest, Owners};
use crate::job::key::Key;
use crate::job::{JobFault, RunError};
use crate::watch::{Stage, Watch};

/// The phase of a computation.
#[derive(Debug, Clone)]
pub enum Phase {
    /// The computation waits for its turn.
    Queued,
    /// The computation runs.
    Running,
    /// The computation has finished with a result.
    Done(Arc<Outcome>),
    /// The computation has ended without a result.
    Failed(Failure),
}

impl Phase {
    /// Returns whether the computation has ended.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Done(_) | Self::Failed(_))
    }
}

/// The result of a computation.
#[derive(Debug)]
pub struct Outcome {
    /// The manifest of the bytes.
    pub manifest: Arc<Manifest>,
    /// The bytes themselves, if no store could take them.
    pub loose: Option<Bytes>,
    /// The durations of the stages.
    pub timings: Timings,
}

/// The reason why a computation ended without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// Nobody was interested any more, or the computation was cancelled.
    Cancelled,
    /// The job turned out to be impossible.
    Impossible(JobFault),
    /// The computation ran longer than this limit.
    TimedOut(Duration),
    /// The computation ran too long for the short lane, and the long lane had no place.
    Busy(Busy),
    /// A fault of the service itself.
    Internal(String),
}

impl Failure {
    /// Converts the error of a run that did not exceed its time limit.
    pub(super) fn of(error: RunError) -> Self {
        match error {
            RunError::Stopped(_) => Self::Cancelled,
            RunError::Impossible(fault) => Self::Impossible(fault),
            RunError::Io(error) => Self::Internal(error.to_string()),
        }
    }
}

/// The durations of the stages of a computation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Timings {
    /// Waiting for a turn.
    pub queue: Duration,
    /// Refining.
    pub refine: Duration,
    /// Whether the refinement was a sweep.
    pub swept: bool,
    /// Drawing.
    pub render: Duration,
    /// Writing bytes.
    pub encode: Duration,
}

/// A computation that waits, runs, or has ended.
#[derive(Debug)]
pub struct Computation {
    /// Key of the artifact being made.
    pub key: Key,
    /// The stop flag and the progress.
    pub watch: Watch,
    /// Total work, in the units of the watch (rows).
    pub work: u128,
    phase: watch::Sender<Phase>,
    /// The number of interests of each tenant.
    interests: Mutex<BTreeMap<Tenant, usize>>,
    stopping: Notify,
    overdue: AtomicBool,
    stages: Arc<Stages>,
}

/// The times at which stages began.
#[derive(Debug)]
struct Stages {
    clock: Arc<dyn Clock>,
    begun: Mutex<Vec<(Option<Stage>, Duration)>>,
}

impl Stages {
    fn mark(&self, stage: Option<Stage>) {
        let now = self.clock.now();
        lock(&self.begun).push((stage, now));
    }
}

impl Computation {
    /// Creates a computation that waits for its turn, with one interest of this tenant.
    pub fn new(key: Key, tenant: Tenant, work: u128, clock: Arc<dyn Clock>) -> Self {
        let stages = Arc::new(Stages { clock, begun: Mutex::default() });
        stages.mark(None);
        let watch = Watch::new();
        let observed = stages.clone();
        watch.observe(move |stage| observed.mark(Some(stage)));
        Self {
            key,
            watch,
            work,
            phase: watch::channel(Phase::Queued).0,
            interests: Mutex::new(BTreeMap::from([(tenant, 1)])),
            stopping: Notify::new(),
            overdue: AtomicBool::new(false),
            stages,
        }
    }

    /// Returns the current phase.
    pub fn phase(&self) -> Phase {
        self.phase.borrow().clone()
    }

    /// Marks the computation as running; its stage is refinement until the watch reports another.
    pub fn begin(&self) {
        self.set(Phase::Running);
        self.watch.enter(Stage::Refine);
    }

    /// Sets the phase.
    pub fn set(&self, phase: Phase) {
        self.phase.send_replace(phase);
    }

    /// Waits for the end of the computation, and returns the final phase.
    pub async fn finished(&self) -> Phase {
        let mut receiver = self.phase.subscribe();
        let last = receiver.wait_for(Phase::is_final).await.map(|phase| phase.clone());
        last.unwrap_or_else(|_| self.phase())
    }

    /// Waits for the end: what was made, or why nothing was. A computation has an end as long as it is held.
    ///
    /// # Errors
    /// [`Failure`].
    pub async fn outcome(&self) -> Result<Arc<Outcome>, Failure> {
        match self.finished().await {
            Phase::Done(outcome) => Ok(outcome),
            Phase::Failed(failure) => Err(failure),
            Phase::Queued | Phase::Running => Err(Failure::Cancelled),
        }
    }

    /// Returns the fraction of the work done, from 0 to 0.99.
    #[expect(clippy::cast_precision_loss, reason = "a share needs few digits")]
    pub fn progress(&self) -> f64 {
        // only refinement counts its work, drawing and writing do not: 1 is left for the end
        (self.watch.done() as f64 / self.work.max(1) as f64).min(0.99)
    }

    /// Adds an interest of a tenant; returns whether the tenant had one before. Returns `None` when no interest is
    /// left, since the computation is ending then.
    pub fn join(&self, tenant: Tenant) -> Option<bool> {
        let mut interests = lock(&self.interests);
        if interests.is_empty() {
            return None;
        }
        let own = interests.entry(tenant).or_default();
        *own += 1;
        Some(*own > 1)
    }

    /// Removes an interest of a tenant; returns true if it was the last of all.
    pub fn leave(&self, tenant: Tenant) -> bool {
        let mut interests = lock(&self.interests);
        let Some(own) = interests.get_mut(&tenant) else { return false };
        *own -= 1;
        if *own == 0 {
            interests.remove(&tenant);
        }
        interests.is_empty()
    }

    /// Returns the tenants that are interested in the result now.
    pub fn owners(&self) -> Owners {
        lock(&self.interests).keys().copied().collect()
    }

    /// Ends the computation, whether it waits or runs.
    pub fn stop(&self) {
        self.watch.stop();
        self.stopping.notify_one();
    }

    /// Waits for [`Computation::stop`]. Only one task may wait, the one that drives the computation.
    pub async fn stopped(&self) {
        self.stopping.notified().await;
    }

    /// Ends the computation because it ran too long.
    pub fn run_out(&self) {
        self.overdue.store(true, Ordering::Release);
        self.watch.stop();
    }

    /// Returns whether the computation ran too long.
    pub fn ran_out(&self) -> bool {
        self.overdue.load(Ordering::Acquire)
    }

    /// Returns the number of interests in the result.
    pub fn n_interests(&self) -> usize {
        lock(&self.interests).values().sum()
    }

    /// Returns the current stage; `None` while the computation waits.
    pub fn stage(&self) -> Option<Stage> {
        let begun = lock(&self.stages.begun);
        begun.last().and_then(|(stage, _)| *stage)
    }

    /// Returns the durations of the stages so far.
    pub fn timings(&self) -> Timings {
        let begun = lock(&self.stages.begun);
        let ends = begun.iter().skip(1).map(|(_, end)| *end).chain([self.stages.clock.now()]);
        let mut timings = Timings::default();
        for ((stage, start), end) in begun.iter().zip(ends) {
            let took = end.saturating_sub(*start);
            match stage {
                None => timings.queue += took,
                Some(Stage::Refine) => timings.refine += took,
                Some(Stage::Sweep) => {
                    timings.refine += took;
                    timings.swept = true;
                }
                Some(Stage::Render) => timings.render += took,
                Some(Stage::Encode) => timings.encode += took,
            }
        }
        timings
    }
}
