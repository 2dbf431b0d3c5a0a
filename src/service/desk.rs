//! The desk: finds an artifact, joins the computation that is making it, or has it made.

use std::any::Any;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::clock::Clock;
use super::computation::{Computation, Failure, Outcome, Phase};
use super::draft::{Draft, Kept};
use super::jobs::{Jobs, Record, State};
use super::pool::{Busy, Lane, Pool, Turn};
use super::store::{Description, Manifest};
use super::tiers::Tiers;
use crate::job::key::Key;
use crate::job::limits::{Admitted, Limits};
use crate::job::{RunError, run};

/// The desk of one service.
#[derive(Debug)]
pub struct Desk {
    /// What is taken on.
    pub limits: Limits,
    /// Where artifacts are kept.
    pub tiers: Tiers,
    /// Who computes.
    pub pool: Pool,
    /// Jobs that outlast their request.
    pub jobs: Jobs,
    /// Longest time one computation may run.
    pub run_timeout: Duration,
    clock: Arc<dyn Clock>,
    under_way: Mutex<HashMap<Key, Arc<Computation>>>,
}

/// How an artifact came about, for `Cache-Status`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// It was there.
    Hit,
    /// It was made for this request.
    Made,
    /// It was being made for another request.
    Joined,
}

/// An interest in a computation; when the last one is dropped the computation stops.
#[derive(Debug)]
pub struct Interest {
    /// The computation.
    pub computation: Arc<Computation>,
    /// Whether it was under way already.
    pub origin: Origin,
    desk: Arc<Desk>,
}

impl Drop for Interest {
    fn drop(&mut self) {
        let mut under_way = self.desk.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        if self.computation.leave() {
            self.computation.stop();
            let key = self.computation.key;
            if under_way.get(&key).is_some_and(|current| Arc::ptr_eq(current, &self.computation)) {
                under_way.remove(&key);
            }
        }
    }
}

impl Desk {
    /// A desk.
    pub fn new(limits: Limits, tiers: Tiers, pool: Pool, run_timeout: Duration, clock: Arc<dyn Clock>) -> Self {
        Self { limits, tiers, pool, jobs: Jobs::default(), run_timeout, clock, under_way: Mutex::default() }
    }

    /// The artifact of a key, if it is kept anywhere.
    pub async fn find(self: &Arc<Self>, key: Key) -> Option<Arc<Manifest>> {
        self.tiers.find(&key).await
    }

    /// Joins the computation of an output, or starts it.
    ///
    /// # Errors
    /// [`Busy`] when too many wait already.
    pub fn compute(self: &Arc<Self>, admitted: Arc<Admitted>, output: usize) -> Result<Interest, Busy> {
        let (key, size) = admitted.estimate().outputs[output];
        let mut under_way = self.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(computation) = under_way.get(&key).filter(|computation| computation.join()) {
            return Ok(Interest { computation: computation.clone(), origin: Origin::Joined, desk: self.clone() });
        }
        let lane = Lane::of(admitted.estimate().time_ms);
        let waiting = self.pool.line_up(lane)?;
        let computation = Arc::new(Computation::new(key, admitted.estimate().forecast.work, self.clock.clone()));
        under_way.insert(key, computation.clone());
        drop(under_way);
        let (desk, task) = (self.clone(), computation.clone());
        tokio::spawn(async move {
            let turn = tokio::select! {
                turn = desk.pool.turn(lane, admitted.estimate().memory_bytes) => turn,
                () = task.stopped() => return desk.finish(&task, Phase::Failed(Failure::Cancelled)),
            };
            drop(waiting);
            let stopper = tokio::spawn(stop_later(task.clone(), desk.run_timeout));
            let worker = (desk.clone(), task.clone());
            let made =
                tokio::task::spawn_blocking(move || worker.0.make(&worker.1, &admitted, output, size.bytes(), turn));
            let phase = made.await.unwrap_or_else(|error| Phase::Failed(Failure::Internal(error.to_string())));
            stopper.abort();
            let stored = match &phase {
                Phase::Done(outcome) if outcome.loose.is_none() => Some(outcome.manifest.clone()),
                _ => None,
            };
            desk.finish(&task, phase);
            stored.into_iter().for_each(|manifest| desk.persist(manifest));
        });
        Ok(Interest { computation, origin: Origin::Made, desk: self.clone() })
    }

    /// Takes a finished computation off the list, then says so.
    fn finish(&self, computation: &Arc<Computation>, phase: Phase) {
        let mut under_way = self.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        if under_way.get(&computation.key).is_some_and(|current| Arc::ptr_eq(current, computation)) {
            under_way.remove(&computation.key);
        }
        drop(under_way);
        computation.set(phase);
    }

