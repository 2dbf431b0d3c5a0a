//! Large buffers that are kept from one computation to the next, since fresh memory pages take more time than writing
//! to them.

use std::ops::{Deref, DerefMut};
use std::sync::Mutex;

/// Smallest buffer to keep, in bytes; the allocator keeps smaller ones itself. Half and twice of it made no measurable
/// difference.
const LEAST_KEPT_BYTES: usize = 1 << 20;

/// The kept buffers, and the maximum number of bytes to keep.
struct KeptBuffers {
    most: usize,
    buffers: Vec<Vec<f64>>,
}

static KEPT_BUFFERS: Mutex<KeptBuffers> = Mutex::new(KeptBuffers { most: 0, buffers: Vec::new() });

fn bytes(buffer: &Vec<f64>) -> usize {
    buffer.capacity() * size_of::<f64>()
}

impl KeptBuffers {
    fn used(&self) -> usize {
        self.buffers.iter().map(bytes).sum()
    }
}

/// Sets the maximum number of bytes to keep; initially nothing is kept.
pub fn keep_at_most(most: usize) {
    let mut shelf = KEPT_BUFFERS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    shelf.most = most;
    while shelf.used() > most {
        shelf.buffers.pop();
    }
}

/// An array of numbers, whose memory may come from an earlier array and is kept for a later one on drop.
#[derive(Debug, Default, PartialEq)]
pub struct Numbers {
    buffer: Vec<f64>,
    len: usize,
}

impl Numbers {
    /// Creates an array of `len` numbers with unspecified values, all of which the caller has to overwrite.
    pub fn to_overwrite(len: usize) -> Self {
        let mut numbers = Self { buffer: taken(len).unwrap_or_else(|| vec![0.0; len]), len };
        if cfg!(debug_assertions) {
            numbers.fill(f64::NAN);
        }
        numbers
    }
}

impl Numbers {
    /// Returns the memory of the array in bytes.
    pub fn bytes(&self) -> usize {
        bytes(&self.buffer)
    }
}

/// Takes the smallest kept buffer with room for `len` numbers, unless more than half of it would be unused.
fn taken(len: usize) -> Option<Vec<f64>> {
    let mut shelf = KEPT_BUFFERS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let fitting = shelf.buffers.iter().enumerate().filter(|(_, buffer)| (len..=2 * len).contains(&buffer.len()));
    let (at, _) = fitting.min_by_key(|(_, buffer)| buffer.len())?;
    Some(shelf.buffers.swap_remove(at))
}

impl From<Vec<f64>> for Numbers {
    fn from(buffer: Vec<f64>) -> Self {
        Self { len: buffer.len(), buffer }
    }
}

impl Clone for Numbers {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl Deref for Numbers {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.buffer[..self.len]
    }
}

impl DerefMut for Numbers {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.buffer[..self.len]
    }
}

impl Drop for Numbers {
    fn drop(&mut self) {
        if bytes(&self.buffer) < LEAST_KEPT_BYTES {
            return;
        }
        let buffer = std::mem::take(&mut self.buffer);
        let mut shelf = KEPT_BUFFERS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if shelf.used() + bytes(&buffer) <= shelf.most {
            shelf.buffers.push(buffer);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_are_used_again_and_at_most_so_much_is_kept() {
        let len = LEAST_KEPT_BYTES / size_of::<f64>();
        keep_at_most(LEAST_KEPT_BYTES);
        let (first, second) = (Numbers::to_overwrite(len), Numbers::to_overwrite(len));
        let place = first.as_ptr();
        drop(first);
        drop(second); // not kept: there is room for one
        let again = Numbers::to_overwrite(len - 1);
        assert_eq!((again.as_ptr(), again.len()), (place, len - 1));
        assert_eq!(taken(len), None);
        drop(again);
        keep_at_most(0);
        assert_eq!(taken(len), None);
    }
}
