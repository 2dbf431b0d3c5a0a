//! The polygon that entered the last upsampling.

use std::sync::Arc;

use crate::math::rows::Rows;
use crate::shape::topology::index;

/// The polygon that entered the last upsampling, towards which a push-back pushes.
#[derive(Debug, Clone)]
pub struct PolygonAnchor {
    /// Number of stored points.
    pub n: usize,
    /// Index of the first control point among the stored points.
    pub first: usize,
    /// Number of control points.
    pub n_control: usize,
    /// Whether it is closed.
    pub closed: bool,
    /// Its corners, which keep their position.
    pub corners: Arc<[u32]>,
    /// Whether points were lost since the upsampling.
    pub lost: bool,
}

impl PolygonAnchor {
    /// Adds to a row `weight x delta x` the displacement of control point `i`: zero at corners; beyond the ends of an
    /// open polygon the reversed displacement of its mirror image.
    pub(super) fn push(&self, i: isize, weight: f64, delta: impl Fn(usize) -> f64, rows: &mut Rows) {
        let n = self.n_control.cast_signed();
        let (i, weight) = match (self.closed, self.first) {
            (true, _) => (i.rem_euclid(n), weight),
            (false, 1) if i < 0 => (-1 - i, -weight),
            (false, 1) if i >= n => (2 * n - 1 - i, -weight),
            _ => (i, weight),
        };
        let Ok(i) = usize::try_from(i) else { return };
        if i < self.n_control && self.corners.binary_search(&index(i)).is_err() {
            rows.add(index(i + self.first), weight * delta(i));
        }
    }
}
