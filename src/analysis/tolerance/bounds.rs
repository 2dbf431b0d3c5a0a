//! The bounds of a search for a level, which refusals state.

/// Most levels that are looked at.
/// Level 16 has 2^32 times as many faces as the input, more than are numbered. Half of it refuses tolerances that are
/// met from level 9 on only.
pub(super) const MAX_LEVEL: u32 = 16;
/// Most faces of a net that are looked at.
/// As a level multiplies faces by 4, half and twice of it shift what is refused by half a level, and halve and double
/// the memory of a search.
pub(super) const MAX_FACES: usize = 1 << 18;
/// The least tolerance, over the greatest coordinate: below it, rounding is not negligible.
/// It is a hundred times what is added for rounding. Half of it leaves fifty times; twice of it refuses what could be
/// kept.
pub(super) const LEAST: f64 = 1e-12;
/// Most units of work of a search, of about 100 ns each: 3.5 minutes, ten times what those take that look at all the
/// levels and faces they may.
/// Half of it leaves five times what those take, and refuses the slowest others after half the time; twice of it holds
/// a thread for 7 minutes.
pub const MAX_WORK: u64 = 1 << 31;
