//! Masks over the vertices of a split into quads: old vertices (V), edge points (E) and face points (F).

use crate::math::rows::Rows;
use crate::shape::topology::{Topology, index};

/// Weights of a V, and of each E and F around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexMask {
    /// Weight of the vertex itself.
    pub own: f64,
    /// Weight of the point of each of its edges.
    pub edges: f64,
    /// Weight of the point of each of its faces.
    pub faces: f64,
}

impl VertexMask {
    /// Returns the mask with all weights multiplied by `scale`.
    #[must_use]
    pub fn times(self, scale: f64) -> Self {
        Self { own: scale * self.own, edges: scale * self.edges, faces: scale * self.faces }
    }

    /// Adds the stencil of the interior vertex `v` of `parent`.
    #[inline]
    pub(in crate::scheme) fn add(self, parent: &Topology, v: usize, out: &mut Rows) {
        let n_v = index(parent.n_vertices());
        let first_face = n_v + index(parent.n_edges());
        let face = |half_edge| first_face + index(parent.face_of(half_edge));
        out.add(index(v), self.own);
        out.group(|out| parent.ring(v).for_each(|half_edge| out.add(n_v + parent.edge(half_edge), self.edges)));
        out.group(|out| parent.ring(v).for_each(|half_edge| out.add(face(half_edge), self.faces)));
    }
}

/// Weights of an E and of the points around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeMask {
    /// Weight of the edge point itself.
    pub own: f64,
    /// Weight of each of the two ends; `None` if they do not take part.
    pub ends: Option<f64>,
    /// Weight of each of the two adjacent face points; `None` if they do not take part.
    pub faces: Option<f64>,
    /// Weight of each of the four adjacent edge points in these faces; `None` if they do not take part.
    pub sides: Option<f64>,
}

impl EdgeMask {
    /// Adds the stencil of edge `e` of `parent`, which must be an inner edge if faces or sides take part.
    #[inline]
    pub(in crate::scheme) fn add(self, parent: &Topology, e: usize, out: &mut Rows) {
        let n_v = index(parent.n_vertices());
        out.add(n_v + index(e), self.own);
        if let Some(weight) = self.ends {
            out.group(|out| parent.ends(e).iter().for_each(|&v| out.add(v, weight)));
        }
        let halves = parent.halves(e);
        if let Some(weight) = self.faces {
            let face = |half_edge| n_v + index(parent.n_edges() + parent.face_of(half_edge));
            out.group(|out| halves.iter().for_each(|&half_edge| out.add(face(half_edge), weight)));
        }
        if let Some(weight) = self.sides {
            let sides = halves.into_iter().flat_map(|half| [parent.next(half), parent.previous(half)]);
            out.group(|out| sides.for_each(|side| out.add(n_v + parent.edge(side), weight)));
        }
    }
}

/// Weights of an F and of the points around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceMask {
    /// Weight of the face point itself.
    pub own: f64,
    /// Weight of each of its vertices.
    pub vertices: f64,
    /// Weight of the point of each of its edges.
    pub edges: f64,
}

impl FaceMask {
    /// Adds the stencil of a face of `parent`.
    pub(in crate::scheme) fn add(self, parent: &Topology, face: usize, out: &mut Rows) {
        let n_v = index(parent.n_vertices());
        out.add(n_v + index(parent.n_edges() + face), self.own);
        let around = parent.half_edges(face);
        out.group(|out| around.clone().for_each(|half_edge| out.add(parent.vertex(half_edge), self.vertices)));
        out.group(|out| around.for_each(|half_edge| out.add(n_v + parent.edge(half_edge), self.edges)));
    }
}
