//! Bounds of the cost of a limit.

/// Most vertices of a disc: about what three rings around a vertex of valence 1,500 have. Half as many would refuse
/// half that valence; twice as many would take twice the time for each step of the search for tangents.
pub(super) const MAX_DISC_VERTICES: usize = 20_000;

/// Vertices of discs that are found in the time of a row of a table, 100 ns.
/// It only says how much of the progress a disc takes: with half of it twice as much is told for the same discs,
/// with twice of it half as much.
pub(super) const VERTICES_A_ROW: u64 = 2;

/// Most points that the operators of one level make of a net, all together. At 160 bytes a point they take 160 MiB:
/// half as many would refuse cycles whose upsamplings together are finer by a root of 2, twice as many would take 320
/// MiB beside the result of a job.
pub(super) const MAX_LEVEL_POINTS: usize = 1 << 20;

/// Most vertices whose surroundings carry parameters that differ: each is followed by itself. Their time is
/// proportional to their number: half as many would refuse half the mesh, twice as many would take twice as long.
pub(super) const MAX_DISCES: usize = 16_384;

/// Most rings whose vertices may decide about a limit. Cost grows with their fourth power: twice as many would take 16
/// times as long, half as many would refuse cycles with more than 7 averages.
pub(super) const MAX_RINGS: usize = 16;

/// Most points in the surroundings of all vertices together. At 50 to 200 microseconds each they take one to three and
/// a half minutes on one thread; that is halved or doubled with them.
pub(super) const MAX_FOLLOWED_POINTS: usize = 1 << 20;

/// Levels within which the points around a vertex have to come together.
/// Points that come 0.96 as close at each level are together after 1,000. Half of it asks for 0.92, twice of it for
/// 0.98, and follows points that never come together for twice as long.
pub(super) const MAX_FOLLOWED_LEVELS: usize = 1_000;

/// Vertices whose discs are compared at a time at first; the number doubles up to [`CHUNK`].
/// Half and twice of it only shift the first doubling: a mesh whose first discs are beyond what is allowed is refused
/// after that many.
pub(super) const FIRST_CHUNK: usize = 64;
/// Vertices whose discs are compared at a time, at most.
/// Half of it waits for all threads, and looks at the watch, twice as often; twice of it holds twice as many discs at
/// once.
pub(super) const CHUNK: usize = 16_384;
/// Vertices that the discs compared at a time have in all, about: 32 MiB of discs around vertices with many faces,
/// and enough work for all threads.
/// Half and twice of it halve and double these bytes; at half of it threads wait for each other twice as often.
pub(super) const CHUNK_VERTICES: usize = 1 << 20;
