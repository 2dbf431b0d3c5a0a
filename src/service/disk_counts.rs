//! Counters of artifacts written to disk and read from it.

use std::sync::atomic::{AtomicU64, Ordering};

/// Counters that never decrease; reports read them.
#[derive(Debug, Default)]
pub struct DiskCounts {
    /// Artifacts that were written.
    pub written: AtomicU64,
    /// Artifacts that were not written because the backlog was full.
    pub dropped_full: AtomicU64,
    /// Artifacts that were not written because the store cannot take them: too large, or a folder has their name.
    pub dropped_unfit: AtomicU64,
    /// Artifacts that were not written because the disk failed, or because it was full and nothing was left to evict.
    pub dropped_failed: AtomicU64,
    /// Artifacts that were not written because the shared store could not be reached.
    pub dropped_away: AtomicU64,
    /// Artifacts that were not written because the service ended first.
    pub dropped_at_end: AtomicU64,
    /// Reads that timed out, because other reads held all places or the disk did not answer in time.
    pub reads_given_up: AtomicU64,
    /// Reads that failed.
    pub reads_failed: AtomicU64,
    /// Reads that failed because the shared store could not be reached; their artifacts were computed instead.
    pub reads_away: AtomicU64,
    /// Large results that were moved back into memory because the disk did not take them.
    pub taken_back: AtomicU64,
    /// Large results that had to be computed again because the disk lost bytes it had taken.
    pub lost: AtomicU64,
}

impl DiskCounts {
    /// Returns the names and values, in the order of the fields.
    pub fn list(&self) -> [(&'static str, u64); 11] {
        let Self {
            written,
            dropped_full,
            dropped_unfit,
            dropped_failed,
            dropped_away,
            dropped_at_end,
            reads_given_up,
            reads_failed,
            reads_away,
            taken_back,
            lost,
        } = self;
        [
            ("written", written),
            ("dropped_full", dropped_full),
            ("dropped_unfit", dropped_unfit),
            ("dropped_failed", dropped_failed),
            ("dropped_away", dropped_away),
            ("dropped_at_end", dropped_at_end),
            ("reads_given_up", reads_given_up),
            ("reads_failed", reads_failed),
            ("reads_away", reads_away),
            ("taken_back", taken_back),
            ("lost", lost),
        ]
        .map(|(name, count)| (name, count.load(Ordering::Relaxed)))
    }
}

/// Increments a counter.
pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}
