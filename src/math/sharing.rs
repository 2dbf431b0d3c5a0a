//! When a loop is worth sharing among threads.

/// Items below which a loop runs on the calling thread: one that reads a request waits for no pool then, neither until
/// its threads are started nor behind a large job. At some ten to a hundred nanoseconds an item such a loop takes a
/// millisecond at most, which no request notices. At half of it more small requests would wait for a pool; at twice of
/// it the loops that gain from being shared would start later.
const SMALL: usize = 16_384;

/// Whether a loop over so many items runs on the calling thread.
pub fn is_small(n: usize) -> bool {
    n < SMALL
}
