//! What rounding adds to the distance between a solid and the limit surface.

use crate::math::functions::real;
use crate::shape::mesh::Mesh;

/// Roundings of a mean besides one a term: those of its weights, of which each has a few.
const OF_WEIGHTS: usize = 8;
/// Roundings of a control point of a face besides those of the vertices that it is made of: at most two of phantom
/// points, eight of the Bezier or clamped form, and one of the decimal text that a reader takes for it.
const OF_FORMS: usize = 16;
/// What coordinates of vertices are multiplied by in control points, and errors of coordinates in distances: phantom
/// points weigh 2 + 1 = 3 along u and along v, and three coordinates are `sqrt(3)` as far as one: `9 sqrt(3) < 16`.
const GROWTH: f64 = 16.0;

/// Bounds the roundings of a cage's refinement: each vertex of a level is a mean of at most `n_terms` others, so its
/// coordinates are off by at most `n_terms + 8` roundings more than theirs, none of which exceeds `2^-53` of the
/// largest coordinate of the cage. After `l` levels control points are thus off by at most
/// `16 (l (n_terms + 8) + 16) 2^-53` times that coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounding {
    /// The largest coordinate of the cage, model units.
    largest: f64,
    n_terms: usize,
}

impl Rounding {
    /// That of a cage. A vertex is a mean of the corners of the faces around it, which have four from the first level
    /// on.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let topology = &mesh.topology;
        let corners = |half_edge: u32| topology.half_edges(topology.face_of(half_edge)).len().max(4);
        let around = (0..topology.n_vertices()).map(|v| topology.ring(v).map(corners).sum::<usize>());
        let largest = mesh.positions.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        Self { largest, n_terms: around.max().unwrap_or_default() }
    }

    /// How far control points of faces of a level are from their places, and their decimal text, at most, model units.
    pub(super) fn after(&self, level: u32) -> f64 {
        let terms = real(self.n_terms + OF_WEIGHTS) * f64::from(level) + real(OF_FORMS);
        GROWTH * terms * 0.5 * f64::EPSILON * self.largest
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
