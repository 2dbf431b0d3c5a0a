//! Spots: parts of pixels that wait for light, which is computed for several at once.

use multiversion::multiversion;

use super::fine::PixelSet;
use super::shade::{Lamps, USUAL_SPREAD, Vec3f};

/// Spots lit at once: sixteen 32-bit numbers fill a vector register of 512 bits, or two of 256, which are computed side
/// by side. With half of it and registers of 256 bits, pictures of small triangles take a twentieth longer; twice of it
/// takes two of 512 for each number. Colours are the same.
const SPOT_LANES: usize = 16;

/// A number for each spot.
type SpotRow = [f32; SPOT_LANES];

/// Places of a tile that wait for light.
#[derive(Debug)]
pub(super) struct Spots {
    /// Normals of any length, and 1 if the back is seen, else 0.
    normal: [[f32; 4]; SPOT_LANES],
    /// Pixel coordinates in the tile.
    place: [[f32; 2]; SPOT_LANES],
    color: [SpotRow; 3],
    metal: SpotRow,
    spread: SpotRow,
    share: SpotRow,
    pixel: [u32; SPOT_LANES],
    waiting: usize,
}

impl Spots {
    /// Creates an empty list of spots; spots have this colour unless another is set.
    pub(super) fn new(color: Vec3f) -> Self {
        let none = [0.0; SPOT_LANES];
        let color = color.map(|c| [c; SPOT_LANES]);
        let (normal, place) = ([[0.0; 4]; SPOT_LANES], [[0.0; 2]; SPOT_LANES]);
        let spread = [USUAL_SPREAD; SPOT_LANES];
        Self { normal, place, color, metal: none, spread, share: none, pixel: [0; SPOT_LANES], waiting: 0 }
    }

    /// Sets the colour of the next spot.
    pub(super) fn color(&mut self, color: Vec3f) {
        let i = self.waiting % SPOT_LANES;
        (0..3).for_each(|k| self.color[k][i] = color[k]);
    }

    /// Sets whether the next spot is of metal, from 0 to 1, and how wide its highlights are.
    pub(super) fn finish(&mut self, [metal, spread]: [f32; 2]) {
        let i = self.waiting % SPOT_LANES;
        (self.metal[i], self.spread[i]) = (metal, spread);
    }

    /// Adds a spot at a place in the tile, in pixels, that gives `share` of the light of `pixel`, counted within the
    /// tile. The last component of the normal is 1 where the back is seen, else 0. There must be room.
    #[inline]
    pub(super) fn push(&mut self, (pixel, share): (u32, f32), normal: [f32; 4], place: [f32; 2]) {
        let i = self.waiting % SPOT_LANES;
        self.normal[i] = normal;
        self.place[i] = place;
        self.share[i] = share;
        self.pixel[i] = pixel;
        self.waiting = i + 1;
    }

    /// Returns whether there is no room for another spot.
    #[inline]
    pub(super) fn are_full(&self) -> bool {
        self.waiting == SPOT_LANES
    }

    /// Adds the light of the waiting spots to `light`, linear and premultiplied, and marks pixels with spots of
    /// different light. The first pixel of the tile is `corner`. Without lamps, the colours of spots are their light.
    pub(super) fn shine(
        &mut self,
        lamps: Option<&Lamps>,
        corner: [f32; 2],
        light: &mut [[f32; 4]],
        marks: &mut PixelSet,
    ) {
        let colors = lamps.map_or(self.color, |lamps| lit(lamps, self, corner));
        add(self, &colors, light, marks);
        self.waiting = 0;
    }
}

/// Returns red, green and blue of all spots. The loop over lanes has no branches, so that it becomes vector code; wider
/// vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn lit(lamps: &Lamps, spots: &Spots, corner: [f32; 2]) -> [SpotRow; 3] {
    let is_metal = spots.metal.iter().any(|metal| *metal > 0.0);
    if is_metal { lanes::<true>(lamps, spots, corner) } else { lanes::<false>(lamps, spots, corner) }
}

#[expect(clippy::inline_always, reason = "only code inside of `lit` uses its wider vectors")]
#[inline(always)]
fn lanes<const METAL: bool>(lamps: &Lamps, spots: &Spots, corner: [f32; 2]) -> [SpotRow; 3] {
    let [mut red, mut green, mut blue] = [[0.0; SPOT_LANES]; 3];
    for i in 0..SPOT_LANES {
        let [x, y, z, back] = spots.normal[i];
        let color = [spots.color[0][i], spots.color[1][i], spots.color[2][i]];
        let place = [corner[0] + spots.place[i][0], corner[1] + spots.place[i][1]];
        let finish = [back, spots.metal[i], spots.spread[i]];
        [red[i], green[i], blue[i]] = lamps.light::<METAL>([x, y, z], color, place, finish);
    }
    [red, green, blue]
}

/// Light of which the parts of a pixel may differ before an edge is seen between them: so much, and this share of it.
/// Half of it looks closely at pixels of smooth surfaces in vain, twice of it leaves steps at faint creases.
const EDGE_LIGHT: [f32; 2] = [0.012, 0.06];

/// Adds red, green and blue of the waiting spots to `light`, and marks pixels where the light of a spot differs so much
/// from the mean of the lights in the sum that an edge between them is seen. Nothing differs from a sum of nothing.
/// Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn add(spots: &Spots, [red, green, blue]: &[SpotRow; 3], light: &mut [[f32; 4]], marks: &mut PixelSet) {
    for i in 0..spots.waiting.min(SPOT_LANES) {
        // the last component is the share of the pixel: it never differs, and is added like the others
        let (color, share) = ([red[i], green[i], blue[i], 1.0], spots.share[i]);
        let sum = &mut light[spots.pixel[i] as usize];
        let mut differs = [false; 4];
        for k in 0..4 {
            differs[k] = (sum[k] - color[k] * sum[3]).abs() > EDGE_LIGHT[0] * sum[3] + EDGE_LIGHT[1] * sum[k];
        }
        if differs[0] | differs[1] | differs[2] | differs[3] {
            marks.add(spots.pixel[i]);
        }
        for k in 0..4 {
            sum[k] += share * color[k];
        }
    }
}
