//! The connectivity of vertices, edges and faces as flat arrays that are never edited, without coordinates.
//!
//! A *half-edge* is one side of an edge: it belongs to one face and runs from a vertex of the face to the next one. It
//! also identifies the corner of the face at the vertex where it starts. Half-edges are numbered face after face.

use std::mem;

use rayon::prelude::*;

use crate::math::sharing::is_small;

/// Stands for "none": the missing second half-edge of a boundary edge, or the missing half-edge of an isolated vertex.
pub const NONE: u32 = u32::MAX;

/// Minimum number of items that one thread takes at a time in loops that make topologies: some ten microseconds at 10
/// ns an item, more than handing them to another thread costs. Half of it makes switching felt; with twice of it the
/// loops of nets of a few thousand faces have work for fewer threads.
const SERIAL_LOOP: usize = 1024;

/// Returns the numbers below `n`, for loops that make topologies.
pub(super) fn each(n: usize) -> impl IndexedParallelIterator<Item = usize> {
    (0..n).into_par_iter().with_min_len(SERIAL_LOOP)
}

/// Returns the vertices and the edges of `n` faces with `sides` sides each, as `fill` writes them to its second and
/// third argument for the face that is its first.
pub(super) fn filled(
    sides: usize,
    n: usize,
    fill: impl Fn(usize, &mut [u32], &mut [u32]) + Sync,
) -> (Vec<u32>, Vec<u32>) {
    let (mut vertices, mut edges) = (vec![0; sides * n], vec![0; sides * n]);
    let faces = vertices.par_chunks_exact_mut(sides).zip(edges.par_chunks_exact_mut(sides));
    faces.enumerate().with_min_len(SERIAL_LOOP).for_each(|(face, (vertices, edges))| fill(face, vertices, edges));
    (vertices, edges)
}

/// Connectivity of an oriented 2-manifold with boundary; every vertex has at most one fan of faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    pub(super) n_vertices: usize,
    pub(super) faces: FaceLayout,
    /// The vertex at which each half-edge starts.
    pub(super) vertices: Vec<u32>,
    /// The edge of each half-edge.
    pub(super) edge_of: Vec<u32>,
    /// The half-edges of each edge; the first one runs in the edge's direction, the second one may be [`NONE`].
    pub(super) halves: Vec<[u32; 2]>,
    /// The first outgoing half-edge of each vertex in counter-clockwise order (on the boundary the one on the outgoing
    /// boundary edge), or [`NONE`].
    pub(super) outgoing: Vec<u32>,
}

/// The layout of the half-edges of faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum FaceLayout {
    /// Face `f` has the half-edges `4 f .. 4 f + 4`.
    Quads,
    /// Face `f` has the half-edges `3 f .. 3 f + 3`.
    Triangles,
    /// Face `f` has the half-edges `starts[f] .. starts[f + 1]`; `owner` is the face of each half-edge.
    Mixed { starts: Vec<u32>, owner: Vec<u32> },
}

/// Converts a count to an index; the limits on admission keep all counts of half-edges below 2^32.
#[expect(clippy::cast_possible_truncation, reason = "the limits keep every count below 2^32")]
pub(crate) const fn index(n: usize) -> u32 {
    n as u32
}

impl Topology {
    /// Returns the number of bytes that the topology occupies.
    pub fn bytes(&self) -> usize {
        let Self { n_vertices: _, faces, vertices, edge_of, halves, outgoing } = self;
        let list = |list: &Vec<u32>| list.capacity() * size_of::<u32>();
        let faces = if let FaceLayout::Mixed { starts, owner } = faces { list(starts) + list(owner) } else { 0 };
        let halves = halves.capacity() * size_of::<[u32; 2]>();
        size_of::<Self>() + faces + list(vertices) + list(edge_of) + halves + list(outgoing)
    }

    /// Number of vertices, isolated ones included.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// Number of edges.
    pub fn n_edges(&self) -> usize {
        self.halves.len()
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        match &self.faces {
            FaceLayout::Quads => self.vertices.len() / 4,
            FaceLayout::Triangles => self.vertices.len() / 3,
            FaceLayout::Mixed { starts, .. } => starts.len() - 1,
        }
    }

    /// Number of half-edges: the sum of the sizes of all faces.
    pub fn n_half_edges(&self) -> usize {
        self.vertices.len()
    }

    /// Returns whether every face has four vertices.
    pub fn is_quads(&self) -> bool {
        match &self.faces {
            FaceLayout::Quads => true,
            FaceLayout::Triangles => false,
            FaceLayout::Mixed { starts, .. } => starts.windows(2).all(|pair| pair[1] - pair[0] == 4),
        }
    }

