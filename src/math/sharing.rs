//! Decides whether a loop is worth sharing among threads.

/// Items below which a loop runs on the calling thread: one that reads a request waits for no pool then, neither until
/// its threads are started nor behind a large job. Measured with a release build on one core, so many items take 2 us
/// where boundary edges are counted, 18 us where sides are sorted, 33 us where points are bounded and 120 us where
/// faces are checked (0.1 to 7 ns an item), and starting a thread takes 25 us. At half of it more small requests would
/// wait for a pool; at twice of it 0.1 ms could be saved at most, by four threads, where loops are not shared yet.
const SERIAL_ITEMS: usize = 16_384;

/// Returns whether a loop over `n` items runs on the calling thread.
pub fn is_small(n: usize) -> bool {
    n < SERIAL_ITEMS
}
