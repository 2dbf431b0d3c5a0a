//! The current status of a batch.

use super::record::Batch;
use crate::service::jobs::{JobPhase, JobState, PROGRESS_PARTS, STEPS_PER_ATTEMPT, Standing};

/// The number of jobs of a batch in each phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PhaseCounts {
    /// Jobs that wait for their turn, or to be queued.
    pub queued: u64,
    /// Jobs that run.
    pub running: u64,
    /// Jobs whose outputs were all made.
    pub done: u64,
    /// Jobs that failed.
    pub failed: u64,
    /// Jobs that were cancelled.
    pub cancelled: u64,
    /// Jobs whose results existed before; they are counted in one of the other fields as well.
    pub hits: u64,
}

/// The status of a batch at one moment.
#[derive(Debug, Clone)]
pub struct BatchStanding {
    /// The record of the batch.
    pub batch: Batch,
    /// The phase of the batch.
    pub phase: JobPhase,
    /// For each item, the status of its job if the job was read and has not ended.
    pub under_way: Vec<Option<Standing>>,
    /// The number of jobs in each phase.
    pub counts: PhaseCounts,
    /// Fraction of the work that is done, from 0 to 1, with the same weight for every job.
    pub progress: f64,
}

impl BatchStanding {
    /// Returns the status of a batch; `job` returns the status of the job of an item.
    pub fn of(batch: Batch, job: impl Fn(usize) -> Option<Standing>) -> Self {
        let goes_on = |at: usize| batch.items[at].ending.is_none() && batch.items[at].job.is_some();
        let under_way: Vec<_> = (0..batch.items.len()).map(|at| if goes_on(at) { job(at) } else { None }).collect();
        let mut counts = PhaseCounts::default();
        for (item, standing) in batch.items.iter().zip(&under_way) {
            let state = item.ending.as_ref().map(|ending| &ending.state);
            let is_running = standing.as_ref().is_some_and(|standing| standing.phase == JobPhase::Running);
            *match state {
                Some(JobState::Done) => &mut counts.done,
                Some(JobState::Failed(_)) => &mut counts.failed,
                Some(JobState::Cancelled) => &mut counts.cancelled,
                None | Some(JobState::Active) if is_running => &mut counts.running,
                None | Some(JobState::Active) => &mut counts.queued,
            } += 1;
            counts.hits += u64::from(item.is_hit);
        }
        let has_begun = counts.queued < batch.items.len() as u64;
        let phase = JobPhase::of(&batch.state, has_begun);
        let progress = progress(&batch, &under_way);
        Self { batch, phase, under_way, counts, progress }
    }

    /// Returns a number that grows as the batch makes progress, in this process and in later ones.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a share in 0..=1 of a thousand parts an item, of which there are few"
    )]
    pub fn sequence(&self) -> u64 {
        let parts = self.batch.items.len() as u64 * PROGRESS_PARTS;
        let step = match self.phase {
            JobPhase::Queued => 0,
            JobPhase::Running => 1 + (self.progress.clamp(0.0, 1.0) * parts as f64) as u64,
            JobPhase::Done | JobPhase::Failed(_) | JobPhase::Cancelled => parts + 2,
        };
        u64::from(self.batch.attempts) * STEPS_PER_ATTEMPT + step
    }
}

#[expect(clippy::cast_precision_loss, reason = "a batch has few items")]
fn progress(batch: &Batch, under_way: &[Option<Standing>]) -> f64 {
    if batch.state == JobState::Done {
        return 1.0;
    }
    let share = |(item, standing): (&super::record::BatchItem, &Option<Standing>)| match (&item.ending, standing) {
        (Some(_), _) => 1.0,
        (None, Some(standing)) => standing.progress,
        (None, None) => 0.0,
    };
    batch.items.iter().zip(under_way).map(share).sum::<f64>() / batch.items.len().max(1) as f64
}
