//! Refines edges: draws sixteen samples in those pixels of a tile where four would show steps.

#![expect(clippy::cast_possible_truncation, reason = "edge functions are clamped and a tile is some dozen pixels wide")]
#![expect(clippy::cast_possible_wrap, reason = "a tile is some dozen pixels wide")]
#![expect(clippy::cast_sign_loss, reason = "pixels are clamped to the tile")]
#![expect(clippy::cast_precision_loss, reason = "places within a tile are small")]

use multiversion::multiversion;

use super::bins::TILE;
use super::project::{STEPS_A_PIXEL, Vertex};
use super::triangle::{NOBODY, TILE_SIDE, area, cover, in_tile, slope, touched};

/// Samples per refined pixel, so that an edge has 17 grey values. Half as many show steps of slanted edges at twice the
/// size; twice as many take twice the time in these pixels.
pub(super) const FINE_SAMPLES: usize = 16;

/// The row of the sample in each column, sixteenths of a pixel. Of many permutations the one whose counts come closest
/// to the areas that lines at any angle cut off: within 1/10 of a pixel, mostly within 1/25.
const SAMPLE_ROWS: [i32; FINE_SAMPLES] = [9, 1, 13, 4, 8, 14, 3, 11, 6, 0, 12, 7, 10, 2, 5, 15];

/// Places of the samples in 32nds of a pixel, right and down.
pub(super) const FINE_PLACES: [[i32; 2]; FINE_SAMPLES] = {
    let mut places = [[0; 2]; FINE_SAMPLES];
    let mut column = 0;
    while column < FINE_SAMPLES {
        places[column] = [2 * column as i32 + 1, 2 * SAMPLE_ROWS[column] + 1];
        column += 1;
    }
    places
};

/// Sub-pixel steps in a 32nd of a pixel, as a power of two.
const STEP_SHIFT: u32 = (STEPS_A_PIXEL / 32).trailing_zeros();
/// Edge functions are clamped to this: beyond it their sign is that of every sample of the pixel, as coordinates stay
/// below 2^22 steps and a pixel is 32 wide. Twice of it would overflow when a sample is added.
const DECIDED_EDGE: i64 = 1 << 29;

/// A set of pixels of a tile, one bit each.
#[derive(Debug, Clone, Default)]
pub(super) struct PixelSet([u32; TILE]);

impl PixelSet {
    /// Adds a pixel, counted row by row.
    pub(super) fn add(&mut self, pixel: u32) {
        self.0[pixel as usize / TILE] |= 1 << (pixel as usize % TILE);
    }

    /// Adds pixels of a row, one bit each.
    pub(super) fn add_row(&mut self, row: usize, pixels: u32) {
        self.0[row] |= pixels;
    }

    pub(super) fn clear(&mut self) {
        self.0 = [0; TILE];
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(|row| *row == 0)
    }

    /// Returns these pixels and those next to, above and below them.
    fn widened(&self) -> [u32; TILE] {
        std::array::from_fn(|y| {
            let row = self.0[y];
            let above = if y > 0 { self.0[y - 1] } else { 0 };
            let below = self.0.get(y + 1).copied().unwrap_or(0);
            row | row << 1 | row >> 1 | above | below
        })
    }
}

/// Depth and owner of sixteen samples in some pixels of a tile.
#[derive(Debug)]
pub(super) struct Fine {
    /// [`FINE_PLACES`], right and down, in memory, see [`PLACE_ROWS`](super::triangle::PLACE_ROWS).
    places: [[i32; FINE_SAMPLES]; 2],
    pixels: [u32; TILE],
    /// For each row, the number of pixels in the rows above it.
    starts: [u32; TILE],
    depth: Vec<[f32; FINE_SAMPLES]>,
    owner: Vec<[u32; FINE_SAMPLES]>,
}

/// A triangle prepared for a tile; edge functions are not negative inside.
struct FineSetup {
    /// Edge functions at the corner of the tile and their steps to the next pixel, right and down.
    edges: [i64; 3],
    right: [i64; 3],
    down: [i64; 3],
    /// The increments of the edge functions at each sample.
    samples: [[i32; FINE_SAMPLES]; 3],
    /// Depth at the corner of the tile, and its growth.
    depth: f64,
    slope: [f64; 2],
    rise: [f32; FINE_SAMPLES],
    range: [f32; 2],
}

impl Default for Fine {
    fn default() -> Self {
        let places = [0, 1].map(|k| FINE_PLACES.map(|place| place[k]));
        Self { places, pixels: [0; TILE], starts: [0; TILE], depth: Vec::new(), owner: Vec::new() }
    }
}

impl Fine {
    /// Starts without triangles, in the marked pixels and their neighbours, since an edge may cross a pixel and miss
    /// its four samples.
    pub(super) fn begin(&mut self, marks: &PixelSet) {
        self.pixels = marks.widened();
        let mut n = 0;
        for (start, row) in self.starts.iter_mut().zip(&self.pixels) {
            *start = n;
            n += row.count_ones();
        }
        self.depth.clear();
        self.depth.resize(n as usize, [0.0; FINE_SAMPLES]);
        self.owner.clear();
        self.owner.resize(n as usize, [NOBODY; FINE_SAMPLES]);
    }

