//! The edges of all levels of a refinement and their halves, which neighbouring faces of different levels share.

use crate::shape::topology::{NONE, Topology, index};

/// An edge of some level. Vertices and edges have indices that are valid on all levels.
#[derive(Debug, Clone, Copy)]
struct LevelEdge {
    /// The vertices at its ends.
    ends: [u32; 2],
    /// Its midpoint on the next level, or [`NONE`]; the half at the first end is edge `half`, the other one `half + 1`.
    middle: u32,
    half: u32,
    /// Whether a face of the surface at the edge was split, so that the halves replace it.
    is_split: bool,
    is_sharp: bool,
}

/// The edges of a refinement, and its number of vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct Edges {
    all: Vec<LevelEdge>,
    n_vertices: u32,
}

/// A piece of the side of a face: an edge that no face of the surface splits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SidePiece {
    /// The edge.
    pub(super) edge: u32,
    /// The vertices at its ends, in the direction of the side.
    pub(super) ends: [u32; 2],
    /// The parameters of the side at these ends.
    pub(super) range: [f64; 2],
}

impl Edges {
    /// Creates the edges of a topology, with the same indices.
    pub(super) fn of(topology: &Topology) -> Self {
        let mut edges = Self { all: Vec::with_capacity(topology.n_edges()), n_vertices: index(topology.n_vertices()) };
        (0..topology.n_edges()).for_each(|e| {
            edges.add(topology.ends(e));
        });
        edges
    }

    /// Adds an edge and returns its index.
    pub(super) fn add(&mut self, ends: [u32; 2]) -> u32 {
        self.all.push(LevelEdge { ends, middle: NONE, half: NONE, is_split: false, is_sharp: false });
        index(self.all.len() - 1)
    }

    /// Adds a vertex and returns its index.
    pub(super) fn add_vertex(&mut self) -> u32 {
        self.n_vertices += 1;
        self.n_vertices - 1
    }

    /// Number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.n_vertices as usize
    }

    /// Number of edges.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Halves an edge; returns its midpoint and its halves, starting with the one at its end `from`.
    pub(super) fn halve(&mut self, edge: u32, from: u32) -> (u32, [u32; 2]) {
        let [a, b] = self.all[edge as usize].ends;
        if self.all[edge as usize].middle == NONE {
            let middle = self.add_vertex();
            let half = self.add([a, middle]);
            self.add([middle, b]);
            (self.all[edge as usize].middle, self.all[edge as usize].half) = (middle, half);
        }
        let LevelEdge { middle, half, .. } = self.all[edge as usize];
        (middle, if from == a { [half, half + 1] } else { [half + 1, half] })
    }

    /// Marks an edge of a face of the surface that is split.
    pub(super) fn split(&mut self, edge: u32) {
        self.all[edge as usize].is_split = true;
    }

    /// Marks an edge as infinitely sharp.
    pub(super) fn sharpen(&mut self, edge: u32) {
        self.all[edge as usize].is_sharp = true;
    }

    /// Returns whether an edge was marked as infinitely sharp.
    pub(super) fn is_sharp(&self, edge: u32) -> bool {
        self.all[edge as usize].is_sharp
    }

    /// Appends the pieces of a side that is this edge, starting at its end `from`; the range holds the side's
    /// parameters there.
    pub(super) fn steps(&self, edge: u32, from: u32, [s, e]: [f64; 2], out: &mut Vec<SidePiece>) {
        let LevelEdge { ends: [a, b], middle, half, is_split, .. } = self.all[edge as usize];
        let to = if from == a { b } else { a };
        if !is_split {
            return out.push(SidePiece { edge, ends: [from, to], range: [s, e] });
        }
        let [near, far] = if from == a { [half, half + 1] } else { [half + 1, half] };
        let m = 0.5 * (s + e);
        self.steps(near, from, [s, m], out);
        self.steps(far, middle, [m, e], out);
    }
}
