//! Topology: which vertices, edges and faces meet, as flat arrays that are never edited. No coordinates.
//!
//! A *corner* is a place where a face has a vertex; it also stands for the half-edge from this vertex to the next one of
//! the face. Corners are numbered face after face.

use rayon::prelude::*;

/// "There is none": the missing second corner of a boundary edge, the missing corner of an isolated vertex.
pub const NONE: u32 = u32::MAX;

/// Connectivity of an oriented 2-manifold with boundary; every vertex has at most one fan of faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    pub(super) n_vertices: usize,
    pub(super) faces: Faces,
    /// Vertex at each corner.
    pub(super) vertices: Vec<u32>,
    /// Edge from each corner to the next of its face.
    pub(super) corner_edge: Vec<u32>,
    /// The corners whose half-edges lie on each edge; the first runs in the edge's direction, the second may be [`NONE`].
    pub(super) edge_corners: Vec<[u32; 2]>,
    /// The first outgoing corner of each vertex in counter-clockwise order (on the boundary the one whose edge is a
    /// boundary edge), or [`NONE`].
    pub(super) vertex_corner: Vec<u32>,
}

/// Where each face's corners are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Faces {
    /// Face `f` has the corners `4 f .. 4 f + 4`.
    Quads,
    /// Face `f` has the corners `3 f .. 3 f + 3`.
    Triangles,
    /// Face `f` has the corners `starts[f] .. starts[f + 1]`; `owner` is the face of each corner.
    Mixed { starts: Vec<u32>, owner: Vec<u32> },
}

/// Number as an index; nets have fewer than 2^32 corners by the limits that admit them.
#[expect(clippy::cast_possible_truncation, reason = "the limits keep every count below 2^32")]
pub(crate) const fn index(n: usize) -> u32 {
    n as u32
}

impl Topology {
    /// Number of vertices, isolated ones included.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// Number of edges.
    pub fn n_edges(&self) -> usize {
        self.edge_corners.len()
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        match &self.faces {
            Faces::Quads => self.vertices.len() / 4,
            Faces::Triangles => self.vertices.len() / 3,
            Faces::Mixed { starts, .. } => starts.len() - 1,
        }
    }

    /// Number of corners: the sum of the sizes of all faces.
    pub fn n_corners(&self) -> usize {
        self.vertices.len()
    }

    /// Whether every face has four vertices.
    pub fn is_quads(&self) -> bool {
        match &self.faces {
            Faces::Quads => true,
            Faces::Triangles => false,
            Faces::Mixed { starts, .. } => starts.windows(2).all(|pair| pair[1] - pair[0] == 4),
        }
    }

    /// The first face that is no triangle, if there is one.
    pub fn first_other_than_triangle(&self) -> Option<usize> {
        match &self.faces {
            Faces::Triangles => None,
            _ => (0..self.n_faces()).find(|&f| self.face(f).len() != 3),
        }
    }

    /// The corners of face `f`.
    #[inline]
    pub fn corners(&self, f: usize) -> std::ops::Range<u32> {
        match &self.faces {
            Faces::Quads => index(4 * f)..index(4 * f + 4),
            Faces::Triangles => index(3 * f)..index(3 * f + 3),
            Faces::Mixed { starts, .. } => starts[f]..starts[f + 1],
        }
    }

    /// The vertices of face `f`, counter-clockwise.
    #[inline]
    pub fn face(&self, f: usize) -> &[u32] {
        let corners = self.corners(f);
        &self.vertices[corners.start as usize..corners.end as usize]
    }

    /// The face of a corner.
    #[inline]
    pub fn face_of(&self, corner: u32) -> usize {
        match &self.faces {
            Faces::Quads => corner as usize / 4,
            Faces::Triangles => corner as usize / 3,
            Faces::Mixed { owner, .. } => owner[corner as usize] as usize,
        }
    }

    /// The next corner of the same face.
    #[inline]
    pub fn next(&self, corner: u32) -> u32 {
        match &self.faces {
            Faces::Quads => (corner & !3) | ((corner + 1) & 3),
            Faces::Triangles => {
                if corner % 3 == 2 {
                    corner - 2
                } else {
                    corner + 1
                }
            }
            Faces::Mixed { .. } => {
                let range = self.corners(self.face_of(corner));
                if corner + 1 == range.end { range.start } else { corner + 1 }
            }
        }
    }

