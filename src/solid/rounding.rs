//! Bounds of the rounding errors in the distance between a solid and the limit surface.

use crate::math::functions::real;
use crate::shape::mesh::Mesh;

/// Roundings of a mean in addition to one per term: those of its weights, which have a few each.
const WEIGHT_ROUNDINGS: usize = 8;
/// Roundings of a control point of a face in addition to those of its vertices: at most two for phantom points, eight
/// for the Bezier or clamped form, and one for the decimal text that a reader parses.
const FORM_ROUNDINGS: usize = 16;
/// The growth factor of coordinates of vertices in control points, and of errors of coordinates in distances: phantom
/// points have weights 2 + 1 = 3 along u and along v, and three coordinates count `sqrt(3)` times: `9 sqrt(3) < 16`.
const COORDINATE_GROWTH: f64 = 16.0;

/// Bounds the roundings of a cage's refinement: each vertex of a level is a mean of at most `n_terms` others, so its
/// coordinates are off by at most `n_terms + 8` roundings more than theirs, none of which exceeds `2^-53` of the
/// largest coordinate of the cage. After `l` levels control points are thus off by at most
/// `16 (l (n_terms + 8) + 16) 2^-53` times that coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounding {
    /// The largest coordinate of the control mesh, in model units.
    largest: f64,
    n_terms: usize,
}

impl Rounding {
    /// Returns the bounds of a control mesh. A vertex is a mean of the corners of the faces around it, which have four
    /// from the first level on.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let topology = &mesh.topology;
        let corners = |half_edge: u32| topology.half_edges(topology.face_of(half_edge)).len().max(4);
        let around = (0..topology.n_vertices()).map(|v| topology.ring(v).map(corners).sum::<usize>());
        let largest = mesh.positions.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        Self { largest, n_terms: around.max().unwrap_or_default() }
    }

    /// Returns a bound of the error of control points of faces of a level, including their decimal text, in model
    /// units.
    pub(super) fn after(&self, level: u32) -> f64 {
        let terms = real(self.n_terms + WEIGHT_ROUNDINGS) * f64::from(level) + real(FORM_ROUNDINGS);
        COORDINATE_GROWTH * terms * 0.5 * f64::EPSILON * self.largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roundings_grow_with_levels_and_terms_and_the_largest_coordinate() {
        let after = |largest: f64, n_terms: usize, level: u32| Rounding { largest, n_terms }.after(level);
        let unit = 0.5 * f64::EPSILON;
        assert_eq!(after(1.0, 16, 0).to_bits(), (256.0 * unit).to_bits());
        assert_eq!(after(2.0, 16, 1).to_bits(), (2.0 * 16.0 * 40.0 * unit).to_bits());
        assert_eq!(after(1.0, 12, 3).to_bits(), (16.0 * 76.0 * unit).to_bits());
    }
}
