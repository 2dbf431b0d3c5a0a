//! Which tiles triangles touch, and which side of them is seen, found for several triangles at once.

#![expect(clippy::cast_sign_loss, reason = "tiles are clamped to the picture")]

use multiversion::multiversion;

use super::bins::{TILE_PX, TileGrid, TileRect};
use super::project::{BEHIND, FAR_OUT, STEPS_A_PIXEL};
use super::triangle_block::{BLOCK_TRIANGLES, BlockRow, TriangleBlock};

/// What becomes of the triangles of a block.
pub(super) struct Admissions {
    fate: BlockRow<u32>,
    /// The first tile, and the numbers of further columns and rows.
    first: BlockRow<u32>,
    across: BlockRow<u32>,
    down: BlockRow<u32>,
    nearest: BlockRow<f32>,
}

/// What becomes of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Admission {
    /// It has no area, or lies outside the picture.
    Unseen,
    /// It must be clipped.
    Cut,
    /// It may touch these tiles; its front or its back is seen, and its largest depth is given.
    Seen { is_back: bool, rect: TileRect, nearest: f32 },
}

// fates as numbers, for vectors
const UNSEEN: u32 = 0;
const CUT: u32 = 1;
const FRONT: u32 = 2;
const BACK: u32 = 3;

impl Admissions {
    /// Looks at the triangles of a block.
    pub(super) fn of(grid: TileGrid, block: &TriangleBlock) -> Self {
        admissions(grid, block)
    }

    /// Returns what becomes of a triangle of the block.
    #[inline]
    pub(super) fn at(&self, i: usize) -> Admission {
        let more = |number: u32| u16::try_from(number).unwrap_or(u16::MAX);
        match self.fate[i] {
            UNSEEN => Admission::Unseen,
            CUT => Admission::Cut,
            side => Admission::Seen {
                is_back: side == BACK,
                rect: TileRect { first: self.first[i], across: more(self.across[i]), down: more(self.down[i]) },
                nearest: self.nearest[i],
            },
        }
    }
}

/// Finds the tiles of a block of triangles. There are no branches, so that it is vector code; wider vectors give the
/// same bits.
#[multiversion(targets("x86_64+avx2"))]
fn admissions(grid: TileGrid, block: &TriangleBlock) -> Admissions {
    let (columns, rows) = (i32::from(grid.columns), i32::from(grid.rows));
    let row = [0; BLOCK_TRIANGLES];
    let mut found = Admissions { fate: row, first: row, across: row, down: row, nearest: [0.0; BLOCK_TRIANGLES] };
    let mut area = [0.0; BLOCK_TRIANGLES];
    for i in 0..BLOCK_TRIANGLES {
        area[i] = block.area(i);
    }
    for i in 0..BLOCK_TRIANGLES {
        let pixels = |u: &[BlockRow<i32>; 3]| {
            let [least, most] = TriangleBlock::range(u, i);
            [least.div_euclid(STEPS_A_PIXEL), most.div_euclid(STEPS_A_PIXEL)]
        };
        let ([left, right], [top, bottom]) = (pixels(&block.x), pixels(&block.y));
        let tile = |pixel: i32| pixel.max(0).div_euclid(TILE_PX);
        let (first_column, first_row) = (tile(left), tile(top));
        found.first[i] = (first_row * columns + first_column) as u32;
        found.across[i] = (tile(right).min(columns - 1) - first_column) as u32;
        found.down[i] = (tile(bottom).min(rows - 1) - first_row) as u32;
        [_, found.nearest[i]] = TriangleBlock::range(&block.depth, i);
        let (a, b, c) = (block.sides[0][i], block.sides[1][i], block.sides[2][i]);
        let is_outside = a & b & c & !FAR_OUT != 0;
        let is_cut = (a | b | c) & (BEHIND | FAR_OUT) != 0;
        let is_in = (right >= 0) & (bottom >= 0) & (first_column < columns) & (first_row < rows);
        let side = if area[i] > 0.0 { BACK } else { FRONT };
        let side = if is_in & (area[i] != 0.0) { side } else { UNSEEN };
        let fate = if is_cut { CUT } else { side };
        found.fate[i] = if is_outside { UNSEEN } else { fate };
    }
    found
}
