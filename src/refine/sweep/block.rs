//! Blocks: the parts of patches whose points are computed at a time, and who receives the points.

use std::ops::RangeInclusive;

use super::grid::{GridSize, Planes};
use super::lattice::CornerFrame;
use super::program::Sweep;
use crate::shape::tile::Tile;

/// A part of a patch in some round: a grid whose first cell is at `at`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) patch: usize,
    pub(super) at: [usize; 2],
    /// Number of pieces of the patch's side.
    pub(super) pieces: usize,
}

impl Block {
    /// Returns the range of vertices on a side of the patch that lie in the block, which has `cells` cells per side.
    pub(super) fn on_side(self, tile: Tile, side: usize, cells: usize) -> Option<RangeInclusive<usize>> {
        if cells == self.pieces {
            return Some(0..=cells);
        }
        let frame = CornerFrame::new(tile, self.pieces, side, 0);
        let (start, along) = (frame.corner(), frame.along());
        let (mut least, mut most) = (0, self.pieces.cast_signed());
        for axis in 0..2 {
            let low = self.at[axis].cast_signed() - start[axis];
            let high = low + cells.cast_signed();
            match along[axis] {
                1 => (least, most) = (least.max(low), most.min(high)),
                -1 => (least, most) = (least.max(-high), most.min(-low)),
                _ if low > 0 || high < 0 => return None,
                _ => {}
            }
        }
        (least <= most).then(|| least.unsigned_abs()..=most.unsigned_abs())
    }

    /// Converts a place of the patch into one relative to the block.
    pub(super) fn inside(self, place: [isize; 2]) -> [isize; 2] {
        [0, 1].map(|axis| place[axis] - self.at[axis].cast_signed())
    }

    /// Returns the block after a split, at the same part of the patch.
    pub(super) fn refined(self) -> Self {
        Self { at: self.at.map(|at| 2 * at), pieces: 2 * self.pieces, ..self }
    }
}

/// Blocks at the same part of consecutive patches, whose grids are refined together.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlockStack {
    pub(super) first: Block,
    /// Number of patches.
    pub(super) patches: usize,
    /// Number of grids, at least as many; those without a patch mean nothing.
    pub(super) grids: usize,
}

impl BlockStack {
    /// Returns each block with its place in the stack.
    pub(super) fn blocks(self) -> impl Iterator<Item = (usize, Block)> {
        (0..self.patches).map(move |place| (place, Block { patch: self.first.patch + place, ..self.first }))
    }
}

/// A consumer of the points of blocks.
pub(super) trait BlockReceiver<const W: usize> {
    /// Returns whether any point of a block with `cells` cells per side is needed.
    fn wants(&self, block: Block, cells: usize) -> bool;

    /// Appends the spans of memory where most points of a block will be written, if they are to be fetched ahead;
    /// `size` is that of the block's grid before the last round.
    fn expect<'a>(&'a self, _: &Sweep, _size: GridSize, _block: Block, _spans: &mut Vec<&'a [f64]>) {}

    /// Receives the points of blocks; `size` is that of their grids before the last round.
    fn take(&mut self, sweep: &Sweep, size: GridSize, stack: BlockStack, planes: &Planes);
}
