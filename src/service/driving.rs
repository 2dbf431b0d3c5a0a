//! Processing of jobs: takes jobs from the queue, reads their requests again, and makes their outputs one after the
//! other.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use super::computation::{Computation, Failure, Outcome, Phase, Timings};
use super::desk::Desk;
use super::jobs::{Attempt, JobState, OutputResult, Record};
use super::peer::Peer;
use super::pool::Lane;
use super::store::Manifest;
use super::task::Task;
use crate::job::JobFault;

/// The tasks of a request, in the order of its outputs.
pub type Tasks = Vec<Arc<dyn Task>>;

/// The reason why the request of an accepted job cannot be read now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unreadable {
    /// There is no room; retry after this duration.
    Later(Duration),
    /// The request can never be read, for this reason.
    Never(String),
}

/// Reads the requests of accepted jobs.
pub trait ReadJobs: Send + Sync {
    /// Returns the tasks of a job.
    fn tasks<'a>(&'a self, record: &'a Record) -> Pin<Box<dyn Future<Output = Result<Tasks, Unreadable>> + Send + 'a>>;
}

/// The outcome of one output within an attempt at a job.
enum OutputOutcome {
    /// The output was made or failed; the attempt continues.
    On(OutputResult),
    /// The attempt is over.
    Over,
}

/// Least pause before something full is tried again. Half of it would retry twice as often; twice of it would leave
/// places empty for longer.
pub(super) const LEAST_PAUSE: Duration = Duration::from_millis(100);

impl Desk {
    /// Processes the jobs of a lane, one after the other. If jobs outlast the process, it stops when the service ends.
    pub async fn do_jobs(self: Arc<Self>, lane: Lane, reader: Arc<dyn ReadJobs>) {
        loop {
            let taken = tokio::select! {
                biased;
                () = self.ended(), if self.jobs.is_durable() => return,
                taken = self.queue.take(lane) => taken,
            };
            if let Some((run, record)) = self.jobs.current_attempt(&taken.item.job) {
                self.do_job(&run, record, &*reader).await;
            }
            taken.done();
        }
    }

    /// Processes a job: makes all its outputs, as far as they can be made.
    async fn do_job(self: &Arc<Self>, run: &Attempt, record: Record, reader: &dyn ReadJobs) {
        self.jobs.begin(run).await;
        let longest = record.terms.run_timeout_s.map(Duration::from_secs);
        let mut ended = run.ended.clone();
        tokio::select! {
            () = self.make_all(run, &record, reader) => {}
            // the record keeps the sender alive
            _ = ended.wait_for(|ended| *ended) => {}
            () = self.clock.sleep(longest.unwrap_or_default()), if longest.is_some() => {
                let seconds = longest.unwrap_or_default().as_secs();
                let reason = format!("it ran for {seconds} s, the most that `run_timeout_s` allows");
                self.jobs.settle(run, JobState::Failed(reason));
            }
        }
    }

    async fn make_all(self: &Arc<Self>, run: &Attempt, record: &Record, reader: &dyn ReadJobs) {
        let tasks = loop {
            match reader.tasks(record).await {
                Ok(tasks) if tasks.len() == record.made.len() => break tasks,
                Ok(_) => {
                    return self.jobs.settle(run, JobState::Failed("its request has become another job".to_owned()));
                }
                Err(Unreadable::Later(pause)) => self.clock.sleep(pause.max(LEAST_PAUSE)).await,
                Err(Unreadable::Never(reason)) => return self.jobs.settle(run, JobState::Failed(reason)),
            }
        };
        for (at, task) in tasks.iter().enumerate() {
            let key = task.key();
            match self.make_output(run, at, task).await {
                OutputOutcome::On(made) => self.jobs.record_output(run, at, key, made),
                OutputOutcome::Over => return,
            }
        }
        self.close_run(run);
    }