    /// Returns the pixels, numbered row by row, with the triangles visible at their samples.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, &[u32; FINE_SAMPLES])> {
        let row = |(y, row): (usize, &u32)| {
            let mut row = *row;
            std::iter::from_fn(move || {
                let x = (row != 0).then(|| row.trailing_zeros())?;
                row &= row - 1;
                Some((y * TILE) as u32 + x)
            })
        };
        self.pixels.iter().enumerate().flat_map(row).zip(&self.owner)
    }

    /// Draws one triangle; of equal depths, that of the lower number is seen.
    pub(super) fn draw(&mut self, corners: [&Vertex; 3], id: u32, origin: [i32; 2]) {
        draw_everywhere(self, corners, id, origin);
    }

    /// Draws one triangle at those places of the tile where it is there.
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    pub(super) fn draw_where(
        &mut self,
        corners: [&Vertex; 3],
        id: u32,
        origin: [i32; 2],
        is_there: impl Fn([f32; 2]) -> bool,
    ) {
        let corners = corners.map(|corner| *corner);
        let Some([left, top, right, bottom]) = in_tile(touched(&corners), origin) else { return };
        let columns = (u32::MAX >> (TILE_SIDE - 1 - (right - left))) << left;
        if (top..=bottom).all(|y| self.pixels[y as usize] & columns == 0) {
            return;
        }
        let Some(setup) = FineSetup::new(corners, origin, &self.places) else { return };
        for y in top..=bottom {
            let row = self.pixels[y as usize];
            let mut rest = row & columns;
            let before = (row & ((1 << left) - 1)).count_ones();
            let mut place = (self.starts[y as usize] + before) as usize;
            while rest != 0 {
                self.cover(place, &setup, [rest.trailing_zeros().cast_signed(), y], id, &is_there);
                rest &= rest - 1;
                place += 1;
            }
        }
    }

    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    fn cover(
        &mut self,
        place: usize,
        setup: &FineSetup,
        [x, y]: [i32; 2],
        id: u32,
        is_there: impl Fn([f32; 2]) -> bool,
    ) {
        let (depth, owner) = (&mut self.depth[place], &mut self.owner[place]);
        if depth.iter().all(|depth| *depth > setup.range[1]) {
            return;
        }
        let edges: [i32; 3] = std::array::from_fn(|k| {
            let value = setup.edges[k] + setup.right[k] * i64::from(x) + setup.down[k] * i64::from(y);
            value.clamp(-DECIDED_EDGE, DECIDED_EDGE) as i32
        });
        let at = |k: usize, s: usize| edges[k] + setup.samples[k][s];
        let outside: [i32; FINE_SAMPLES] = std::array::from_fn(|s| at(0, s) | at(1, s) | at(2, s));
        let place = |[right, down]: [i32; 2]| [x as f32 + right as f32 / 32.0, y as f32 + down as f32 / 32.0];
        let is_hole = |s: usize| outside[s] >= 0 && !is_there(place(FINE_PLACES[s]));
        let outside = std::array::from_fn(|s| if is_hole(s) { -1 } else { outside[s] });
        let base = (setup.depth + setup.slope[0] * f64::from(x) + setup.slope[1] * f64::from(y)) as f32;
        let z = std::array::from_fn(|s| setup.within(base + setup.rise[s]));
        cover(outside, z, id, depth, owner);
    }
}

/// Draws one triangle; wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn draw_everywhere(fine: &mut Fine, corners: [&Vertex; 3], id: u32, origin: [i32; 2]) {
    fine.draw_where(corners, id, origin, |_| true);
}

impl FineSetup {
    /// Prepares a triangle for a tile; returns `None` if it has no area.
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    fn new(mut corners: [Vertex; 3], origin: [i32; 2], places: &[[i32; FINE_SAMPLES]; 2]) -> Option<Self> {
        let area = area(&corners);
        if area == 0 {
            return None;
        }
        let slope = slope(&corners);
        if area < 0 {
            corners.swap(1, 2);
        }
        let [left, top] = origin.map(|o| i64::from(o) * i64::from(STEPS_A_PIXEL));
        let (mut edges, mut right, mut down, mut samples) = ([0; 3], [0; 3], [0; 3], [[0; FINE_SAMPLES]; 3]);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let (dx, dy) = (b.x - a.x, b.y - a.y);
            // an edge that two triangles share is counted for exactly one of them
            let counts = dy > 0 || (dy == 0 && dx > 0);
            let value = i64::from(dx) * (top - i64::from(a.y)) - i64::from(dy) * (left - i64::from(a.x));
            edges[k] = (value - i64::from(!counts)) >> STEP_SHIFT;
            (right[k], down[k]) = (-32 * i64::from(dy), 32 * i64::from(dx));
            for (sample, (x, y)) in samples[k].iter_mut().zip(places[0].iter().zip(&places[1])) {
                *sample = dx * y - dy * x;
            }
        }
        let a = corners[0];
        let x = (left - i64::from(a.x)) as f64 / f64::from(STEPS_A_PIXEL);
        let y = (top - i64::from(a.y)) as f64 / f64::from(STEPS_A_PIXEL);
        let mut rise = [0.0; FINE_SAMPLES];
        for (rise, (x, y)) in rise.iter_mut().zip(places[0].iter().zip(&places[1])) {
            *rise = ((slope[0] * f64::from(*x) + slope[1] * f64::from(*y)) / 32.0) as f32;
        }
        let depths = [corners[0].depth, corners[1].depth, corners[2].depth];
        Some(Self {
            edges,
            right,
            down,
            samples,
            depth: f64::from(a.depth) + slope[0] * x + slope[1] * y,
            slope,
            rise,
            range: [depths[0].min(depths[1]).min(depths[2]), depths[0].max(depths[1]).max(depths[2])],
        })
    }

    /// Returns a depth, clamped to the depths of the corners.
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    fn within(&self, z: f32) -> f32 {
        let z = if z > self.range[0] { z } else { self.range[0] };
        if z < self.range[1] { z } else { self.range[1] }
    }
}
