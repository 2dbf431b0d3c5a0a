//! Bounds of what a limit may take.

/// Most vertices of a patch: about what three rings around a vertex of valence 1,500 have.
pub(super) const MAX_PATCH_VERTICES: usize = 20_000;

/// Vertices of patches that are found in the time of a row of a table, 100 ns.
pub(super) const VERTICES_A_ROW: u64 = 2;

/// Most points that the operators of one level make of a net, all together.
pub(super) const MAX_LEVEL_POINTS: usize = 1 << 20;

/// Most vertices whose surroundings carry parameters that differ: each is followed by itself.
pub(super) const MAX_PATCHES: usize = 16_384;

/// Most rings whose vertices may decide about a limit.
pub(super) const MAX_RINGS: usize = 16;

/// Most points in the surroundings of all vertices together.
pub(super) const MAX_FOLLOWED_POINTS: usize = 1 << 20;

/// Levels within which the points around a vertex have to come together.
pub(super) const MAX_FOLLOWED_LEVELS: usize = 1_000;
