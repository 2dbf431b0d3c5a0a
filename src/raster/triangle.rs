//! Coverage and depth of triangles in one tile: whole-number edge functions at four samples a pixel.
//!
//! Every sample lies on the lattice of eighths of a pixel, so an edge function divided by the 32 sub-pixel steps of an
//! eighth and rounded down keeps its sign at every sample, and fits 32 bits for every edge that crosses the tile. An
//! edge that two triangles share is counted for exactly one of them. Source: J. Pineda, SIGGRAPH 1988, 17-20.

#![expect(clippy::cast_possible_truncation, reason = "values are bounded by the guard band, see `project`")]
#![expect(clippy::cast_possible_wrap, reason = "a tile is some dozen pixels wide")]
#![expect(clippy::cast_sign_loss, reason = "pixels are clamped to the tile")]
#![expect(clippy::cast_precision_loss, reason = "pixels are clamped to the tile and areas stay below 2^48")]
#![expect(clippy::needless_range_loop, reason = "loops over lanes are vector code")]

use std::ops::Range;

use super::bins::TILE;
use super::project::{STEPS_A_PIXEL, Vertex};

/// Samples a pixel.
/// Where they see an edge, the pixel is looked at more closely, see `fine`. Two would miss thin things, eight take
/// twice the time and memory of a tile.
pub(super) const SAMPLES: usize = 4;

/// Places of the samples in eighths of a pixel, right and down: no two in one row, column or diagonal.
pub(super) const SAMPLE_PLACES: [[i32; 2]; SAMPLES] = [[3, 1], [7, 3], [1, 5], [5, 7]];

/// Owner of a sample that no triangle covers.
pub(super) const NOBODY: u32 = u32::MAX;

const EIGHTH_STEPS: i32 = STEPS_A_PIXEL / 8;
/// Width and height of a tile in pixels.
pub(super) const TILE_SIDE: i32 = TILE as i32;

/// Rows of at least so many pixels are cut to what a triangle may cover of them; below, that takes longer than it
/// spares.
/// Half of it cuts rows for which that takes longer, twice of it looks at pixels in vain; pictures are the same.
pub(super) const CUT_PX: usize = 12;

/// Pixels that are looked at in the time that it takes to cut a row.
/// It only says what cutting counts: half and twice of it halve and double its share of the predicted time.
pub(super) const ROW_PX: u64 = 8;

/// A triangle prepared for a tile; depths are those of the first pixel of its bounding box.
pub(super) struct TriangleSetup {
    /// The column at which edge functions are given: the left one of the box, or that before where narrow rows with an
    /// odd number of pixels, which are filled in pairs from there, would leave the tile.
    pub(super) first: i32,
    /// The edge functions at the corner of the pixel in that column and in the first row; not negative inside.
    pub(super) edges: [i32; 3],
    /// Their steps for an eighth of a pixel.
    pub(super) right: [i32; 3],
    pub(super) down: [i32; 3],
    /// Pixels of the tile, bounds included: left, top, right, bottom.
    pub(super) pixels: [i32; 4],
    pub(super) depth: [f32; SAMPLES],
    pub(super) slope: [f32; 2],
    pub(super) range: [f32; 2],
}

/// Samples of the two pixels that are looked at together: eight numbers of 32 bits fill a vector register of 256 bits.
/// Half of it leaves half of that empty; twice of it looks at more pixels beside small triangles in vain.
const PAIR_SAMPLES: usize = 2 * SAMPLES;

/// Right and down for each sample of two pixels, eighths of a pixel.
pub(super) type PlaceRows = [[i32; PAIR_SAMPLES]; 2];

/// [`SAMPLE_PLACES`] in a pixel and in that to the right, right and down. Those who draw keep a copy in memory, as
/// numbers that the compiler knows are multiplied one by one, by shifts and sums, and not in vectors.
pub(super) const PLACE_ROWS: PlaceRows = {
    let mut rows = [[0; PAIR_SAMPLES]; 2];
    let mut lane = 0;
    while lane < PAIR_SAMPLES {
        let [right, down] = SAMPLE_PLACES[lane % SAMPLES];
        [rows[0][lane], rows[1][lane]] = [right + 8 * (lane / SAMPLES) as i32, down];
        lane += 1;
    }
    rows
};

