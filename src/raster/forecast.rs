//! Forecasts the work of drawing triangles from their positions in the picture, without drawing pixels.

#![expect(clippy::cast_precision_loss, reason = "a forecast needs no last digit")]
#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a forecast is clamped to what it can be")]

use super::bins::{FEW_TILES, TILE};
use super::camera::Camera;
use super::project::{BEHIND, FAR_OUT, STEPS_A_PIXEL, vertices_of};
use super::samples::Done;
use super::triangle::{CUT_PX, ROW_PX};

/// Pixels that are looked at in 100 ns, the time of a row of a table: 0.8 ns each, measured with a stack of 40,000
/// quads in a picture of 2048 x 2048, and rounded up.
/// Pictures whose forecast is wrong by a factor of two still take the right lane, as work that outstays it is moved.
const VIEWED_PIXELS_A_ROW: f64 = 100.0;
/// Triangles that a tile finds not to touch it in 100 ns, of which it sets up eight at once. A face of 100,000 corners,
/// of which every tile looks at all triangles, then is told 1.5 s.
/// Half or twice of it tells half or twice the time of such a face, and nothing of other pictures.
const TRIANGLES_A_ROW: f64 = 8.0;
/// Triangles that are projected, clipped and sorted into tiles in 100 ns: 50 ns each, measured with a million small
/// ones before eight of them were projected and culled at once.
/// Half or twice of it tells pictures of fine meshes to take twice or half of what they take.
const SORTED_A_ROW: f64 = 2.0;
/// Tiles that a line crosses, over those beside each other along its longer side.
/// A diagonal crosses up to 2, a level line 1. Half of it tells steep lines too short; twice of it tells all lines
/// twice as long as they may be.
const CROSSED_TILES: f64 = 1.5;

/// Returns the work done, in rows.
pub(super) fn rows(done: Done) -> u64 {
    in_rows(done.pixels as f64, done.triangles as f64) as u64
}

fn in_rows(pixels: f64, triangles: f64) -> f64 {
    pixels / VIEWED_PIXELS_A_ROW + triangles / TRIANGLES_A_ROW
}

/// A forecast of the work of drawing triangles, in rows of a weight table, 100 ns each. Hidden triangles count in full,
/// since they are processed unless those in front are drawn before.
#[derive(Debug, Clone, Copy)]
pub struct RasterForecast {
    size_px: [f64; 2],
    rows: f64,
}

impl RasterForecast {
    /// Creates an empty forecast for a picture of this size.
    pub fn of([width, height]: [u32; 2]) -> Self {
        Self { size_px: [f64::from(width), f64::from(height)], rows: 0.0 }
    }

    /// Adds a triangle that will be drawn as `parts` equal ones.
    pub fn add(&mut self, camera: &Camera, corners: [[f64; 3]; 3], parts: f64) {
        let placed = vertices_of(camera, corners.map(|corner| camera.view(corner)));
        let [width, height] = self.size_px;
        let sides = placed.map(|vertex| vertex.sides);
        if sides[0] & sides[1] & sides[2] & !FAR_OUT != 0 {
            self.rows += parts / SORTED_A_ROW;
            return;
        }
        if (sides[0] | sides[1] | sides[2]) & (BEHIND | FAR_OUT) != 0 {
            // the surface may cover all of the picture
            self.add_parts(width * height, self.size_px, parts, 1.0);
            return;
        }
        let [a, b, c] = placed.map(|vertex| [vertex.x, vertex.y].map(|x| f64::from(x) / f64::from(STEPS_A_PIXEL)));
        let low = |k: usize| a[k].min(b[k]).min(c[k]);
        let side = |k: usize| a[k].max(b[k]).max(c[k]) - low(k);
        let inside = |k: usize| (low(k) + side(k)).min(self.size_px[k]) - low(k).max(0.0);
        let sides = [side(0), side(1)];
        let share = [0, 1].map(|k| if sides[k] > 0.0 { (inside(k) / sides[k]).clamp(0.0, 1.0) } else { 1.0 });
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs() / 2.0;
        self.add_parts(area, sides, parts, share[0] * share[1]);
    }

    /// Adds the parts of a triangle with this area and these sides, of which the fraction `share` lies in the picture.
    fn add_parts(&mut self, area: f64, sides: [f64; 2], parts: f64, share: f64) {
        let tile = TILE as f64;
        let [width, height] = sides.map(|side| side / parts.sqrt());
        let area = area / parts;
        let pixels = if width < CUT_PX as f64 {
            (width + 1.0) * (height + 1.0)
        } else {
            let rows = CROSSED_TILES * width.max(height) + area / tile;
            area + rows * ROW_PX as f64
        };
        let tiles = (1.0 + width / tile) * (1.0 + height / tile);
        let all = self.size_px.map(|side| (side / tile).ceil()).iter().product();
        // large triangles are looked at in every tile
        let tiles = if tiles > FEW_TILES as f64 { all } else { tiles.min(all) };
        let each = in_rows(pixels * share, tiles) + 1.0 / SORTED_A_ROW;
        self.rows += parts * each;
    }

    /// Returns the work if `times` as many triangles like those were added.
    pub fn rows(&self, times: f64) -> u64 {
        (self.rows * times).clamp(0.0, u64::MAX as f64) as u64
    }
}
