//! The desk: finds an artifact, joins the computation that is making it, or has it made.

use std::future::Future;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use super::account::{Account, Full};
use super::batches::{Batches, Begun};
use super::clock::Clock;
use super::computation::{Computation, Failure, Outcome, Phase};
use super::jobs::Jobs;
use super::kept_work::KeptWork;
use super::lent::{InFlight, Lent};
use super::peer::{Kind, Peer, Peers, Ticket};
use super::pool::{Busy, Lane, Memory, Panicked, Pool, Turn, Waiting};
use super::queue::Queue;
use super::result_buffer::ResultBuffer;
use super::store::{Description, Manifest, Usage};
use super::tally::{Found, Tally};
use super::task::Task;
use super::tiers::{Kept, Tiers};
use super::under_way::{Interest, UnderWay};
use super::uploads::Uploads;
use crate::job::RunError;
use crate::job::key::Key;
use crate::job::limits::Limits;
use tokio::sync::watch;

/// The desk of one service.
#[derive(Debug)]
pub struct Desk {
    /// What is taken on.
    pub limits: Limits,
    /// Where artifacts are kept.
    pub tiers: Tiers,
    /// Who computes.
    pub pool: Pool,
    /// The memory of the service.
    pub account: Account,
    /// The answers on their way.
    pub in_flight: InFlight,
    /// What each client holds.
    pub peers: Arc<Peers>,
    /// What computations leave for later ones.
    pub work: KeptWork,
    /// Jobs that outlast their request.
    pub jobs: Jobs,
    /// Lists of jobs that are done one after the other.
    pub batches: Batches,
    /// Those of them that somebody has to do.
    pub(super) begun: Begun,
    /// The jobs that wait for their turn.
    pub queue: Arc<dyn Queue>,
    /// The files that clients sent.
    pub uploads: Uploads,
    /// What happened, counted.
    pub tally: Arc<Tally>,
    /// How much is taken on, and for how long.
    pub terms: Terms,
    pub(super) clock: Arc<dyn Clock>,
    under_way: Arc<UnderWay>,
    /// Comes true when the service is to end.
    pub(super) ending: watch::Sender<bool>,
}

/// Where jobs are kept that outlast their request, and where they wait.
#[derive(Debug)]
pub struct JobKeeping {
    /// What is known of them.
    pub jobs: Jobs,
    /// What is known of lists of them.
    pub batches: Batches,
    /// Their line.
    pub queue: Arc<dyn Queue>,
    /// The files that they may name.
    pub uploads: Uploads,
}

/// How much work a desk takes on, and for how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terms {
    /// Longest time one computation may run.
    pub run_timeout: Duration,
    /// Longest time a computation may hold a place in the short lane; it is begun again in the long lane then.
    pub short_time: Duration,
    /// Most requests of one peer that wait at once, and most of its jobs that go on without their request.
    pub most_a_peer: u64,
    /// Most requests that wait at once.
    pub most_waiting: u64,
    /// Most jobs that wait in a lane.
    pub most_jobs: usize,
    /// How long a job is known after nothing more will happen to it.
    pub job_ttl: Duration,
}

impl Desk {
    /// A desk.
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

    /// The artifact of a key, if it is in memory and was made for the tenant of this peer.
    pub fn at_hand(&self, key: &Key, peer: Peer) -> Option<Arc<Manifest>> {
        let found = self.tiers.at_hand(key).filter(|manifest| manifest.owners.contain(peer.tenant()));
        found.inspect(|_| self.count_hit())
    }

    /// Counts an artifact that was found in memory.
    pub fn count_hit(&self) {
        self.tally.looked(Found::Memory);
    }

    /// The artifact of a key, if it is kept anywhere and was made for the tenant of this peer.
    pub async fn find(self: &Arc<Self>, key: Key, peer: Peer) -> Option<Arc<Manifest>> {
        if let Some(manifest) = self.at_hand(&key, peer) {
            return Some(manifest);
        }
        let found = self.tiers.find(&key).await.filter(|manifest| manifest.owners.contain(peer.tenant()));
        self.tally.looked(if found.is_some() { Found::Disk } else { Found::Nowhere });
        found
    }

    /// Joins the computation of a task for a peer, or starts it.
    ///
    /// # Errors
    /// [`Busy`] when too many wait already.
    pub fn compute(self: &Arc<Self>, task: Arc<dyn Task>, peer: Peer) -> Result<Interest, Busy> {
        let cost = task.cost();
        let lane = self.pool.lane_of(cost.time_ms, cost.memory_bytes);
        let ticket = self.ticket(peer, Kind::Waiting).ok_or_else(|| self.pool.busy(lane))?;
        self.compute_for(task, peer, ticket, |bytes| self.pool.line_up(lane, peer, bytes))
    }

