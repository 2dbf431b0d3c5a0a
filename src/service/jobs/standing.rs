//! The current status of a job.

use std::time::Duration;

use super::record::{JobState, OutputResult, Record};
use crate::service::computation::{self, Computation, Timings};
use crate::watch::Stage;

/// Number of steps of the sequence number, within an attempt, for places in the queue; jobs further back share the
/// first step.
const QUEUE_PLACES: u64 = 1000;
/// Number of steps of the sequence number for the progress of a running job, after those for the queue; the end
/// follows.
pub(in crate::service) const PROGRESS_PARTS: u64 = 1000;
/// Distance of the sequence numbers of consecutive attempts, more than an attempt has steps.
pub(in crate::service) const STEPS_PER_ATTEMPT: u64 = 1 << 32;

/// The phase of a job or a batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JobPhase {
    /// The job or batch waits for its turn.
    Queued,
    /// Some output is being computed, or was computed.
    Running,
    /// All outputs were made.
    Done,
    /// Some output was not made, for this reason.
    Failed(String),
    /// The job or batch was cancelled.
    Cancelled,
}

impl JobPhase {
    /// Returns the phase of a job or a batch from its state, and from whether any part of it has begun.
    pub fn of(state: &JobState, has_begun: bool) -> Self {
        match state {
            JobState::Active if has_begun => Self::Running,
            JobState::Active => Self::Queued,
            JobState::Done => Self::Done,
            JobState::Failed(reason) => Self::Failed(reason.clone()),
            JobState::Cancelled => Self::Cancelled,
        }
    }

    /// Returns whether nothing more will happen.
    pub fn is_settled(&self) -> bool {
        !matches!(self, Self::Queued | Self::Running)
    }

    /// Returns why the job failed, if it did.
    pub fn reason(&self) -> Option<&str> {
        if let Self::Failed(reason) = self { Some(reason) } else { None }
    }
}

/// The status of a job at one moment.
#[derive(Debug, Clone)]
pub struct Standing {
    /// The record of the job.
    pub record: Record,
    /// The phase of the job.
    pub phase: JobPhase,
    /// The stage of the running computation.
    pub stage: Option<Stage>,
    /// The level that is being made, if the computation makes levels one after another.
    pub level: Option<u32>,
    /// Fraction of the work that is done, from 0 to 1.
    pub progress: f64,
    /// Number of jobs before it in the queue, if it waits.
    pub ahead: Option<usize>,
    /// Time spent so far on all outputs, and waiting.
    pub timings: Timings,
}

impl Standing {
    /// Returns the status of a job at the time `now`; `ahead` is the number of jobs before it in the queue.
    pub fn of(record: Record, now: Duration, ahead: Option<usize>) -> Self {
        let computing = record.computing.as_ref().map(|(_, interest)| interest.computation.clone());
        let has_begun = record.made.iter().any(Option::is_some)
            || computing.as_ref().is_some_and(|computing| !matches!(computing.phase(), computation::Phase::Queued));
        let phase = JobPhase::of(&record.state, has_begun);
        let stage = computing.as_ref().and_then(|computing| computing.stage());
        let fraction = computing.as_ref().map_or(0.0, |computing| computing.progress());
        let level = (stage == Some(Stage::Refine)).then(|| level(&record.summary.cost.vertices, fraction));
        let (timings, progress) = (timings(&record, computing.as_deref(), now), progress(&record, fraction));
        Self { phase, stage, level: level.flatten(), progress, ahead, timings, record }
    }

    /// Returns a number that grows with every change of the job's status, in this process and in later ones.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a share in 0..=1 of a thousand parts"
    )]
    pub fn sequence(&self) -> u64 {
        let parts = (self.progress.clamp(0.0, 1.0) * PROGRESS_PARTS as f64) as u64;
        let step = match self.phase {
            JobPhase::Queued => QUEUE_PLACES - self.ahead.map_or(0, |ahead| ahead as u64 + 1).min(QUEUE_PLACES),
            JobPhase::Running => QUEUE_PLACES + 1 + parts,
            JobPhase::Done | JobPhase::Failed(_) | JobPhase::Cancelled => QUEUE_PLACES + PROGRESS_PARTS + 2,
        };
        u64::from(self.record.attempts) * STEPS_PER_ATTEMPT + step
    }
}

/// Returns the level that is being made after `fraction` of the work, assuming that a level takes time in proportion to
/// its vertices.
#[expect(clippy::cast_precision_loss, reason = "a share needs few digits")]
fn level(vertices: &[u64], fraction: f64) -> Option<u32> {
    let made: f64 = vertices.iter().skip(1).map(|n| *n as f64).sum();
    let mut left = fraction * made;
    let at = vertices.iter().skip(1).position(|n| {
        left -= *n as f64;
        left < 0.0
    });
    let last = vertices.len().checked_sub(1)?;
    u32::try_from(at.map_or(last, |at| at + 1)).ok()
}

#[expect(clippy::cast_precision_loss, reason = "a job has 64 outputs at most")]
fn progress(record: &Record, fraction: f64) -> f64 {
    let made = record.made.iter().flatten().count();
    if record.state == JobState::Done {
        return 1.0;
    }
    let is_under_way = if record.is_active() { fraction } else { 0.0 };
    (made as f64 + is_under_way) / record.made.len().max(1) as f64
}

fn timings(record: &Record, computing: Option<&Computation>, now: Duration) -> Timings {
    let begun = record.begun.or(record.settled).unwrap_or(now);
    let mut sum = Timings { queue: begun.saturating_sub(record.queued), ..Timings::default() };
    let made = record.made.iter().flatten().filter_map(|made| match made {
        OutputResult::Done { timings, .. } => Some(*timings),
        OutputResult::Failed(_) => None,
    });
    for Timings { queue, refine, swept, render, encode } in made.chain(computing.map(Computation::timings)) {
        sum.queue += queue;
        sum.refine += refine;
        sum.swept |= swept;
        sum.render += render;
        sum.encode += encode;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_under_way_is_the_one_whose_vertices_are_being_made() {
        let vertices = [8, 26, 98, 386];
        let at = |done: f64| level(&vertices, done / 510.0);
        assert_eq!([at(0.0), at(25.0), at(27.0), at(125.0), at(510.0)], [1, 1, 2, 3, 3].map(Some));
        assert_eq!((level(&[], 0.5), level(&[4], 0.5)), (None, Some(0)));
    }
}
