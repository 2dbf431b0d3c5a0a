//! The connectivity of the split of triangles at their centres: a new vertex in each face, every inner edge flipped; in
//! closed form and in parallel.
//!
//! Order. Vertices: the old ones, then one for each face, in its order; where boundary edges are cut in three, the
//! vertex of a face at the boundary is the one next to the start of its boundary edge, and those next to the ends
//! follow, edge by edge. Faces: by old face, corner by corner: at the corner `a -> b` of the face `f` the triangle of
//! `a`, the vertex of the face beyond, and that of `f`; at a boundary edge left whole `a`, `b` and the vertex of `f`;
//! at one cut in three the two new vertices on it and the third vertex of `f`.

use rayon::prelude::*;

use super::topology::{FaceLayout, NONE, Topology, each, filled, index};

/// How a split at face centres treats boundary edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundarySplit {
    /// Boundary edges stay whole: the first of two steps.
    Whole,
    /// Boundary edges are cut in three: the second of two steps. Every face has at most one boundary edge then.
    Thirds,
}

impl Topology {
    /// The topology after a split of triangles at their centres; see the order above.
    #[must_use]
    pub fn split_at_face_centres(&self, boundary: BoundarySplit) -> Self {
        let split = FaceCentreSplit::of(self, boundary);
        let (vertices, edge_of) = filled(3, self.n_half_edges(), |half_edge, vertices, edges| {
            vertices.copy_from_slice(&split.triangle(index(half_edge)));
            edges.copy_from_slice(&split.sides(index(half_edge)));
        });
        Self {
            n_vertices: self.n_vertices() + self.n_faces() + split.cut.len(),
            faces: FaceLayout::Triangles,
            vertices,
            edge_of,
            halves: split.edges(),
            outgoing: split.outgoing(),
        }
    }
}

/// One split: the topology before it, and the boundary half-edges whose edges are cut.
struct FaceCentreSplit<'a> {
    old: &'a Topology,
    boundary: BoundarySplit,
    /// The half-edges of the boundary edges that are cut, by edge.
    cut: Vec<u32>,
}

impl<'a> FaceCentreSplit<'a> {
    fn of(old: &'a Topology, boundary: BoundarySplit) -> Self {
        let cut = match boundary {
            BoundarySplit::Whole => Vec::new(),
            BoundarySplit::Thirds => {
                let boundary = (0..old.n_edges()).filter(|&e| old.is_boundary_edge(e));
                boundary.map(|e| old.halves(e)[0]).collect()
            }
        };
        Self { old, boundary, cut }
    }

    /// Returns the boundary half-edge of the face of `half_edge`, if its edge is cut.
    #[inline]
    fn cut_in(&self, half_edge: u32) -> Option<u32> {
        if self.cut.is_empty() {
            return None;
        }
        let mut corners = self.old.half_edges(self.old.face_of(half_edge));
        corners.find(|&half_edge| self.old.twin(half_edge) == NONE)
    }

    /// Returns the rank of a boundary half-edge among those that are cut.
    fn rank(&self, half_edge: u32) -> u32 {
        let edge = self.old.edge(half_edge);
        index(self.cut.partition_point(|&other| self.old.edge(other) < edge))
    }

    /// Returns the new vertex of a face or, if it has a cut edge, the one next to the start of that edge.
    #[inline]
    fn vertex_of(&self, half_edge: u32) -> u32 {
        index(self.old.n_vertices() + self.old.face_of(half_edge))
    }

    /// Returns the new vertex next to the end of a cut edge.
    fn second(&self, cut: u32) -> u32 {
        index(self.old.n_vertices() + self.old.n_faces()) + self.rank(cut)
    }

    /// Returns the new vertex of a face that is connected across the inner edge `half_edge`.
    #[inline]
    fn centre(&self, half_edge: u32) -> u32 {
        match self.cut_in(half_edge) {
            Some(cut) if self.old.next(cut) == half_edge => self.second(cut),
            _ => self.vertex_of(half_edge),
        }
    }

    /// Returns the new triangle at a half-edge.
    #[inline]
    fn triangle(&self, half_edge: u32) -> [u32; 3] {
        let old = self.old;
        let twin = old.twin(half_edge);
        match self.boundary {
            _ if twin != NONE => [old.vertex(half_edge), self.centre(twin), self.centre(half_edge)],
            BoundarySplit::Whole => [old.vertex(half_edge), old.vertex(old.next(half_edge)), self.vertex_of(half_edge)],
            BoundarySplit::Thirds => {
                [self.vertex_of(half_edge), self.second(half_edge), old.vertex(old.previous(half_edge))]
            }
        }
    }

