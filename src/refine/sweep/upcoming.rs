//! The memory of results, which is fetched into the cache while the points that will be written there are computed.
//!
//! A core can wait for few lines of memory at a time, and stores that miss the cache take as long as all sums of a round
//! on a large result. Asked for in small portions between sums, the lines arrive in time.

use std::vec::IntoIter;

use crate::ahead::{LINE_BYTES, fetch};

/// Number of values in a line of memory.
const LINE: usize = LINE_BYTES / size_of::<f64>();

/// Number of sums between two portions. Half of it gains nothing; with twice of it, and twice the lines, half of the
/// gain is lost, as all lines at once gain nothing.
pub(super) const SUMS: usize = 512;

/// Number of lines in a portion: those of the largest blocks are then spread over the sums of a round with one blend.
const PORTION: usize = 32;

/// Spans of the result that will be written soon.
#[derive(Debug, Default)]
pub(super) struct Upcoming<'a> {
    now: &'a [f64],
    later: IntoIter<&'a [f64]>,
}

impl<'a> Upcoming<'a> {
    pub(super) fn new(spans: Vec<&'a [f64]>) -> Self {
        Self { now: &[], later: spans.into_iter() }
    }

    /// Asks for a portion of lines. Returns `false` if all have been asked for.
    pub(super) fn fetch(&mut self) -> bool {
        let mut lines = PORTION;
        while lines > 0 {
            if self.now.is_empty() {
                let Some(next) = self.later.next() else { return false };
                self.now = next;
            }
            let (now, rest) = self.now.split_at(self.now.len().min(lines * LINE));
            now.iter().step_by(LINE).for_each(fetch);
            (self.now, lines) = (rest, lines - now.len().div_ceil(LINE));
        }
        true
    }
}
