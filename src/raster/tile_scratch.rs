//! Draws one tile: its samples, their light, refined edges, and the lines on top.

#![expect(clippy::cast_precision_loss, reason = "pixel numbers are small")]

use super::binned_model::BinnedModel;
use super::bins::TILE;
use super::facets::Facets;
use super::fine::{FINE_PLACES, FINE_SAMPLES, Fine, PixelSet};
use super::forecast;
use super::line::StrokeLayer;
use super::paint::Hiding;
use super::samples::Samples;
use super::shade::{Lamps, Spots};
use super::triangle::{NOBODY, SAMPLE_PLACES, SAMPLES};
use super::veil::Veil;
use crate::watch::{Stopped, Watch};

#[expect(clippy::cast_possible_truncation, reason = "a tile is some dozen pixels wide")]
const TILE_WIDTH: u32 = TILE as u32;
/// Number of pixels of a tile.
const TILE_PIXELS: usize = TILE * TILE;

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

/// A drawn tile that something touches.
#[derive(Debug)]
pub(super) struct Drawn {
    /// Linear light of the surface in each pixel from 0 to 65,535, premultiplied by the covered fraction of the pixel,
    /// which is the last component; empty if there is no surface.
    pub(super) surface: Vec<[u16; 4]>,
    /// The largest depth in each pixel, 0 if no sample is covered; empty if there is no surface.
    pub(super) depth: Vec<f32>,
    /// Linear light of the lines on top, like `surface`.
    pub(super) over: Vec<[u16; 4]>,
}

impl TileScratch {
    pub(super) fn new(model: &BinnedModel<'_>) -> Self {
        let lighter = || Lighter {
            light: vec![[0.0; 4]; TILE_PIXELS],
            facets: Facets::default(),
            spots: Spots::new(model.lamps.as_ref().map_or([0.0; 3], |lamps| lamps.outside)),
            marks: PixelSet::default(),
        };
        let has_clear = model.paint.is_some_and(|paint| paint.has_clear());
        Self {
            samples: Samples::new(),
            fine: Fine::default(),
            lighter: lighter(),
            glass: has_clear.then(|| Glass { samples: Samples::new(), lighter: lighter() }),
            coverage: vec![0.0; TILE_PIXELS],
            over: vec![[0.0; 4]; TILE_PIXELS],
        }
    }

