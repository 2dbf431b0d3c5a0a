//! The loop over tiles: draw, ground, encode.

use std::iter;

use rayon::prelude::*;

use super::binned_model::BinnedModel;
use super::bins::{TILE, TileGrid};
use super::camera::Camera;
use super::contact::{Ground, Shadow};
use super::model::Model;
use super::occlusion::Occlusion;
use super::pixmap::{Pixmap, premultiplied};
use super::tile_rows::TileWriter;
use super::tile_scratch::{Drawn, TILE_PIXELS, TileScratch};
use crate::kept::Kept;
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
    // threads that wait for the last part of the shadow sort triangles
    let (shadow, binned) =
        rayon::join(|| Shadow::of(model, camera, look.shadow, watch), || BinnedModel::new(model, camera, grid, watch));
    let (shadow, binned) = (shadow?, binned?);
    let mut memory = TileMemory::new(&binned);
    let tiles = memory.drawn(&binned, look.is_fine, watch)?;
    drop(binned);
    let occlusion = if look.is_occluded { Some(Occlusion::of(&tiles, grid, camera, watch)?) } else { None };
    let background = look.background;
    let writer = TileWriter { background, paper: premultiplied(background), occlusion, shadow };
    let (columns, n_rows) = (width as usize, height as usize);
    let mut bytes = Kept::to_overwrite(columns * n_rows * 4);
    bytes.par_chunks_mut(columns * 4).enumerate().try_for_each(|(y, line)| {
        watch.check()?;
        let row = &tiles[y / TILE * usize::from(grid.columns)..];
        let shadow = writer.shadow.as_ref().and_then(|shadow| shadow.row(y));
        for (column, part) in line.chunks_mut(TILE * 4).enumerate() {
            writer.write(row[column].as_ref(), shadow.as_ref(), [column * TILE, y], part);
        }
        Ok(())
    })?;
    Ok(Pixmap { width, height, bytes })
}

/// The memory for the surface in all tiles, one after the other; none if the surface is not visible.
struct TileMemory {
    light: Kept<[u16; 4]>,
    depth: Kept<f32>,
}

impl TileMemory {
    fn new(model: &BinnedModel<'_>) -> Self {
        let n_pixels = if model.lamps.is_some() { model.grid.len() * TILE_PIXELS } else { 0 };
        Self { light: Kept::to_overwrite(n_pixels), depth: Kept::to_overwrite(n_pixels) }
    }

    /// Draws all tiles, row by row.
    fn drawn(
        &mut self,
        model: &BinnedModel<'_>,
        is_fine: bool,
        watch: &Watch,
    ) -> Result<Vec<Option<Drawn<'_>>>, Stopped> {
        let columns = usize::from(model.grid.columns);
        let surfaces = self.light.chunks_mut(TILE_PIXELS).zip(self.depth.chunks_mut(TILE_PIXELS)).map(Some);
        let tiles: Vec<_> = surfaces.chain(iter::repeat_with(|| None)).take(model.grid.len()).enumerate().collect();
        let draw = |scratch: &mut TileScratch, (tile, memory)| {
            watch.check()?;
            let place: [usize; 2] = [tile % columns, tile / columns];
            let origin = place.map(|i| i32::try_from(i * TILE).expect("pictures are bounded"));
            scratch.draw(model, (tile, origin), memory, (is_fine, watch))
        };
        tiles.into_par_iter().map_init(|| TileScratch::new(model), draw).collect()
    }
}
