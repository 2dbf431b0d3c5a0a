//! The desk: finds an artifact, joins the computation that is making it, or starts one.

use std::future::Future;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use super::account::Account;
use super::batches::{Batches, Begun};
use super::clock::Clock;
use super::computation::{Computation, Failure, Outcome, Phase};
use super::jobs::Jobs;
use super::kept_work::KeptWork;
use super::lent::{InFlight, Lent};
use super::peer::{Peer, Peers, QuotaKind, Ticket};
use super::pool::{Busy, ComputePlace, Lack, Lane, LaneMemory, Panicked, Pool, WaitingRequest};
use super::queue::Queue;
use super::result_buffer::ResultBuffer;
use super::store::{ArtifactDescription, Manifest, Usage};
use super::tally::{LookupResult, Tally};
use super::task::Task;
use super::tiers::{Stored, Tiers};
use super::under_way::{Interest, UnderWay};
use super::uploads::Uploads;
use crate::job::RunError;
use crate::job::key::Key;
use crate::job::limits::Limits;
use tokio::sync::watch;

/// The state of one service: its stores, threads, memory, jobs and counters.
#[derive(Debug)]
pub struct Desk {
    /// The limits of one job.
    pub limits: Limits,
    /// The stores of artifacts.
    pub tiers: Tiers,
    /// The compute threads.
    pub pool: Pool,
    /// The memory account.
    pub account: Account,
    /// The artifacts in memory that are being sent.
    pub in_flight: InFlight,
    /// The amounts that each client holds of what clients share.
    pub peers: Arc<Peers>,
    /// Intermediate work of computations that later ones reuse.
    pub work: KeptWork,
    /// The records of jobs that outlast their request.
    pub jobs: Jobs,
    /// The records of batches.
    pub batches: Batches,
    /// Batches that were accepted or resumed and are to be processed.
    pub(super) begun: Begun,
    /// The queue of jobs that wait for their turn.
    pub queue: Arc<dyn Queue>,
    /// The files that clients sent.
    pub uploads: Uploads,
    /// Counters of computations, jobs and lookups.
    pub tally: Arc<Tally>,
    /// Limits on the amount and the duration of work.
    pub terms: Terms,
    pub(super) clock: Arc<dyn Clock>,
    under_way: Arc<UnderWay>,
    /// Becomes true when the service is to end.
    pub(super) ending: watch::Sender<bool>,
}

/// The records and the queue of jobs that outlast their request, and the uploads they use.
#[derive(Debug)]
pub struct JobKeeping {
    /// The records of jobs.
    pub jobs: Jobs,
    /// The records of batches.
    pub batches: Batches,
    /// The queue of jobs.
    pub queue: Arc<dyn Queue>,
    /// The uploads that jobs may name.
    pub uploads: Uploads,
}

/// Limits on the amount and the duration of work of one desk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terms {
    /// Maximum running time of one computation.
    pub run_timeout: Duration,
    /// Maximum time of a computation in the short lane; after it the computation starts again in the long lane.
    pub short_time: Duration,
    /// Maximum number of waiting requests of one peer, and of its jobs that continue without their request.
    pub most_a_peer: u64,
    /// Maximum number of waiting requests of all peers.
    pub most_waiting: u64,
    /// Maximum number of jobs that wait in a lane.
    pub most_jobs: usize,
    /// The time for which the record of a job is kept after the job is settled.
    pub job_ttl: Duration,
}

impl Desk {
    /// Creates a desk.
    pub fn new(
        limits: Limits,
        tiers: Tiers,
        pool: Pool,
        account: Account,
        JobKeeping { jobs, batches, queue, uploads }: JobKeeping,
        (terms, clock): (Terms, Arc<dyn Clock>),
    ) -> Self {
        let (peers, under_way, ending) = (Arc::default(), Arc::default(), watch::channel(false).0);
        let (in_flight, work) = (InFlight::default(), KeptWork::new(account.work_bytes));
        let tally = jobs.tally().clone();
        Self {
            limits,
            tiers,
            pool,
            account,
            in_flight,
            peers,
            work,
            jobs,
            batches,
            begun: Begun::default(),
            queue,
            uploads,
            tally,
            terms,
            clock,
            under_way,
            ending,
        }
    }

    /// Returns the manifest of an artifact, if it is in memory and was made for the tenant of this peer.
    pub fn at_hand(&self, key: &Key, peer: Peer) -> Option<Arc<Manifest>> {
        let found = self.tiers.at_hand(key).filter(|manifest| manifest.owners.contain(peer.tenant()));
        found.inspect(|_| self.count_hit())
    }

    /// Counts an artifact that was found in memory.
    pub fn count_hit(&self) {
        self.tally.looked(LookupResult::Memory);
    }

    /// Returns the manifest of an artifact, if a store has it and it was made for the tenant of this peer.
    pub async fn find_artifact(self: &Arc<Self>, key: Key, peer: Peer) -> Option<Arc<Manifest>> {
        if let Some(manifest) = self.at_hand(&key, peer) {
            return Some(manifest);
        }
        let found = self.tiers.find(&key).await.filter(|manifest| manifest.owners.contain(peer.tenant()));
        self.tally.looked(if found.is_some() { LookupResult::Disk } else { LookupResult::Nowhere });
        found
    }

