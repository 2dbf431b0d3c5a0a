//! Counters of the service: computations and jobs by how they ended, the durations of stages, and lookups by where the
//! result was found.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::computation::{Failure, Phase, Timings};
use super::jobs::JobState;

/// Upper bounds of the buckets of a histogram in milliseconds, each about five times the one before: from the time of a
/// cached lookup to that of the longest run.
pub const BOUNDS_MS: [u64; 9] = [1, 5, 20, 100, 500, 2_000, 10_000, 60_000, 300_000];

/// A histogram of durations.
#[derive(Debug, Default)]
pub struct Histogram {
    buckets: [AtomicU64; BOUNDS_MS.len()],
    count: AtomicU64,
    sum_us: AtomicU64,
}

impl Histogram {
    fn add(&self, took: Duration) {
        let us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        for (bound, bucket) in BOUNDS_MS.iter().zip(&self.buckets) {
            bucket.fetch_add(u64::from(us <= bound * 1000), Ordering::Relaxed);
        }
        self.count.fetch_add(1, Ordering::Relaxed);
        self.sum_us.fetch_add(us, Ordering::Relaxed);
    }

    /// Returns how many durations were at most each bound, how many there were, and their sum.
    pub fn read(&self) -> ([u64; BOUNDS_MS.len()], u64, Duration) {
        let buckets = std::array::from_fn(|at| self.buckets[at].load(Ordering::Relaxed));
        (buckets, self.count.load(Ordering::Relaxed), Duration::from_micros(self.sum_us.load(Ordering::Relaxed)))
    }
}

/// The place where a lookup found a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookupResult {
    /// The result was found in memory.
    Memory,
    /// The result was found on disk.
    Disk,
    /// The result was found nowhere.
    Nowhere,
}

/// Counters that never decrease.
#[derive(Debug, Default)]
pub struct Tally {
    computations: [AtomicU64; COMPUTATION_ENDS.len()],
    stages: [Histogram; STAGE_NAMES.len()],
    jobs: [AtomicU64; JOB_ENDS.len()],
    found: [AtomicU64; CACHE_PLACES.len()],
}

const COMPUTATION_ENDS: [&str; 6] = ["done", "cancelled", "impossible", "timed_out", "busy", "internal"];
const STAGE_NAMES: [&str; 4] = ["queue", "refine", "render", "encode"];
const JOB_ENDS: [&str; 3] = ["done", "failed", "cancelled"];
const CACHE_PLACES: [&str; 3] = ["memory", "disk", "none"];

impl Tally {
    /// Counts a computation that has ended.
    pub(super) fn computed(&self, phase: &Phase) {
        let at = match phase {
            Phase::Done(outcome) => {
                let Timings { queue, refine, render, encode, .. } = outcome.timings;
                let took = [queue, refine, render, encode];
                self.stages.iter().zip(took).for_each(|(stage, took)| stage.add(took));
                0
            }
            Phase::Failed(Failure::Impossible(_)) => 2,
            Phase::Failed(Failure::TimedOut(_)) => 3,
            Phase::Failed(Failure::Busy(_)) => 4,
            Phase::Failed(Failure::Internal(_)) => 5,
            Phase::Failed(Failure::Cancelled) | Phase::Queued | Phase::Running => 1,
        };
        self.computations[at].fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a job that was settled.
    pub(super) fn count_settled(&self, state: &JobState) {
        let at = match state {
            JobState::Done => 0,
            JobState::Failed(_) => 1,
            JobState::Cancelled | JobState::Active => 2,
        };
        self.jobs[at].fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a lookup of a result.
    pub(super) fn looked(&self, found: LookupResult) {
        let at = match found {
            LookupResult::Memory => 0,
            LookupResult::Disk => 1,
            LookupResult::Nowhere => 2,
        };
        self.found[at].fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the number of computations by how they ended.
    pub fn computations(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        named(&COMPUTATION_ENDS, &self.computations)
    }

    /// Returns the histogram of each stage.
    pub fn stages(&self) -> impl Iterator<Item = (&'static str, &Histogram)> {
        STAGE_NAMES.into_iter().zip(&self.stages)
    }

    /// Returns the number of jobs by how they ended.
    pub fn jobs(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        named(&JOB_ENDS, &self.jobs)
    }

    /// Returns the number of lookups by where the result was found.
    pub fn lookups(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        named(&CACHE_PLACES, &self.found)
    }
}

fn named<'a>(names: &'a [&'static str], counts: &'a [AtomicU64]) -> impl Iterator<Item = (&'static str, u64)> + 'a {
    names.iter().copied().zip(counts.iter().map(|count| count.load(Ordering::Relaxed)))
}