/// Returns `n` pairs of pixels from pixel `first` of row `y` of a tile on.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
fn row_of<'a>(
    depth: &'a mut [[f32; SAMPLES]],
    owner: &'a mut [[u32; SAMPLES]],
    [first, y]: [i32; 2],
    n: usize,
) -> impl Iterator<Item = (&'a mut [[f32; SAMPLES]; 2], &'a mut [[u32; SAMPLES]; 2])> {
    let first = (y * TILE_SIDE + first) as usize;
    let row = first..first + 2 * n;
    depth[row.clone()].as_chunks_mut().0.iter_mut().zip(owner[row].as_chunks_mut().0)
}

/// Gives triangle number `id` the samples of a pixel that it covers (`outside` is not negative there) and where it is
/// the nearest. There are no branches, so that all samples are one vector.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn cover<const N: usize>(
    outside: [i32; N],
    z: [f32; N],
    id: u32,
    depth: &mut [f32; N],
    owner: &mut [u32; N],
) {
    let mask = |is: bool| u32::from(is).wrapping_neg();
    let seen: [u32; N] = std::array::from_fn(|s| {
        mask(outside[s] >= 0) & (mask(z[s] > depth[s]) | (mask(z[s] >= depth[s]) & mask(id < owner[s])))
    });
    *depth = std::array::from_fn(|s| f32::from_bits(z[s].to_bits() & seen[s] | depth[s].to_bits() & !seen[s]));
    *owner = std::array::from_fn(|s| id & seen[s] | owner[s] & !seen[s]);
}

/// Returns twice the signed area of a triangle in square steps.
#[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
#[inline(always)]
pub(super) fn area(&[a, b, c]: &[Vertex; 3]) -> i64 {
    i64::from(b.x - a.x) * i64::from(c.y - a.y) - i64::from(c.x - a.x) * i64::from(b.y - a.y)
}

/// Returns the first pixel that has a sample from this place on, in steps.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn low_pixel(steps: i32) -> i32 {
    (steps - 7 * EIGHTH_STEPS + STEPS_A_PIXEL - 1).div_euclid(STEPS_A_PIXEL)
}

/// Returns the last pixel that has a sample up to this place, in steps.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn high_pixel(steps: i32) -> i32 {
    (steps - EIGHTH_STEPS).div_euclid(STEPS_A_PIXEL)
}

/// Returns those pixels of a box (left, top, right, bottom, bounds included) that lie in the tile at `origin`, counted
/// from there; `None` if there are none.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn in_tile([left, top, right, bottom]: [i32; 4], origin: [i32; 2]) -> Option<[i32; 4]> {
    let last = TILE_SIDE - 1;
    let (left, right) = ((left - origin[0]).max(0), (right - origin[0]).min(last));
    let (top, bottom) = ((top - origin[1]).max(0), (bottom - origin[1]).min(last));
    (left <= right && top <= bottom).then_some([left, top, right, bottom])
}

/// Pixels that a bounding box touches: left, top, right, bottom, bounds included.
pub(super) fn touched(&[a, b, c]: &[Vertex; 3]) -> [i32; 4] {
    let pixel = |u: i32| u.div_euclid(STEPS_A_PIXEL);
    let (left, top) = (a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y));
    [pixel(left), pixel(top), pixel(a.x.max(b.x).max(c.x)), pixel(a.y.max(b.y).max(c.y))]
}

/// One edge in a tile.
pub(super) enum TileEdge {
    /// The tile lies outside.
    Outside,
    /// The tile lies inside.
    Inside,
    /// Value at the origin of the tile and steps for each eighth of a pixel, right and down.
    Crossing(i32, i32, i32),
}

/// How far from the origin of a tile corners may lie whose edge functions have 31 bits before they are divided.
/// Half of it leaves some triangles of a few pixels to the general way; twice of it overflows.
pub(super) const NEAR_ORIGIN: i32 = 1 << 14;

/// Returns how the edge from `a` to `b`, in steps, lies to the tile whose first pixel is `origin`.
pub(super) fn edge(a: [i32; 2], b: [i32; 2], origin: [i32; 2]) -> TileEdge {
    let (dx, dy) = (i64::from(b[0] - a[0]), i64::from(b[1] - a[1]));
    let counts = dy > 0 || (dy == 0 && dx > 0);
    let x = i64::from(origin[0] * STEPS_A_PIXEL - a[0]);
    let y = i64::from(origin[1] * STEPS_A_PIXEL - a[1]);
    let value = (dx * y - dy * x - i64::from(!counts)) >> EIGHTH_STEPS.trailing_zeros();
    let last = i64::from(8 * TILE_SIDE - 1);
    if value + (-dy * last).max(0) + (dx * last).max(0) < 0 {
        TileEdge::Outside
    } else if value + (-dy * last).min(0) + (dx * last).min(0) >= 0 {
        TileEdge::Inside
    } else {
        TileEdge::Crossing(value as i32, -dy as i32, dx as i32)
    }
}

