//! The memory of results, which is fetched into the cache while the points that will be written there are computed.
//!
//! A core can wait for few lines of memory at a time, and stores that miss the cache take nearly as long as all sums
//! of a large result. Asked for in small portions between sums, the lines arrive in time.

use std::ops::Range;
use std::vec::IntoIter;

use super::aligned::LINE;

/// Number of sums between two portions. Half of it, with half the lines, makes no measurable difference; all lines at
/// once gain nothing.
const SUMS: usize = 512;

/// Number of lines in a portion: those of the largest blocks are then spread over two thirds of the sums of a round of
/// Catmull-Clark. With two thirds of it some have not been asked for when they are written; a third more makes no
/// measurable difference.
const PORTION: usize = 48;

/// Spans of the result that will be written soon.
#[derive(Debug, Default)]
pub(super) struct Upcoming<'a> {
    now: &'a [f64],
    later: IntoIter<&'a [f64]>,
}

impl<'a> Upcoming<'a> {
    /// Whether processors of this kind can be asked for memory.
    pub(super) const IS_FETCHED: bool = cfg!(target_arch = "x86_64");

    pub(super) fn new(spans: Vec<&'a [f64]>) -> Self {
        Self { now: &[], later: spans.into_iter() }
    }

    /// Calls `compute` with consecutive parts of the ranges, at each index of which it computes a number of sums, and
    /// asks for a portion of lines before each.
    pub(super) fn between(&mut self, ranges: &[Range<usize>], sums: usize, mut compute: impl FnMut(Range<usize>)) {
        let mut left = 0;
        for range in ranges {
            let mut at = range.start;
            while at < range.end {
                if left == 0 {
                    left = if self.fetch() { SUMS / sums } else { usize::MAX };
                }
                let n = left.min(range.end - at);
                compute(at..at + n);
                (at, left) = (at + n, left - n);
            }
        }
    }

    /// Asks for a portion of lines. Returns `false` if all have been asked for.
    fn fetch(&mut self) -> bool {
        let mut lines = PORTION;
        while lines > 0 {
            if self.now.is_empty() {
                let Some(next) = self.later.next() else { return false };
                self.now = next;
            }
            let (now, rest) = self.now.split_at(self.now.len().min(lines * LINE));
            fetch(now);
            (self.now, lines) = (rest, lines - now.len().div_ceil(LINE));
        }
        true
    }
}

/// Asks for the lines of memory of values that will be overwritten, to be fetched no nearer than the second cache: a
/// line that is fetched into the first one occupies one of its few slots until it arrives, and loads wait for a slot,
/// too.
///
/// Nothing but the time of a later access changes. Does nothing where the processor cannot be asked.
pub(super) fn fetch(values: &[f64]) {
    #[cfg(target_arch = "x86_64")]
    values.iter().step_by(LINE).for_each(safe_arch::prefetch_t2);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = values;
}
