//! A topology whose faces are all split `d x d`: quads into quads, or triangles into triangles.

use rayon::prelude::*;

use super::tile::{Cell, CellSide, Tile, TilePosition};
use super::topology::{FaceLayout, NONE, Topology, each, filled, index};

/// The split of a topology in closed form: the indices of vertices, edges and faces after it, and their origins.
///
/// Vertices: those of the parent; then edge by edge its `d - 1` points in its direction; then face by face its inner
/// points, row by row. Edges: edge by edge its `d` pieces, then those inside the faces. Faces: face by face its cells,
/// row by row. For `d = 2` and quads this is [`Topology::split`].
#[derive(Debug, Clone, Copy)]
pub struct Tiling<'a> {
    parent: &'a Topology,
    tile: Tile,
    pieces: usize,
}

/// The origin of a vertex after a split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ancestor {
    /// A vertex of the parent.
    Vertex(usize),
    /// A point on an edge of the parent: the edge, and the steps from its start.
    Edge(usize, usize),
    /// A point inside a face of the parent: the face, and the steps towards corner 1 and towards the last corner.
    Face(usize, [usize; 2]),
}

impl<'a> Tiling<'a> {
    /// Creates the split of `parent`, all of whose faces have as many sides as `tile`, into `pieces` pieces per edge.
    pub fn new(parent: &'a Topology, tile: Tile, pieces: usize) -> Self {
        Self { parent, tile, pieces }
    }

    /// Number of vertices after the split.
    pub fn n_vertices(&self) -> usize {
        self.first_inner() + self.parent.n_faces() * self.tile.inner_vertices(self.pieces)
    }

    /// Number of faces after the split.
    pub fn n_faces(&self) -> usize {
        self.parent.n_faces() * self.pieces * self.pieces
    }

    /// Returns the index of the first vertex inside a face.
    fn first_inner(&self) -> usize {
        self.parent.n_vertices() + self.parent.n_edges() * (self.pieces - 1)
    }

    /// Returns the origin of a vertex.
    #[inline]
    pub fn ancestor(&self, v: usize) -> Ancestor {
        let n_v = self.parent.n_vertices();
        if v < n_v {
            Ancestor::Vertex(v)
        } else if v < self.first_inner() {
            Ancestor::Edge((v - n_v) / (self.pieces - 1), (v - n_v) % (self.pieces - 1) + 1)
        } else {
            let (inner, each) = (v - self.first_inner(), self.tile.inner_vertices(self.pieces));
            Ancestor::Face(inner / each, self.tile.inside(self.pieces, inner % each))
        }
    }

    /// Returns the vertex at a place of a face of the parent.
    #[inline]
    pub fn vertex(&self, face: usize, place: [usize; 2]) -> u32 {
        let first = self.parent.half_edges(face).start;
        match self.tile.place(self.pieces, place) {
            TilePosition::Corner(corner) => self.parent.vertex(first + corner),
            TilePosition::Side(side, at) => {
                let edge = self.parent.edge(first + side) as usize;
                let forward = self.parent.halves(edge)[0] == first + side;
                let at = if forward { at } else { self.pieces - at };
                index(self.parent.n_vertices() + edge * (self.pieces - 1) + at - 1)
            }
            TilePosition::Inside(number) => index(self.first_inside(face) + number),
        }
    }

    /// Returns the first vertex inside a face.
    pub(super) fn first_inside(&self, face: usize) -> usize {
        self.first_inner() + face * self.tile.inner_vertices(self.pieces)
    }

    /// Returns the vertices of a face after the split; for a triangle, only the first three are used.
    #[inline]
    pub fn face(&self, face: usize) -> [u32; 4] {
        let each = self.pieces * self.pieces;
        let cell = self.tile.cell(self.pieces, face % each);
        self.tile.corners(cell).map(|place| self.vertex(face / each, place))
    }

    /// Returns the first face of an edge of the parent, and the place in it that is `at` steps along the edge.
    pub(super) fn along(&self, edge: usize, at: usize) -> (usize, [usize; 2]) {
        let half_edge = self.parent.halves(edge)[0];
        let face = self.parent.face_of(half_edge);
        let side = half_edge - self.parent.half_edges(face).start;
        (face, self.tile.along(self.pieces, side, at))
    }

    /// Returns the half-edge at corner `corner` of a cell of a face.
    fn corner(&self, face: usize, cell: Cell, corner: u32) -> u32 {
        let number = face * self.pieces * self.pieces + self.tile.number(self.pieces, cell);
        index(number) * self.tile.sides() + corner
    }

    /// Returns the half-edge that is piece `piece` of a half-edge of the parent.
    fn piece(&self, half_edge: u32, piece: usize) -> u32 {
        let face = self.parent.face_of(half_edge);
        let side = half_edge - self.parent.half_edges(face).start;
        self.corner(face, self.tile.at_side(self.pieces, side, piece), side)
    }

    /// Returns the edge at side `side` of a cell of a face.
    fn edge(&self, face: usize, cell: Cell, side: u32) -> u32 {
        let d = self.pieces;
        match self.tile.side(d, cell, side) {
            CellSide::Outer(side, piece) => {
                let half_edge = self.parent.half_edges(face).start + side;
                let edge = self.parent.edge(half_edge) as usize;
                let forward = self.parent.halves(edge)[0] == half_edge;
                index(edge * d + if forward { piece } else { d - 1 - piece })
            }
            CellSide::Inner(number) => index(self.parent.n_edges() * d + face * self.tile.inner_edges(d) + number),
        }
    }

    /// Builds the topology after the split.
    pub fn topology(&self) -> Topology {
        let (parent, tile, d) = (self.parent, self.tile, self.pieces);
        let sides = tile.sides() as usize;
        let (vertices, edge_of) = filled(sides, self.n_faces(), |child, vertices, edges| {
            let (face, cell) = (child / (d * d), tile.cell(d, child % (d * d)));
            vertices.copy_from_slice(&self.face(child)[..sides]);
            (0..).zip(edges).for_each(|(side, edge)| *edge = self.edge(face, cell, side));
        });
        let pieces = each(d * parent.n_edges()).map(|piece| {
            let [first, second] = parent.halves(piece / d);
            let other = if second == NONE { NONE } else { self.piece(second, d - 1 - piece % d) };
            [self.piece(first, piece % d), other]
        });
        let n = tile.inner_edges(d);
        let sides_of = |edge: usize| tile.at_edge(d, edge % n).map(|(cell, side)| self.corner(edge / n, cell, side));
        let inner = each(n * parent.n_faces()).map(sides_of);
        let new = self.n_vertices() - parent.n_vertices();
        let kept = parent.outgoing.par_iter().map(|&c| if c == NONE { NONE } else { self.piece(c, 0) });
        let made = each(new).map(|v| match self.ancestor(parent.n_vertices() + v) {
            Ancestor::Edge(edge, at) => self.piece(parent.halves(edge)[0], at),
            Ancestor::Face(face, place) => self.corner(face, Cell::at(place), 0),
            Ancestor::Vertex(_) => unreachable!("vertices of the parent come first"),
        });
        Topology {
            n_vertices: self.n_vertices(),
            faces: match tile {
                Tile::Quad => FaceLayout::Quads,
                Tile::Triangle => FaceLayout::Triangles,
            },
            halves: pieces.chain(inner).collect(),
            outgoing: kept.chain(made).collect(),
            vertices,
            edge_of,
        }
    }
}
