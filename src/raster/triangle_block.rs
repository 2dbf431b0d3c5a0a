//! Triangles prepared for a tile several at a time, each number of all of them in one vector.

#![expect(clippy::cast_possible_truncation, reason = "depths need no more than the precision of f32")]
#![expect(clippy::cast_possible_wrap, reason = "a tile is some dozen pixels wide")]
#![expect(
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop,
    reason = "loops without branches are vector code"
)]

use multiversion::multiversion;

use super::project::{BEHIND, STEPS_A_PIXEL, Vertex};
use super::triangle::{
    CUT_PX, NEAR_ORIGIN, SAMPLE_PLACES, SAMPLES, TILE_SIDE, TileEdge, TriangleSetup, edge, high_pixel, low_pixel,
};

/// Triangles looked at together: eight numbers of 32 bits fill a vector register of 256 bits. Half of it leaves half of
/// that empty; twice of it needs two registers for each number.
pub(super) const BLOCK_TRIANGLES: usize = 8;

/// A number for each triangle of a block.
pub(super) type BlockRow<T> = [T; BLOCK_TRIANGLES];

/// The corners of a block of triangles, three rows each.
#[derive(Debug)]
pub(super) struct TriangleBlock {
    pub(super) x: [BlockRow<i32>; 3],
    pub(super) y: [BlockRow<i32>; 3],
    pub(super) depth: [BlockRow<f32>; 3],
    pub(super) sides: [BlockRow<u32>; 3],
    pub(super) id: BlockRow<u32>,
    /// The number of triangles.
    pub(super) n: usize,
}

/// A block of triangles prepared for a tile.
pub(super) struct BlockSetup {
    /// Pixels of the tile that hold a sample of the bounding box, bounds included; none if left is right of right, or
    /// top below bottom.
    left: BlockRow<i32>,
    top: BlockRow<i32>,
    right: BlockRow<i32>,
    bottom: BlockRow<i32>,
    /// The column at which edge functions are given, see [`TriangleSetup`].
    first: BlockRow<i32>,
    /// The largest depth.
    pub(super) nearest: BlockRow<f32>,
    farthest: BlockRow<f32>,
    /// Twice the area in square steps.
    area: BlockRow<f64>,
    /// Whether the edge functions count; else corners are too far from the tile.
    is_near: BlockRow<bool>,
    edges: [BlockRow<i32>; 3],
    steps_right: [BlockRow<i32>; 3],
    steps_down: [BlockRow<i32>; 3],
    depth: [BlockRow<f32>; SAMPLES],
    slope: [BlockRow<f32>; 2],
}

/// The places of the corners of a block of triangles, turned so that areas are positive.
struct CornerPlaces {
    x: [BlockRow<i32>; 3],
    y: [BlockRow<i32>; 3],
}

impl CornerPlaces {
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn of(block: &TriangleBlock, areas: &BlockRow<f64>) -> Self {
        let (mut x, mut y) = (block.x, block.y);
        for i in 0..BLOCK_TRIANGLES {
            let is_turned = areas[i] < 0.0;
            for u in [&mut x, &mut y] {
                (u[1][i], u[2][i]) = if is_turned { (u[2][i], u[1][i]) } else { (u[1][i], u[2][i]) };
            }
        }
        Self { x, y }
    }
}

impl Default for TriangleBlock {
    fn default() -> Self {
        let (none, zero) = ([[0; BLOCK_TRIANGLES]; 3], [[0.0; BLOCK_TRIANGLES]; 3]);
        Self { x: none, y: none, depth: zero, sides: [[BEHIND; BLOCK_TRIANGLES]; 3], id: [0; BLOCK_TRIANGLES], n: 0 }
    }
}

impl TriangleBlock {
    /// Adds a triangle; there must be room.
    #[inline]
    pub(super) fn push(&mut self, corners: [&Vertex; 3], id: u32) {
        let i = self.n % BLOCK_TRIANGLES;
        for (k, corner) in corners.into_iter().enumerate() {
            (self.x[k][i], self.y[k][i]) = (corner.x, corner.y);
            (self.depth[k][i], self.sides[k][i]) = (corner.depth, corner.sides);
        }
        self.id[i] = id;
        self.n = i + 1;
    }

