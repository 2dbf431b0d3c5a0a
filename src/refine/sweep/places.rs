//! Locates vertices and faces on patches: from an index in the documented order to a place.

use std::ops::Range;
use std::sync::Arc;

use super::lattice::{CornerFrame, last};
use super::surface::PatchSurface;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, Topology, index};

/// Approximate number of vertices that are requested at a time: they take 1.5 MB as points and as much as bytes, and
/// stay in the cache of a core. With half as many, points that neighbouring patches share are computed twice as often;
/// with twice as many, points leave the cache before they are encoded.
const VERTICES_PER_REQUEST: usize = 1 << 16;

/// The places of the vertices and faces of a refined mesh.
#[derive(Debug)]
pub(super) struct SweepPlaces {
    base: Arc<Topology>,
    patches: Arc<Topology>,
    tile: Tile,
    /// Whether the patches are the faces of the base.
    is_whole: bool,
    /// Number of pieces of a base edge.
    n: usize,
    /// Number of pieces of a patch's side.
    pub(super) pieces: usize,
    /// For each base face, and for the end of the list, the number of vertices inside the faces before it.
    inner: Vec<usize>,
}

/// Consecutive vertices, or the cells of consecutive faces, along a line of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) patch: usize,
    pub(super) from: [usize; 2],
    pub(super) step: [isize; 2],
    pub(super) len: usize,
}

/// The directions of spans along rows and columns.
const ROW_DIRECTION: [isize; 2] = [1, 0];
const COLUMN_DIRECTION: [isize; 2] = [0, 1];

impl Span {
    /// Returns the place of the last element of the span.
    pub(super) fn last(&self) -> [usize; 2] {
        self.place(self.len - 1)
    }

    pub(super) fn place(&self, k: usize) -> [usize; 2] {
        std::array::from_fn(|axis| self.from[axis].wrapping_add_signed(self.step[axis] * k.cast_signed()))
    }

    /// Returns whether the span may lie on the diagonal side of a triangle.
    pub(super) fn is_diagonal(&self) -> bool {
        self.len == 1 || (self.step[0] != 0 && self.step[1] != 0)
    }

    /// Returns whether the span runs forwards along a row.
    pub(super) fn is_row(&self) -> bool {
        self.step == ROW_DIRECTION
    }
}

impl SweepPlaces {
    /// Creates the places after splits that divide each base edge into `n` pieces.
    pub(super) fn new(surface: &PatchSurface, n: usize) -> Self {
        let (base, patches) = (surface.base.clone(), surface.patches.clone());
        let (tile, half) = (surface.tile, n / 2);
        let is_whole = tile == Tile::Triangle || base.is_quads();
        let inside = |size: usize| {
            if size == 4 || is_whole { tile.inner_vertices(n) } else { 1 + size * (half - 1) * half }
        };
        let mut inner = vec![0];
        inner.extend((0..base.n_faces()).scan(0, |sum, f| {
            *sum += inside(base.face(f).len());
            Some(*sum)
        }));
        Self { base, patches, tile, is_whole, n, pieces: if is_whole { n } else { half }, inner }
    }

    /// Returns the first vertex inside a base face.
    fn first_inner(&self) -> usize {
        self.base.n_vertices() + self.base.n_edges() * (self.n - 1)
    }

    /// Returns the span of vertex `v` and the vertices after it; `None` if `v` has no face.
    pub(super) fn span(&self, v: usize) -> Option<Span> {
        let Some(beyond) = v.checked_sub(self.base.n_vertices()) else {
            let half_edge = self.patches.ring(v).next()?;
            let (patch, side) = self.side(half_edge);
            return Some(Span { patch, from: self.at_side(self.pieces, side, 0), step: ROW_DIRECTION, len: 1 });
        };
        let on_edge = self.n - 1;
        Some(match v.checked_sub(self.first_inner()) {
            None => self.on_edge(beyond / on_edge, beyond % on_edge + 1),
            Some(inner) => {
                let f = self.inner.partition_point(|&first| first <= inner) - 1;
                self.inside(f, inner - self.inner[f])
            }
        })
    }

