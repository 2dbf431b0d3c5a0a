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
    /// Weight of each of the four far vertices, opposite in the adjacent triangles; `None` if they do not take part.
    pub far: Option<f64>,
}

impl TriangleEdgeMask {
    /// Adds the stencil of edge `e`; a missing far vertex is replaced by reflection.
    pub(in crate::scheme) fn add(self, old: &Topology, e: usize, out: &mut Rows) {
        let halves = old.halves(e);
        let opposite = |half_edge| old.vertex(old.previous(half_edge));
        out.group(|out| old.ends(e).iter().for_each(|&v| out.add(v, self.ends)));
        out.group(|out| halves.iter().for_each(|&half_edge| out.add(opposite(half_edge), self.opposite)));
        if let Some(weight) = self.far {
            out.group(|out| halves.iter().for_each(|&half_edge| add_far(old, half_edge, weight, out)));
        }
    }
}

/// Adds the two far vertices on the side of a half-edge, opposite the other sides of its triangle.
fn add_far(old: &Topology, half_edge: u32, weight: f64, out: &mut Rows) {
    let (onward, back) = (old.next(half_edge), old.previous(half_edge));
    let opposite = old.vertex(back);
    for (side, near, far) in [(onward, onward, half_edge), (back, half_edge, onward)] {
        let beyond = old.twin(side);
        if beyond == NONE {
            // across the side from `near` to the opposite vertex, the reflected point is near + opposite - far
            out.add(old.vertex(near), weight);
            out.add(opposite, weight);
            out.add(old.vertex(far), -weight);
        } else {
            out.add(old.vertex(old.previous(beyond)), weight);
        }
    }
}
