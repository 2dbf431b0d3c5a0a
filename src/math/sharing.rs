//! When a loop is worth sharing among threads.

/// Items below which a loop of a few nanoseconds an item runs on the calling thread. Handing work to rayon from outside of
/// its threads costs some 10 us, and far more where its pool has to be started first or is busy with a large job; a loop
/// of 16,384 items takes about as long. At half of it a waiting request could still be held up by a pool that it does not
/// need; at twice of it the largest serial loop would take some 100 us, which is time that one request of a busy server
/// can spare but a mesh of millions of faces never has to.
const SMALL: usize = 16_384;

/// Whether a loop over so many items runs on the calling thread.
pub fn is_small(n: usize) -> bool {
    n < SMALL
}