    fn on_edge(&self, edge: usize, at: usize) -> Span {
        let half_edge = self.base.halves(edge)[0];
        let f = self.base.face_of(half_edge);
        let (first, size) = (self.base.half_edges(f).start as usize, self.base.face(f).len());
        let side = half_edge as usize - first;
        if size == 4 || self.is_whole {
            return self.in_face(f, self.at_side(self.n, side, at), self.frame(side).along(), self.n - at);
        }
        if at <= self.pieces {
            return Span {
                patch: first + side,
                from: [at, 0],
                step: ROW_DIRECTION,
                len: (self.pieces - at + 1).min(self.n - at),
            };
        }
        let back = self.n - at;
        Span { patch: first + (side + 1) % size, from: [0, back], step: [0, -1], len: back }
    }

    /// Returns the span inside face `f` that starts at inner vertex `inner`.
    fn inside(&self, f: usize, inner: usize) -> Span {
        let (first, size) = (self.base.half_edges(f).start as usize, self.base.face(f).len());
        if size == 4 || self.is_whole {
            let from = self.tile.inside(self.n, inner);
            let end = last(self.tile, self.n, from[1]);
            return self.in_face(f, from, ROW_DIRECTION, end - from[0]);
        }
        let Some(rest) = inner.checked_sub(1) else {
            return Span { patch: first, from: [self.pieces; 2], step: ROW_DIRECTION, len: 1 };
        };
        let spoke = self.pieces - 1;
        let Some(rest) = rest.checked_sub(size * spoke) else {
            let at = rest % spoke;
            return Span {
                patch: first + rest / spoke,
                from: [self.pieces, at + 1],
                step: COLUMN_DIRECTION,
                len: spoke - at,
            };
        };
        let (part, rest) = (rest / (spoke * spoke), rest % (spoke * spoke));
        let (i, j) = (rest % spoke, rest / spoke);
        Span { patch: first + part, from: [i + 1, j + 1], step: ROW_DIRECTION, len: spoke - i }
    }

    /// Returns a span of at most `len` points in a quad or a triangle, cut where it leaves its patch.
    fn in_face(&self, f: usize, from: [usize; 2], step: [isize; 2], len: usize) -> Span {
        if self.is_whole {
            return Span { patch: f, from, step, len };
        }
        let half = self.pieces;
        let upper = from.map(|x| usize::from(x > half));
        let from: [usize; 2] = std::array::from_fn(|axis| from[axis] - upper[axis] * half);
        let axis = usize::from(step[0] == 0);
        let here = match (step[axis] > 0, upper[axis] > 0) {
            (true, _) => half - from[axis] + 1,
            (false, true) => from[axis],
            (false, false) => from[axis] + 1,
        };
        let patch = self.base.half_edges(f).start as usize + upper[0] + 2 * upper[1];
        Span { patch, from, step, len: len.min(here) }
    }

    /// Returns the cells of a face and of the next faces in the same row of a patch.
    pub(super) fn cells(&self, face: usize) -> Span {
        let n = self.n;
        let f = self.base.face_of(index(4 * face / (n * n)));
        let first = self.base.half_edges(f).start as usize;
        let local = face - first * n * n / 4;
        if self.base.face(f).len() == 4 {
            let (i, j) = (local % n, local / n);
            if self.is_whole {
                return Span { patch: f, from: [i, j], step: ROW_DIRECTION, len: n - i };
            }
            let upper = [i, j].map(|x| usize::from(x >= self.pieces));
            let from = [i - upper[0] * self.pieces, j - upper[1] * self.pieces];
            return Span {
                patch: first + upper[0] + 2 * upper[1],
                from,
                step: ROW_DIRECTION,
                len: self.pieces - from[0],
            };
        }
        let half = self.pieces;
        let (part, local) = (local / (half * half), local % (half * half));
        Span { patch: first + part, from: [local % half, local / half], step: ROW_DIRECTION, len: half - local % half }
    }

