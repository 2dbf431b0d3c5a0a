//! The connectivity after corners are cut off: one vertex per face corner, and one face per face, edge and vertex, in
//! closed form and in parallel, except for the first step of an open mesh.
//!
//! Order. Vertices: face by face, corner by corner; the first step of an open mesh appends for each boundary edge, in
//! their order, a vertex near its start and one near its end, then the corners that stay. Faces: first one for each
//! face, in its order and starting at its first corner; then one for each edge in their order, starting at the start of
//! the edge in its first face, then in its second; then one for each vertex in their order, counter-clockwise from its
//! first corner. After the first step boundary edges and boundary vertices have no face of their own.

use rayon::prelude::*;

use super::check::{FaceList, Winding};
use super::connect::CheckedTopology;
use super::topology::{FaceLayout, NONE, Topology, each, index};
use crate::fault::Fault;

impl Topology {
    /// The topology after a first cut of all corners. Each boundary edge and each boundary vertex gets a face, too:
    /// the edge a quad with two new vertices on the boundary, a vertex with k faces one of k + 2 vertices; at a corner
    /// that stays, which has one face, one of 4.
    ///
    /// # Errors
    /// As [`Topology::of_faces`], which builds the result.
    pub fn cut_corners_first(&self, fixed: &[u32]) -> Result<Self, Vec<Fault>> {
        if self.n_boundary() == 0 {
            return Ok(self.cut_corners());
        }
        let boundary = BoundaryRank::of(self);
        let n_c = index(self.n_half_edges());
        let near = |half_edge: u32, end: u32| n_c + 2 * boundary.rank(self.edge(half_edge)) + end;
        let mut faces = FaceList::default();
        (0..self.n_faces()).for_each(|f| faces.push(self.half_edges(f)));
        for e in 0..self.n_edges() {
            let [first, second] = self.halves(e);
            let [start, end] =
                if second == NONE { [near(first, 0), near(first, 1)] } else { [self.next(second), second] };
            faces.push([first, start, end, self.next(first)]);
        }
        for v in (0..self.n_vertices()).filter(|&v| !self.is_isolated(v)) {
            let mut cycle: Vec<u32> = self.ring(v).collect();
            let (first, last) = (cycle[0], cycle[cycle.len() - 1]);
            if self.twin(first) == NONE {
                cycle.push(near(self.previous(last), 1));
                let corner = fixed.binary_search(&index(v)).ok();
                cycle.extend(corner.map(|place| n_c + 2 * boundary.len() + index(place)));
                cycle.push(near(first, 0));
            }
            faces.push(cycle);
        }
        let n = (n_c + 2 * boundary.len()) as usize + fixed.len();
        Self::of_faces(n, faces, Winding::Refuse).map(|CheckedTopology { topology, .. }| topology)
    }

    /// Returns the vertices that replace the boundary vertex `v` in a first step: the fixed corner, or the two new
    /// vertices next to it on the boundary, the preceding one first.
    pub fn cut_corners_first_at(&self, v: u32, fixed: &[u32]) -> Option<Vec<u32>> {
        let [onward, from] = self.boundary_edges(v as usize)?;
        let rim = BoundaryRank::of(self);
        let first = index(self.n_half_edges());
        let corner = fixed.binary_search(&v).ok().map(|place| vec![first + 2 * rim.len() + index(place)]);
        Some(corner.unwrap_or_else(|| vec![first + 2 * rim.rank(from) + 1, first + 2 * rim.rank(onward)]))
    }

    /// Returns the topology after a cut of all corners in which each inner edge and each inner vertex gets a
    /// face. Vertices without faces are left out; inner vertices have at least 3 faces, boundary vertices at most 2.
    #[must_use]
    pub fn cut_corners(&self) -> Self {
        CornerCut::of(self).topology()
    }
}

/// The boundary edges, ascending.
#[derive(Debug)]
struct BoundaryRank(Vec<u32>);

impl BoundaryRank {
    fn of(topology: &Topology) -> Self {
        Self((0..index(topology.n_edges())).filter(|&e| topology.is_boundary_edge(e as usize)).collect())
    }

    fn len(&self) -> u32 {
        index(self.0.len())
    }

    fn rank(&self, edge: u32) -> u32 {
        index(self.0.partition_point(|&e| e < edge))
    }
}

/// One step, with the numbering of its parts.
struct CornerCut<'a> {
    old: &'a Topology,
    /// For each edge, the rank of its face among the edge faces; `None` if every edge has a face.
    rank: Option<Vec<u32>>,
    /// First half-edge of each vertex face, relative to the first half-edge of all vertex faces; the last entry is
    /// their total.
    starts: Vec<u32>,
    n_edge_faces: usize,
}

impl<'a> CornerCut<'a> {
    fn of(old: &'a Topology) -> Self {
        let n_boundary = old.n_boundary();
        let rank = (n_boundary > 0).then(|| {
            let inner = (0..old.n_edges()).map(|e| u32::from(!old.is_boundary_edge(e)));
            inner.scan(0, |sum, one| Some(std::mem::replace(sum, *sum + one))).collect()
        });
        let is_open = |v: usize| n_boundary > 0 && old.boundary_edges(v).is_some();
        let size = |v: usize| if is_open(v) { 0 } else { index(old.ring(v).count()) };
        let mut starts: Vec<u32> = each(old.n_vertices()).map(size).collect();
        let mut sum = 0;
        starts.iter_mut().for_each(|start| sum += std::mem::replace(start, sum));
        starts.push(sum);
        Self { old, rank, starts, n_edge_faces: old.n_edges() - n_boundary }
    }

    /// Returns the first half-edge of the face of an inner edge.
    #[inline]
    fn edge_face(&self, e: u32) -> u32 {
        let rank = self.rank.as_ref().map_or(e, |rank| rank[e as usize]);
        index(self.old.n_half_edges()) + 4 * rank
    }

