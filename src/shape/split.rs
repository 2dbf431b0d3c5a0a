//! The quad split of a topology: every face of n vertices becomes n quads, in closed form and in parallel.

use rayon::prelude::*;

use super::topology::{FaceLayout, NONE, Topology, each, filled, index};

/// The position of a corner's child quad among the four children of a quad, which are ordered row by row.
pub(super) const ROW_BY_ROW: [u32; 4] = [0, 1, 3, 2];

impl Topology {
    /// The topology after an upsampling of arity 2.
    ///
    /// Vertices: those of the parent, then one for each edge, then one for each face. The child quad of a corner holds
    /// (vertex, edge point, face point, edge point before), counter-clockwise. The four quads of a quad stand row by
    /// row (origin at corner 0, first axis towards corner 1) and keep its orientation; those of another face stand
    /// corner by corner, each starting at its vertex.
    #[must_use]
    pub fn split(&self) -> Self {
        let (n_v, n_e, n_c) = (self.n_vertices(), self.n_edges(), self.n_half_edges());
        let (vertices, edge_of) = filled(4, n_c, |child, vertices, edges| {
            let half_edge = self.parent_half_edge(index(child));
            let rotation = self.child(half_edge, 0) & 3;
            let (quad, sides) = (self.child_quad(half_edge), self.child_edges(half_edge));
            for i in 0..4 {
                let at = (i + rotation as usize) & 3;
                vertices[at] = quad[i];
                edges[at] = sides[i];
            }
        });
        let halves = each(2 * n_e).map(|half| self.half_corners(half));
        let spokes = each(n_c).map(|half_edge| {
            let half_edge = index(half_edge);
            [self.child(half_edge, 1), self.child(self.next(half_edge), 2)]
        });
        let kept = self.outgoing.par_iter().map(|&c| if c == NONE { NONE } else { self.child(c, 0) });
        let on_edges = self.halves.par_iter().map(|corners| self.child(self.next(corners[0]), 3));
        let on_faces = (0..self.n_faces()).into_par_iter().map(|f| self.child(self.half_edges(f).start, 2));
        Self {
            n_vertices: n_v + n_e + self.n_faces(),
            faces: FaceLayout::Quads,
            vertices,
            edge_of,
            halves: halves.chain(spokes).collect(),
            outgoing: kept.chain(on_edges).chain(on_faces).collect(),
        }
    }

    /// Returns the vertices of the child quad of a corner: its vertex, edge point, face point, and the edge point
    /// before.
    #[inline]
    pub fn child_quad(&self, half_edge: u32) -> [u32; 4] {
        let (n_v, n_e) = (index(self.n_vertices()), index(self.n_edges()));
        let face = index(self.face_of(half_edge));
        let before = self.edge(self.previous(half_edge));
        [self.vertex(half_edge), n_v + self.edge(half_edge), n_v + n_e + face, n_v + before]
    }

    /// Returns half-edge `i` (0 to 3, counted from the vertex) of the child quad of `half_edge`.
    #[inline]
    fn child(&self, half_edge: u32, i: u32) -> u32 {
        let range = self.half_edges(self.face_of(half_edge));
        let j = half_edge - range.start;
        if range.end - range.start == 4 {
            4 * (range.start + ROW_BY_ROW[j as usize]) + ((j + i) & 3)
        } else {
            4 * half_edge + i
        }
    }

    /// Returns the half-edge whose child quad has index `child`: the inverse of `child`.
    #[inline]
    pub fn parent_half_edge(&self, child: u32) -> u32 {
        let range = self.half_edges(self.face_of(child));
        if range.end - range.start == 4 { range.start + ROW_BY_ROW[(child - range.start) as usize] } else { child }
    }

    /// Returns the edges of the child quad of a corner, in the order of [`Topology::child_quad`].
    #[inline]
    fn child_edges(&self, half_edge: u32) -> [u32; 4] {
        let n_e = index(self.n_edges());
        let before = self.previous(half_edge);
        let (edge, edge_before) = (self.edge(half_edge), self.edge(before));
        let forward = self.halves[edge as usize][0] == half_edge;
        let forward_before = self.halves[edge_before as usize][0] == before;
        [
            2 * edge + u32::from(!forward),
            2 * n_e + half_edge,
            2 * n_e + before,
            2 * edge_before + u32::from(forward_before),
        ]
    }

    /// Returns the half-edges on half `half & 1` of edge `half / 2`.
    #[inline]
    fn half_corners(&self, half: usize) -> [u32; 2] {
        let [first, second] = self.halves[half / 2];
        if half & 1 == 0 {
            let other = if second == NONE { NONE } else { self.child(self.next(second), 3) };
            [self.child(first, 0), other]
        } else {
            let other = if second == NONE { NONE } else { self.child(second, 0) };
            [self.child(self.next(first), 3), other]
        }
    }
}
