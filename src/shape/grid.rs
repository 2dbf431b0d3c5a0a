//! The documented order of a mesh that was split into quads: base vertices, then the points on base edges, then those
//! inside base faces, each base face a grid. Independent of the order in which the splits were carried out.
//!
//! With `n` pieces per edge, the product over all splits (even if some face is not a quad): an edge has `n - 1` inner
//! points in the direction of its first appearance; a quad has `(n-1) x (n-1)`, row by row (origin at corner 0, first
//! axis towards corner 1); any other face has its centre, then each spoke from the midpoint of edge 0, 1, ... to the
//! centre, then the inside of the quad at corner 0, 1, ..., row by row. Faces are ordered by base face, row by row.

mod constructed;

use std::sync::Arc;

use super::line::{VertexLine, lines_across, quads};
use super::origin::Origin;
use super::tile::Tile;
use super::topology::{Topology, index};

/// The order of one split mesh.
#[derive(Debug, Clone)]
pub struct QuadGrid {
    base: Arc<Topology>,
    /// The topology before the last split.
    parent: Arc<Topology>,
    /// Number of pieces per edge at each split.
    pieces: Arc<[u32]>,
    /// Number of pieces of a base edge.
    n: usize,
    /// Whether all splits have arity 2.
    is_binary: bool,
    /// Whether all base faces are quads.
    is_quads: bool,
    /// For each base face the number of inner vertices of those before it; empty if all base faces are quads, which
    /// have equally many.
    inner: Vec<u32>,
}

impl QuadGrid {
    /// Returns the order of `base` after splits with `pieces` pieces per edge; `parent` is the topology before the last
    /// split. If some base face is not a quad, the first split has 2 pieces per edge.
    ///
    /// With no split, which a base of quads may have, the order is that of the base.
    pub fn new(base: Arc<Topology>, parent: Arc<Topology>, pieces: Arc<[u32]>) -> Self {
        let n = pieces.iter().map(|&d| d as usize).product();
        let (is_binary, is_quads) = (pieces.iter().all(|&d| d == 2), base.is_quads());
        let counted = 0..if is_quads { 0 } else { base.n_faces() };
        let sizes = counted.map(|f| inner_vertices(base.face(f).len(), n));
        let inner = sizes.scan(0, |sum, size| Some(std::mem::replace(sum, *sum + index(size)))).collect();
        Self { base, parent, pieces, n, is_binary, is_quads, inner }
    }

    /// Returns the order of another base with the same faces after the same splits.
    #[must_use]
    pub(super) fn over(&self, base: &Arc<Topology>) -> Self {
        Self::new(base.clone(), base.clone(), self.pieces.clone())
    }

    /// Number of pieces of a base edge.
    pub fn pieces(&self) -> usize {
        self.n
    }

    /// Number of pieces of half an edge; meaningful where a base face is not a quad.
    fn half(&self) -> usize {
        self.n / 2
    }

    fn splits(&self) -> usize {
        self.pieces.len()
    }

    /// Returns the number of faces in base faces with `corners` corners in all: a quarter of a grid per corner.
    fn faces_of(&self, corners: usize) -> usize {
        corners * self.n * self.n / 4
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        let last = self.base.n_faces().checked_sub(1);
        self.first_inner() + last.map_or(0, |last| self.inner_before(last) + self.inner_of(last))
    }

    /// Number of faces, all of them quads.
    pub fn n_faces(&self) -> usize {
        self.faces_of(self.base.n_half_edges())
    }

    /// First inner vertex of all faces.
    pub(crate) fn first_inner(&self) -> usize {
        self.base.n_vertices() + self.base.n_edges() * (self.n - 1)
    }

    /// The vertices of face `f`, numbered in the documented order.
    pub fn face(&self, f: usize) -> [u32; 4] {
        let half = self.half();
        let base_face = self.base_face(f);
        let local = f - self.first_face(base_face);
        let around = [(0, 0), (1, 0), (1, 1), (0, 1)];
        if self.base.face(base_face).len() == 4 {
            let (i, j) = (local % self.n, local / self.n);
            around.map(|(di, dj)| self.quad_vertex(base_face, i + di, j + dj))
        } else {
            let part = local / (half * half);
            let (i, j) = (local % half, local / half % half);
            around.map(|(di, dj)| self.part_vertex(base_face, part, i + di, j + dj))
        }
    }

    /// Writes the vertices of consecutive faces from face `f` on, as many as `out` holds.
    pub fn faces(&self, mut f: usize, mut out: &mut [[u32; 4]]) {
        while !out.is_empty() {
            let base_face = self.base_face(f);
            let local = f - self.first_face(base_face);
            let is_quad = self.base.face(base_face).len() == 4;
            let n = if is_quad { self.n } else { self.half() };
            let (part, local) = if is_quad { (0, local) } else { (local / (n * n), local % (n * n)) };
            let patch;
            (patch, out) = out.split_at_mut((n * n - local).min(out.len()));
            f += patch.len();
            if is_quad {
                quads(n, local, patch, self.lines(base_face));
            } else {
                let sides = [0, 1, 2, 3].map(|side| {
                    VertexLine::new(n, |at| {
                        let [i, j] = Tile::Quad.along(n, side, at);
                        self.part_vertex(base_face, part, i, j)
                    })
                });
                quads(n, local, patch, lines_across(&sides, self.first_inside_part(base_face, part) as usize));
            }
        }
    }

    /// Returns the lines of vertices across a base face that is a quad, by their distance from its first side.
    pub(crate) fn lines(&self, f: usize) -> impl Fn(usize) -> VertexLine {
        let first = self.base.half_edges(f).start;
        let sides = [self.side(first), self.side(first + 1), self.side(first + 2), self.side(first + 3)];
        let inner = self.first_inner() + self.inner_before(f);
        move |j| lines_across(&sides, inner)(j)
    }

