//! How a batch stands now.

use super::record::Batch;
use crate::service::jobs::{Phase, Standing, State};

/// Steps of a sequence number within an attempt: so many parts an item.
const PARTS: u64 = 1000;
const STEPS: u64 = 1 << 32;

/// How many jobs of a batch stand where.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Of those that wait for their turn, or to be put in line.
    pub queued: u64,
    /// Of those that are being done.
    pub running: u64,
    /// Of those whose outputs were all made.
    pub done: u64,
    /// Of those that failed.
    pub failed: u64,
    /// Of those that were cancelled.
    pub cancelled: u64,
    /// Of those whose results were there before.
    pub hits: u64,
}

/// How a batch stands.
#[derive(Debug, Clone)]
pub struct BatchStanding {
    /// What is known of it.
    pub batch: Batch,
    /// Where it stands.
    pub phase: Phase,
    /// How its jobs stand that have been read and go on.
    pub under_way: Vec<Option<Standing>>,
    /// How many jobs stand where.
    pub counts: Counts,
    /// Share of the work done, from 0 to 1, where every job counts as much.
    pub progress: f64,
}

impl BatchStanding {
    /// How a batch stands; `job` tells how a job of it does.
    pub fn of(batch: Batch, job: impl Fn(usize) -> Option<Standing>) -> Self {
        let goes_on = |at: usize| batch.items[at].ending.is_none() && batch.items[at].job.is_some();
        let under_way: Vec<_> = (0..batch.items.len()).map(|at| if goes_on(at) { job(at) } else { None }).collect();
        let mut counts = Counts::default();
        for (item, standing) in batch.items.iter().zip(&under_way) {
            let state = item.ending.as_ref().map(|ending| &ending.state);
            let is_running = standing.as_ref().is_some_and(|standing| standing.phase == Phase::Running);
            *match state {
                Some(State::Done) => &mut counts.done,
                Some(State::Failed(_)) => &mut counts.failed,
                Some(State::Cancelled) => &mut counts.cancelled,
                None | Some(State::Active) if is_running => &mut counts.running,
                None | Some(State::Active) => &mut counts.queued,
            } += 1;
            counts.hits += u64::from(item.is_hit);
        }
        let has_begun = counts.queued < batch.items.len() as u64;
        let phase = Phase::of(&batch.state, has_begun);
        let progress = progress(&batch, &under_way);
        Self { batch, phase, under_way, counts, progress }
    }

    /// A number that grows with everything that happens to the batch, in this process and in those after it.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a share in 0..=1 of a thousand parts an item, of which there are few"
    )]
    pub fn sequence(&self) -> u64 {
        let parts = self.batch.items.len() as u64 * PARTS;
        let step = match self.phase {
            Phase::Queued => 0,
            Phase::Running => 1 + (self.progress.clamp(0.0, 1.0) * parts as f64) as u64,
            Phase::Done | Phase::Failed(_) | Phase::Cancelled => parts + 2,
        };
        u64::from(self.batch.attempts) * STEPS + step
    }
}

#[expect(clippy::cast_precision_loss, reason = "a batch has few items")]
fn progress(batch: &Batch, under_way: &[Option<Standing>]) -> f64 {
    if batch.state == State::Done {
        return 1.0;
    }
    let share = |(item, standing): (&super::record::Item, &Option<Standing>)| match (&item.ending, standing) {
        (Some(_), _) => 1.0,
        (None, Some(standing)) => standing.progress,
        (None, None) => 0.0,
    };
    batch.items.iter().zip(under_way).map(share).sum::<f64>() / batch.items.len().max(1) as f64
}
