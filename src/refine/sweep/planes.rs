//! The planes of a refined grid, and the masks that compute their points.

/// The number of planes of a refined grid: vertices, edge points along the first and along the second axis, and face
/// points or, on triangles, edge points along the diagonals.
pub(super) const PLANES: usize = 4;

/// A weight and the points whose symmetric sum it multiplies: the plane of each point, and its cell relative to that of
/// the computed point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MaskGroup {
    pub(super) weight: f64,
    pub(super) members: Vec<(usize, [isize; 2])>,
}

/// The weighted groups whose sum is a refined point.
pub(super) type PlaneMask = Vec<MaskGroup>;