    /// Returns whether all base faces are quads.
    pub(crate) fn is_quads(&self) -> bool {
        self.is_quads
    }

    /// Returns the base face that contains face `f`.
    pub fn base_face(&self, f: usize) -> usize {
        self.base.face_of(index(4 * f / (self.n * self.n)))
    }

    /// Returns the base cell in which vertex `v`, indexed in the documented order, arose.
    pub fn origin(&self, v: usize) -> Origin {
        let on_edges = self.base.n_vertices();
        if v < on_edges {
            return Origin { dimension: 0, cell: index(v) };
        }
        if v < self.first_inner() {
            return Origin { dimension: 1, cell: index((v - on_edges) / (self.n - 1)) };
        }
        Origin { dimension: 2, cell: index(self.face_around(v)) }
    }

    /// Returns the first face of base face `f`.
    pub fn first_face(&self, f: usize) -> usize {
        self.faces_of(self.base.half_edges(f).start as usize)
    }

    /// Returns the vertices on the side that starts at `corner`.
    fn side(&self, corner: u32) -> VertexLine {
        let (n, ends) = (self.n, [corner, self.base.next(corner)].map(|corner| self.base.vertex(corner)));
        let (edge, between) = (self.base.edge(corner) as usize, n - 1);
        let first = index(self.base.n_vertices() + edge * between);
        if self.base.halves(edge)[0] == corner {
            VertexLine::between_ends(n, ends, first, 1)
        } else {
            VertexLine::between_ends(n, ends, first.wrapping_add(index(n)).wrapping_sub(2), 1_u32.wrapping_neg())
        }
    }

    /// Returns point `at` (0 to n) on the side that starts at `corner`, counted from the corner.
    fn on_side(&self, corner: u32, at: usize) -> u32 {
        let n = self.n;
        if at == 0 {
            return self.base.vertex(corner);
        }
        if at == n {
            return self.base.vertex(self.base.next(corner));
        }
        let edge = self.base.edge(corner) as usize;
        let forward = self.base.halves(edge)[0] == corner;
        let at = if forward { at } else { n - at };
        index(self.base.n_vertices() + edge * (n - 1) + at - 1)
    }

    /// Number of points inside base face `f`.
    pub fn inner_of(&self, f: usize) -> usize {
        inner_vertices(self.base.face(f).len(), self.n)
    }

    /// Returns the number of points inside the base faces before `f`.
    fn inner_before(&self, f: usize) -> usize {
        if self.is_quads { f * inner_vertices(4, self.n) } else { self.inner[f] as usize }
    }

    fn inner_vertex(&self, f: usize, place: usize) -> u32 {
        index(self.first_inner() + self.inner_before(f) + place)
    }

    fn quad_vertex(&self, f: usize, i: usize, j: usize) -> u32 {
        let n = self.n;
        let first = self.base.half_edges(f).start;
        match (i, j) {
            (_, 0) => self.on_side(first, i),
            (_, j) if i == n => self.on_side(first + 1, j),
            (i, _) if j == n => self.on_side(first + 2, n - i),
            (0, _) => self.on_side(first + 3, n - j),
            _ => self.inner_vertex(f, (j - 1) * (n - 1) + i - 1),
        }
    }

    fn part_vertex(&self, f: usize, part: usize, i: usize, j: usize) -> u32 {
        let half = self.half();
        let size = self.base.face(f).len();
        let first = self.base.half_edges(f).start;
        let before = (part + size - 1) % size;
        match (i, j) {
            (_, 0) => self.on_side(first + index(part), i),
            (0, _) => self.on_side(first + index(before), self.n - j),
            (i, j) if i == half && j == half => self.inner_vertex(f, 0),
            (i, _) if i == half => self.inner_vertex(f, 1 + part * (half - 1) + j - 1),
            (_, j) if j == half => self.inner_vertex(f, 1 + before * (half - 1) + i - 1),
            _ => self.first_inside_part(f, part) + index((j - 1) * (half - 1) + i - 1),
        }
    }

    /// Returns the first vertex inside the quad at a corner of a face that is not a quad, after its centre and spokes
    /// and the insides of the quads before.
    fn first_inside_part(&self, f: usize, part: usize) -> u32 {
        let between = self.half() - 1;
        self.inner_vertex(f, 1 + self.base.face(f).len() * between + part * between * between)
    }

    /// Returns the vertex at `[i, j]` of a patch, each from 0 to the pieces of its side. A patch is a base face if all
    /// base faces are quads, else a face of the base's first split.
    #[inline]
    pub fn patch_vertex(&self, patch: usize, [i, j]: [usize; 2]) -> u32 {
        if self.is_quads {
            return self.quad_vertex(patch, i, j);
        }
        let f = self.base.face_of(index(patch));
        let part = patch - self.base.half_edges(f).start as usize;
        if self.base.face(f).len() == 4 {
            self.quad_vertex(f, i + part % 2 * self.half(), j + part / 2 * self.half())
        } else {
            self.part_vertex(f, part, i, j)
        }
    }

    /// The base face inside which vertex `v` lies.
    fn face_around(&self, v: usize) -> usize {
        let inner = v - self.first_inner();
        if self.is_quads {
            // with one piece an edge there are no inner vertices, and this is not called
            return inner / inner_vertices(4, self.n).max(1);
        }
        self.inner.partition_point(|&before| before as usize <= inner) - 1
    }
}

fn inner_vertices(size: usize, n: usize) -> usize {
    let half = n / 2;
    if size == 4 { (n - 1) * (n - 1) } else { 1 + size * (half - 1) + size * (half - 1) * (half - 1) }
}
