//! Which tiles triangles touch, and which side of them is seen, found for several triangles at once.

#![expect(clippy::cast_sign_loss, reason = "tiles are clamped to the picture")]
#![expect(
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop,
    reason = "loops without branches are vector code"
)]

use multiversion::multiversion;

use super::bins::{TILE_PX, TileGrid, TileRect};
use super::project::{BEHIND, FAR_OUT, STEPS_A_PIXEL};
use super::triangle_block::{BLOCK_TRIANGLES, BlockRow, TriangleBlock};

/// What becomes of the triangles of a block.
pub(super) struct BlockFates {
    fate: BlockRow<u32>,
    /// The first tile, and the numbers of further columns and rows, packed.
    first: BlockRow<u32>,
    further: BlockRow<u32>,
    nearest: BlockRow<f32>,
}

/// What becomes of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TriangleFate {
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

impl BlockFates {
    /// Looks at the triangles of a block.
    pub(super) fn of(grid: TileGrid, block: &TriangleBlock) -> Self {
        fates(grid, block)
    }

    /// Returns what becomes of a triangle of the block.
    #[inline]
    pub(super) fn at(&self, i: usize) -> TriangleFate {
        match self.fate[i] {
            UNSEEN => TriangleFate::Unseen,
            CUT => TriangleFate::Cut,
            side => TriangleFate::Seen {
                is_back: side == BACK,
                rect: TileRect { first: self.first[i], further: self.further[i] },
                nearest: self.nearest[i],
            },
        }
    }
}

/// Finds the tiles of a block of triangles. There are no branches, so that it is vector code; wider vectors give the
/// same bits.
#[multiversion(targets("x86_64+avx2"))]
fn fates(grid: TileGrid, block: &TriangleBlock) -> BlockFates {
    let (columns, rows) = (i32::from(grid.columns), i32::from(grid.rows));
    let row = [0; BLOCK_TRIANGLES];
    let mut found = BlockFates { fate: row, first: row, further: row, nearest: [0.0; BLOCK_TRIANGLES] };
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
        let across = tile(right).min(columns - 1) - first_column;
        let down = tile(bottom).min(rows - 1) - first_row;
        found.further[i] = TileRect::packed(across as u32, down as u32);
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

#[cfg(test)]
mod tests {
    use proptest::array::uniform9;
    use proptest::collection;
    use proptest::prelude::*;

    use super::*;
    use crate::raster::project::{ABOVE, LEFT, RIGHT, Vertex};
    use crate::raster::triangle::{area, touched};

    const NONE: Vertex = Vertex { x: 0, y: 0, depth: 0.0, sides: BEHIND };

    fn fate(grid: TileGrid, triangles: &[[Vertex; 3]]) -> Vec<TriangleFate> {
        let mut block = TriangleBlock::default();
        (0..).zip(triangles).for_each(|(id, corners)| block.push(corners.each_ref(), id));
        let fates = BlockFates::of(grid, &block);
        (0..triangles.len()).map(|i| fates.at(i)).collect()
    }

    proptest! {
        #[test]
        fn triangles_of_a_block_are_admitted_as_each_of_them_alone(
            numbers in collection::vec(uniform9(-70_000_i32..400_000), 1..=BLOCK_TRIANGLES),
            (width, height) in (1..1200_u32, 1..1200_u32),
        ) {
            let grid = TileGrid::of(width, height);
            let depth = |number: i32| i16::try_from(number % 1000).expect("it is small").into();
            let corner = |x: i32, y: i32, number: i32| Vertex { x, y, depth: depth(number), sides: 0 };
            let triangles: Vec<[Vertex; 3]> = numbers
                .iter()
                .map(|&[a, b, c, d, e, f, g, h, i]| [corner(a, b, g), corner(c, d, h), corner(e, f, i)])
                .collect();
            for (corners, fate) in triangles.iter().zip(fate(grid, &triangles)) {
                let nearest = corners[0].depth.max(corners[1].depth).max(corners[2].depth);
                let rect = TileRect::of(grid, touched(corners)).filter(|_| area(corners) != 0);
                let seen = |rect| TriangleFate::Seen { is_back: area(corners) > 0, rect, nearest };
                prop_assert_eq!(fate, rect.map_or(TriangleFate::Unseen, seen));
            }
        }
    }

    #[test]
    fn triangles_beyond_one_side_are_unseen_and_those_that_reach_too_far_are_cut() {
        let grid = TileGrid::of(64, 64);
        let with = |sides: [u32; 3]| {
            let places = [[256, 256], [5120, 256], [256, 5120]];
            [0, 1, 2].map(|k| Vertex { x: places[k][0], y: places[k][1], depth: 0.5, sides: sides[k] })
        };
        let fates = [
            (with([LEFT, LEFT | ABOVE, LEFT]), TriangleFate::Unseen),
            (with([BEHIND; 3]), TriangleFate::Unseen),
            (with([LEFT | FAR_OUT, RIGHT, 0]), TriangleFate::Cut),
            (with([FAR_OUT; 3]), TriangleFate::Cut),
            (with([0, BEHIND, 0]), TriangleFate::Cut),
            ([with([0; 3])[0]; 3], TriangleFate::Unseen),
            ([NONE; 3], TriangleFate::Unseen),
        ];
        let (triangles, expected): (Vec<_>, Vec<_>) = fates.into_iter().unzip();
        assert_eq!(fate(grid, &triangles), expected);
    }
}
