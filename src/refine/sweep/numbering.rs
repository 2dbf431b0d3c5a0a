//! The documented numbers of the points of patches.

use std::sync::Arc;

use crate::shape::grid::Grid;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::Topology;

/// The documented order of a mesh after some splits that halve all edges.
#[derive(Debug)]
pub(super) struct Numbering {
    base: Arc<Topology>,
    /// Pieces of an edge of the base.
    pieces: usize,
    /// The order of quads; triangles are numbered by arithmetic.
    quads: Option<Grid>,
}

impl Numbering {
    /// The numbers after so many splits of a base.
    pub(super) fn new(base: &Arc<Topology>, tile: Tile, splits: usize) -> Self {
        let quads = || Grid::new(base.clone(), base.clone(), vec![2; splits].into());
        Self { base: base.clone(), pieces: 1 << splits, quads: (tile == Tile::Quad).then(quads) }
    }

    /// Pieces of an edge of the base.
    pub(super) fn pieces(&self) -> usize {
        self.pieces
    }

    fn triangles(&self) -> Tiling<'_> {
        Tiling::new(&self.base, Tile::Triangle, self.pieces)
    }

    /// Number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.quads.as_ref().map_or_else(|| self.triangles().n_vertices(), Grid::n_vertices)
    }

    /// Number of points inside a face of the base.
    pub(super) fn inner_of(&self, face: usize) -> usize {
        self.quads.as_ref().map_or_else(|| Tile::Triangle.inner_vertices(self.pieces), |grid| grid.inner_of(face))
    }

    /// The number of a point of a patch: of a face of the base where all of them are quads or triangles, else of that
    /// face of the base's first split.
    pub(super) fn vertex(&self, patch: usize, place: [isize; 2]) -> u32 {
        let place = place.map(isize::cast_unsigned);
        match &self.quads {
            Some(grid) => grid.patch_vertex(patch, place),
            None => self.triangles().vertex(patch, place),
        }
    }

    /// The numbers of the points of a patch in one column and consecutive rows, from an inner point on.
    pub(super) fn rows(&self, patch: usize, [i, j]: [usize; 2], n: usize) -> impl Iterator<Item = u32> {
        let vertex = |j: usize| self.vertex(patch, [i, j].map(usize::cast_signed));
        let first = if n > 0 { vertex(j) } else { 0 };
        // the rows of quads have all as many points, those of triangles one less each
        let step = if n > 1 { vertex(j + 1).wrapping_sub(first) } else { 0 };
        let less = u32::from(self.quads.is_none());
        let next = move |&(at, step): &(u32, u32)| Some((at.wrapping_add(step), step.wrapping_sub(less)));
        std::iter::successors(Some((first, step)), next).map(|(at, _)| at).take(n)
    }
}