    /// Returns the first half-edge of the vertex faces.
    fn first_vertex_face(&self) -> u32 {
        index(self.old.n_half_edges() + 4 * self.n_edge_faces)
    }

    /// Returns the new edge that crosses an inner edge at the end where the half-edge `outgoing` starts.
    #[inline]
    fn crossing(&self, outgoing: u32) -> u32 {
        let e = self.old.edge(outgoing);
        let n_c = index(self.old.n_half_edges());
        let end = u32::from(self.old.halves(e as usize)[0] != outgoing);
        n_c + (self.edge_face(e) - n_c) / 2 + end
    }

    fn topology(&self) -> Topology {
        let (vertices, edge_of) = self.corners();
        Topology {
            n_vertices: self.old.n_half_edges(),
            faces: self.faces(),
            vertices,
            edge_of,
            halves: self.edges(),
            outgoing: self.outgoing(),
        }
    }

    /// Returns the sizes of the faces: those of the old faces, 4 per edge, and the number of faces around each vertex.
    fn faces(&self) -> FaceLayout {
        let old = self.old;
        let quads = old.is_quads() && self.starts.windows(2).all(|pair| matches!(pair[1] - pair[0], 0 | 4));
        if quads {
            return FaceLayout::Quads;
        }
        let kept = (0..old.n_faces()).map(|f| old.half_edges(f).start);
        let of_edges = (0..index(self.n_edge_faces)).map(|rank| index(old.n_half_edges()) + 4 * rank);
        let first = self.first_vertex_face();
        let of_vertices = self.starts.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| first + pair[0]);
        let end = first + self.starts[self.starts.len() - 1];
        let starts: Vec<u32> = kept.chain(of_edges).chain(of_vertices).chain([end]).collect();
        let mut owner = vec![0; end as usize];
        starts.windows(2).enumerate().for_each(|(f, pair)| {
            owner[pair[0] as usize..pair[1] as usize].fill(index(f));
        });
        FaceLayout::Mixed { starts, owner }
    }

    /// Returns the vertex and the edge of each half-edge.
    fn corners(&self) -> (Vec<u32>, Vec<u32>) {
        let old = self.old;
        let n_c = index(old.n_half_edges());
        let of_edge = |e: usize| {
            let [first, second] = old.halves(e);
            let vertices = [first, old.next(second), second, old.next(first)];
            (vertices, [self.crossing(first), second, self.crossing(second), first])
        };
        let inner = |e: &usize| self.rank.is_none() || !old.is_boundary_edge(*e);
        let of_edges: Vec<_> = each(old.n_edges()).filter(inner).map(of_edge).collect();
        let of_vertex = |v: usize| {
            let shown = self.starts[v + 1] > self.starts[v];
            let ring = shown.then(|| old.ring(v)).into_iter().flatten();
            // the edge to the next vertex crosses the edge before, which the next half-edge of the ring leaves
            ring.map(|half_edge| (half_edge, self.crossing(old.twin(old.previous(half_edge)))))
        };
        let of_vertices: Vec<(u32, u32)> = each(old.n_vertices()).flat_map_iter(of_vertex).collect();
        let vertices = (0..n_c)
            .chain(of_edges.iter().flat_map(|(vertices, _)| *vertices))
            .chain(of_vertices.iter().map(|(vertex, _)| *vertex));
        let edges = (0..n_c)
            .chain(of_edges.iter().flat_map(|(_, edges)| *edges))
            .chain(of_vertices.iter().map(|(_, edge)| *edge));
        rayon::join(|| vertices.collect(), || edges.collect())
    }

    /// Returns the half-edges of each edge: along the sides of the old faces, then across both ends of each inner
    /// edge.
    fn edges(&self) -> Vec<[u32; 2]> {
        let old = self.old;
        let along = each(old.n_half_edges()).map(index).map(|half_edge| {
            let [first, second] = old.halves(old.edge(half_edge) as usize);
            let side = if first == half_edge { 3 } else { 1 };
            [half_edge, if second == NONE { NONE } else { self.edge_face(old.edge(half_edge)) + side }]
        });
        let across = each(old.n_edges()).map(index).flat_map_iter(|e| {
            let [first, second] = old.halves(e as usize);
            let ends = (second != NONE).then(|| {
                let start = [self.edge_face(e), self.around(old.next(second))];
                [start, [self.edge_face(e) + 2, self.around(old.next(first))]]
            });
            ends.into_iter().flatten()
        });
        along.chain(across).collect()
    }

    /// Returns the half-edge of the vertex face at the new vertex of `outgoing`, or [`NONE`] on the boundary.
    fn around(&self, outgoing: u32) -> u32 {
        let v = self.old.vertex(outgoing) as usize;
        if self.starts[v + 1] == self.starts[v] {
            return NONE;
        }
        let place = self.old.ring(v).position(|half_edge| half_edge == outgoing).unwrap_or(0);
        self.first_vertex_face() + self.starts[v] + index(place)
    }

    /// Returns the first outgoing half-edge of each new vertex: in its face, or on the boundary over the edge between
    /// its faces.
    fn outgoing(&self) -> Vec<u32> {
        let old = self.old;
        let first = |half_edge: u32| {
            let on_edge = self.rank.is_some() && old.boundary_edges(old.vertex(half_edge) as usize).is_some();
            if !on_edge || old.twin(half_edge) == NONE {
                return half_edge;
            }
            let e = old.edge(half_edge);
            self.edge_face(e) + if old.halves(e as usize)[0] == half_edge { 0 } else { 2 }
        };
        each(old.n_half_edges()).map(index).map(first).collect()
    }
}
