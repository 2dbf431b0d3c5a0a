//! The documented order of a split mesh, for any kind of split.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::grid::QuadGrid;
use super::source::{FaceChunk, Origin};
use super::tile::Tile;
use super::topology::Topology;
use super::triangle_grid::TriangleGrid;

/// The documented order of a split mesh.
#[derive(Debug, Clone)]
pub enum Order {
    /// After splits into quads.
    Quads(QuadGrid),
    /// After splits into triangles.
    Triangles(TriangleGrid),
}

impl Order {
    /// Returns the order of `base` after splits with `pieces` pieces per edge; `parent` is the topology before the
    /// last split.
    ///
    /// # Panics
    /// If there is no split: then the order is that of the base.
    pub fn new(base: Arc<Topology>, parent: Arc<Topology>, tile: Tile, pieces: Arc<[u32]>) -> Self {
        match tile {
            Tile::Quad => Self::Quads(QuadGrid::new(base, parent, pieces)),
            Tile::Triangle => Self::Triangles(TriangleGrid::new(base, parent, pieces)),
        }
    }

    /// Returns the order of another base with the same faces after the same splits, without an order of construction.
    #[must_use]
    pub fn over(&self, base: &Arc<Topology>) -> Self {
        match self {
            Self::Quads(grid) => Self::Quads(grid.over(base)),
            Self::Triangles(grid) => Self::Triangles(grid.over(base)),
        }
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        match self {
            Self::Quads(grid) => grid.n_vertices(),
            Self::Triangles(grid) => grid.n_vertices(),
        }
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        match self {
            Self::Quads(grid) => grid.n_faces(),
            Self::Triangles(grid) => grid.n_faces(),
        }
    }

    /// Number of vertices per face.
    pub fn face_size(&self) -> usize {
        match self {
            Self::Quads(_) => 4,
            Self::Triangles(_) => 3,
        }
    }

    /// Returns the base face that contains face `f`.
    pub fn base_face(&self, f: usize) -> usize {
        match self {
            Self::Quads(grid) => grid.base_face(f),
            Self::Triangles(grid) => grid.base_face(f),
        }
    }

    /// Returns the base cell in which vertex `v`, indexed in the documented order, arose.
    pub fn origin(&self, v: usize) -> Origin {
        match self {
            Self::Quads(grid) => grid.origin(v),
            Self::Triangles(grid) => grid.origin(v),
        }
    }

    /// First face of base face `f`.
    pub fn first_face(&self, f: usize) -> usize {
        match self {
            Self::Quads(grid) => grid.first_face(f),
            Self::Triangles(grid) => grid.first_face(f),
        }
    }

    /// Writes the vertices of face `f`, numbered in the documented order, to `out`, which has [`Order::face_size`]
    /// places.
    pub fn face(&self, f: usize, out: &mut [u32]) {
        match self {
            Self::Quads(grid) => out.copy_from_slice(&grid.face(f)),
            Self::Triangles(grid) => out.copy_from_slice(&grid.face(f)),
        }
    }

    /// Fills `out` with the faces in these ranges, one range after another.
    pub fn faces(&self, ranges: impl Iterator<Item = Range<usize>> + Clone, out: &mut FaceChunk) {
        let n = ranges.clone().map(|range| range.len()).sum();
        let mut places = out.places(self.face_size(), n);
        for range in ranges {
            let here;
            (here, places) = places.split_at_mut(self.face_size() * range.len());
            match self {
                Self::Quads(grid) => pieces(range.start, here, |first, faces| grid.faces(first, faces)),
                Self::Triangles(grid) => pieces(range.start, here, |first, faces| grid.faces(first, faces)),
            }
        }
    }

    /// Calls `each` with the index in the order of construction of each vertex in `range`.
    pub fn each_constructed(&self, range: Range<usize>, each: impl FnMut(u32)) {
        match self {
            Self::Quads(grid) => grid.each_constructed(range, each),
            Self::Triangles(grid) => range.map(|v| grid.constructed(v)).for_each(each),
        }
    }

    /// Returns the index of vertex `v` in the order of construction.
    pub fn constructed(&self, v: usize) -> u32 {
        match self {
            Self::Quads(grid) => grid.constructed(v),
            Self::Triangles(grid) => grid.constructed(v),
        }
    }
}

/// Number of faces that a thread writes at a time: one megabyte. Half as many make no difference; shorter lists are not
/// worth two threads.
const WRITTEN_FACES_PER_TASK: usize = 1 << 16;

/// Divides the slots of faces into pieces and calls `list(first, faces)` for each, in parallel; the first face is
/// `first`.
fn pieces<const N: usize>(first: usize, places: &mut [u32], list: impl Fn(usize, &mut [[u32; N]]) + Sync) {
    let faces = places.as_chunks_mut().0;
    if faces.len() <= WRITTEN_FACES_PER_TASK {
        return list(first, faces);
    }
    faces
        .par_chunks_mut(WRITTEN_FACES_PER_TASK)
        .enumerate()
        .for_each(|(piece, faces)| list(first + piece * WRITTEN_FACES_PER_TASK, faces));
}