    /// Joins the computation of a task for a peer, or starts it.
    ///
    /// # Errors
    /// [`Busy`] when too many wait already.
    pub fn compute(self: &Arc<Self>, task: Arc<dyn Task>, peer: Peer) -> Result<Interest, Busy> {
        self.compute_for(task, peer, self.ticket(peer, QuotaKind::Waiting), Pool::line_up)
    }

    /// Computes like [`Desk::compute`], for a job accepted earlier: the number of computations that its peer has in
    /// line is no limit.
    ///
    /// # Errors
    /// [`Busy`] when the line is full.
    pub(super) fn compute_accepted(self: &Arc<Self>, task: Arc<dyn Task>, peer: Peer) -> Result<Interest, Busy> {
        let ticket = self.peers.take(peer, QuotaKind::Accepted, 1, u64::MAX, u64::MAX);
        self.compute_for(task, peer, ticket, Pool::line_up_again)
    }

    fn compute_for(
        self: &Arc<Self>,
        task: Arc<dyn Task>,
        peer: Peer,
        ticket: Option<Ticket>,
        line_up: impl FnOnce(&Pool, Lane, Peer, u128) -> Result<WaitingRequest, Busy>,
    ) -> Result<Interest, Busy> {
        let (key, cost) = (task.key(), task.cost());
        let lane = self.pool.lane_of(cost.time_ms, cost.memory_bytes);
        let ticket = ticket.ok_or_else(|| self.pool.busy(lane, Lack::Waiting))?;
        let mut place = None;
        let begin = || {
            place = Some(line_up(&self.pool, lane, peer, cost.memory_bytes)?);
            Ok(Arc::new(Computation::new(key, peer.tenant(), cost.work, self.clock.clone())))
        };
        let interest = self.under_way.join_or_begin(key, ticket, begin)?;
        if let Some(waiting) = place {
            tokio::spawn(self.clone().see_through(interest.computation.clone(), task, peer, lane, waiting));
        }
        Ok(interest)
    }

    /// Takes a ticket for one more thing that a peer holds, if the limits allow it.
    pub(super) fn ticket(&self, peer: Peer, kind: QuotaKind) -> Option<Ticket> {
        let most_of_all = if kind == QuotaKind::Waiting { self.terms.most_waiting } else { u64::MAX };
        self.peers.take(peer, kind, 1, self.terms.most_a_peer, most_of_all)
    }

    /// Runs a task when its turn comes; if it takes too long for the short lane, it starts again in the long one.
    async fn see_through(
        self: Arc<Self>,
        computation: Arc<Computation>,
        task: Arc<dyn Task>,
        peer: Peer,
        mut lane: Lane,
        mut waiting: WaitingRequest,
    ) {
        let phase = loop {
            let place = tokio::select! {
                place = self.pool.compute_place(lane, waiting) => place,
                () = computation.stopped() => break Phase::Failed(Failure::Cancelled),
            };
            let phase = self.clone().run_task(&computation, &task, lane, place).await;
            let is_moved = matches!(&phase, Phase::Failed(Failure::Cancelled)) && computation.watch.is_set_aside();
            if !is_moved {
                break phase;
            }
            lane = Lane::Long;
            match self.pool.line_up_again(lane, peer, task.cost().memory_bytes) {
                Ok(again) => waiting = again,
                Err(busy) => break Phase::Failed(Failure::Busy(busy)),
            }
            computation.watch.begin_again();
            computation.set(Phase::Queued);
        };
        let stored = match &phase {
            Phase::Done(outcome) if outcome.loose.is_none() => Some(outcome.manifest.clone()),
            _ => None,
        };
        self.under_way.remove(&computation); // before its final phase is published
        self.tally.computed(&phase);
        computation.set(phase);
        stored.into_iter().for_each(|manifest| self.tiers.persist(&manifest));
    }

    /// Runs a task at a place among the compute threads, within the time limit of the lane.
    async fn run_task(
        self: Arc<Self>,
        computation: &Arc<Computation>,
        task: &Arc<dyn Task>,
        lane: Lane,
        place: ComputePlace,
    ) -> Phase {
        let Terms { run_timeout, short_time, .. } = self.terms;
        if computation.watch.check().is_err() {
            return Phase::Failed(Failure::Cancelled);
        }
        computation.begin();
        let start = self.clock.now();
        let (desk, made, of_task) = (self.clone(), computation.clone(), task.clone());
        let making = place.spawn_keeping(move || desk.make_stored(&made, &*of_task));
        let aside = (lane == Lane::Short).then_some(short_time);
        let made = until_overdue(making, computation, aside, run_timeout).await;
        self.pool.finished(lane, self.clock.now().saturating_sub(start));
        match made {
            Ok((Ok(outcome), memory)) => Phase::Done(Arc::new(self.charged(outcome, memory))),
            Ok((Err(RunError::Stopped(_)), _)) if computation.ran_out() => {
                Phase::Failed(Failure::TimedOut(run_timeout))
            }
            Ok((Err(error), _)) => Phase::Failed(Failure::of(error)),
            Err(Panicked(message)) => Phase::Failed(Failure::Internal(format!("a computation panicked: {message}"))),
        }
    }

