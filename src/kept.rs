//! Large buffers that are kept from one computation to the next, since fresh memory pages take more time than writing
//! to them.

use std::any::Any;
use std::collections::VecDeque;
use std::fmt;
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

/// The kept buffers, oldest first, their bytes, and the maximum of these.
struct KeptBuffers {
    most: usize,
    used: usize,
    buffers: VecDeque<KeptBuffer>,
}

static KEPT_BUFFERS: Mutex<KeptBuffers> = Mutex::new(KeptBuffers::NONE);

fn shelf() -> MutexGuard<'static, KeptBuffers> {
    KEPT_BUFFERS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl KeptBuffers {
    const NONE: Self = Self { most: 0, used: 0, buffers: VecDeque::new() };

    /// Takes the smallest buffer with room for `len` values, unless more than a fifth of it would be unused.
    fn take<T: KeptValue>(&mut self, len: usize) -> Option<Vec<T>> {
        let fitting = |kept: &KeptBuffer| {
            let n = kept.buffer.downcast_ref::<Vec<T>>()?.len();
            (len..=len.saturating_add(len / 4)).contains(&n).then_some(n)
        };
        let (_, at) = self.buffers.iter().enumerate().filter_map(|(at, kept)| Some((fitting(kept)?, at))).min()?;
        let kept = self.buffers.remove(at)?;
        self.used -= kept.bytes;
        kept.buffer.downcast().ok().map(|buffer| *buffer)
    }

    /// Keeps a buffer, if it alone is not too large. Returns the buffers for which there is no room.
    fn keep<T: KeptValue>(&mut self, buffer: Vec<T>) -> Vec<KeptBuffer> {
        let kept = KeptBuffer { bytes: bytes(&buffer), buffer: Box::new(buffer) };
        let Some(rest) = self.most.checked_sub(kept.bytes) else { return vec![kept] };
        let left = self.shrunk_to(rest);
        self.used += kept.bytes;
        self.buffers.push_back(kept);
        left
    }

    /// Leaves at most so many bytes, and returns the oldest buffers, which they do not hold.
    fn shrunk_to(&mut self, most: usize) -> Vec<KeptBuffer> {
        let mut left = Vec::new();
        while self.used > most
            && let Some(oldest) = self.buffers.pop_front()
        {
            self.used -= oldest.bytes;
            left.push(oldest);
        }
        left
    }
}

fn bytes<T>(buffer: &Vec<T>) -> usize {
    buffer.capacity() * size_of::<T>()
}

/// Sets the maximum number of bytes to keep; initially nothing is kept.
pub fn keep_at_most(most: usize) {
    let mut shelf = shelf();
    shelf.most = most;
    let left = shelf.shrunk_to(most);
    // nobody waits while the system takes memory back
    drop(shelf);
    drop(left);
}

/// A value that an array in kept memory may consist of.
pub trait KeptValue: Copy + Send + 'static {
    /// What stands in fresh memory that is to be overwritten: in debug builds, where it stands in all such memory, a
    /// value that no result should have, otherwise zero.
    const UNSPECIFIED: Self;
}

impl KeptValue for f64 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::NAN } else { 0.0 };
}

impl KeptValue for f32 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::NAN } else { 0.0 };
}

impl KeptValue for u8 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { 0xa5 } else { 0 };
}

impl KeptValue for u16 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { 0xa5a5 } else { 0 };
}

impl KeptValue for u32 {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) { Self::MAX } else { 0 };
}

impl<T: KeptValue, const N: usize> KeptValue for [T; N] {
    const UNSPECIFIED: Self = [T::UNSPECIFIED; N];
}

/// An array whose memory may come from an earlier array and is kept for a later one on drop.
pub struct Kept<T: KeptValue> {
    buffer: Vec<T>,
    len: usize,
}

/// An array of numbers in kept memory.
pub type Numbers = Kept<f64>;

impl<T: KeptValue> Kept<T> {
    /// Creates an array of `len` unspecified values, all of which the caller has to overwrite: they may be those of an
    /// earlier array.
    pub fn to_overwrite(len: usize) -> Self {
        let is_small = len.saturating_mul(size_of::<T>()) < LEAST_KEPT_BYTES / 2;
        let taken = if is_small { None } else { shelf().take(len) };
        let Some(buffer) = taken else { return vec![T::UNSPECIFIED; len].into() };
        let mut kept = Self { buffer, len };
        if cfg!(debug_assertions) {
            kept.fill(T::UNSPECIFIED);
        }
        kept
    }

    /// Returns the memory of the array in bytes.
    pub fn bytes(&self) -> usize {
        bytes(&self.buffer)
    }
}

impl<T: KeptValue + fmt::Debug> fmt::Debug for Kept<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: KeptValue + PartialEq> PartialEq for Kept<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: KeptValue + Eq> Eq for Kept<T> {}

impl<T: KeptValue> Default for Kept<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: KeptValue> From<Vec<T>> for Kept<T> {
    fn from(buffer: Vec<T>) -> Self {
        Self { len: buffer.len(), buffer }
    }
}

impl<T: KeptValue> FromIterator<T> for Kept<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl<T: KeptValue> Clone for Kept<T> {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl<T: KeptValue> Deref for Kept<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.buffer[..self.len]
    }
}

impl<T: KeptValue> DerefMut for Kept<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.buffer[..self.len]
    }
}

impl<T: KeptValue> Drop for Kept<T> {
    fn drop(&mut self) {
        if self.bytes() < LEAST_KEPT_BYTES {
            return;
        }
        let mut shelf = shelf();
        let left = shelf.keep(std::mem::take(&mut self.buffer));
        drop(shelf);
        drop(left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_are_used_again_and_the_oldest_give_way() {
        let mut shelf = KeptBuffers { most: 800, ..KeptBuffers::NONE };
        let buffers = [40, 50, 60].map(|n| vec![0.0_f64; n]);
        let [first, second, third] = [0, 1, 2].map(|i| buffers[i].as_ptr());
        for buffer in buffers {
            shelf.keep(buffer);
        }
        // 320 and 400 bytes gave way to 480
        assert_eq!((shelf.used, shelf.buffers.len()), (480, 1));
        assert!(shelf.take::<f64>(50).is_some_and(|taken| taken.as_ptr() == third));
        assert_eq!(shelf.used, 0);
        assert_ne!(first, second);
    }

    #[test]
    fn only_buffers_that_fit_are_taken() {
        let mut shelf = KeptBuffers { most: 10_000, ..KeptBuffers::NONE };
        for n in [140, 100, 120] {
            assert!(shelf.keep(vec![0.0_f64; n]).is_empty());
        }
        assert_eq!((shelf.keep(vec![0.0_f64; 1251]).len(), shelf.buffers.len()), (1, 3), "it alone does not fit");
        let mut taken = |len: usize| shelf.take::<f64>(len).map(|buffer| buffer.len());
        assert_eq!([taken(79), taken(141), taken(101), taken(80), taken(80)], [None, None, Some(120), Some(100), None]);
        assert_eq!(shelf.take::<[f64; 2]>(70), None, "the same bytes of another type");
        assert_eq!(shelf.shrunk_to(0).len(), 1);
        assert_eq!(shelf.used, 0);
    }

    #[test]
    fn what_is_behind_an_array_does_not_count() {
        let of = |buffer: Vec<u32>| Kept { buffer, len: 2 };
        assert_eq!(of(vec![1, 2, 3]), of(vec![1, 2]));
        assert_eq!(format!("{:?}", of(vec![1, 2, 3])), "[1, 2]");
    }
}
