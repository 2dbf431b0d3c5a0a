//! Bounds of what a limit may take.

/// Most vertices of a patch: about what three rings around a vertex of valence 1,500 have. Half as many would refuse
/// half that valence; twice as many would take twice the time for each step of the search for tangents.
pub(super) const MAX_PATCH_VERTICES: usize = 20_000;

/// Vertices of patches that are found in the time of a row of a table, 100 ns.
pub(super) const VERTICES_A_ROW: u64 = 2;

/// Most points that the operators of one level make of a net, all together. At 160 bytes a point they take 160 MiB:
/// half as many would refuse cycles whose upsamplings together are finer by a root of 2, twice as many would take 320
/// MiB beside the result of a job.
pub(super) const MAX_LEVEL_POINTS: usize = 1 << 20;

/// Most vertices whose surroundings carry parameters that differ: each is followed by itself. Their time is
/// proportional to their number: half as many would refuse half the mesh, twice as many would take twice as long.
pub(super) const MAX_PATCHES: usize = 16_384;

/// Most rings whose vertices may decide about a limit. Cost grows with their fourth power: twice as many would take 16
/// times as long, half as many would refuse cycles with more than 7 averages.
pub(super) const MAX_RINGS: usize = 16;

/// Most points in the surroundings of all vertices together. At 50 to 200 microseconds each they take one to three and
/// a half minutes on one thread; that is halved or doubled with them.
pub(super) const MAX_FOLLOWED_POINTS: usize = 1 << 20;

/// Levels within which the points around a vertex have to come together.
pub(super) const MAX_FOLLOWED_LEVELS: usize = 1_000;
