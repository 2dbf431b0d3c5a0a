//! Large buffers that are kept from one computation to the next, since fresh memory pages take more time than writing
//! to them.

use std::any::Any;
use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Smallest buffer to keep, in bytes; the allocator keeps smaller ones itself. Half and twice of it made no measurable
/// difference.
const LEAST_KEPT_BYTES: usize = 1 << 20;

/// A buffer that is kept, a `Vec` of some type.
struct KeptBuffer {
    bytes: usize,
    buffer: Box<dyn Any + Send>,
}

/// The kept buffers, those kept longest first, and the maximum number of bytes to keep.
struct KeptBuffers {
    most: usize,
    used: usize,
    buffers: VecDeque<KeptBuffer>,
}

static KEPT_BUFFERS: Mutex<KeptBuffers> = Mutex::new(KeptBuffers { most: 0, used: 0, buffers: VecDeque::new() });

fn shelf() -> MutexGuard<'static, KeptBuffers> {
    KEPT_BUFFERS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl KeptBuffers {
    /// Drops the buffers that were kept longest until at most `most` bytes are kept.
    fn shrink_to(&mut self, most: usize) {
        while self.used > most
            && let Some(oldest) = self.buffers.pop_front()
        {
            self.used -= oldest.bytes;
        }
    }
}

/// Sets the maximum number of bytes to keep; initially nothing is kept.
pub fn keep_at_most(most: usize) {
    let mut shelf = shelf();
    shelf.most = most;
    shelf.shrink_to(most);
}

/// A value that an array in kept memory may consist of.
pub trait Plain: Copy + Send + 'static {
    /// What stands in an array that is to be overwritten: in debug builds a value that no result should have, otherwise
    /// zero, which fresh memory has by itself.
    const UNSPECIFIED: Self;
}

impl Plain for f64 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::NAN } else { 0.0 };
}

impl Plain for f32 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::NAN } else { 0.0 };
}

impl Plain for u8 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::MAX } else { 0 };
}

impl Plain for u32 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::MAX } else { 0 };
}

impl<T: Plain, const N: usize> Plain for [T; N] {
    const UNSPECIFIED: Self = [T::UNSPECIFIED; N];
}

/// An array whose memory may come from an earlier array and is kept for a later one on drop.
#[derive(Debug, PartialEq)]
pub struct Kept<T: Plain> {
    buffer: Vec<T>,
    len: usize,
}

/// An array of numbers in kept memory.
pub type Numbers = Kept<f64>;

impl<T: Plain> Kept<T> {
    /// Creates an array of `len` unspecified values, all of which the caller has to overwrite.
    pub fn to_overwrite(len: usize) -> Self {
        let Some(buffer) = taken(len) else { return vec![T::UNSPECIFIED; len].into() };
        let mut kept = Self { buffer, len };
        if cfg!(debug_assertions) {
            kept.fill(T::UNSPECIFIED);
        }
        kept
    }

    /// Returns the memory of the array in bytes.
    pub fn bytes(&self) -> usize {
        self.buffer.capacity() * size_of::<T>()
    }
}

/// Takes the smallest kept buffer with room for `len` values, unless more than half of it would be unused.
fn taken<T: Plain>(len: usize) -> Option<Vec<T>> {
    let mut shelf = shelf();
    let fitting = |kept: &KeptBuffer| {
        let buffer: &Vec<T> = kept.buffer.downcast_ref()?;
        (len..=2 * len).contains(&buffer.len()).then_some(buffer.len())
    };
    let buffers = shelf.buffers.iter().enumerate();
    let (_, at) = buffers.filter_map(|(at, kept)| Some((fitting(kept)?, at))).min()?;
    let kept = shelf.buffers.remove(at)?;
    shelf.used -= kept.bytes;
    kept.buffer.downcast().ok().map(|buffer| *buffer)
}

impl<T: Plain> Default for Kept<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: Plain> From<Vec<T>> for Kept<T> {
    fn from(buffer: Vec<T>) -> Self {
        Self { len: buffer.len(), buffer }
    }
}

impl<T: Plain> Clone for Kept<T> {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl<T: Plain> Deref for Kept<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.buffer[..self.len]
    }
}

impl<T: Plain> DerefMut for Kept<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.buffer[..self.len]
    }
}

impl<T: Plain> Drop for Kept<T> {
    fn drop(&mut self) {
        let bytes = self.bytes();
        if bytes < LEAST_KEPT_BYTES {
            return;
        }
        let buffer = std::mem::take(&mut self.buffer);
        let mut shelf = shelf();
        if bytes <= shelf.most {
            let most = shelf.most - bytes;
            shelf.shrink_to(most);
            shelf.used += bytes;
            shelf.buffers.push_back(KeptBuffer { bytes, buffer: Box::new(buffer) });
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
        let place = second.as_ptr();
        drop(first);
        drop(second); // instead of the first: there is room for one
        let again = Numbers::to_overwrite(len - 1);
        assert_eq!((again.as_ptr(), again.len()), (place, len - 1));
        assert_eq!(taken::<f64>(len), None);
        drop(again);
        assert_eq!(taken::<[f64; 2]>(len / 2), None, "the same bytes of another type");
        keep_at_most(0);
        assert_eq!((taken::<f64>(len), shelf().used), (None, 0));
    }
}