    /// Returns the first face that is not a triangle, if there is one.
    pub fn first_other_than_triangle(&self) -> Option<usize> {
        match &self.faces {
            FaceLayout::Triangles => None,
            _ => (0..self.n_faces()).find(|&f| self.face(f).len() != 3),
        }
    }

    /// Returns the half-edges of face `f`.
    #[inline]
    pub fn half_edges(&self, f: usize) -> std::ops::Range<u32> {
        match &self.faces {
            FaceLayout::Quads => index(4 * f)..index(4 * f + 4),
            FaceLayout::Triangles => index(3 * f)..index(3 * f + 3),
            FaceLayout::Mixed { starts, .. } => starts[f]..starts[f + 1],
        }
    }

    /// Returns the vertices of face `f`, counter-clockwise.
    #[inline]
    pub fn face(&self, f: usize) -> &[u32] {
        let half_edges = self.half_edges(f);
        &self.vertices[half_edges.start as usize..half_edges.end as usize]
    }

    /// Returns the face of a half-edge.
    #[inline]
    pub fn face_of(&self, half_edge: u32) -> usize {
        match &self.faces {
            FaceLayout::Quads => half_edge as usize / 4,
            FaceLayout::Triangles => half_edge as usize / 3,
            FaceLayout::Mixed { owner, .. } => owner[half_edge as usize] as usize,
        }
    }

    /// Returns the next half-edge of the same face.
    #[inline]
    pub fn next(&self, half_edge: u32) -> u32 {
        match &self.faces {
            FaceLayout::Quads => (half_edge & !3) | ((half_edge + 1) & 3),
            FaceLayout::Triangles => {
                if half_edge % 3 == 2 {
                    half_edge - 2
                } else {
                    half_edge + 1
                }
            }
            FaceLayout::Mixed { .. } => {
                let range = self.half_edges(self.face_of(half_edge));
                if half_edge + 1 == range.end { range.start } else { half_edge + 1 }
            }
        }
    }

    /// Returns the previous half-edge of the same face.
    #[inline]
    pub fn previous(&self, half_edge: u32) -> u32 {
        match &self.faces {
            FaceLayout::Quads => (half_edge & !3) | (half_edge.wrapping_sub(1) & 3),
            FaceLayout::Triangles => {
                if half_edge.is_multiple_of(3) {
                    half_edge + 2
                } else {
                    half_edge - 1
                }
            }
            FaceLayout::Mixed { .. } => {
                let range = self.half_edges(self.face_of(half_edge));
                if half_edge == range.start { range.end - 1 } else { half_edge - 1 }
            }
        }
    }

    /// Returns the vertex at which a half-edge starts.
    #[inline]
    pub fn vertex(&self, half_edge: u32) -> u32 {
        self.vertices[half_edge as usize]
    }

    /// Returns the edge of a half-edge.
    #[inline]
    pub fn edge(&self, half_edge: u32) -> u32 {
        self.edge_of[half_edge as usize]
    }

    /// Returns the one or two half-edges of edge `e`; the first runs in the edge's direction, the second may be
    /// [`NONE`].
    #[inline]
    pub fn halves(&self, e: usize) -> [u32; 2] {
        self.halves[e]
    }

    /// Returns the two ends of edge `e`, in its direction.
    #[inline]
    pub fn ends(&self, e: usize) -> [u32; 2] {
        let half_edge = self.halves[e][0];
        [self.vertex(half_edge), self.vertex(self.next(half_edge))]
    }

    /// Returns the end of edge `e` other than `v`.
    #[inline]
    pub fn other_end(&self, e: usize, v: usize) -> u32 {
        let [from, to] = self.ends(e);
        if from as usize == v { to } else { from }
    }

    /// Returns whether edge `e` has only one face.
    #[inline]
    pub fn is_boundary_edge(&self, e: usize) -> bool {
        self.halves[e][1] == NONE
    }

    /// Returns the opposite half-edge on the same edge, or [`NONE`] on the boundary.
    #[inline]
    pub fn twin(&self, half_edge: u32) -> u32 {
        let [first, second] = self.halves[self.edge(half_edge) as usize];
        if first == half_edge { second } else { first }
    }