    /// Computes on this thread and the pool's.
    fn make(&self, task: &Computation, admitted: &Admitted, output: usize, about: u128, turn: Turn) -> Phase {
        if task.watch.check().is_err() {
            return Phase::Failed(Failure::Cancelled);
        }
        task.set(Phase::Running);
        let start = self.clock.now();
        let made = catch_unwind(AssertUnwindSafe(|| turn.run(|| self.make_stored(task, admitted, output, about))));
        let took = self.clock.now().saturating_sub(start);
        self.pool.finished(took);
        match made {
            Ok(Ok(outcome)) => Phase::Done(Arc::new(outcome)),
            Ok(Err(RunError::Stopped(_))) if task.ran_out() => Phase::Failed(Failure::TimedOut(self.run_timeout)),
            Ok(Err(RunError::Stopped(_))) => Phase::Failed(Failure::Cancelled),
            Ok(Err(RunError::Impossible(fault))) => Phase::Failed(Failure::Impossible(fault)),
            Ok(Err(RunError::Io(error))) => Phase::Failed(Failure::Internal(error.to_string())),
            Err(panic) => Phase::Failed(Failure::Internal(message(&*panic))),
        }
    }

    /// Computes into a store; where no store takes the bytes, keeps them for this answer alone. Computes again only
    /// what the disk has lost.
    fn make_stored(
        &self,
        task: &Computation,
        admitted: &Admitted,
        output: usize,
        about: u128,
    ) -> Result<Outcome, RunError> {
        let asked = &admitted.job().outputs[output];
        let made = |draft: &mut Draft<'_>| {
            let report = run(admitted, asked, draft, &task.watch)?;
            let description = Description { media_type: asked.format.media_type().into(), warnings: report.warnings };
            let Kept { manifest, loose } = draft.commit(description).map_err(|error| RunError::Io(error.into()))?;
            Ok(Outcome { manifest, loose, timings: task.timings() })
        };
        let mut draft = self.tiers.draft(task.key, about);
        match made(&mut draft) {
            Err(RunError::Io(error)) if draft.has_lost_bytes() => {
                tracing::warn!(key = %task.key, %error, "the disk lost the result; it is made again, in memory");
                made(&mut self.tiers.draft_in_memory(task.key, about))
            }
            made => made,
        }
    }

    /// Makes a job's record follow its computation, so that it goes on without its request.
    pub fn detach(self: &Arc<Self>, id: Key, admitted: Arc<Admitted>, interest: Interest) {
        let artifact = interest.computation.key;
        let again = u32::from(interest.origin == Origin::Made);
        let attempts = self.jobs.get(&id).map_or(1, |record| record.attempts + again);
        let computation = interest.computation.clone();
        let state = State::Active(Arc::new(interest));
        self.jobs.put(Record { id, admitted, artifact, attempts, state });
        let desk = self.clone();
        tokio::spawn(async move {
            let state = match computation.finished().await {
                Phase::Done(outcome) => State::Done(outcome.manifest.clone(), outcome.timings),
                Phase::Failed(failure) => State::Failed(failure),
                Phase::Queued | Phase::Running => return,
            };
            desk.jobs.settle(&id, &computation, state);
        });
    }

    /// Has an artifact that was just made brought to disk, in the background of its answer.
    fn persist(self: &Arc<Self>, manifest: Arc<Manifest>) {
        self.tiers.persist(&manifest);
    }

    /// Computations under way or waiting.
    pub fn n_under_way(&self) -> usize {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Waits until no computation is under way or waiting.
    pub async fn idle(&self) {
        loop {
            let some = self.under_way.lock().unwrap_or_else(PoisonError::into_inner).values().next().cloned();
            let Some(computation) = some else { return };
            computation.finished().await;
        }
    }

    /// Ends every computation, for the end of the service.
    pub fn stop(&self) {
        let under_way = self.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        under_way.values().for_each(|computation| computation.stop());
    }

    /// Requests and jobs that wait for a computation.
    pub fn n_interests(&self) -> usize {
        let under_way = self.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        under_way.values().map(|computation| computation.n_interests()).sum()
    }
}

/// Stops a computation that runs too long.
async fn stop_later(computation: Arc<Computation>, after: Duration) {
    tokio::time::sleep(after).await;
    computation.run_out();
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    format!("a computation panicked: {}", text.unwrap_or_else(|| "no message".to_owned()))
}
