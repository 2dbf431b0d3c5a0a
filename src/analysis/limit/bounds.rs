//! Bounds of the cost of a limit.

/// Maximum number of vertices of a disc: about what three rings around a vertex of valence 1,500 have. Half as many
/// would refuse half that valence; twice as many would double the time of each step of the search for tangents.
pub(super) const MAX_DISC_VERTICES: usize = 20_000;

/// Number of disc vertices that are found in the time of one table row, 100 ns. It only weighs discs in the reported
/// progress: half of it reports twice as much for the same discs, twice of it half as much.
pub(super) const VERTICES_A_ROW: u64 = 2;

/// Maximum number of points that all operators of one level make of a net together. At 160 bytes a point they take 160
/// MiB: half as many would admit only cycles that are coarser by a root of 2; twice as many would take 320 MiB beside
/// the result of a job.
pub(super) const MAX_LEVEL_POINTS: usize = 1 << 20;

/// Maximum number of discs whose vertices carry parameters that differ; each is followed separately. Their time is
/// proportional to their number: half as many would refuse half the mesh; twice as many would take twice as long.
pub(super) const MAX_DISCS: usize = 16_384;

/// Maximum number of rings whose vertices may influence a limit. Cost grows with the fourth power of the rings: twice
/// as many would take 16 times as long; half as many would refuse cycles with more than 7 averages.
pub(super) const MAX_INFLUENCE_RINGS: usize = 16;

/// Maximum number of points in the surroundings of all vertices together. At 50 to 200 microseconds each they take one
/// to three and a half minutes on one thread; half or twice as many halve or double that.
pub(super) const MAX_FOLLOWED_POINTS: usize = 1 << 20;

/// Maximum number of levels within which the points around a vertex must converge. Points whose distance shrinks by
/// 0.96 per level have converged after 1,000. Half of it would require 0.92; twice of it would allow 0.98, and follow
/// points that never converge for twice as long.
pub(super) const MAX_FOLLOWED_LEVELS: usize = 1_000;

/// Initial number of vertices whose discs are compared in one chunk; it doubles up to [`DISCS_PER_CHUNK`]. Half and
/// twice of it only shift the first doubling: a mesh whose first discs exceed a limit is refused after that many.
pub(super) const FIRST_CHUNK: usize = 64;
/// Maximum number of vertices whose discs are compared in one chunk. Half of it synchronises all threads and checks the
/// watch twice as often; twice of it holds twice as many discs at once.
pub(super) const DISCS_PER_CHUNK: usize = 16_384;
/// Approximate total number of disc vertices in one chunk: 32 MiB of discs around vertices with many faces, and enough
/// work for all threads. Half and twice of it halve and double these bytes; at half of it threads wait for each other
/// twice as often.
pub(super) const CHUNK_VERTICES: usize = 1 << 20;
