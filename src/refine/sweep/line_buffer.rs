//! Buffers whose values begin at a line of memory: loops then store whole registers within lines, and load more of them
//! so.

use std::ops::{Deref, DerefMut};

/// Number of bytes in a line of memory. Where lines are longer, some registers of values lie across two lines.
const LINE_BYTES: usize = 64;

/// Number of values in a line.
const LINE: usize = LINE_BYTES / size_of::<f64>();

/// Values that begin at a line of memory. No value depends on where that is.
#[derive(Debug, Default)]
pub(super) struct LineBuffer {
    values: Vec<f64>,
    /// Index of the first value that counts.
    start: usize,
}

impl LineBuffer {
    /// Returns the first `len` values. A buffer that is shorter is extended, and what it held is lost.
    pub(super) fn first(&mut self, len: usize) -> &mut [f64] {
        if self.len() < len {
            self.values.clear();
            self.values.resize(len + LINE, 0.0);
            self.start = self.values.as_ptr().align_offset(LINE_BYTES).min(LINE);
        }
        &mut self[..len]
    }
}

impl Deref for LineBuffer {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values[self.start..]
    }
}

impl DerefMut for LineBuffer {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[self.start..]
    }
}