    /// Draws one tile; returns `None` if nothing touches it. If `is_fine`, edges are refined.
    pub(super) fn draw(
        &mut self,
        model: &BinnedModel<'_>,
        (tile, origin): (usize, [i32; 2]),
        is_fine: bool,
        watch: &Watch,
    ) -> Result<Option<Drawn>, Stopped> {
        let surface = model.touches(tile);
        let lined = model.layers.iter().any(|layer| layer.tile(tile).next().is_some());
        if !surface && !lined {
            return Ok(None);
        }
        self.samples.clear();
        let has_clear = self.glass.is_some();
        // front faces mostly hide the back faces behind them
        for is_back in [false, true] {
            for (n, id) in model.tile(tile, is_back, self.samples.farthest()).enumerate() {
                if n % 4096 == 4095 {
                    watch.check()?;
                    watch.advance(forecast::rows(self.samples.done()));
                }
                match hiding(model, id, has_clear) {
                    Hiding::Wholly => self.samples.draw(model.corners(id), id, origin),
                    Hiding::InPlaces => {
                        let alpha = alphas(model, id, origin);
                        self.samples.draw_where(model.corners(id), id, origin, |place| alpha(place) >= OPAQUE_ALPHA);
                    }
                    Hiding::Partly | Hiding::Never => {}
                }
            }
        }
        watch.advance(forecast::rows(self.samples.done()));
        let mut drawn = Drawn { surface: Vec::new(), depth: Vec::new(), over: Vec::new() };
        if let Some(lamps) = model.lamps.as_ref().filter(|_| surface) {
            self.lighter.begin();
            for (pixel, owners) in (0..).zip(&self.samples.owner) {
                self.lighter
                    .add::<_, false>(model, lamps, (pixel, owners), origin, |held| SAMPLE_CENTRES[held as usize]);
            }
            self.lighter.finish(model, lamps);
            if is_fine && !self.lighter.marks.is_empty() {
                self.look_closely(model, lamps, (tile, origin), watch)?;
            }
            self.glaze(model, lamps, (tile, origin), watch)?;
            drawn.surface = packed(&self.lighter.light);
            drawn.depth = self.samples.depth.iter().map(|d| d[0].max(d[1]).max(d[2]).max(d[3])).collect();
        }
        if lined {
            self.over.fill([0.0; 4]);
            for layer in &model.layers {
                self.stroke(model, layer, tile, origin, watch)?;
            }
            drawn.over = packed(&self.over);
        }
        Ok(Some(drawn))
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
            for (n, id) in model.tile(tile, is_back, 0.0).enumerate() {
                if n % 4096 == 4095 {
                    watch.check()?;
                }
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
        for (pixel, owners) in self.fine.pixels() {
            self.lighter.light[pixel as usize] = [0.0; 4];
            self.lighter.add::<_, false>(model, lamps, (pixel, owners), origin, fine_centre);
        }
        self.lighter.finish(model, lamps);
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
            for (n, id) in model.tile(tile, is_back, self.samples.farthest()).enumerate() {
                if n % 4096 == 4095 {
                    watch.check()?;
                }
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
            watch.advance(forecast::rows(samples.done()));
            lighter.begin();
            for (pixel, owners) in (0..).zip(&samples.owner) {
                lighter.add::<_, true>(model, lamps, (pixel, owners), origin, |held| SAMPLE_CENTRES[held as usize]);
            }
            lighter.finish(model, lamps);
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

/// Accumulates the light of the pixels of a tile.
struct Lighter {
    /// Linear light of each pixel, premultiplied by the lit fraction.
    light: Vec<[f32; 4]>,
    facets: Facets,
    spots: Spots,
    /// Pixels with a visible edge: partly covered, or with parts of different light.
    marks: PixelSet,
}

impl Lighter {
    fn begin(&mut self) {
        self.facets.clear();
        self.marks.clear();
        self.light.fill([0.0; 4]);
    }

    /// Lights the visible surface in a pixel, once per triangle, at the centroid of its samples; if `IS_CLEAR`, alpha
    /// matters.
    fn add<const SAMPLES: usize, const IS_CLEAR: bool>(
        &mut self,
        model: &BinnedModel<'_>,
        lamps: &Lamps,
        (pixel, owners): (u32, &[u32; SAMPLES]),
        origin: [i32; 2],
        centre: impl Fn(u32) -> [f32; 3],
    ) {
        let all = (1 << SAMPLES) - 1;
        if owners.iter().all(|owner| *owner == owners[0]) {
            if owners[0] != NOBODY {
                self.add_part::<IS_CLEAR>(model, lamps, (pixel, owners[0]), origin, centre(all));
            }
            return;
        }
        let mut rest = held_by(owners, NOBODY);
        if rest != 0 {
            self.marks.add(pixel);
        }
        while rest != all {
            let owner = owners[rest.trailing_ones() as usize];
            let held = held_by(owners, owner);
            rest |= held;
            self.add_part::<IS_CLEAR>(model, lamps, (pixel, owner), origin, centre(held));
        }
    }

    /// Lights the part of a pixel in which a triangle is seen; the part is given by its centroid and its share.
    #[inline]
    fn add_part<const IS_CLEAR: bool>(
        &mut self,
        model: &BinnedModel<'_>,
        lamps: &Lamps,
        (pixel, owner): (u32, u32),
        origin: [i32; 2],
        [right, down, share]: [f32; 3],
    ) {
        let (facet, tint) = self.facets.of(model, owner, origin);
        let [x, y] = [(pixel % TILE_WIDTH) as f32, (pixel / TILE_WIDTH) as f32];
        let place = [x + right, y + down];
        let paint = model.paint.as_ref().zip(tint).map(|(paint, tint)| paint.color(tint, place));
        let finished = model.finisher.as_ref().map(|finisher| {
            let normal = |place| facet.normal(place);
            let corner = origin.map(|o| o as f32);
            finisher.color(paint.unwrap_or(lamps.outside), normal, place, corner, facet.back)
        });
        if let Some(color) = finished.or(paint) {
            self.spots.color(color);
        }
        let global = [origin[0] as f32 + place[0], origin[1] as f32 + place[1]];
        let alpha = model.paint.as_ref().zip(tint).filter(|_| IS_CLEAR);
        let alpha = alpha.map_or(1.0, |(paint, tint)| paint.alpha(model.whole(owner), tint, place));
        let share = share * alpha;
        if let Some(paint) = &model.paint {
            self.spots.finish(paint.finish(model.whole(owner)));
        }
        self.spots.push((pixel, share), facet.normal(place), global, facet.back);
        if self.spots.full() {
            self.finish(model, lamps);
        }
    }

    /// Adds the light of the waiting spots; if the surface has a finish, their colours unchanged.
    fn finish(&mut self, model: &BinnedModel<'_>, lamps: &Lamps) {
        if model.finisher.is_some() {
            self.spots.show(&mut self.light, &mut self.marks);
        } else {
            lamps.illuminate(&mut self.spots, &mut self.light, &mut self.marks);
        }
    }
}

/// Alpha from which a texture hides everything behind it and is drawn with the opaque surfaces; below 1 minus this, it
/// is invisible. It is half a byte step from 1: twice of the margin would treat pixels of 254 as opaque, half of it is
/// closer to the rounding of a blend of four pixels.
const OPAQUE_ALPHA: f32 = 1.0 - 0.5 / 255.0;

/// Returns how a triangle hides what lies behind it; without translucent triangles, all are opaque.
fn hiding(model: &BinnedModel<'_>, id: u32, has_clear: bool) -> Hiding {
    model.paint.filter(|_| has_clear).map_or(Hiding::Wholly, |paint| paint.hiding(model.whole(id)))
}

/// Returns the opacity of a triangle as a function of the place in the tile.
fn alphas<'a>(model: &'a BinnedModel<'_>, id: u32, origin: [i32; 2]) -> impl Fn([f32; 2]) -> f32 + 'a {
    let (_, tint) = model.facet(id, origin);
    let paint = model.paint.as_ref().zip(tint);
    move |place| paint.as_ref().map_or(1.0, |(paint, tint)| paint.alpha(model.whole(id), tint, place))
}

/// Returns the samples of `owner` as a bit set.
fn held_by<const SAMPLES: usize>(owners: &[u32; SAMPLES], owner: u32) -> u32 {
    (0..SAMPLES).fold(0, |held, s| held | (u32::from(owners[s] == owner) << s))
}

/// Returns the centroid in the pixel of a set of sixteen samples, right and down, and its fraction of the pixel.
fn fine_centre(held: u32) -> [f32; 3] {
    let (mut x, mut y, mut rest) = (0, 0, held);
    while rest != 0 {
        let [right, down] = FINE_PLACES[rest.trailing_zeros() as usize];
        (x, y) = (x + right, y + down);
        rest &= rest - 1;
    }
    let n = held.count_ones() as f32;
    [x as f32 / (32.0 * n), y as f32 / (32.0 * n), n / FINE_SAMPLES as f32]
}

/// For each set of four samples its centroid in the pixel, right and down, and its fraction of the pixel.
const SAMPLE_CENTRES: [[f32; 3]; 1 << SAMPLES] = {
    let mut centres = [[0.0; 3]; 1 << SAMPLES];
    let mut held = 1;
    while held < 1 << SAMPLES {
        let (mut n, mut x, mut y, mut s) = (0, 0, 0, 0);
        while s < SAMPLES {
            if held >> s & 1 == 1 {
                (n, x, y) = (n + 1, x + SAMPLE_PLACES[s][0], y + SAMPLE_PLACES[s][1]);
            }
            s += 1;
        }
        let eighths = 8.0 * n as f32;
        centres[held] = [x as f32 / eighths, y as f32 / eighths, n as f32 / SAMPLES as f32];
        held += 1;
    }
    centres
};

/// Converts light to 16-bit integers.
fn packed(light: &[[f32; 4]]) -> Vec<[u16; 4]> {
    // the first 16 digits after the point of a number from 1 to 2, which are those of its bits: no cast, so vector code
    let number = |x: f32| {
        let x = if x > 0.0 { x } else { 0.0 };
        let x = if x < 1.0 { x } else { 1.0 };
        let two = 1.0 + (x * (65535.0 / 65536.0) + 0.5 / 65536.0);
        (two.to_bits() >> 7 & 0xffff) as u16
    };
    light.iter().map(|light| light.map(number)).collect()
}