    /// Returns the index of the face at a cell of a patch.
    pub(super) fn face(&self, patch: usize, [i, j]: [usize; 2]) -> usize {
        let n = self.n;
        if self.is_whole {
            return patch * n * n + j * n + i;
        }
        let (f, half) = (self.base.face_of(index(patch)), self.pieces);
        let first = self.base.half_edges(f).start as usize;
        let part = patch - first;
        if self.base.face(f).len() == 4 {
            first * half * half + (j + part / 2 * half) * n + i + part % 2 * half
        } else {
            patch * half * half + j * half + i
        }
    }

    /// Divides a span of vertices into parts inside the patch and, for vertices on its sides, spans of the cells
    /// around them.
    pub(super) fn divide(
        &self,
        at: usize,
        span: Span,
        inside: &mut Vec<(usize, Span)>,
        strips: &mut Vec<(usize, Span)>,
    ) {
        let is_on_side = |[i, j]: [usize; 2]| [i, j].map(|x| x == 0 || x == self.pieces);
        let mut start = 0;
        while start < span.len {
            let sides = is_on_side(span.place(start));
            let len = (start..span.len).take_while(|&k| is_on_side(span.place(k)) == sides).count();
            let part = Span { from: span.place(start), len, ..span };
            match sides {
                [false, false] => inside.push((at + start, part)),
                [true, true] => strips.extend(self.around_corner(&part).map(|cell| (at + start, cell))),
                _ => strips.extend(self.beside(&part).map(|strip| (at + start, strip))),
            }
            start += len;
        }
    }

    /// Returns the cells around a vertex at a corner of its patch.
    fn around_corner(&self, vertex: &Span) -> impl Iterator<Item = Span> {
        let [i, j] = vertex.from.map(|x| x > 0);
        let corner = [[0, 3], [1, 2]][usize::from(i)][usize::from(j)];
        let v = self.patches.vertex(self.patches.half_edges(vertex.patch).start + corner) as usize;
        self.patches.ring(v).map(|half_edge| {
            let (patch, side) = self.side(half_edge);
            let [a, b] = [[0, 0], [1, 1]].map(|place| self.frame(side).place(place));
            let from = [0, 1].map(|axis| a[axis].min(b[axis]).unsigned_abs());
            Span { patch, from, step: ROW_DIRECTION, len: 1 }
        })
    }

    /// Returns the cells on both sides of vertices on a side of their patch, one more cell than vertices on each side.
    fn beside(&self, span: &Span) -> impl Iterator<Item = Span> {
        let n = self.pieces;
        let [i, j] = span.from;
        let (side, steps) = match (i, j) {
            (i, 0) => (0, i),
            (i, j) if i == n => (1, j),
            (i, j) if j == n => (2, n - i),
            (_, j) => (3, n - j),
        };
        let half_edge = self.patches.half_edges(span.patch).start + index(side);
        let along = self.frame(side).along();
        // a single vertex has no direction of its own
        let forward = span.len == 1 || span.step == along;
        let twin = Some(self.patches.twin(half_edge)).filter(|&twin| twin != NONE);
        let own = self.strip((span.patch, side), steps, forward, span.len);
        let beyond = twin.map(|twin| self.strip(self.side(twin), n - steps, !forward, span.len));
        std::iter::once(own).chain(beyond)
    }

    /// Returns the cells along a side of a patch around `n_vertices` vertices, the first of which is `steps` steps
    /// along it.
    fn strip(&self, (patch, side): (usize, usize), steps: usize, forward: bool, n_vertices: usize) -> Span {
        let first = if forward { steps - 1 } else { steps }.cast_signed();
        let [a, b] = [[first, 0], [first + 1, 1]].map(|place| self.frame(side).place(place));
        let from = [0, 1].map(|axis| a[axis].min(b[axis]).unsigned_abs());
        let step = self.frame(side).along().map(|x| if forward { x } else { -x });
        Span { patch, from, step, len: n_vertices + 1 }
    }