    /// Returns whether there is no room for another triangle.
    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.n == BLOCK_TRIANGLES
    }

    /// Returns twice the signed area of triangle `i` in square steps. Coordinates have 23 bits, so that it is exact.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn area(&self, i: usize) -> f64 {
        let way = |u: &[BlockRow<i32>; 3], k: usize| f64::from(u[k][i] - u[0][i]);
        way(&self.x, 1) * way(&self.y, 2) - way(&self.x, 2) * way(&self.y, 1)
    }

    /// Returns the least and the largest number of triangle `i`.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn range<T: Copy + PartialOrd>(numbers: &[BlockRow<T>; 3], i: usize) -> [T; 2] {
        let less = |a: T, b: T| if b < a { b } else { a };
        let more = |a: T, b: T| if b > a { b } else { a };
        let [a, b, c] = [numbers[0][i], numbers[1][i], numbers[2][i]];
        [less(less(a, b), c), more(more(a, b), c)]
    }
}

/// Prepares triangles for the tile whose first pixel is `origin`; wider vectors give the same bits. It is not part of
/// what draws them, since AVX-512 makes that faster and this slower.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn prepared(block: &TriangleBlock, origin: [i32; 2]) -> BlockSetup {
    BlockSetup::of(block, origin)
}

impl BlockSetup {
    /// Prepares triangles like [`prepared`]. There are no branches but for triangles far from the tile, so that it is
    /// vector code.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn of(block: &TriangleBlock, origin: [i32; 2]) -> Self {
        let (row, zero) = ([0; BLOCK_TRIANGLES], [0.0; BLOCK_TRIANGLES]);
        let mut setup = Self {
            left: row,
            top: row,
            right: row,
            bottom: row,
            first: row,
            nearest: zero,
            farthest: zero,
            area: [0.0; BLOCK_TRIANGLES],
            is_near: [false; BLOCK_TRIANGLES],
            edges: [row; 3],
            steps_right: [row; 3],
            steps_down: [row; 3],
            depth: [zero; SAMPLES],
            slope: [zero; 2],
        };
        for i in 0..BLOCK_TRIANGLES {
            setup.area[i] = block.area(i);
            [setup.farthest[i], setup.nearest[i]] = TriangleBlock::range(&block.depth, i);
        }
        let corner = origin.map(|pixel| pixel * STEPS_A_PIXEL);
        for i in 0..BLOCK_TRIANGLES {
            let ([least_x, most_x], [least_y, most_y]) =
                (TriangleBlock::range(&block.x, i), TriangleBlock::range(&block.y, i));
            setup.left[i] = (low_pixel(least_x) - origin[0]).max(0);
            setup.top[i] = (low_pixel(least_y) - origin[1]).max(0);
            // without area, it covers nothing
            let right = (high_pixel(most_x) - origin[0]).min(TILE_SIDE - 1);
            setup.right[i] = if setup.area[i] == 0.0 { -1 } else { right };
            setup.bottom[i] = (high_pixel(most_y) - origin[1]).min(TILE_SIDE - 1);
            let width = setup.right[i] - setup.left[i] + 1;
            let first = (TILE_SIDE - ((width + 1) & !1)).min(setup.left[i]);
            setup.first[i] = if width < CUT_PX as i32 { first } else { setup.left[i] };
            let is_near = |least: i32, most: i32| (least > -NEAR_ORIGIN) & (most < NEAR_ORIGIN);
            setup.is_near[i] =
                is_near(least_x - corner[0], most_x - corner[0]) & is_near(least_y - corner[1], most_y - corner[1]);
        }
        let places = CornerPlaces::of(block, &setup.area);
        setup.add_edges(&places, corner);
        setup.add_depths(block, corner);
        if setup.is_near[..block.n.min(BLOCK_TRIANGLES)].contains(&false) {
            setup.add_far_edges(&places, origin);
        }
        setup
    }

    /// Sets the edge functions at the corner of the pixel in column `first` and in the first row, for triangles whose
    /// corners are near: there, every edge is taken to cross the tile.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn add_edges(&mut self, corners: &CornerPlaces, corner: [i32; 2]) {
        for k in 0..3 {
            let next = (k + 1) % 3;
            for i in 0..BLOCK_TRIANGLES {
                let (x, y) = (corners.x[k][i], corners.y[k][i]);
                let (dx, dy) = (corners.x[next][i] - x, corners.y[next][i] - y);
                let counts = (dy > 0) | ((dy == 0) & (dx > 0));
                let value = dx.wrapping_mul(corner[1] - y).wrapping_sub(dy.wrapping_mul(corner[0] - x));
                let value = value.wrapping_sub(i32::from(!counts)) >> (STEPS_A_PIXEL / 8).trailing_zeros();
                let first = (-dy).wrapping_mul(8 * self.first[i]).wrapping_add(dx.wrapping_mul(8 * self.top[i]));
                self.edges[k][i] = value.wrapping_add(first);
                (self.steps_right[k][i], self.steps_down[k][i]) = (-dy, dx);
            }
        }
    }

    /// Sets the depths at the samples of the first pixel of the box and their growth.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn add_depths(&mut self, block: &TriangleBlock, corner: [i32; 2]) {
        let mut first = [0.0; BLOCK_TRIANGLES];
        let mut slope = [[0.0; BLOCK_TRIANGLES]; 2];
        for i in 0..BLOCK_TRIANGLES {
            let rise = |k: usize| f64::from(block.depth[k][i]) - f64::from(block.depth[0][i]);
            let way = |u: &[BlockRow<i32>; 3], k: usize| f64::from(u[k][i] - u[0][i]);
            let (bx, by, cx, cy) = (way(&block.x, 1), way(&block.y, 1), way(&block.x, 2), way(&block.y, 2));
            let scale = f64::from(STEPS_A_PIXEL) / self.area[i];
            slope[0][i] = (rise(1) * cy - rise(2) * by) * scale;
            slope[1][i] = (rise(2) * bx - rise(1) * cx) * scale;
            let x = f64::from(corner[0] + self.left[i] * STEPS_A_PIXEL - block.x[0][i]);
            let y = f64::from(corner[1] + self.top[i] * STEPS_A_PIXEL - block.y[0][i]);
            let pixels = 1.0 / f64::from(STEPS_A_PIXEL);
            first[i] = f64::from(block.depth[0][i]) + slope[0][i] * (x * pixels) + slope[1][i] * (y * pixels);
        }
        for (s, [x, y]) in SAMPLE_PLACES.into_iter().enumerate() {
            let (x, y) = (f64::from(x), f64::from(y));
            for i in 0..BLOCK_TRIANGLES {
                self.depth[s][i] = (first[i] + slope[0][i] / 8.0 * x + slope[1][i] / 8.0 * y) as f32;
            }
        }
        for k in 0..2 {
            for i in 0..BLOCK_TRIANGLES {
                self.slope[k][i] = slope[k][i] as f32;
            }
        }
    }

    /// Returns the pixels of triangle `i` in the tile: left, top, right, bottom, bounds included; `None` if there are
    /// none.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn pixels(&self, i: usize) -> Option<[i32; 4]> {
        let [left, top, right, bottom] = [self.left[i], self.top[i], self.right[i], self.bottom[i]];
        (left <= right && top <= bottom).then_some([left, top, right, bottom])
    }

    /// Returns triangle `i`, which has pixels in the tile.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn at(&self, i: usize) -> TriangleSetup {
        let of = |rows: &[BlockRow<i32>; 3]| [rows[0][i], rows[1][i], rows[2][i]];
        TriangleSetup {
            edges: of(&self.edges),
            right: of(&self.steps_right),
            down: of(&self.steps_down),
            first: self.first[i],
            pixels: [self.left[i], self.top[i], self.right[i], self.bottom[i]],
            depth: [self.depth[0][i], self.depth[1][i], self.depth[2][i], self.depth[3][i]],
            slope: [self.slope[0][i], self.slope[1][i]],
            range: [self.farthest[i], self.nearest[i]],
        }
    }

    /// Sets the edge functions of triangles with corners far from the tile; those outside of it have no pixels there.
    #[cold]
    #[inline(never)]
    fn add_far_edges(&mut self, corners: &CornerPlaces, origin: [i32; 2]) {
        for i in 0..BLOCK_TRIANGLES {
            if self.is_near[i] || self.pixels(i).is_none() {
                continue;
            }
            for k in 0..3 {
                let at = |k: usize| [corners.x[k][i], corners.y[k][i]];
                let (value, right, down) = match edge(at(k), at((k + 1) % 3), origin) {
                    TileEdge::Inside => (0, 0, 0),
                    TileEdge::Crossing(value, right, down) => (value, right, down),
                    TileEdge::Outside => {
                        self.right[i] = -1;
                        break;
                    }
                };
                (self.steps_right[k][i], self.steps_down[k][i]) = (right, down);
                let first = (8 * right).wrapping_mul(self.first[i]).wrapping_add((8 * down).wrapping_mul(self.top[i]));
                self.edges[k][i] = value.wrapping_add(first);
            }
        }
    }
}