    /// Returns the edge from the start of a half-edge to the new vertex of its face, as the triangle across the edge
    /// before has it.
    #[inline]
    fn spoke(&self, half_edge: u32) -> u32 {
        index(self.old.n_edges()) + half_edge
    }

    /// Returns the second spoke at the vertex opposite a cut edge, to the new vertex next to the edge's end.
    fn extra_spoke(&self, cut: u32) -> u32 {
        index(self.old.n_edges() + self.old.n_half_edges()) + self.rank(cut)
    }

    /// Returns the spoke at a half-edge to the new vertex that belongs to the inner edge `from` of the same face.
    #[inline]
    fn spoke_seen(&self, half_edge: u32, from: u32) -> u32 {
        match self.cut_in(half_edge) {
            Some(cut) if self.old.next(cut) == from && self.old.previous(cut) == half_edge => self.extra_spoke(cut),
            _ => self.spoke(half_edge),
        }
    }

    /// Returns the edges of the new triangle at a half-edge. The flipped edge of an inner edge takes its index, and so
    /// do a whole boundary edge and the middle third of one that is cut.
    #[inline]
    fn sides(&self, half_edge: u32) -> [u32; 3] {
        let old = self.old;
        let (edge, twin) = (old.edge(half_edge), old.twin(half_edge));
        match self.boundary {
            _ if twin != NONE => [self.spoke_seen(old.next(twin), twin), edge, self.spoke_seen(half_edge, half_edge)],
            BoundarySplit::Whole => [edge, self.spoke(old.next(half_edge)), self.spoke(half_edge)],
            BoundarySplit::Thirds => [edge, self.extra_spoke(half_edge), self.spoke(old.previous(half_edge))],
        }
    }

    /// Returns the half-edges of each edge.
    fn edges(&self) -> Vec<[u32; 2]> {
        let old = self.old;
        let crossing = each(old.n_edges()).map(|e| {
            let [first, second] = old.halves(e);
            if second == NONE { [3 * first, NONE] } else { [3 * first + 1, 3 * second + 1] }
        });
        let spokes = each(old.n_half_edges()).map(|half_edge| self.on_spoke(index(half_edge)));
        let extra = self.cut.par_iter().map(|&cut| {
            // from the vertex opposite the cut edge to its second new vertex: in the triangle across, and in the
            // middle triangle
            [3 * old.twin(old.next(cut)), 3 * cut + 1]
        });
        crossing.chain(spokes).chain(extra).collect()
    }

    /// Returns the half-edges of a spoke; the first runs towards the new vertex, unless only the other one exists.
    #[inline]
    fn on_spoke(&self, half_edge: u32) -> [u32; 2] {
        let old = self.old;
        let before = old.previous(half_edge);
        match self.cut_in(half_edge) {
            // at the start of a cut edge, the spoke is a boundary edge
            Some(cut) if cut == half_edge => [3 * old.twin(before), NONE],
            // at its end, the spoke is a boundary edge towards the end
            Some(cut) if old.next(cut) == half_edge => [3 * half_edge + 2, NONE],
            // at the third vertex, to the first new vertex: the middle triangle has this spoke, too
            Some(cut) => [3 * cut + 2, 3 * half_edge + 2],
            None => {
                let towards = if old.twin(before) == NONE { 3 * before + 1 } else { 3 * old.twin(before) };
                [towards, 3 * half_edge + 2]
            }
        }
    }

    /// Returns the first outgoing half-edge of each vertex.
    fn outgoing(&self) -> Vec<u32> {
        let old = self.old;
        let kept = |v: usize| {
            let half_edge = old.outgoing[v];
            if half_edge == NONE {
                return NONE;
            }
            if self.boundary == BoundarySplit::Whole || old.twin(half_edge) != NONE {
                return 3 * half_edge;
            }
            // the boundary continues to the first new vertex, along an edge of the triangle across the edge before
            3 * old.twin(old.previous(half_edge))
        };
        let of_face = |f: usize| {
            let first = old.half_edges(f).start;
            match self.cut_in(first) {
                // from the first new vertex along the middle third
                Some(cut) => 3 * cut,
                None => 3 * first + 2,
            }
        };
        // from the second new vertex to the end of the old edge
        let seconds = self.cut.par_iter().map(|&cut| 3 * old.next(cut) + 2);
        each(old.n_vertices()).map(kept).chain(each(old.n_faces()).map(of_face)).chain(seconds).collect()
    }
}