    /// Returns point `at` on a side of a tile with `n` pieces.
    fn at_side(&self, n: usize, side: usize, at: usize) -> [usize; 2] {
        CornerFrame::new(self.tile, n, side, 0).place([at.cast_signed(), 0]).map(isize::cast_unsigned)
    }

    /// Returns the frame at one of the sides of a patch.
    fn frame(&self, side: usize) -> CornerFrame {
        CornerFrame::new(self.tile, self.pieces, side, 0)
    }

    /// Returns the patch of a half-edge, and the side of it that the half-edge is.
    fn side(&self, half_edge: u32) -> (usize, usize) {
        let patch = self.patches.face_of(half_edge);
        (patch, (half_edge - self.patches.half_edges(patch).start) as usize)
    }
}

impl SweepPlaces {
    /// Returns the best end for a range of vertices that starts at `v`, so that no block of `rows` rows is refined for
    /// two ranges.
    pub(super) fn stretch(&self, v: usize, rows: usize) -> usize {
        let (edges, inside) = (self.base.n_vertices(), self.first_inner());
        let on_edge = self.n - 1;
        if v < edges {
            return edges.min(v + VERTICES_PER_REQUEST / 16);
        }
        let Some(inner) = v.checked_sub(inside) else {
            let whole = (VERTICES_PER_REQUEST / on_edge).max(1);
            return inside.min(edges + ((v - edges) / on_edge + whole) * on_edge);
        };
        let f = self.inner.partition_point(|&first| first <= inner) - 1;
        let (start, end) = (self.inner[f], self.inner[f + 1]);
        if end - start <= VERTICES_PER_REQUEST {
            let last = self.inner.partition_point(|&end| end <= inner + VERTICES_PER_REQUEST) - 1;
            return inside + self.inner[last].max(end);
        }
        let (local, size) = (inner - start, self.base.face(f).len());
        let band = |width: usize, local: usize| {
            let row = (local / width + 1) / rows * rows + rows - 1;
            row.min(width) * width
        };
        let to = if self.tile == Tile::Triangle {
            let row = (self.tile.inside(self.n, local)[1] / rows * rows + rows - 1).min(self.n - 2);
            row * on_edge - row * (row + 1) / 2
        } else if size == 4 {
            band(on_edge, local)
        } else {
            let spoke = self.pieces - 1;
            match local.checked_sub(1 + size * spoke) {
                None => 1 + size * spoke,
                Some(rest) => {
                    let part = rest / (spoke * spoke);
                    1 + size * spoke + part * spoke * spoke + band(spoke, rest % (spoke * spoke))
                }
            }
        };
        inside + start + to
    }

    /// Returns the best end for a range of faces that starts at `face`.
    pub(super) fn stretch_of_faces(&self, face: usize, rows: usize) -> usize {
        let n = self.n;
        let f = self.base.face_of(index(4 * face / (n * n)));
        let first = |f: usize| {
            if f == self.base.n_faces() { self.base.n_half_edges() } else { self.base.half_edges(f).start as usize }
        };
        let faces = |f: usize| first(f) * n * n / 4;
        if faces(f + 1) - faces(f) <= VERTICES_PER_REQUEST {
            let mut last = f + 1;
            while last < self.base.n_faces() && faces(last + 1) <= face + VERTICES_PER_REQUEST {
                last += 1;
            }
            return faces(last);
        }
        let width = if self.base.face(f).len() == 4 { n } else { self.pieces };
        let row = (face - faces(f)) / width;
        (faces(f) + (row / rows + 1) * rows * width).min(faces(f + 1))
    }
}

/// Covers a range by consecutive spans, sorted by patch, each with its offset in the range.
pub(super) fn spans(range: Range<usize>, mut span: impl FnMut(usize) -> Option<Span>) -> Vec<(usize, Span)> {
    let (mut spans, mut v) = (Vec::new(), range.start);
    while v < range.end {
        let Some(span) = span(v) else {
            v += 1;
            continue;
        };
        let len = span.len.min(range.end - v);
        spans.push((v - range.start, Span { len, ..span }));
        v += len;
    }
    spans.sort_by_key(|(_, span)| span.patch);
    spans
}
