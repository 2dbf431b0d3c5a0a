//! The order of construction: the index that a vertex of a [`QuadGrid`] has in the splits themselves.

use std::ops::Range;

use super::QuadGrid;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::index;
use crate::shape::triangle_grid::descended;

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
    /// Returns the index of vertex `v` in the order of construction (see
    /// [`Topology::split`](crate::shape::topology::Topology::split)).
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
        self.constructed_in_face(f, v - self.first_inner() - self.inner_before(f))
    }

    /// Calls `each` with the index in the order of construction of each vertex in `range`.
    pub fn each_constructed(&self, range: Range<usize>, mut each: impl FnMut(u32)) {
        let inside = self.first_inner();
        (range.start..range.end.min(inside)).for_each(|v| each(self.constructed(v)));
        let mut v = range.start.max(inside);
        while v < range.end {
            let f = self.face_around(v);
            let first = inside + self.inner_before(f);
            let end = range.end.min(first + self.inner_of(f));
            (v - first..end - first).for_each(|inner| each(self.constructed_in_face(f, inner)));
            v = end;
        }
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
