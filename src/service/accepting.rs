//! Accepting, cancelling, resuming and forgetting jobs.

use std::sync::Arc;
use std::time::Duration;

use super::account::Full;
use super::desk::Desk;
use super::job_key::{JobKey, JobTerms};
use super::jobs::{Admission, Attempt, Holder, JobState, JobSummary, New, OutputResult, Record, Standing};
use super::peer::{Paid, Peer, QuotaKind};
use super::pool::{Busy, Lack, Lane};
use super::queue::QueuedJob;
use super::store::{Pin, StoreError};
use super::under_way::Interest;
use crate::job::JobEntries;

/// Interval between checks for jobs that have waited too long for their turn or whose time to live has ended. Half of
/// it would check twice as often; twice of it would act twice as late.
const CHECK_PERIOD: Duration = Duration::from_millis(500);

/// The reason why a job is not accepted.
#[derive(Debug, thiserror::Error)]
pub enum NotAccepted {
    /// Too many jobs wait already, or there is no memory for the record of the job.
    #[error("there is no room for more work")]
    Busy(Busy),
    /// The record cannot be written, so that the job would be lost when the process ends.
    #[error("the job cannot be written down: {0}")]
    Unwritten(String),
}

impl From<Busy> for NotAccepted {
    fn from(busy: Busy) -> Self {
        Self::Busy(busy)
    }
}

impl From<StoreError> for NotAccepted {
    fn from(error: StoreError) -> Self {
        Self::Unwritten(error.to_string())
    }
}