    /// Finds an output, or computes it.
    async fn make_output(self: &Arc<Self>, run: &Attempt, at: usize, task: &Arc<dyn Task>) -> OutputOutcome {
        let peer = self.jobs.get(&run.job).map_or(Peer::SELF, |record| record.peer);
        loop {
            if let Some(manifest) = self.find_artifact(task.key(), peer).await {
                return OutputOutcome::On(stored_result(&manifest));
            }
            let interest = match self.compute_accepted(task.clone(), peer) {
                Ok(interest) => interest,
                Err(busy) => {
                    self.clock.sleep(busy.retry_after).await;
                    continue;
                }
            };
            let computation = interest.computation.clone();
            if !self.jobs.attach(run, at, interest) {
                return OutputOutcome::Over;
            }
            match computation.finished().await {
                Phase::Failed(Failure::Busy(busy)) => self.clock.sleep(busy.retry_after).await,
                phase => return self.outcome_of(run, phase, |fault| task.fault(fault).to_string()),
            }
        }
    }

    /// Converts the final phase of a computation into the outcome of its output; settles the job if the attempt is
    /// over.
    fn outcome_of(&self, run: &Attempt, phase: Phase, explain: impl FnOnce(JobFault) -> String) -> OutputOutcome {
        match phase {
            Phase::Done(outcome) => OutputOutcome::On(computed_result(&outcome)),
            // the job is resumed after the restart
            Phase::Failed(Failure::Cancelled) if self.is_ending() && self.jobs.is_durable() => OutputOutcome::Over,
            Phase::Failed(Failure::Cancelled) | Phase::Queued | Phase::Running => {
                self.jobs.settle(run, JobState::Cancelled);
                OutputOutcome::Over
            }
            Phase::Failed(Failure::Impossible(fault)) => OutputOutcome::On(OutputResult::Failed(explain(fault))),
            Phase::Failed(Failure::TimedOut(limit)) => OutputOutcome::On(OutputResult::Failed(format!(
                "it ran for {} s, the most this server allows",
                limit.as_secs()
            ))),
            Phase::Failed(Failure::Busy(_)) => OutputOutcome::On(OutputResult::Failed(
                "there was no place for work as long as it came to be; send it again".to_owned(),
            )),
            Phase::Failed(Failure::Internal(_)) => {
                OutputOutcome::On(OutputResult::Failed("a fault of planish; please report it".to_owned()))
            }
        }
    }

    /// Waits for the only output of a job, whose computation is under way already, and settles the job.
    pub(super) async fn see_single(
        &self,
        run: Attempt,
        computation: &Computation,
        explain: impl FnOnce(JobFault) -> String,
    ) {
        let mut ended = run.ended.clone();
        let phase = tokio::select! {
            phase = computation.finished() => phase,
            _ = ended.wait_for(|ended| *ended) => return,
        };
        if let OutputOutcome::On(made) = self.outcome_of(&run, phase, explain) {
            self.jobs.record_output(&run, 0, computation.key, made);
            self.close_run(&run);
        }
    }

    /// Settles an attempt whose outputs were all made or failed.
    fn close_run(&self, run: &Attempt) {
        let Some(record) = self.jobs.get(&run.job) else { return };
        let failed = record.made.iter().flatten().find_map(|made| match made {
            OutputResult::Failed(reason) => Some(reason.clone()),
            OutputResult::Done { .. } => None,
        });
        self.jobs.settle(run, failed.map_or(JobState::Done, JobState::Failed));
    }
}

/// Describes an output that a store had already.
pub fn stored_result(manifest: &Manifest) -> OutputResult {
    let timings = Timings::default();
    OutputResult::Done { bytes: manifest.length, warnings: manifest.warnings.clone(), timings }
}

/// Describes an output that was computed.
pub fn computed_result(outcome: &Outcome) -> OutputResult {
    let Outcome { manifest, timings, .. } = outcome;
    OutputResult::Done { bytes: manifest.length, warnings: manifest.warnings.clone(), timings: *timings }
}
