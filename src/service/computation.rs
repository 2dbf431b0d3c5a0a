//! One computation under way, shared by everyone who is interested in its result.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::{Notify, watch};

use super::clock::Clock;
use super::job_key::Tenant;
use super::store::{Manifest, Owners};
use crate::job::key::Key;
use crate::job::{JobFault, RunError};
use crate::watch::{Stage, Watch};

/// Where a computation stands.
#[derive(Debug, Clone)]
pub enum Phase {
    /// Waiting for a turn.
    Queued,
    /// Under way.
    Running,
    /// Finished.
    Done(Arc<Outcome>),
    /// Ended without a result.
    Failed(Failure),
}

impl Phase {
    /// Whether nothing more will happen.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Done(_) | Self::Failed(_))
    }
}

/// A result.
#[derive(Debug)]
pub struct Outcome {
    /// What is known of the bytes.
    pub manifest: Arc<Manifest>,
    /// The bytes themselves when no store could take them.
    pub loose: Option<Bytes>,
    /// How long it took.
    pub timings: Timings,
}

/// Why a computation ended without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// Nobody was interested any more, or it was cancelled.
    Cancelled,
    /// The job turned out to be impossible.
    Impossible(JobFault),
    /// It ran longer than a computation may.
    TimedOut(Duration),
    /// It turned out to be long, and there was no place for long work; come back after so much time.
    Busy(Duration),
    /// A fault of the service itself.
    Internal(String),
}

impl Failure {
    /// Why a run failed that was given its time.
    pub(super) fn of(error: RunError) -> Self {
        match error {
            RunError::Stopped(_) => Self::Cancelled,
            RunError::Impossible(fault) => Self::Impossible(fault),
            RunError::Io(error) => Self::Internal(error.to_string()),
        }
    }
}

/// How long the stages of a computation took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Timings {
    /// Waiting for a turn.
    pub queue: Duration,
    /// Refining.
    pub refine: Duration,
    /// Whether that was done by a sweep.
    pub swept: bool,
    /// Drawing.
    pub render: Duration,
    /// Writing bytes.
    pub encode: Duration,
}

/// A computation.
#[derive(Debug)]
pub struct Computation {
    /// Key of the artifact being made.
    pub key: Key,
    /// Its stop flag and progress.
    pub watch: Watch,
    /// Rows to be made in all.
    pub work: u128,
    phase: watch::Sender<Phase>,
    /// How many interests of each tenant there are in it.
    interests: Mutex<BTreeMap<Tenant, usize>>,
    stopping: Notify,
    overdue: AtomicBool,
    stages: Arc<Stages>,
}

/// The moments at which stages began.
#[derive(Debug)]
struct Stages {
    clock: Arc<dyn Clock>,
    begun: Mutex<Vec<(Option<Stage>, Duration)>>,
}

impl Stages {
    fn mark(&self, stage: Option<Stage>) {
        let now = self.clock.now();
        self.begun.lock().unwrap_or_else(PoisonError::into_inner).push((stage, now));
    }
}

impl Computation {
    /// A computation that waits for its turn, with one interest in it, of this tenant.
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

    /// Where it stands.
    pub fn phase(&self) -> Phase {
        self.phase.borrow().clone()
    }

    /// Says that it runs; it refines until it says what else it does.
    pub fn begin(&self) {
        self.set(Phase::Running);
        self.watch.enter(Stage::Refine);
    }

    /// Moves it on.
    pub fn set(&self, phase: Phase) {
        self.phase.send_replace(phase);
    }

    /// Waits until nothing more will happen.
    pub async fn finished(&self) -> Phase {
        let mut receiver = self.phase.subscribe();
        let last = receiver.wait_for(Phase::is_final).await.map(|phase| phase.clone());
        last.unwrap_or_else(|_| self.phase())
    }

    /// Share of the work done, from 0 to 1.
    #[expect(clippy::cast_precision_loss, reason = "a share needs few digits")]
    pub fn progress(&self) -> f64 {
        // refining is counted, drawing and writing are not: 1 is kept for the end
        (self.watch.done() as f64 / self.work.max(1) as f64).min(0.99)
    }

    fn interests(&self) -> MutexGuard<'_, BTreeMap<Tenant, usize>> {
        self.interests.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One interest of a tenant more, and whether it had one before; `None` when nobody had one any more, so that the
    /// computation is ending.
    pub fn join(&self, tenant: Tenant) -> Option<bool> {
        let mut interests = self.interests();
        if interests.is_empty() {
            return None;
        }
        let own = interests.entry(tenant).or_default();
        *own += 1;
        Some(*own > 1)
    }

    /// One interest of a tenant less; true when that was the last of all.
    pub fn leave(&self, tenant: Tenant) -> bool {
        let mut interests = self.interests();
        let Some(own) = interests.get_mut(&tenant) else { return false };
        *own -= 1;
        if *own == 0 {
            interests.remove(&tenant);
        }
        interests.is_empty()
    }

    /// The tenants that are interested in its result now.
    pub fn owners(&self) -> Owners {
        self.interests().keys().copied().collect()
    }

    /// Ends it, whether it waits or runs.
    pub fn stop(&self) {
        self.watch.stop();
        self.stopping.notify_one();
    }

    /// Comes true when it is to end; for the one task that has it made.
    pub async fn stopped(&self) {
        self.stopping.notified().await;
    }

    /// Ends it because it ran too long.
    pub fn run_out(&self) {
        self.overdue.store(true, Ordering::Release);
        self.watch.stop();
    }

    /// Whether it ran too long.
    pub fn ran_out(&self) -> bool {
        self.overdue.load(Ordering::Acquire)
    }

    /// How many are interested in its result.
    pub fn n_interests(&self) -> usize {
        self.interests().values().sum()
    }

    /// What it does now; nothing while it waits, or before it says so.
    pub fn stage(&self) -> Option<Stage> {
        let begun = self.stages.begun.lock().unwrap_or_else(PoisonError::into_inner);
        begun.last().and_then(|(stage, _)| *stage)
    }

    /// How long its stages took so far.
    pub fn timings(&self) -> Timings {
        let begun = self.stages.begun.lock().unwrap_or_else(PoisonError::into_inner);
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