impl TriangleSetup {
    /// Returns the number of pixels in a row.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn width(&self) -> usize {
        (self.pixels[2] - self.pixels[0] + 1) as usize
    }

    /// Gives triangle number `id` the samples of the tile that it covers and where it is the nearest. Returns the
    /// number of pixels looked at. The places are [`PLACE_ROWS`].
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    pub(super) fn fill(
        &self,
        id: u32,
        depth: &mut [[f32; SAMPLES]],
        owner: &mut [[u32; SAMPLES]],
        places: &PlaceRows,
    ) -> u64 {
        let [left, top, _, bottom] = self.pixels;
        let n = self.width().div_ceil(2);
        let mut edges = self.edges_at(places, self.edges);
        for (row, y) in (0_i32..).zip(top..=bottom) {
            self.fill_row(id, edges, [self.first - left, row], row_of(depth, owner, [self.first, y], n));
            for k in 0..3 {
                for lane in 0..PAIR_SAMPLES {
                    edges[k][lane] = edges[k][lane].wrapping_add(8 * self.down[k]);
                }
            }
        }
        self.width() as u64 * (bottom - top + 1) as u64
    }

    /// Does what [`TriangleSetup::fill`] does, after cutting each row to what the triangle may cover of it. For each
    /// row, [`ROW_PX`] are counted in addition.
    #[expect(clippy::inline_always, reason = "only code inside of `fill_wide` uses its wider vectors")]
    #[inline(always)]
    pub(super) fn fill_cut(
        &self,
        id: u32,
        depth: &mut [[f32; SAMPLES]],
        owner: &mut [[u32; SAMPLES]],
        places: &PlaceRows,
    ) -> u64 {
        let [left, top, _, bottom] = self.pixels;
        let mut pixels = 0;
        for (row, y) in (0_i32..).zip(top..=bottom) {
            let span = self.span(row, self.width());
            pixels += span.len() as u64 + ROW_PX;
            let n = span.len().div_ceil(2);
            let first = (left + span.start as i32).min(TILE_SIDE - 2 * n as i32);
            let mut edges = self.edges;
            for k in 0..3 {
                let across = (8 * self.right[k]).wrapping_mul(first - left);
                edges[k] = edges[k].wrapping_add(across).wrapping_add((8 * self.down[k]).wrapping_mul(row));
            }
            let edges = self.edges_at(places, edges);
            self.fill_row(id, edges, [first - left, row], row_of(depth, owner, [first, y], n));
        }
        pixels
    }

    /// Returns the edge functions at the samples of a pair of pixels, given those at the corner of the first.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn edges_at(&self, places: &PlaceRows, corner: [i32; 3]) -> [[i32; PAIR_SAMPLES]; 3] {
        let mut edges = [[0; PAIR_SAMPLES]; 3];
        for k in 0..3 {
            for lane in 0..PAIR_SAMPLES {
                let across = self.right[k].wrapping_mul(places[0][lane]);
                let along = self.down[k].wrapping_mul(places[1][lane]);
                edges[k][lane] = corner[k].wrapping_add(across).wrapping_add(along);
            }
        }
        edges
    }

    /// Fills a row, two pixels at a time, given the edge functions of the first pair and its column and row from the
    /// first pixel of the triangle.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn fill_row<'a>(
        &self,
        id: u32,
        mut edges: [[i32; PAIR_SAMPLES]; 3],
        [column, row]: [i32; 2],
        pairs: impl Iterator<Item = (&'a mut [[f32; SAMPLES]; 2], &'a mut [[u32; SAMPLES]; 2])>,
    ) {
        let lift = row as f32 * self.slope[1];
        let (mut base, mut columns) = ([0.0; PAIR_SAMPLES], [0.0; PAIR_SAMPLES]);
        for lane in 0..PAIR_SAMPLES {
            base[lane] = self.depth[lane % SAMPLES] + lift;
            columns[lane] = (column + (lane / SAMPLES) as i32) as f32;
        }
        for (depth, owner) in pairs {
            let (mut outside, mut z) = ([0; PAIR_SAMPLES], [0.0; PAIR_SAMPLES]);
            for lane in 0..PAIR_SAMPLES {
                outside[lane] = edges[0][lane] | edges[1][lane] | edges[2][lane];
                z[lane] = self.within(base[lane] + columns[lane] * self.slope[0]);
            }
            let (depth, owner) = (depth.as_flattened_mut(), owner.as_flattened_mut());
            if let (Some(depth), Some(owner)) = (depth.as_mut_array(), owner.as_mut_array()) {
                cover::<PAIR_SAMPLES>(outside, z, id, depth, owner);
            }
            for lane in 0..PAIR_SAMPLES {
                for k in 0..3 {
                    edges[k][lane] = edges[k][lane].wrapping_add(16 * self.right[k]);
                }
                columns[lane] += 2.0;
            }
        }
    }

    /// Does what [`TriangleSetup::fill`] does, at those places of the tile where the triangle is there.
    pub(super) fn fill_where(
        &self,
        id: u32,
        depth: &mut [[f32; SAMPLES]],
        owner: &mut [[u32; SAMPLES]],
        is_there: impl Fn([f32; 2]) -> bool,
    ) -> u64 {
        let [left, top, _, bottom] = self.pixels;
        let n = self.width();
        let mut pixels = 0;
        for (row, y) in (0_i32..).zip(top..=bottom) {
            let span = if n < CUT_PX { 0..n } else { self.span(row, n) };
            pixels += span.len() as u64 + if n < CUT_PX { 0 } else { ROW_PX };
            let lift = row as f32 * self.slope[1];
            for column in span {
                let edge = |k: usize, s: usize| {
                    let [x, y] = SAMPLE_PLACES[s];
                    let right = self.right[k].wrapping_mul(8 * (left - self.first + column as i32) + x);
                    self.edges[k].wrapping_add(right).wrapping_add(self.down[k].wrapping_mul(8 * row + y))
                };
                let outside: [i32; SAMPLES] = std::array::from_fn(|s| edge(0, s) | edge(1, s) | edge(2, s));
                let place = |s: usize| {
                    let [x, y] = SAMPLE_PLACES[s].map(|eighths| eighths as f32 / 8.0);
                    [(left as usize + column) as f32 + x, y + (top + row) as f32]
                };
                let is_hole = |s: usize| outside[s] >= 0 && !is_there(place(s));
                let outside = std::array::from_fn(|s| if is_hole(s) { -1 } else { outside[s] });
                let z = self.depth.map(|z| self.within(z + lift + column as f32 * self.slope[0]));
                let pixel = (y * TILE_SIDE + left) as usize + column;
                cover(outside, z, id, &mut depth[pixel], &mut owner[pixel]);
            }
        }
        pixels
    }

    /// Returns a depth, clamped to the depths of the corners.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    fn within(&self, z: f32) -> f32 {
        let z = if z > self.range[0] { z } else { self.range[0] };
        if z < self.range[1] { z } else { self.range[1] }
    }

    /// Returns the columns of a row of `n` pixels in which a sample may lie inside. An edge function that is negative
    /// at all samples of a pixel leaves it out, and all are linear along the row.
    fn span(&self, row: i32, n: usize) -> Range<usize> {
        let (mut first, mut end) = (0_i64, n as i64);
        for k in 0..3 {
            let at = |[x, y]: [i32; 2]| self.right[k].wrapping_mul(x).wrapping_add(self.down[k].wrapping_mul(y));
            let [a, b, c, d] = SAMPLE_PLACES;
            let most = at(a).max(at(b)).max(at(c)).max(at(d));
            let edge = self.edges[k].wrapping_add((8 * self.down[k]).wrapping_mul(row));
            let most = i64::from(edge.wrapping_add(most));
            let right = i64::from(8 * self.right[k]);
            if right > 0 && most < 0 {
                // most + right column >= 0
                first = first.max((-most + right - 1) / right);
            } else if most < 0 {
                return 0..0;
            } else if right < 0 {
                end = end.min(most / -right + 1);
            }
        }
        let first = first.min(n as i64);
        first as usize..end.max(first) as usize
    }
}

/// Returns the growth of depth for each pixel to the right and down; 0 for a triangle without area.
#[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
#[inline(always)]
pub(super) fn slope(corners: &[Vertex; 3]) -> [f64; 2] {
    let [a, b, c] = *corners;
    let area = area(corners);
    if area == 0 {
        return [0.0; 2];
    }
    let (db, dc) = (f64::from(b.depth) - f64::from(a.depth), f64::from(c.depth) - f64::from(a.depth));
    let (bx, by) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
    let (cx, cy) = (f64::from(c.x - a.x), f64::from(c.y - a.y));
    let scale = f64::from(STEPS_A_PIXEL) / area as f64;
    [(db * cy - dc * by) * scale, (dc * bx - db * cx) * scale]
}
