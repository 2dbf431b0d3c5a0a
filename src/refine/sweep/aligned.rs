//! Buffers whose values begin at a cache line: loops over stacks of eight grids and more then load and store whole
//! registers within lines, and other loops cross fewer lines.

use std::ops::{Deref, DerefMut};

/// Number of bytes in a cache line. With half of it, registers of 64 bytes may cross lines; twice of it changes nothing
/// but memory.
const LINE_BYTES: usize = 64;

/// Number of values in a cache line, which a processor fetches at once. Where lines are longer, some are asked for
/// twice.
pub(super) const LINE: usize = LINE_BYTES / size_of::<f64>();

/// Values that begin at a cache line. No value depends on where that is.
#[derive(Debug, Default)]
pub(super) struct AlignedBuffer {
    values: Vec<f64>,
    /// Index of the first value that counts.
    start: usize,
}

impl AlignedBuffer {
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

impl Deref for AlignedBuffer {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values[self.start..]
    }
}

impl DerefMut for AlignedBuffer {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[self.start..]
    }
}
