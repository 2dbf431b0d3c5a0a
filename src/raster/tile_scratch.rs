//! Draws one tile: its samples, their light, refined edges, and the lines on top.

use multiversion::multiversion;

use super::binned_model::{BinnedModel, LISTED_TRIANGLES};
use super::bins::TILE;
use super::facet_block::FacetBlock;
use super::fine::Fine;
use super::forecast;
use super::lighter::{Lighter, LitTile};
use super::line::StrokeLayer;
use super::paint::Hiding;
use super::samples::Samples;
use super::shade::Lamps;
use super::veil::Veil;
use crate::watch::{Stopped, Watch};

/// Number of pixels of a tile.
pub(super) const TILE_PIXELS: usize = TILE * TILE;

/// The scratch memory of one thread.
pub(super) struct TileScratch {
    samples: Samples,
    fine: Fine,
    lighter: Lighter,
    glass: Option<Glass>,
    coverage: Vec<f32>,
    over: Vec<[f32; 4]>,
}

/// The nearest samples of translucent triangles: first of back-facing ones, then of front-facing ones, each blended
/// over what lies behind.
struct Glass {
    samples: Samples,
    lighter: Lighter,
}

/// The memory for the surface in a tile: light and depth of each pixel, see [`Drawn`].
pub(super) type SurfaceMemory<'a> = (&'a mut [[u16; 4]], &'a mut [f32]);

/// A drawn tile that something touches.
#[derive(Debug)]
pub(super) struct Drawn<'a> {
    /// Linear light of the surface in each pixel from 0 to 65,535, premultiplied by the covered fraction of the pixel,
    /// which is the last component; empty if there is no surface.
    pub(super) surface: &'a [[u16; 4]],
    /// The largest depth in each pixel, 0 if no sample is covered; empty if there is no surface.
    pub(super) depth: &'a [f32],
    /// Linear light of the lines on top, like `surface`.
    pub(super) over: Vec<[u16; 4]>,
}

/// The tiles of a picture, row by row; `None` where nothing is drawn.
pub(super) type DrawnTiles<'a> = [Option<Drawn<'a>>];

impl TileScratch {
    pub(super) fn new(model: &BinnedModel<'_>) -> Self {
        let has_clear = model.paint.is_some_and(|paint| paint.has_clear());
        Self {
            samples: Samples::new(),
            fine: Fine::default(),
            lighter: Lighter::new(model),
            glass: has_clear.then(|| Glass { samples: Samples::new(), lighter: Lighter::new(model) }),
            coverage: vec![0.0; TILE_PIXELS],
            over: vec![[0.0; 4]; TILE_PIXELS],
        }
    }