    /// Returns the half-edges that leave vertex `v`, counter-clockwise; on the boundary from boundary edge to boundary
    /// edge.
    #[inline]
    pub fn ring(&self, v: usize) -> Ring<'_> {
        Ring::from(self, self.ring_start(v))
    }

    /// Returns the half-edge with which the [`ring`](Self::ring) of vertex `v` begins, or [`NONE`] if it has no face.
    #[inline]
    pub fn ring_start(&self, v: usize) -> u32 {
        self.outgoing[v]
    }

    /// Returns whether vertex `v` has no face.
    #[inline]
    pub fn is_isolated(&self, v: usize) -> bool {
        self.outgoing[v] == NONE
    }

    /// Returns the two boundary edges at vertex `v` (outgoing, incoming), if it lies on the boundary.
    pub fn boundary_edges(&self, v: usize) -> Option<[u32; 2]> {
        let start = self.outgoing[v];
        if start == NONE || self.twin(start) != NONE {
            return None;
        }
        let last = self.ring(v).last().expect("a vertex with a half-edge has a ring");
        Some([self.edge(start), self.edge(self.previous(last))])
    }

    /// Returns a half-edge between two vertices, if there is one: the one from the first to the second, if it exists.
    pub fn between(&self, [a, b]: [u32; 2]) -> Option<u32> {
        let towards = |a: u32, b: u32| self.ring(a as usize).find(|&half_edge| self.vertex(self.next(half_edge)) == b);
        towards(a, b).or_else(|| towards(b, a))
    }

    /// Returns the edges at a vertex, counter-clockwise; on the boundary from boundary edge to boundary edge.
    pub fn edges_at(&self, v: usize) -> impl Iterator<Item = u32> {
        self.ring(v).flat_map(|half_edge| {
            let before = self.previous(half_edge);
            let last = (self.twin(before) == NONE).then(|| self.edge(before));
            std::iter::once(self.edge(half_edge)).chain(last)
        })
    }

    /// Returns the valence of vertex `v`, the number of its edges.
    pub fn valence(&self, v: usize) -> usize {
        self.ring(v).count() + usize::from(self.boundary_edges(v).is_some())
    }

    /// Returns for each face whether it lies within `rings` rings of the `reached` vertices, and marks the vertices of
    /// these faces as reached, too.
    pub fn faces_within(&self, rings: usize, reached: &mut [bool]) -> Vec<bool> {
        let mut found = vec![false; self.n_faces()];
        let mut front: Vec<usize> = (0..reached.len()).filter(|&v| reached[v]).collect();
        for _ in 0..rings {
            let mut next = Vec::new();
            for f in front.iter().flat_map(|&v| self.ring(v)).map(|half_edge| self.face_of(half_edge)) {
                if !mem::replace(&mut found[f], true) {
                    let vertices = self.face(f).iter().map(|&v| v as usize);
                    next.extend(vertices.filter(|&v| !mem::replace(&mut reached[v], true)));
                }
            }
            front = next;
        }
        found
    }

    /// Returns the number of boundary edges, which is also the number of boundary vertices.
    pub fn n_boundary(&self) -> usize {
        let is_boundary = |half_edges: &&[u32; 2]| half_edges[1] == NONE;
        if is_small(self.n_edges()) {
            return self.halves.iter().filter(is_boundary).count();
        }
        self.halves.par_iter().filter(is_boundary).count()
    }

    /// Returns the boundary loops as lists of vertices with the mesh on the left, each from the loop's lowest edge.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.n_edges()];
        let mut loops = Vec::new();
        for e in 0..self.n_edges() {
            if seen[e] || !self.is_boundary_edge(e) {
                continue;
            }
            let mut vertices = Vec::new();
            let mut at = e;
            while !seen[at] {
                seen[at] = true;
                let [from, to] = self.ends(at);
                vertices.push(from);
                let onward = self.boundary_edges(to as usize).expect("a boundary edge ends on the boundary");
                at = onward[0] as usize;
            }
            loops.push(vertices);
        }
        loops
    }
}

/// Iterator over the outgoing half-edges of a vertex.
#[derive(Debug, Clone)]
pub struct Ring<'a> {
    topology: &'a Topology,
    start: u32,
    at: u32,
}

impl<'a> Ring<'a> {
    /// Creates the ring that starts at an outgoing half-edge.
    pub(super) fn from(topology: &'a Topology, start: u32) -> Self {
        Self { topology, start, at: start }
    }
}

impl Iterator for Ring<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.at == NONE {
            return None;
        }
        let half_edge = self.at;
        let onward = self.topology.twin(self.topology.previous(half_edge));
        self.at = if onward == self.start { NONE } else { onward };
        Some(half_edge)
    }
}
