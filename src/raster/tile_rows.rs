//! Encodes drawn tiles as the bytes of pixels, one row of a tile at a time, channel by channel.

#![expect(clippy::cast_possible_truncation, reason = "shares of a byte fit in it")]

use multiversion::multiversion;

use super::bins::TILE;
use super::contact::{Shadow, ShadowRow};
use super::occlusion::Occlusion;
use super::pixmap::{ENCODING, light_step, rounded_down};
use super::tile_scratch::Drawn;

/// Linear light of the pixels of a row, premultiplied: red, green, blue, and what is covered of each pixel.
type RowLight = [[f32; TILE]; 4];

/// The share from which a pixel is opaque, a fortieth of the step of a byte away from 1: twice as far away, its colours
/// are still those of a full pixel; half of it is closer to the rounding of sums of sixteen samples.
const OPAQUE: f32 = 0.9999;

/// Composes the layers of a picture and encodes them.
pub(super) struct TileWriter {
    /// The background as a pixel.
    pub(super) background: [u8; 4],
    /// The background, linear and premultiplied.
    pub(super) paper: [f32; 4],
    pub(super) occlusion: Option<Occlusion>,
    pub(super) shadow: Option<Shadow>,
}

/// Pixels of a row, ready for the table of bytes.
struct EncodedRow {
    /// Red, green and blue in steps of the table.
    steps: [[u16; TILE]; 3],
    alpha: [u8; TILE],
    /// All bits of a pixel where something is drawn that remains after rounding.
    kept: [u32; TILE],
    /// The background where nothing is drawn, else 0.
    empty: [u32; TILE],
}

impl TileWriter {
    /// Writes the pixels of one row of a tile; the first is at `[left, y]` in the picture.
    pub(super) fn write(
        &self,
        tile: Option<&Drawn<'_>>,
        shadow: Option<&ShadowRow<'_>>,
        [left, y]: [usize; 2],
        part: &mut [u8],
    ) {
        let pixels = part.as_chunks_mut::<4>().0;
        let first = y % TILE * TILE;
        let row = |list: &[[u16; 4]]| list.get(first..).and_then(<[_]>::first_chunk).map(unpacked);
        let surface = tile.and_then(|tile| row(tile.surface));
        let is_open = surface.is_none_or(|surface| surface[3].iter().any(|share| *share < 1.0));
        let dark = shadow.filter(|_| is_open).and_then(|shadow| shadow.dark(left));
        if tile.is_none() && dark.is_none() {
            pixels.fill(self.background);
            return;
        }
        let mut light = surface.unwrap_or([[0.0; TILE]; 4]);
        if let (Some(_), Some(occlusion), Some(tile)) = (surface, &self.occlusion, tile)
            && let Some(depths) = tile.depth.get(first..).and_then(<[_]>::first_chunk)
        {
            darken(&mut light, &occlusion.open([left, y], depths));
        }
        let lines = tile.and_then(|tile| row(&tile.over)).unwrap_or([[0.0; TILE]; 4]);
        let background = u32::from_le_bytes(self.background);
        let encoded = encoded(&light, &lines, &dark.unwrap_or([0.0; TILE]), (self.paper, background));
        let table = &*ENCODING;
        for (x, pixel) in pixels.iter_mut().enumerate().take(TILE) {
            let [red, green, blue] = &encoded.steps;
            let color = [table.of_step(red[x]), table.of_step(green[x]), table.of_step(blue[x]), encoded.alpha[x]];
            let drawn = u32::from_le_bytes(color);
            *pixel = (drawn & encoded.kept[x] | encoded.empty[x]).to_le_bytes();
        }
    }
}

/// Returns the light of a row of packed pixels.
#[multiversion(targets("x86_64+avx2"))]
fn unpacked(row: &[[u16; 4]; TILE]) -> RowLight {
    let mut light = [[0.0; TILE]; 4];
    for (x, pixel) in row.iter().enumerate() {
        for k in 0..4 {
            light[k][x] = f32::from(pixel[k]) * (1.0 / 65535.0);
        }
    }
    light
}

/// Multiplies colours by what occlusion leaves of their light.
fn darken(light: &mut RowLight, open: &[f32; TILE]) {
    for channel in &mut light[..3] {
        channel.iter_mut().zip(open).for_each(|(light, open)| *light *= open);
    }
}

/// Lays a surface over the shadow on the background, and lines over all.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn encoded(
    surface: &RowLight,
    lines: &RowLight,
    dark: &[f32; TILE],
    (paper, background): ([f32; 4], u32),
) -> EncodedRow {
    let mut light = [[0.0; TILE]; 4];
    for k in 0..4 {
        for x in 0..TILE {
            let shade = if k == 3 { dark[x] } else { 0.0 };
            let ground = shade + (1.0 - dark[x]) * paper[k];
            let rest = if surface[3][x] < 1.0 { 1.0 - surface[3][x] } else { 0.0 };
            light[k][x] = lines[k][x] + (1.0 - lines[3][x]) * (surface[k][x] + rest * ground);
        }
    }
    let mut row = EncodedRow { steps: [[0; TILE]; 3], alpha: [0; TILE], kept: [0; TILE], empty: [0; TILE] };
    for x in 0..TILE {
        let alpha = if light[3][x] >= OPAQUE { 1.0 } else { light[3][x] };
        for (steps, light) in row.steps.iter_mut().zip(&light) {
            steps[x] = light_step(light[x] / alpha);
        }
        row.alpha[x] = rounded_down(alpha * 255.0 + 0.5) as u8;
        let drawn = [surface[3][x], lines[3][x], dark[x]].map(|share| u32::from(share > 0.0).wrapping_neg());
        let drawn = drawn[0] | drawn[1] | drawn[2];
        row.kept[x] = drawn & u32::from(alpha > 0.0).wrapping_neg();
        row.empty[x] = !drawn & background;
    }
    row
}
