//! The documented order of a mesh that was split into quads: base vertices, then the points on base edges, then those
//! inside base faces, each base face a grid. Independent of the order in which the splits were carried out.
//!
//! With `n` pieces per edge, the product over all splits (even if some face is not a quad): an edge has `n - 1` inner
//! points in the direction of its first appearance; a quad has `(n-1) x (n-1)`, row by row (origin at corner 0, first
//! axis towards corner 1); any other face has its centre, then each spoke from the midpoint of edge 0, 1, ... to the
//! centre, then the inside of the quad at corner 0, 1, ..., row by row. Faces are ordered by base face, row by row.

use std::ops::Range;
use std::sync::Arc;

use super::line::{VertexLine, lines_across, quads};
use super::source::Origin;
use super::tile::Tile;
use super::tiling::Tiling;
use super::topology::{Topology, index};
use super::triangle_grid::descended;

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
    /// For each base face the offset of its first inner vertex, from the first inner vertex of all faces.
    inner: Vec<u32>,
}

/// A position inside a base face.
#[derive(Debug, Clone, Copy)]
enum FacePosition {
    /// In a quad: `(i, j)`, `0 <= i, j <= n`.
    Quad(usize, usize),
    /// In the quad at one corner of another face: corner, `(i, j)`, `0 <= i, j <= n / 2`.
    Sector(usize, usize, usize),
    /// On the spoke from the midpoint of an edge (position 0) to the centre (position `n / 2`).
    Spoke(usize, usize),
    /// At the centre of a face that is not a quad.
    Centre,
}

impl QuadGrid {
    /// Returns the order of `base` after splits with `pieces` pieces per edge; `parent` is the topology before the last
    /// split. If some base face is not a quad, the first split has 2 pieces per edge.
    ///
    /// With no split, which a base of quads may have, the order is that of the base.
    pub fn new(base: Arc<Topology>, parent: Arc<Topology>, pieces: Arc<[u32]>) -> Self {
        let n = pieces.iter().map(|&d| d as usize).product();
        let sizes = (0..base.n_faces()).map(|f| inner_vertices(base.face(f).len(), n));
        let inner = sizes.scan(0, |sum, size| Some(std::mem::replace(sum, *sum + index(size)))).collect();
        let (is_binary, is_quads) = (pieces.iter().all(|&d| d == 2), base.is_quads());
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
        self.first_inner() + self.inner.last().map_or(0, |&last| last as usize + self.inner_of(self.inner.len() - 1))
    }

    /// Number of faces, all of them quads.
    pub fn n_faces(&self) -> usize {
        self.faces_of(self.base.n_half_edges())
    }

