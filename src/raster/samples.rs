//! Depth and owner of the samples of one tile, and the drawing of triangles into them.

#![expect(clippy::cast_sign_loss, reason = "pixels are clamped to the tile")]

use multiversion::multiversion;

use super::bins::TILE;
use super::project::Vertex;
use super::triangle::{CUT_PX, NOBODY, PLACE_ROWS, PlaceRows, SAMPLES, TILE_SIDE};
use super::triangle_block::{BLOCK_TRIANGLES, BlockSetup, TriangleBlock, prepared};

/// Depth and owner of every sample of a tile.
#[derive(Debug)]
pub(super) struct Samples {
    /// `TILE x TILE` pixels, four depths each; 0 is infinitely far.
    pub(super) depth: Vec<[f32; SAMPLES]>,
    /// The triangle seen at each sample.
    pub(super) owner: Vec<[u32; SAMPLES]>,
    /// The triangles that wait to be drawn with others.
    waiting: TriangleBlock,
    /// [`PLACE_ROWS`] in memory.
    places: PlaceRows,
    /// No sample is farther than this.
    farthest: f32,
    /// Pixels visited since `farthest` was found.
    visited: usize,
    /// The work done since [`Samples::done`] was last called.
    done: Done,
}

/// The work of drawing triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Done {
    /// Pixels looked at, and [`ROW_PX`](super::triangle::ROW_PX) for each row of them that was cut to what the triangle
    /// may cover.
    pub(super) pixels: u64,
    /// Triangles looked at.
    pub(super) triangles: u64,
}

impl Samples {
    pub(super) fn new() -> Self {
        let n = TILE * TILE;
        let (depth, owner) = (vec![[0.0; SAMPLES]; n], vec![[NOBODY; SAMPLES]; n]);
        Self {
            depth,
            owner,
            waiting: TriangleBlock::default(),
            places: PLACE_ROWS,
            farthest: 0.0,
            visited: 0,
            done: Done::default(),
        }
    }

    /// Returns the work done since this was last called.
    pub(super) fn done(&mut self) -> Done {
        std::mem::take(&mut self.done)
    }

    pub(super) fn clear(&mut self) {
        self.depth.fill([0.0; SAMPLES]);
        self.owner.fill([NOBODY; SAMPLES]);
        (self.farthest, self.visited, self.waiting.n) = (0.0, 0, 0);
    }

    /// Begins anew with nothing in front of what stands in `others`, which is not seen itself.
    pub(super) fn begin_before(&mut self, others: &Self) {
        self.depth.copy_from_slice(&others.depth);
        self.owner.fill([NOBODY; SAMPLES]);
        (self.farthest, self.visited, self.waiting.n) = (0.0, 0, 0);
    }

    /// Draws one triangle into the tile whose first pixel is `origin`, at once or when [`Samples::settle`] is called.
    /// Of triangles with equal depth at a sample that with the lower number is seen, so that the order of drawing does
    /// not matter.
    #[inline]
    pub(super) fn draw(&mut self, corners: [&Vertex; 3], id: u32, origin: [i32; 2]) {
        self.waiting.push(corners, id);
        if self.waiting.is_full() {
            self.settle(origin);
        }
    }

    /// Draws the triangles that wait.
    pub(super) fn settle(&mut self, origin: [i32; 2]) {
        if self.waiting.n > 0 {
            draw_everywhere(self, origin);
            self.waiting.n = 0;
        }
    }

    /// Draws one triangle like [`Samples::draw`], at once, at those places of the tile where it is there.
    pub(super) fn draw_where(
        &mut self,
        corners: [&Vertex; 3],
        id: u32,
        origin: [i32; 2],
        is_there: impl Fn([f32; 2]) -> bool,
    ) {
        self.settle(origin);
        self.waiting.push(corners, id);
        let setups = prepared(&self.waiting, origin);
        if self.width_if_seen(&setups, 0).is_some() {
            self.done.pixels += setups.at(0).fill_where(id, &mut self.depth, &mut self.owner, &is_there);
        }
        self.waiting.n = 0;
    }

    /// Returns the width in pixels of triangle `i` of those that wait, if it may be seen in the tile.
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    fn width_if_seen(&mut self, setup: &BlockSetup, i: usize) -> Option<usize> {
        self.done.triangles += 1;
        if self.visited > 4 * TILE * TILE {
            self.farthest();
        }
        let nearest = setup.nearest[i];
        // an equal depth may still win by its number
        if nearest < self.farthest {
            return None;
        }
        let pixels @ [left, top, right, bottom] = setup.pixels(i)?;
        if self.is_hidden(pixels, nearest) {
            return None;
        }
        self.visited += ((right - left + 1) * (bottom - top + 1)) as usize;
        Some((right - left + 1) as usize)
    }

    /// Returns the smallest depth of a sample.
    pub(super) fn farthest(&mut self) -> f32 {
        if self.visited > 0 {
            let least =
                |a: [f32; SAMPLES], b: &[f32; SAMPLES]| std::array::from_fn(|s| if b[s] < a[s] { b[s] } else { a[s] });
            self.visited = 0;
            self.farthest =
                self.depth.iter().fold([f32::INFINITY; SAMPLES], least).into_iter().fold(f32::INFINITY, f32::min);
        }
        self.farthest
    }

    /// Sets `depths` to the largest depth in each pixel, 0 if no sample is covered.
    pub(super) fn nearest(&self, depths: &mut [f32]) {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        for (nearest, d) in depths.iter_mut().zip(&self.depth) {
            *nearest = larger(larger(d[0], d[1]), larger(d[2], d[3]));
        }
    }

    /// Returns whether every sample of some pixels (left, top, right, bottom, bounds included) is nearer than
    /// `nearest`.
    #[expect(clippy::inline_always, reason = "only code inside of `draw_everywhere` uses its wider vectors")]
    #[inline(always)]
    fn is_hidden(&self, [left, top, right, bottom]: [i32; 4], nearest: f32) -> bool {
        // loops, as closures would be compiled apart
        for y in top..=bottom {
            let row = (y * TILE_SIDE + left) as usize..=(y * TILE_SIDE + right) as usize;
            for depth in &self.depth[row] {
                let mut is_hidden = true;
                for depth in depth {
                    is_hidden &= *depth > nearest;
                }
                if !is_hidden {
                    return false;
                }
            }
        }
        true
    }
}

/// Draws the triangles that wait, two pixels at a time; wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn draw_everywhere(samples: &mut Samples, origin: [i32; 2]) {
    let setups = prepared(&samples.waiting, origin);
    for i in 0..samples.waiting.n.min(BLOCK_TRIANGLES) {
        let Some(width) = samples.width_if_seen(&setups, i) else { continue };
        if width < CUT_PX {
            let id = samples.waiting.id[i];
            let Samples { depth, owner, places, .. } = samples;
            samples.done.pixels += setups.at(i).fill(id, depth, owner, places);
        } else {
            fill_wide(samples, &setups, i);
        }
    }
}

/// Draws triangle `i` of those that wait, which is wide. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn fill_wide(samples: &mut Samples, setups: &BlockSetup, i: usize) {
    let id = samples.waiting.id[i];
    samples.done.pixels += setups.at(i).fill_cut(id, &mut samples.depth, &mut samples.owner, &samples.places);
}
