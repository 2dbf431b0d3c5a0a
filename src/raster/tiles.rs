//! The loop over tiles: draw, ground, encode.

use rayon::prelude::*;

use super::binned_model::BinnedModel;
use super::bins::{TILE, TileGrid};
use super::camera::Camera;
use super::contact::{Ground, Shadow, ShadowRow};
use super::model::Model;
use super::occlusion::Occlusion;
use super::pixmap::{ENCODING, Pixmap, premultiplied};
use super::tile_scratch::{Drawn, TileScratch};
use crate::watch::{Stopped, Watch};

/// Maximum width and height of a picture in pixels. With the guard band, edge functions stay integers below 2^31; twice
/// of it would need wider ones.
pub const MAX_SIDE_PX: u32 = 8192;

/// The background and the quality of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RenderStyle {
    /// Background colour, straight sRGB.
    pub background: [u8; 4],
    /// Whether edges are drawn with sixteen samples per pixel instead of four.
    pub is_fine: bool,
    /// Whether hollows receive less light.
    pub is_occluded: bool,
    /// When the model has a shadow on the ground, the level plane through its lowest point.
    pub shadow: Ground,
}

/// Draws the model into a picture of `width x height` pixels (1 to [`MAX_SIDE_PX`] each; the camera must have been
/// framed for them).
///
/// # Errors
/// [`Stopped`] when the watch says stop; it is asked at least once a tile.
///
/// # Panics
/// When an index points past its array.
pub fn render(
    model: &Model<'_>,
    camera: &Camera,
    look: RenderStyle,
    [width, height]: [u32; 2],
    watch: &Watch,
) -> Result<Pixmap, Stopped> {
    let (width, height) = (width.clamp(1, MAX_SIDE_PX), height.clamp(1, MAX_SIDE_PX));
    let grid = TileGrid::of(width, height);
    let shadow = Shadow::of(model, camera, look.shadow, watch)?;
    let tiles = drawn(&BinnedModel::new(model, camera, grid, watch)?, look.is_fine, watch)?;
    let occlusion = if look.is_occluded { Some(Occlusion::of(&tiles, grid, camera, watch)?) } else { None };
    let finish = TileWriter { look, occlusion, shadow, paper: premultiplied(look.background) };
    let (columns, n_rows) = (width as usize, height as usize);
    let mut bytes = vec![0; columns * n_rows * 4];
    bytes.par_chunks_mut(columns * 4).enumerate().try_for_each(|(y, line)| {
        watch.check()?;
        let row = &tiles[y / TILE * usize::from(grid.columns)..];
        let shadow = finish.shadow.as_ref().and_then(|shadow| shadow.row(y));
        for (column, part) in line.chunks_mut(TILE * 4).enumerate() {
            finish.write(row[column].as_ref(), shadow.as_ref(), [column * TILE, y], part);
        }
        Ok(())
    })?;
    Ok(Pixmap { width, height, bytes })
}

/// Draws all tiles, row by row.
fn drawn(model: &BinnedModel<'_>, is_fine: bool, watch: &Watch) -> Result<Vec<Option<Drawn>>, Stopped> {
    let TileGrid { columns, rows } = model.grid;
    let tiles = (0..usize::from(columns) * usize::from(rows)).into_par_iter();
    let draw = |scratch: &mut TileScratch, tile: usize| {
        watch.check()?;
        let place = [tile % usize::from(columns), tile / usize::from(columns)];
        let origin = place.map(|i| i32::try_from(i * TILE).expect("pictures are bounded"));
        scratch.draw(model, (tile, origin), is_fine, watch)
    };
    tiles.map_init(|| TileScratch::new(model), draw).collect()
}

/// Encodes drawn tiles as the bytes of pixels.
struct TileWriter {
    look: RenderStyle,
    occlusion: Option<Occlusion>,
    shadow: Option<Shadow>,
    /// The background, linear and premultiplied.
    paper: [f32; 4],
}

impl TileWriter {
    /// Writes the pixels of one row of a tile, from pixel `place` of the picture on.
    fn write(&self, tile: Option<&Drawn>, shadow: Option<&ShadowRow<'_>>, [left, y]: [usize; 2], part: &mut [u8]) {
        let pixels = part.as_chunks_mut::<4>().0;
        if tile.is_none() && shadow.is_none() {
            pixels.fill(self.look.background);
            return;
        }
        let first = y % TILE * TILE;
        for (x, pixel) in pixels.iter_mut().enumerate() {
            let mut light = tile.and_then(|tile| tile.surface.get(first + x)).copied().map_or([0.0; 4], unpacked);
            if light[3] > 0.0
                && let (Some(occlusion), Some(tile)) = (&self.occlusion, tile)
            {
                let open = occlusion.open([left + x, y], tile.depth[first + x]);
                light = [light[0] * open, light[1] * open, light[2] * open, light[3]];
            }
            let line = tile.and_then(|tile| tile.over.get(first + x)).copied().map_or([0.0; 4], unpacked);
            if light[3] < 1.0 {
                let dark = shadow.map_or(0.0, |shadow| shadow.at(left + x));
                if [light[3], line[3], dark].iter().all(|share| *share <= 0.0) {
                    *pixel = self.look.background;
                    continue;
                }
                light = over(light, over([0.0, 0.0, 0.0, dark], self.paper));
            }
            *pixel = ENCODING.pixel(over(line, light));
        }
    }
}

fn unpacked(light: [u16; 4]) -> [f32; 4] {
    light.map(|x| f32::from(x) * (1.0 / 65535.0))
}

/// Composes linear, premultiplied light over other light.
fn over(light: [f32; 4], under: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|k| light[k] + (1.0 - light[3]) * under[k])
}
