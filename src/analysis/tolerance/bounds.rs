//! The bounds of a search for a level, which refusals state.

/// Highest level that is considered.
/// Level 16 has 2^32 times as many faces as the input, more than can be numbered. Half of it would refuse tolerances
/// that are met at level 9 or later.
pub(super) const MAX_SEARCH_LEVEL: u32 = 16;
/// Maximum number of faces of a net that is considered.
/// As a level multiplies faces by 4, half and twice of it shift what is refused by half a level, and halve and double
/// the memory of a search.
pub(super) const MAX_NET_FACES: usize = 1 << 18;
/// Smallest tolerance, relative to the greatest coordinate; below it, rounding is not negligible.
/// It is a hundred times what is added for rounding. Half of it is only fifty times as much; twice of it would refuse
/// tolerances that can be met.
pub(super) const LEAST_MESH_TOLERANCE: f64 = 1e-12;
/// Maximum work of a search, in units of about 100 ns: 3.5 minutes, ten times what a search of all permitted levels and
/// faces takes.
/// Half of it is five times what that takes, and refuses slower searches after half the time; twice of it occupies a
/// thread for 7 minutes.
pub const MAX_MESH_WORK: u64 = 1 << 31;
