//! Masks of the new point of an edge between two triangles.

use crate::math::rows::Rows;
use crate::shape::topology::{NONE, Topology};

/// Weights of the vertices around an inner edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleEdgeMask {
    /// Weight of each end of the edge.
    pub ends: f64,
    /// Weight of the vertex opposite the edge in each of its triangles.
    pub opposite: f64,
    /// Weight of each of the four far vertices, those opposite in the triangles beyond, where they take part.
    pub far: Option<f64>,
}

impl TriangleEdgeMask {
    /// Adds what lies around edge `e`; a far vertex that is missing is reflected.
    pub(in crate::scheme) fn add(self, old: &Topology, e: usize, out: &mut Rows) {
        old.ends(e).iter().for_each(|&v| out.add(v, self.ends));
        for half_edge in old.halves(e) {
            let (onward, back) = (old.next(half_edge), old.previous(half_edge));
            let opposite = old.vertex(back);
            out.add(opposite, self.opposite);
            let Some(weight) = self.far else { continue };
            for (side, near, far) in [(onward, onward, half_edge), (back, half_edge, onward)] {
                let beyond = old.twin(side);
                if beyond == NONE {
                    // across the side from `near` to the opposite vertex lies near + opposite - far
                    out.add(old.vertex(near), weight);
                    out.add(opposite, weight);
                    out.add(old.vertex(far), -weight);
                } else {
                    out.add(old.vertex(old.previous(beyond)), weight);
                }
            }
        }
    }
}
