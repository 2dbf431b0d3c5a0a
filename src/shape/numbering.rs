//! The indices of a part's vertices, edges and faces in the whole net, level after level.

use super::split::ROW_BY_ROW;
use super::topology::Topology;

/// The indices that the vertices, edges and faces of a part of a net have in the whole net, modulo 2^64.
///
/// Perturbations are seeded by these indices. After an upsampling of arity 2 they follow in closed form, as in
/// [`Topology::split`]: with `V`, `E`, `F`, `C` the numbers of vertices, edges, faces and corners of the whole net,
/// vertex v remains v, edge e makes vertex `V + e` and the edges `2 e`, `2 e + 1` in its direction, face f makes vertex
/// `V + E + f`, and corner c makes edge `2 E + c` and a face. So a part can be followed through levels at which the
/// whole net would be too large; beyond 64 bits the indices wrap around.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    whole: CellCounts,
    vertices: Vec<u64>,
    faces: Vec<NumberedFace>,
    /// For each half-edge its edge in the whole net.
    sides: Vec<OrientedEdge>,
}

/// Numbers of cells of the whole net.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct CellCounts {
    vertices: u64,
    edges: u64,
    faces: u64,
    corners: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NumberedFace {
    number: u64,
    /// The index of the face's first half-edge in the whole net.
    start: u64,
    /// The position in the whole net's face of the half-edge that is the first one here.
    offset: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct OrientedEdge {
    edge: u64,
    /// Whether the side runs in the direction that the edge has in the whole net.
    forward: bool,
}

impl Numbering {
    /// Returns the numbering of a whole net.
    pub fn of(topology: &Topology) -> Self {
        let whole = CellCounts {
            vertices: topology.n_vertices() as u64,
            edges: topology.n_edges() as u64,
            faces: topology.n_faces() as u64,
            corners: topology.n_half_edges() as u64,
        };
        let faces = 0..topology.n_faces();
        let sides = faces.clone().flat_map(|f| topology.half_edges(f)).map(|half_edge| {
            let edge = topology.edge(half_edge);
            OrientedEdge { edge: edge.into(), forward: topology.halves(edge as usize)[0] == half_edge }
        });
        let sides = sides.collect();
        let face = |f: usize| NumberedFace { number: f as u64, start: topology.half_edges(f).start.into(), offset: 0 };
        Self { whole, vertices: (0..whole.vertices).collect(), faces: faces.map(face).collect(), sides }
    }

    /// Returns the index of vertex `v` in the whole net.
    pub fn vertex(&self, v: usize) -> u64 {
        self.vertices[v]
    }

    /// Returns the index in the whole net of edge `e` of the part, whose topology is given.
    pub fn edge(&self, topology: &Topology, e: usize) -> u64 {
        self.sides[topology.halves(e)[0] as usize].edge
    }

    /// Returns the index of face `f` in the whole net.
    pub fn face(&self, f: usize) -> u64 {
        self.faces[f].number
    }

    /// Returns the numbering of a part of this net, whose topology is given: of the given vertices, and of the faces
    /// that start at the given half-edges.
    #[must_use]
    pub fn of_submesh(&self, topology: &Topology, vertices: &[u32], corners: &[u32]) -> Self {
        let mut part = Self {
            whole: self.whole,
            vertices: Vec::new(),
            faces: Vec::with_capacity(corners.len()),
            sides: Vec::with_capacity(4 * corners.len()),
        };
        for &first in corners {
            let f = topology.face_of(first);
            let range = topology.half_edges(f);
            let face = self.faces[f];
            let offset = (face.offset + first - range.start) % (range.end - range.start);
            part.faces.push(NumberedFace { offset, ..face });
            let mut half_edge = first;
            for _ in range {
                part.sides.push(self.sides[half_edge as usize]);
                half_edge = topology.next(half_edge);
            }
        }
        part.with_vertices(self, vertices)
    }

    /// Replaces the vertices by the given vertices of `of`.
    fn with_vertices(self, of: &Self, vertices: &[u32]) -> Self {
        Self { vertices: vertices.iter().map(|&v| of.vertices[v as usize]).collect(), ..self }
    }

    /// Returns the numbering of a net with the same faces whose vertices are the given vertices of the part.
    #[must_use]
    pub fn with_origins(&self, origins: &[u32]) -> Self {
        self.clone().with_vertices(self, origins)
    }

    /// Returns the numbering after an upsampling of arity 2; `topology` is that of the part before it.
    #[must_use]
    pub fn split(&self, topology: &Topology) -> Self {
        let whole = self.whole;
        let on_edges = whole.vertices;
        let on_faces = on_edges.wrapping_add(whole.edges);
        let spokes = whole.edges.wrapping_mul(2);
        let edges = (0..topology.n_edges()).map(|e| on_edges.wrapping_add(self.edge(topology, e)));
        let middles = self.faces.iter().map(|face| on_faces.wrapping_add(face.number));
        let vertices = self.vertices.iter().copied().chain(edges).chain(middles).collect();
        let n = topology.n_half_edges();
        let mut split = Self {
            whole: CellCounts {
                vertices: on_faces.wrapping_add(whole.faces),
                edges: spokes.wrapping_add(whole.corners),
                faces: whole.corners,
                corners: whole.corners.wrapping_mul(4),
            },
            vertices,
            faces: Vec::with_capacity(n),
            sides: Vec::with_capacity(4 * n),
        };
        for f in 0..topology.n_faces() {
            for child in topology.half_edges(f) {
                let half_edge = topology.parent_half_edge(child);
                let before = topology.previous(half_edge);
                let [along, back] = [half_edge, before].map(|half_edge| self.sides[half_edge as usize]);
                let [here, there] = [half_edge, before].map(|half_edge| self.corner(topology, f, half_edge));
                let half = |side: OrientedEdge, second: bool| {
                    let number = side.edge.wrapping_mul(2).wrapping_add(u64::from(second == side.forward));
                    OrientedEdge { edge: number, forward: side.forward }
                };
                let spoke = |(start, j): (u64, u32), forward| OrientedEdge {
                    edge: spokes.wrapping_add(start.wrapping_add(j.into())),
                    forward,
                };
                let sides = [half(along, false), spoke(here, true), spoke(there, false), half(back, true)];
                let is_quad = topology.half_edges(f).len() == 4;
                // the child quads of a quad keep its orientation, those of other faces start at their vertex
                let first = if is_quad { half_edge - topology.half_edges(f).start } else { 0 };
                split.sides.extend((0..4).map(|at| sides[((at + 4 - first) % 4) as usize]));
                let (start, j) = here;
                let (place, offset) = if is_quad { (ROW_BY_ROW[j as usize], (j + 4 - first) % 4) } else { (j, 0) };
                let number = start.wrapping_add(place.into());
                split.faces.push(NumberedFace { number, start: number.wrapping_mul(4), offset });
            }
        }
        split
    }

    /// Returns a corner of face `f` in the whole net: the first half-edge of the face, and the offset from it.
    fn corner(&self, topology: &Topology, f: usize, half_edge: u32) -> (u64, u32) {
        let (face, range) = (self.faces[f], topology.half_edges(f));
        (face.start, (half_edge - range.start + face.offset) % (range.end - range.start))
    }
}
