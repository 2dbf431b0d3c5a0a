//! Masks of a vertex and its neighbours, all of them or those along a curve.

use crate::math::rows::Rows;
use crate::shape::topology::{Topology, index};

/// Weights of a vertex and of each of its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingMask {
    /// Weight of the vertex itself.
    pub own: f64,
    /// Weight of each neighbour.
    pub neighbours: f64,
}

impl RingMask {
    /// The mask (1, 2, 1)/4, which turns linear upsampling into cubic B-splines.
    pub const CUBIC: Self = Self { own: 0.5, neighbours: 0.25 };

    /// Returns the mask with all weights multiplied by `scale`.
    #[must_use]
    pub fn times(self, scale: f64) -> Self {
        Self { own: scale * self.own, neighbours: scale * self.neighbours }
    }

    /// Adds vertex `v` and the other ends of these edges.
    pub(in crate::scheme) fn add_ends(
        self,
        old: &Topology,
        v: usize,
        edges: impl Iterator<Item = u32>,
        out: &mut Rows,
    ) {
        out.add(index(v), self.own);
        out.group(|out| edges.for_each(|e| out.add(old.other_end(e as usize, v), self.neighbours)));
    }

    /// Adds vertex `v` and the points of these edges after a split of `parent` into quads.
    #[inline]
    pub(in crate::scheme) fn add_edge_points(self, parent: &Topology, v: usize, edges: [u32; 2], out: &mut Rows) {
        let n_v = index(parent.n_vertices());
        out.add(index(v), self.own);
        out.group(|out| edges.iter().for_each(|&e| out.add(n_v + e, self.neighbours)));
    }
}