    /// Charges the bytes of an outcome that no store has until the last response has sent them: to the share of
    /// answers, or, if that has no room, by keeping the memory of the computation.
    fn charged(&self, mut outcome: Outcome, memory: Option<LaneMemory>) -> Outcome {
        let Some(bytes) = outcome.loose.take() else { return outcome };
        let length = bytes.len() as u64;
        outcome.loose = Some(match (self.account.answers.take_if_free(length), memory) {
            (None, Some(mut memory)) => {
                memory.shrink_to(length);
                Lent::new(bytes, memory)
            }
            (held, _) => Lent::new(bytes, held),
        });
        outcome
    }

    /// Computes a result into a store; if no store takes the bytes, keeps them for this response only. Computes a
    /// second time only if the disk has lost the bytes.
    fn make_stored(&self, computation: &Computation, task: &dyn Task) -> Result<Outcome, RunError> {
        let (key, about, work) = (computation.key, task.cost().result_bytes, self.work.of(&computation.owners()));
        let made = |buffer: &mut ResultBuffer<'_>| {
            let report = task.run(buffer, &work, &computation.watch)?;
            let (media_type, owners) = (task.media_type().into(), computation.owners());
            let description = ArtifactDescription { media_type, warnings: report.warnings, owners };
            let Stored { manifest, loose } = buffer.commit(description).map_err(|error| RunError::Io(error.into()))?;
            Ok(Outcome { manifest, loose, timings: computation.timings() })
        };
        let mut buffer = ResultBuffer::new(&self.tiers, key, about);
        match made(&mut buffer) {
            Err(RunError::Io(error)) if buffer.has_lost_bytes() => {
                tracing::warn!(%key, %error, "the disk lost the result; it is made again, in memory");
                made(&mut ResultBuffer::in_memory(&self.tiers, key, about))
            }
            made => made,
        }
    }

    /// Returns the names of the lines that are full and of the memory shares that refuse requests. The shares of the
    /// lanes are left out, since a lane without free memory is at work, and so is that of records, since old records
    /// make room.
    pub fn full(&self) -> Vec<&'static str> {
        let Account { bodies, inputs, answers, .. } = &self.account;
        let shares = [bodies, inputs, answers].into_iter().filter(|share| share.is_full()).map(|share| share.name);
        shares.chain(self.pool.full_lanes()).collect()
    }

    /// Returns the name and the usage of each store.
    pub fn stores(&self) -> Vec<(&'static str, Usage)> {
        let uploads = ("uploads", self.uploads.usage());
        self.tiers.usage().into_iter().chain([uploads]).collect()
    }

    /// Returns the number of computations that wait or run.
    pub fn n_under_way(&self) -> usize {
        self.under_way.len()
    }

    /// Waits until no computation waits or runs and, if jobs do not outlast the process, no job is active.
    pub async fn idle(&self) {
        loop {
            if let Some(computation) = self.under_way.any() {
                computation.finished().await;
            } else if let Some(job) = self.jobs.any_active().filter(|_| !self.jobs.is_durable()) {
                // the record holds the sender, and is forgotten only after the end
                let _ = job.ended.subscribe().wait_for(|ended| *ended).await;
            } else {
                return;
            }
        }
    }

    /// Returns the clock of the service.
    pub fn clock(&self) -> Arc<dyn Clock> {
        self.clock.clone()
    }

    /// Signals the end of the service: event streams end and, if jobs outlast the process, no further job starts.
    pub fn end(&self) {
        self.ending.send_replace(true);
    }

    /// Waits for the signal that the service is to end.
    pub async fn ended(&self) {
        // the desk itself holds the sender
        let _ = self.ending.subscribe().wait_for(|ending| *ending).await;
    }

    /// Returns whether the service is to end.
    pub fn is_ending(&self) -> bool {
        *self.ending.borrow()
    }

    /// Stops every computation, at the end of the service.
    pub fn stop(&self) {
        self.under_way.stop();
    }

    /// Returns the number of interests of requests and jobs in computations.
    pub fn n_interests(&self) -> usize {
        self.under_way.n_interests()
    }
}

/// Waits for a computation, sets it aside when it exceeds the time limit of its lane, and stops it when it exceeds the
/// time limit of any computation.
async fn until_overdue<T>(
    making: impl Future<Output = T>,
    computation: &Computation,
    aside: Option<Duration>,
    timeout: Duration,
) -> T {
    let mut making = pin!(making);
    let aside = aside.filter(|aside| *aside < timeout);
    if let Ok(made) = tokio::time::timeout(aside.unwrap_or(timeout), &mut making).await {
        return made;
    }
    if aside.is_some() {
        computation.watch.set_aside();
    } else {
        computation.run_out();
    }
    making.await
}