    /// First inner vertex of all faces.
    fn first_inner(&self) -> usize {
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
                let first = self.base.half_edges(base_face).start;
                let sides = [self.side(first), self.side(first + 1), self.side(first + 2), self.side(first + 3)];
                quads(n, local, patch, lines_across(&sides, self.first_inner() + self.inner[base_face] as usize));
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

    fn inner_vertex(&self, f: usize, place: usize) -> u32 {
        index(self.first_inner() + self.inner[f] as usize + place)
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

    /// Returns the index of vertex `v` in the order of construction (see [`Topology::split`]).
    pub fn constructed(&self, v: usize) -> u32 {
        let on_edges = self.base.n_vertices();
        if v < on_edges {
            return index(v);
        }
        if v < self.first_inner() {
            let (edge, at) = ((v - on_edges) / (self.n - 1), (v - on_edges) % (self.n - 1) + 1);
            return if self.is_binary {
                self.constructed_on_edge(edge, at)
            } else {
                let (f, place) = self.beside(edge, at);
                self.descended(f, place)
            };
        }
        let f = self.face_around(v);
        self.constructed_in_face(f, v - self.first_inner() - self.inner[f] as usize)
    }

    /// Calls `each` with the index in the order of construction of each vertex in `range`.
    pub fn each_constructed(&self, range: Range<usize>, mut each: impl FnMut(u32)) {
        let inside = self.first_inner();
        (range.start..range.end.min(inside)).for_each(|v| each(self.constructed(v)));
        let mut v = range.start.max(inside);
        while v < range.end {
            let f = self.face_around(v);
            let first = inside + self.inner[f] as usize;
            let end = range.end.min(first + self.inner_of(f));
            (v - first..end - first).for_each(|inner| each(self.constructed_in_face(f, inner)));
            v = end;
        }
    }

    /// The base face inside which vertex `v` lies.
    fn face_around(&self, v: usize) -> usize {
        let inner = index(v - self.first_inner());
        self.inner.partition_point(|&first| first <= inner) - 1
    }

    /// Returns the constructed index of inner vertex `inner` of a base face.
    fn constructed_in_face(&self, f: usize, inner: usize) -> u32 {
        let place = self.place(f, inner);
        if self.is_binary { self.constructed_inside(f, place) } else { self.descended(f, place) }
    }

    /// Returns the constructed index of inner point `at` of a base edge, which arose as the midpoint of a piece of the
    /// edge.
    fn constructed_on_edge(&self, edge: usize, at: usize) -> u32 {
        let level = self.splits() - at.trailing_zeros() as usize;
        let odd = at >> at.trailing_zeros();
        let pieces = 1 << (level - 1);
        index(self.vertices_at(level - 1) + edge * pieces + odd / 2)
    }

    /// Returns the number of vertices after `level` splits, by counting cells from those of the base.
    fn vertices_at(&self, level: usize) -> usize {
        let (mut v, mut e, mut f) = (self.base.n_vertices(), self.base.n_edges(), self.base.n_faces());
        let mut corners = self.base.n_half_edges();
        for _ in 0..level {
            (v, e, f) = (v + e + f, 2 * e + corners, corners);
            corners *= 4;
        }
        v
    }

    fn place(&self, f: usize, inner: usize) -> FacePosition {
        let (n, half) = (self.n, self.half());
        let size = self.base.face(f).len();
        if size == 4 {
            return FacePosition::Quad(inner % (n - 1) + 1, inner / (n - 1) + 1);
        }
        if inner == 0 {
            return FacePosition::Centre;
        }
        let (rest, spoke) = (inner - 1, half - 1);
        if rest < size * spoke {
            return FacePosition::Spoke(rest / spoke, rest % spoke + 1);
        }
        let rest = rest - size * spoke;
        let (part, rest) = (rest / (spoke * spoke), rest % (spoke * spoke));
        FacePosition::Sector(part, rest % spoke + 1, rest / spoke + 1)
    }

    fn constructed_inside(&self, f: usize, place: FacePosition) -> u32 {
        if self.splits() == 1 || matches!(place, FacePosition::Centre) {
            return index(self.base.n_vertices() + self.base.n_edges() + f);
        }
        let first = self.base.half_edges(f).start as usize;
        let quarter = 1_usize << (2 * (self.splits() - 2));
        let edge_points = index(self.parent.n_vertices());
        match place {
            FacePosition::Quad(i, j) => self.constructed_at(first * quarter + morton(i / 2, j / 2), i, j),
            FacePosition::Sector(part, i, j) => {
                self.constructed_at((first + part) * quarter + morton(i / 2, j / 2), i, j)
            }
            FacePosition::Spoke(part, at) => {
                let cell = (first + part) * quarter + morton(self.half() / 2 - 1, at / 2);
                let corner = index(4 * cell + 1);
                if at % 2 == 0 { self.parent.vertex(corner) } else { edge_points + self.parent.edge(corner) }
            }
            FacePosition::Centre => unreachable!("handled above"),
        }
    }

    /// Returns the vertex at the origin of a parent's cell (`i`, `j` even), on its sides at the origin (one odd), or
    /// inside it.
    fn constructed_at(&self, cell: usize, i: usize, j: usize) -> u32 {
        let edge_points = index(self.parent.n_vertices());
        let origin = index(4 * cell);
        match (i % 2, j % 2) {
            (0, 0) => self.parent.vertex(origin),
            (1, 0) => edge_points + self.parent.edge(origin),
            (0, _) => edge_points + self.parent.edge(origin + 3),
            _ => edge_points + index(self.parent.n_edges() + cell),
        }
    }

    /// Returns the first face of a base edge and the position in it of the edge's inner point `at`.
    fn beside(&self, edge: usize, at: usize) -> (usize, FacePosition) {
        let corner = self.base.halves(edge)[0];
        let f = self.base.face_of(corner);
        let (side, size) = (corner - self.base.half_edges(f).start, self.base.face(f).len());
        if size == 4 {
            let [i, j] = Tile::Quad.along(self.n, side, at);
            (f, FacePosition::Quad(i, j))
        } else if at <= self.half() {
            (f, FacePosition::Sector(side as usize, at, 0))
        } else {
            (f, FacePosition::Sector((side as usize + 1) % size, 0, self.n - at))
        }
    }

    /// Returns the constructed index of a position in a base face after splits of any arity.
    fn descended(&self, f: usize, place: FacePosition) -> u32 {
        let (n, half, first) = (self.n, self.half(), self.base.half_edges(f).start as usize);
        let (pieces, n, face, place) = match place {
            FacePosition::Quad(i, j) if self.is_quads => (&self.pieces[..], n, f, [i, j]),
            FacePosition::Quad(i, j) => {
                let (cell, place) = Tile::Quad.enter(2, half, [i, j]);
                (&self.pieces[1..], half, first + Tile::Quad.number(2, cell), place)
            }
            FacePosition::Sector(part, i, j) => (&self.pieces[1..], half, first + part, [i, j]),
            FacePosition::Spoke(part, at) => (&self.pieces[1..], half, first + part, [half, at]),
            FacePosition::Centre => (&self.pieces[1..], half, first, [half, half]),
        };
        let (face, place) = descended(Tile::Quad, pieces, n, face, place);
        Tiling::new(&self.parent, Tile::Quad, self.pieces[self.splits() - 1] as usize).vertex(face, place)
    }
}

fn inner_vertices(size: usize, n: usize) -> usize {
    let half = n / 2;
    if size == 4 { (n - 1) * (n - 1) } else { 1 + size * (half - 1) + size * (half - 1) * (half - 1) }
}

/// Interleaves the bits of `i` (even positions) and `j` (odd positions): the index of a cell after repeated splits.
fn morton(i: usize, j: usize) -> usize {
    fn spread(x: usize) -> usize {
        let x = x as u64;
        let x = (x | x << 16) & 0x0000_ffff_0000_ffff;
        let x = (x | x << 8) & 0x00ff_00ff_00ff_00ff;
        let x = (x | x << 4) & 0x0f0f_0f0f_0f0f_0f0f;
        let x = (x | x << 2) & 0x3333_3333_3333_3333;
        let x = (x | x << 1) & 0x5555_5555_5555_5555;
        usize::try_from(x).expect("cells are numbered below 2^32")
    }
    spread(i) | spread(j) << 1
}
