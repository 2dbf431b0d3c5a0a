//! The documented indices of the points of patches.

use std::sync::Arc;

use crate::shape::grid::QuadGrid;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::Topology;

/// The documented order of a mesh after some splits that halve all edges.
#[derive(Debug)]
pub(super) struct SplitOrder {
    base: Arc<Topology>,
    /// Number of pieces of a base edge.
    pieces: usize,
    /// The order of a refined mesh of quads; `None` for triangles, whose indices are computed directly.
    quads: Option<QuadGrid>,
}

impl SplitOrder {
    /// Creates the numbering after `splits` splits of a base.
    pub(super) fn new(base: &Arc<Topology>, tile: Tile, splits: usize) -> Self {
        let quads = || QuadGrid::new(base.clone(), base.clone(), vec![2; splits].into());
        Self { base: base.clone(), pieces: 1 << splits, quads: (tile == Tile::Quad).then(quads) }
    }

    /// Returns the number of pieces of a base edge.
    pub(super) fn pieces(&self) -> usize {
        self.pieces
    }

    fn triangles(&self) -> Tiling<'_> {
        Tiling::new(&self.base, Tile::Triangle, self.pieces)
    }

    /// Returns the number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.quads.as_ref().map_or_else(|| self.triangles().n_vertices(), QuadGrid::n_vertices)
    }

    /// Returns the number of points inside a base face.
    pub(super) fn inner_of(&self, face: usize) -> usize {
        self.quads.as_ref().map_or_else(|| Tile::Triangle.inner_vertices(self.pieces), |grid| grid.inner_of(face))
    }

    /// Returns the index of a point of a patch. A patch is a base face if the base has only quads or only triangles,
    /// else a face of the first split of the base.
    pub(super) fn vertex(&self, patch: usize, [i, j]: [isize; 2]) -> u32 {
        let place = [i.cast_unsigned(), j.cast_unsigned()];
        match &self.quads {
            Some(grid) => grid.patch_vertex(patch, place),
            None => self.triangles().vertex(patch, place),
        }
    }

    /// Returns the indices of points of a patch in one column and consecutive rows, from an inner point on; only the
    /// first `n` of them count.
    pub(super) fn rows(&self, patch: usize, [i, j]: [usize; 2], n: usize) -> RowStarts {
        let vertex = |j: usize| self.vertex(patch, [i, j].map(usize::cast_signed));
        let first = if n > 0 { vertex(j) } else { 0 };
        let step = if n > 1 { vertex(j + 1).wrapping_sub(first) } else { 0 };
        RowStarts { next: first, step, less: u32::from(self.quads.is_none()) }
    }
}

/// The indices of points in one column and consecutive rows.
#[derive(Debug)]
pub(super) struct RowStarts {
    next: u32,
    /// Number of points from here to the next row.
    step: u32,
    /// By how many points each row is shorter than the one before: none in a quad, one in a triangle.
    less: u32,
}

impl Iterator for RowStarts {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let here = self.next;
        self.next = here.wrapping_add(self.step);
        self.step = self.step.wrapping_sub(self.less);
        Some(here)
    }
}
