//! The documented order of a triangle mesh that was split: base vertices, then the points on base edges, then those
//! inside base faces, row by row. Independent of the order in which the splits were carried out.
//!
//! With `n` pieces per edge: an edge has `n - 1` inner points in the direction of its first appearance; a triangle has
//! `(n-1)(n-2)/2`, row by row (origin at corner 0, first axis towards corner 1). Faces are ordered by base face, then
//! row by row; upward and downward triangles of a row alternate from left to right. The upward triangle at `(i, j)` has
//! the vertices `(i, j)`, `(i + 1, j)`, `(i, j + 1)`; the downward one next to it has `(i + 1, j + 1)`, `(i, j + 1)`,
//! `(i + 1, j)`.

use std::sync::Arc;

use super::line::{VertexLine, lines_across_triangle, triangles};
use super::origin::Origin;
use super::tile::Tile;
use super::tiling::{Ancestor, Tiling};
use super::topology::{Topology, index};

/// The order of one split triangle mesh.
#[derive(Debug, Clone)]
pub struct TriangleGrid {
    base: Arc<Topology>,
    /// The topology before the last split.
    parent: Arc<Topology>,
    /// Number of pieces per edge at each split.
    pieces: Arc<[u32]>,
    /// Number of pieces of a base edge.
    n: usize,
}

impl TriangleGrid {
    /// Returns the order of `base` after splits with `pieces` pieces per edge; `parent` is the topology before the
    /// last split.
    ///
    /// # Panics
    /// If there is no split: then the order is that of the base.
    pub fn new(base: Arc<Topology>, parent: Arc<Topology>, pieces: Arc<[u32]>) -> Self {
        assert!(!pieces.is_empty(), "an unsplit mesh is in its own order");
        let n = pieces.iter().map(|&d| d as usize).product();
        Self { base, parent, pieces, n }
    }

    /// Returns the order of another base with the same faces after the same splits.
    #[must_use]
    pub(super) fn over(&self, base: &Arc<Topology>) -> Self {
        Self::new(base.clone(), base.clone(), self.pieces.clone())
    }

    /// Returns the base split in one step, which numbers everything in the documented order.
    fn whole(&self) -> Tiling<'_> {
        Tiling::new(&self.base, Tile::Triangle, self.n)
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.whole().n_vertices()
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.whole().n_faces()
    }

    /// Returns the vertices of face `f`, indexed in the documented order.
    pub fn face(&self, f: usize) -> [u32; 3] {
        let [a, b, c, _] = self.whole().face(f);
        [a, b, c]
    }

    /// Fills `out` with the vertices of consecutive faces from face `f` on.
    pub fn faces(&self, mut f: usize, mut out: &mut [[u32; 3]]) {
        let (n, whole) = (self.n, self.whole());
        while !out.is_empty() {
            let (base_face, local) = (f / (n * n), f % (n * n));
            let patch;
            (patch, out) = out.split_at_mut((n * n - local).min(out.len()));
            f += patch.len();
            let side = |side| VertexLine::new(n, |at| whole.vertex(base_face, Tile::Triangle.along(n, side, at)));
            let (sides, inner) = ([0, 1, 2].map(side), whole.first_inside(base_face));
            triangles(n, Tile::Triangle.row(n, local), patch, lines_across_triangle(&sides, inner));
        }
    }

    /// Returns the base face that contains face `f`.
    pub fn base_face(&self, f: usize) -> usize {
        f / (self.n * self.n)
    }

    /// Returns the base cell in which vertex `v`, indexed in the documented order, arose.
    pub fn origin(&self, v: usize) -> Origin {
        let (dimension, cell) = match self.whole().ancestor(v) {
            Ancestor::Vertex(v) => (0, v),
            Ancestor::Edge(edge, _) => (1, edge),
            Ancestor::Face(face, _) => (2, face),
        };
        Origin { dimension, cell: index(cell) }
    }

    /// Returns the first face of base face `f`.
    pub fn first_face(&self, f: usize) -> usize {
        f * self.n * self.n
    }

    /// Returns the index of vertex `v` in the order of construction (see [`Tiling`]).
    pub fn constructed(&self, v: usize) -> u32 {
        let (face, place) = match self.whole().ancestor(v) {
            Ancestor::Vertex(v) => return index(v),
            Ancestor::Edge(edge, at) => self.whole().along(edge, at),
            Ancestor::Face(face, place) => (face, place),
        };
        let last = self.pieces[self.pieces.len() - 1] as usize;
        let (face, place) = descended(Tile::Triangle, &self.pieces, self.n, face, place);
        Tiling::new(&self.parent, Tile::Triangle, last).vertex(face, place)
    }
}

/// Follows a place of a face with `n` pieces per edge through all splits but the last one; returns the face before the
/// last split, and the place in it.
pub(super) fn descended(
    tile: Tile,
    pieces: &[u32],
    n: usize,
    mut face: usize,
    mut place: [usize; 2],
) -> (usize, [usize; 2]) {
    let mut step = n;
    for &d in &pieces[..pieces.len() - 1] {
        let d = d as usize;
        step /= d;
        let (cell, inside) = tile.enter(d, step, place);
        face = face * d * d + tile.number(d, cell);
        place = inside;
    }
    (face, place)
}