    /// As [`Desk::compute`], for a job that was accepted before: however many its peer has in line.
    ///
    /// # Errors
    /// [`Busy`] when the line is full.
    pub(super) fn compute_accepted(self: &Arc<Self>, task: Arc<dyn Task>, peer: Peer) -> Result<Interest, Busy> {
        let cost = task.cost();
        let lane = self.pool.lane_of(cost.time_ms, cost.memory_bytes);
        let ticket = self.peers.take(peer, Kind::Accepted, 1, u64::MAX, u64::MAX);
        let ticket = ticket.ok_or_else(|| self.pool.busy(lane))?;
        self.compute_for(task, peer, ticket, |bytes| self.pool.line_up_again(lane, peer, bytes))
    }

    fn compute_for(
        self: &Arc<Self>,
        task: Arc<dyn Task>,
        peer: Peer,
        ticket: Ticket,
        line_up: impl FnOnce(u128) -> Result<Waiting, Busy>,
    ) -> Result<Interest, Busy> {
        let (key, cost) = (task.key(), task.cost());
        let lane = self.pool.lane_of(cost.time_ms, cost.memory_bytes);
        let mut place = None;
        let begin = || {
            place = Some(line_up(cost.memory_bytes)?);
            Ok(Arc::new(Computation::new(key, peer.tenant(), cost.work, self.clock.clone())))
        };
        let interest = self.under_way.join_or_begin(key, ticket, begin)?;
        if let Some(waiting) = place {
            tokio::spawn(self.clone().see_through(interest.computation.clone(), task, peer, lane, waiting));
        }
        Ok(interest)
    }

    /// A ticket for one thing more that a peer holds, where it may.
    pub(super) fn ticket(&self, peer: Peer, kind: Kind) -> Option<Ticket> {
        let most_of_all = if kind == Kind::Waiting { self.terms.most_waiting } else { u64::MAX };
        self.peers.take(peer, kind, 1, self.terms.most_a_peer, most_of_all)
    }

    /// Has a task made when its turn comes; what takes too long for the short lane is begun again in the long one.
    async fn see_through(
        self: Arc<Self>,
        computation: Arc<Computation>,
        task: Arc<dyn Task>,
        peer: Peer,
        mut lane: Lane,
        mut waiting: Waiting,
    ) {
        let phase = loop {
            let turn = tokio::select! {
                turn = self.pool.turn(lane, waiting) => turn,
                () = computation.stopped() => break Phase::Failed(Failure::Cancelled),
            };
            let phase = self.clone().take_turn(&computation, &task, lane, turn).await;
            let is_moved = matches!(&phase, Phase::Failed(Failure::Cancelled)) && computation.watch.is_set_aside();
            if !is_moved {
                break phase;
            }
            lane = Lane::Long;
            match self.pool.line_up_again(lane, peer, task.cost().memory_bytes) {
                Ok(place) => waiting = place,
                Err(busy) => break Phase::Failed(Failure::Busy(busy.retry_after)),
            }
            computation.watch.begin_again();
            computation.set(Phase::Queued);
        };
        let stored = match &phase {
            Phase::Done(outcome) if outcome.loose.is_none() => Some(outcome.manifest.clone()),
            _ => None,
        };
        self.finish(&computation, phase);
        stored.into_iter().for_each(|manifest| self.persist(&manifest));
    }

    /// Has a task made in a turn, for as long as the lane allows.
    async fn take_turn(
        self: Arc<Self>,
        computation: &Arc<Computation>,
        task: &Arc<dyn Task>,
        lane: Lane,
        turn: Turn,
    ) -> Phase {
        let Terms { run_timeout, short_time, .. } = self.terms;
        if computation.watch.check().is_err() {
            return Phase::Failed(Failure::Cancelled);
        }
        computation.begin();
        let start = self.clock.now();
        let (desk, made, of_task) = (self.clone(), computation.clone(), task.clone());
        let making = turn.spawn_keeping(move || desk.make_stored(&made, &*of_task));
        let aside = (lane == Lane::Short).then_some(short_time);
        let made = until_overdue(making, computation, aside, run_timeout).await;
        self.pool.finished(lane, self.clock.now().saturating_sub(start));
        match made {
            Ok((Ok(outcome), memory)) => Phase::Done(Arc::new(self.lent(outcome, memory))),
            Ok((Err(RunError::Stopped(_)), _)) if computation.ran_out() => {
                Phase::Failed(Failure::TimedOut(run_timeout))
            }
            Ok((Err(error), _)) => Phase::Failed(Failure::of(error)),
            Err(Panicked(message)) => Phase::Failed(Failure::Internal(format!("a computation panicked: {message}"))),
        }
    }