    /// The previous corner of the same face.
    #[inline]
    pub fn previous(&self, corner: u32) -> u32 {
        match &self.faces {
            Faces::Quads => (corner & !3) | (corner.wrapping_sub(1) & 3),
            Faces::Triangles => {
                if corner.is_multiple_of(3) {
                    corner + 2
                } else {
                    corner - 1
                }
            }
            Faces::Mixed { .. } => {
                let range = self.corners(self.face_of(corner));
                if corner == range.start { range.end - 1 } else { corner - 1 }
            }
        }
    }

    /// The vertex at a corner.
    #[inline]
    pub fn vertex(&self, corner: u32) -> u32 {
        self.vertices[corner as usize]
    }

    /// The edge from a corner to the next of its face.
    #[inline]
    pub fn edge(&self, corner: u32) -> u32 {
        self.corner_edge[corner as usize]
    }

    /// The one or two corners on edge `e`; the first runs in the edge's direction.
    #[inline]
    pub fn edge_corners(&self, e: usize) -> [u32; 2] {
        self.edge_corners[e]
    }

    /// The two ends of edge `e`, in its direction.
    #[inline]
    pub fn ends(&self, e: usize) -> [u32; 2] {
        let corner = self.edge_corners[e][0];
        [self.vertex(corner), self.vertex(self.next(corner))]
    }

    /// The end of edge `e` that is not its end `v`.
    #[inline]
    pub fn other_end(&self, e: usize, v: usize) -> u32 {
        let [from, to] = self.ends(e);
        if from as usize == v { to } else { from }
    }

    /// Whether edge `e` has one face only.
    #[inline]
    pub fn is_boundary_edge(&self, e: usize) -> bool {
        self.edge_corners[e][1] == NONE
    }

    /// The corner on the other side of a corner's edge, or [`NONE`].
    #[inline]
    pub fn twin(&self, corner: u32) -> u32 {
        let [first, second] = self.edge_corners[self.edge(corner) as usize];
        if first == corner { second } else { first }
    }

    /// Outgoing corners of vertex `v`, counter-clockwise; on the boundary from boundary to boundary.
    #[inline]
    pub fn ring(&self, v: usize) -> Ring<'_> {
        let start = self.vertex_corner[v];
        Ring::from(self, start)
    }

    /// Whether no face has vertex `v`.
    #[inline]
    pub fn is_isolated(&self, v: usize) -> bool {
        self.vertex_corner[v] == NONE
    }

    /// The two boundary edges at vertex `v` (outgoing, incoming), if it lies on the boundary.
    pub fn boundary_edges(&self, v: usize) -> Option<[u32; 2]> {
        let start = self.vertex_corner[v];
        if start == NONE || self.twin(start) != NONE {
            return None;
        }
        let last = self.ring(v).last().expect("a vertex with a corner has a ring");
        Some([self.edge(start), self.edge(self.previous(last))])
    }

    /// Number of edges at vertex `v`.
    pub fn valence(&self, v: usize) -> usize {
        self.ring(v).count() + usize::from(self.boundary_edges(v).is_some())
    }

    /// Number of boundary edges, which is also the number of boundary vertices.
    pub fn n_boundary(&self) -> usize {
        self.edge_corners.par_iter().filter(|corners| corners[1] == NONE).count()
    }

    /// The boundary loops, each as its vertices with the mesh on the left, starting at the loop's lowest edge.
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

/// Iterator over the outgoing corners of a vertex.
#[derive(Debug, Clone)]
pub struct Ring<'a> {
    topology: &'a Topology,
    start: u32,
    at: u32,
}

impl<'a> Ring<'a> {
    /// The ring that starts at an outgoing corner.
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
        let corner = self.at;
        let onward = self.topology.twin(self.topology.previous(corner));
        self.at = if onward == self.start { NONE } else { onward };
        Some(corner)
    }
}