impl Desk {
    fn record_memory(&self, peer: Peer) -> impl Fn(u64) -> Result<Paid, Full> + '_ {
        move |bytes| self.peers.charge(&self.account.records, QuotaKind::RecordBytes, peer, bytes)
    }

    /// Pins the uploads that a job needs, as far as they are in the store.
    fn pins(&self, summary: &JobSummary) -> Vec<Arc<Pin>> {
        summary.blobs.iter().filter_map(|id| self.uploads.pin(id)).map(Arc::new).collect()
    }

    /// Accepts a job: records it and puts it into the queue; if jobs outlast the process, it is done even after a
    /// restart. A job that is active or done already is not done again; one that failed or was cancelled is. If all
    /// results exist, `made` describes them, and the job is recorded as done.
    ///
    /// # Errors
    /// [`NotAccepted`].
    pub async fn accept(
        self: &Arc<Self>,
        job: JobKey,
        summary: JobSummary,
        terms: JobTerms,
        (peer, holder): (Peer, Holder),
        made: Vec<OutputResult>,
    ) -> Result<(), NotAccepted> {
        match self.jobs.join(&job, holder) {
            Some(JobState::Active) => return Ok(self.jobs.written(job).await?),
            Some(_) => return Ok(()),
            None => {}
        }
        let lane = self.pool.lane_of(summary.cost.time_ms.into(), summary.cost.memory_bytes.into());
        let waiting = self.queue.waiting(lane);
        let busy = |lack| self.pool.busy_behind(lane, lack, waiting);
        let ticket = match made.is_empty() {
            true if waiting >= self.terms.most_jobs => return Err(busy(Lack::Jobs).into()),
            true => Some(self.ticket(peer, QuotaKind::Detached).ok_or_else(|| busy(Lack::Jobs))?),
            false => None,
        };
        let pins = if made.is_empty() { self.pins(&summary) } else { Vec::new() };
        let new = New { job, summary, terms, peer, holder, ticket, made, pins };
        let placed = self.jobs.accept(self.record_memory(peer), new, false).map_err(|_| busy(Lack::Records))?;
        let Admission::New(run) = placed else { return Ok(self.jobs.written(job).await?) };
        // a task of its own, which continues if the client disconnects here
        let desk = self.clone();
        let lined_up = tokio::spawn(async move {
            desk.line_up_job(&run, QueuedJob { job, lane, priority: terms.priority, peer }).await
        });
        lined_up.await.unwrap_or_else(|error| Err(NotAccepted::Unwritten(error.to_string())))
    }

    async fn line_up_job(&self, run: &Attempt, item: QueuedJob) -> Result<(), NotAccepted> {
        let written = self.jobs.written(item.job).await.map_err(NotAccepted::from);
        let lined_up = match written {
            Ok(()) => self.queue.push(item).await.map_err(|error| NotAccepted::Unwritten(error.to_string())),
            Err(error) => Err(error),
        };
        if lined_up.is_err() {
            self.jobs.settle(run, JobState::Failed("it could not be written down".to_owned()));
            self.jobs.remove(&item.job);
        }
        lined_up
    }

    /// Turns a computation under way into a job, so that it continues without the request that started it. `entries`
    /// map faults to places in that request.
    ///
    /// # Errors
    /// [`NotAccepted`]; then the interest is dropped.
    pub async fn detach(
        self: &Arc<Self>,
        job: JobKey,
        summary: JobSummary,
        mut interest: Interest,
        (peer, entries): (Peer, JobEntries),
    ) -> Result<(), NotAccepted> {
        let lane = self.pool.lane_of(summary.cost.time_ms.into(), summary.cost.memory_bytes.into());
        self.jobs.join(&job, Holder::Client);
        let run = match self.jobs.current_attempt(&job) {
            Some((run, _)) => run,
            None => self
                .detached(job, summary, &interest, (peer, entries))
                .map_err(|Full| self.pool.busy(lane, Lack::Jobs))?,
        };
        if let Some(ticket) = self.peers.take(peer, QuotaKind::Accepted, 1, u64::MAX, u64::MAX) {
            interest.count_as(ticket);
        }
        self.jobs.attach(&run, 0, interest);
        let desk = self.clone();
        let written = tokio::spawn(async move { desk.jobs.written(job).await });
        Ok(written.await.map_err(|error| NotAccepted::Unwritten(error.to_string()))??)
    }

    /// Returns the run of a job whose only computation is under way already; the job ends with that computation.
    fn detached(
        self: &Arc<Self>,
        job: JobKey,
        summary: JobSummary,
        interest: &Interest,
        (peer, entries): (Peer, JobEntries),
    ) -> Result<Attempt, Full> {
        let ticket = Some(self.ticket(peer, QuotaKind::Detached).ok_or(Full)?);
        let (terms, made, pins) = (JobTerms::default(), Vec::new(), self.pins(&summary));
        let holder = Holder::Client;
        let new = New { job, summary, terms, peer, holder, ticket, made, pins };
        let run = match self.jobs.accept(self.record_memory(peer), new, true)? {
            Admission::New(run) => run,
            // another request has accepted the job in the meantime
            Admission::Known(record) => return self.jobs.current_attempt(&record.job).map(|(run, _)| run).ok_or(Full),
        };
        let (desk, watched, computation) = (self.clone(), run.clone(), interest.computation.clone());
        tokio::spawn(async move {
            desk.jobs.begin(&watched).await;
            desk.see_single(watched, &computation, |fault| entries.fault(fault).to_string()).await;
        });
        Ok(run)
    }

    /// Records a job whose results exist, so that the artifacts they refer to can be made.
    ///
    /// # Errors
    /// [`Busy`] when there is no room for the record.
    pub fn record(&self, job: JobKey, summary: JobSummary, made: Vec<OutputResult>, peer: Peer) -> Result<(), Busy> {
        let (terms, pins) = (JobTerms::default(), Vec::new());
        let new = New { job, summary, terms, peer, holder: Holder::Client, ticket: None, made, pins };
        let put = self.jobs.accept(self.record_memory(peer), new, false);
        put.map(drop).map_err(|_| self.pool.busy(Lane::Long, Lack::Records))
    }

    /// Returns the state and progress of a job, if the job is known.
    pub fn standing(&self, job: &JobKey) -> Option<Standing> {
        self.jobs.get(job).map(|record| self.standing_of(record))
    }

    /// Returns the state and progress of the job of a record.
    pub fn standing_of(&self, record: Record) -> Standing {
        let ahead = if record.is_active() { self.queue.ahead(&record.job) } else { None };
        Standing::of(record, self.clock.now(), ahead)
    }

    /// Cancels an active job; computations that nobody else needs are stopped. Returns false if the job is not active.
    pub fn cancel(&self, job: &JobKey) -> bool {
        self.queue.withdraw(job);
        self.jobs.end(job, JobState::Cancelled, |_| true)
    }

    /// Cancels and forgets a job. Returns false if the job is not known.
    pub fn forget(&self, job: &JobKey) -> bool {
        self.queue.withdraw(job);
        self.jobs.remove(job)
    }

    /// Puts the active jobs of an earlier process into the queue, and returns their number. A job that may have crashed
    /// the process is queued only after a pause ([`Record::pause`]).
    ///
    /// # Errors
    /// When the records cannot be read.
    pub async fn recover(self: &Arc<Self>) -> Result<usize, StoreError> {
        let memory = |bytes| self.peers.charge_self(&self.account.records, QuotaKind::RecordBytes, bytes);
        let runs = self.jobs.recover(memory, |summary| self.pins(summary))?;
        for run in &runs {
            let Some(record) = self.jobs.get(&run.job) else { continue };
            let lane = record.lane(|time, memory| self.pool.lane_of(time, memory));
            let item = QueuedJob { job: run.job, lane, priority: record.terms.priority, peer: record.peer };
            let (desk, pause) = (self.clone(), record.pause());
            let queued = async move {
                desk.clock.sleep(pause).await;
                if let Err(error) = desk.queue.push(item).await {
                    tracing::warn!(%error, job = %item.job.id, "a job waits for a next start");
                }
            };
            if pause.is_zero() {
                queued.await;
            } else {
                tokio::spawn(queued);
            }
        }
        Ok(runs.len())
    }

    /// Fails jobs that have waited for their turn longer than they allow, and forgets jobs and batches that were
    /// settled longer ago than the time to live.
    pub fn tidy(&self) {
        let (late, old) = self.jobs.overdue(self.terms.job_ttl);
        for job in late {
            let reason = "its turn did not come in the time that `queue_timeout_s` allows; send it again";
            if self.jobs.end(&job, JobState::Failed(reason.to_owned()), |record| record.begun.is_none()) {
                self.queue.withdraw(&job);
            }
        }
        for job in &old {
            self.jobs.remove(job);
        }
        for batch in &self.batches.overdue(self.terms.job_ttl) {
            self.forget_batch(batch);
        }
    }

    /// Calls [`Desk::tidy`] at regular intervals, without end.
    pub async fn keep_tidy(&self) {
        loop {
            self.tidy();
            self.clock.sleep(CHECK_PERIOD).await;
        }
    }
}