    /// Takes a finished computation off the list, then says so.
    fn finish(&self, computation: &Arc<Computation>, phase: Phase) {
        self.under_way.remove(computation);
        self.tally.computed(&phase);
        computation.set(phase);
    }

    /// An outcome whose bytes, where no store has them, are paid for until the last answer has them: as an answer, or,
    /// where these have no room, with the memory of their computation.
    fn lent(&self, mut outcome: Outcome, memory: Option<Memory>) -> Outcome {
        let Some(bytes) = outcome.loose.take() else { return outcome };
        let length = bytes.len() as u64;
        outcome.loose = Some(match (self.account.answers.try_take(length), memory) {
            (Err(Full), Some(mut memory)) => {
                memory.shrink_to(length);
                Lent::new(bytes, memory)
            }
            (held, _) => Lent::new(bytes, held.ok()),
        });
        outcome
    }

    /// Computes into a store; where no store takes the bytes, keeps them for this answer alone. Computes again only
    /// what the disk has lost.
    fn make_stored(&self, computation: &Computation, task: &dyn Task) -> Result<Outcome, RunError> {
        let (key, about, work) = (computation.key, task.cost().result_bytes, self.work.of(&computation.owners()));
        let made = |buffer: &mut ResultBuffer<'_>| {
            let report = task.run(buffer, &work, &computation.watch)?;
            let (media_type, owners) = (task.media_type().into(), computation.owners());
            let description = Description { media_type, warnings: report.warnings, owners };
            let Kept { manifest, loose } = buffer.commit(description).map_err(|error| RunError::Io(error.into()))?;
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

    /// Has an artifact that was just made brought to disk, in the background of its answer.
    fn persist(&self, manifest: &Arc<Manifest>) {
        self.tiers.persist(manifest);
    }

    /// The lines that let nobody more in, and the shares of memory that refuse requests. Lanes whose memory is taken
    /// are at work, and records leave for others.
    pub fn full(&self) -> Vec<&'static str> {
        let Account { bodies, inputs, answers, .. } = &self.account;
        let shares = [bodies, inputs, answers].into_iter().filter(|share| share.is_full()).map(|share| share.name);
        shares.chain(self.pool.full_lanes()).collect()
    }

    /// What each store holds: its name and usage.
    pub fn stores(&self) -> Vec<(&'static str, Usage)> {
        let uploads = ("uploads", self.uploads.usage());
        self.tiers.usage().into_iter().chain([uploads]).collect()
    }

    /// Computations under way or waiting.
    pub fn n_under_way(&self) -> usize {
        self.under_way.len()
    }

    /// Waits until no computation is under way or waiting, and, where jobs do not outlast the process, no job goes on.
    pub async fn idle(&self) {
        loop {
            if let Some(computation) = self.under_way.any() {
                computation.finished().await;
            } else if let Some(job) = self.jobs.any_active().filter(|_| !self.jobs.last()) {
                // its sender stays with the record, which is forgotten only when it has ended
                let _ = job.ended.subscribe().wait_for(|ended| *ended).await;
            } else {
                return;
            }
        }
    }

    /// The clock of the service.
    pub fn clock(&self) -> Arc<dyn Clock> {
        self.clock.clone()
    }

    /// Says that the service is to end: nobody waits for events any more, and where jobs outlast the process no further
    /// one has its turn.
    pub fn end(&self) {
        self.ending.send_replace(true);
    }

    /// Comes true when the service is to end.
    pub async fn ended(&self) {
        // the sender is the desk's own
        let _ = self.ending.subscribe().wait_for(|ending| *ending).await;
    }

    /// Whether the service is to end.
    pub fn is_ending(&self) -> bool {
        *self.ending.borrow()
    }

    /// Ends every computation, for the end of the service.
    pub fn stop(&self) {
        self.under_way.stop();
    }

    /// Requests and jobs that wait for a computation.
    pub fn n_interests(&self) -> usize {
        self.under_way.n_interests()
    }
}

/// Waits for a computation, sets it aside when it runs too long for its lane, and stops it when it runs too long for
/// any.
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