    /// Draws one tile; `memory` is for its surface, if that is visible. Returns `None` if nothing touches it. If
    /// `is_fine`, edges are refined.
    pub(super) fn draw<'a>(
        &mut self,
        model: &BinnedModel<'_>,
        (tile, origin): (usize, [i32; 2]),
        memory: Option<SurfaceMemory<'a>>,
        (is_fine, watch): (bool, &Watch),
    ) -> Result<Option<Drawn<'a>>, Stopped> {
        let surface = model.touches(tile);
        let lined = model.layers.iter().any(|layer| layer.tile(tile).next().is_some());
        if !surface && !lined {
            return Ok(None);
        }
        self.samples.clear();
        let has_clear = self.glass.is_some();
        // front faces mostly hide the back faces behind them
        for is_back in [false, true] {
            let mut n_listed = 0;
            for list in model.tile(tile, is_back, self.samples.farthest()) {
                for &id in list {
                    match hiding(model, id, has_clear) {
                        Hiding::Wholly => self.samples.draw(model.corners(id), id, origin),
                        Hiding::InPlaces => {
                            let alpha = alphas(model, id, origin);
                            let is_there = |place| alpha(place) >= OPAQUE_ALPHA;
                            self.samples.draw_where(model.corners(id), id, origin, is_there);
                        }
                        Hiding::Partly | Hiding::Never => {}
                    }
                }
                watch.check()?;
                n_listed += list.len();
                if n_listed >= LISTED_TRIANGLES {
                    n_listed = 0;
                    watch.advance(forecast::rows(self.samples.done()));
                }
            }
            self.samples.settle(origin);
        }
        watch.advance(forecast::rows(self.samples.done()));
        let mut drawn = Drawn { surface: &[], depth: &[], over: Vec::new() };
        if let (Some(lamps), Some((light, depth))) = (model.lamps.as_ref().filter(|_| surface), memory) {
            self.lighter.illuminate(&LitTile::new(model, lamps, origin, false), &self.samples.owner);
            if is_fine && !self.lighter.marks.is_empty() {
                self.look_closely(model, lamps, (tile, origin), watch)?;
            }
            self.glaze(model, lamps, (tile, origin), watch)?;
            pack(&self.lighter.light, light);
            self.samples.nearest(depth);
            (drawn.surface, drawn.depth) = (light, depth);
        }
        if lined {
            drawn.over = self.strokes(model, (tile, origin), watch)?;
        }
        Ok(Some(drawn))
    }

    /// Draws all layers of lines.
    fn strokes(
        &mut self,
        model: &BinnedModel<'_>,
        (tile, origin): (usize, [i32; 2]),
        watch: &Watch,
    ) -> Result<Vec<[u16; 4]>, Stopped> {
        self.over.fill([0.0; 4]);
        for layer in &model.layers {
            self.stroke(model, layer, tile, origin, watch)?;
        }
        let mut over = vec![[0; 4]; TILE_PIXELS];
        pack(&self.over, &mut over);
        Ok(over)
    }

    /// Draws the pixels with visible edges once more, with more samples.
    fn look_closely(
        &mut self,
        model: &BinnedModel<'_>,
        lamps: &Lamps,
        (tile, origin): (usize, [i32; 2]),
        watch: &Watch,
    ) -> Result<(), Stopped> {
        self.fine.begin(&self.lighter.marks);
        for is_back in [false, true] {
            for list in model.tile(tile, is_back, 0.0) {
                watch.check()?;
                for &id in list {
                    match hiding(model, id, self.glass.is_some()) {
                        Hiding::Wholly => self.fine.draw(model.corners(id), id, origin),
                        Hiding::InPlaces => {
                            let alpha = alphas(model, id, origin);
                            self.fine.draw_where(model.corners(id), id, origin, |place| alpha(place) >= OPAQUE_ALPHA);
                        }
                        Hiding::Partly | Hiding::Never => {}
                    }
                }
            }
        }
        self.lighter.look_closely(&LitTile::new(model, lamps, origin, false), &self.fine);
        Ok(())
    }

    /// Draws the translucent triangles over what lies behind them, with four samples per pixel.
    fn glaze(
        &mut self,
        model: &BinnedModel<'_>,
        lamps: &Lamps,
        (tile, origin): (usize, [i32; 2]),
        watch: &Watch,
    ) -> Result<(), Stopped> {
        let Some(Glass { samples, lighter }) = &mut self.glass else { return Ok(()) };
        for is_back in [true, false] {
            samples.begin_before(&self.samples);
            for list in model.tile(tile, is_back, self.samples.farthest()) {
                watch.check()?;
                for &id in list {
                    match hiding(model, id, true) {
                        Hiding::Partly => samples.draw(model.corners(id), id, origin),
                        Hiding::InPlaces => {
                            let alpha = alphas(model, id, origin);
                            let is_clear = |place| (1.0 - OPAQUE_ALPHA..OPAQUE_ALPHA).contains(&alpha(place));
                            samples.draw_where(model.corners(id), id, origin, is_clear);
                        }
                        Hiding::Wholly | Hiding::Never => {}
                    }
                }
            }
            samples.settle(origin);
            watch.advance(forecast::rows(samples.done()));
            lighter.illuminate(&LitTile::new(model, lamps, origin, true), &samples.owner);
            for (under, over) in self.lighter.light.iter_mut().zip(&lighter.light) {
                *under = std::array::from_fn(|k| over[k] + (1.0 - over[3]) * under[k]);
            }
        }
        Ok(())
    }

    /// Draws a layer of lines: first the coverage of all lines, then their colour once, so that joints do not show.
    fn stroke(
        &mut self,
        model: &BinnedModel<'_>,
        layer: &StrokeLayer,
        tile: usize,
        origin: [i32; 2],
        watch: &Watch,
    ) -> Result<(), Stopped> {
        self.coverage.fill(0.0);
        let mut veil = Veil::new(model, &self.samples, layer.half_px());
        for (n, segment) in layer.tile(tile).enumerate() {
            if n % 4096 == 4095 {
                watch.check()?;
            }
            layer.cover(segment, origin, &mut self.coverage, |pixel, depth| veil.seen(pixel, depth));
        }
        for (over, &cover) in self.over.iter_mut().zip(&self.coverage).filter(|(_, cover)| **cover > 0.0) {
            let rest = 1.0 - cover * layer.light[3];
            *over = std::array::from_fn(|k| cover * layer.light[k] + rest * over[k]);
        }
        Ok(())
    }
}

/// Alpha from which a texture hides everything behind it and is drawn with the opaque surfaces; below 1 minus this, it
/// is invisible. It is half a byte step from 1: twice of the margin would treat pixels of 254 as opaque, half of it is
/// closer to the rounding of a blend of four pixels.
const OPAQUE_ALPHA: f32 = 1.0 - 0.5 / 255.0;

/// Returns how a triangle hides what lies behind it; without translucent triangles, all are opaque.
fn hiding(model: &BinnedModel<'_>, id: u32, has_clear: bool) -> Hiding {
    match &model.paint {
        Some(paint) if has_clear => paint.hiding(model.whole(id)),
        _ => Hiding::Wholly,
    }
}

/// Returns the opacity of a triangle as a function of the place in the tile.
fn alphas<'a>(model: &'a BinnedModel<'_>, id: u32, origin: [i32; 2]) -> impl Fn([f32; 2]) -> f32 + 'a {
    let tint = FacetBlock::of(model, &[id], origin).tint(0);
    let paint = model.paint.as_ref().zip(tint);
    move |place| paint.as_ref().map_or(1.0, |(paint, tint)| paint.alpha(model.whole(id), tint, place))
}

/// Converts light to 16-bit integers. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn pack(light: &[[f32; 4]], packed: &mut [[u16; 4]]) {
    for (packed, light) in packed.iter_mut().zip(light) {
        for k in 0..4 {
            let x = if light[k] > 0.0 { light[k] } else { 0.0 };
            let x = if x < 1.0 { x } else { 1.0 };
            // the first 16 digits after the point of a number from 1 to 2, which are those of its bits: no cast, so
            // vector code
            let two = 1.0 + (x * (65535.0 / 65536.0) + 0.5 / 65536.0);
            packed[k] = (two.to_bits() >> 7 & 0xffff) as u16;
        }
    }
}
