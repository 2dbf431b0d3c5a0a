//! The planes of a refined grid, and the masks with which their points are made.

/// The four planes of a refined grid: vertices, points of edges along the first and the second axis, and points of
/// faces or, where faces are triangles, of edges along the diagonals.
pub(super) const PLANES: usize = 4;

/// A weight and the points whose symmetric sum it belongs to: the plane of each, and its cell counted from that of the
/// point that is made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MaskGroup {
    pub(super) weight: f64,
    pub(super) members: Vec<(usize, [isize; 2])>,
}

/// What a point is made of, group after group.
pub(super) type Mask = Vec<MaskGroup>;
