//! The loop over tiles: draw, light, draw lines over it, encode.

#![expect(clippy::cast_precision_loss, reason = "pixel numbers are small")]

use rayon::prelude::*;

use super::binned_model::BinnedModel;
use super::bins::{Grid, TILE};
use super::camera::Camera;
use super::facets::Facets;
use super::forecast;
use super::line::Layer;
use super::model::Model;
use super::pixmap::{ENCODING, Pixmap, premultiplied};
use super::shade::{Lamps, Spots};
use super::triangle::{NOBODY, PLACES, SAMPLES, Samples, slope};
use crate::watch::{Stopped, Watch};

#[expect(clippy::cast_possible_truncation, reason = "a tile is some dozen pixels wide")]
const SIDE: u32 = TILE as u32;

/// Lines on a surface are lifted toward the viewer by this share of the radius of the scene.
/// Half of it lets lines sink into coarse triangles beside them; twice of it lets lines behind an edge show through
/// sooner.
const LIFT: f64 = 1e-3;
/// On steep surfaces they are lifted by at most this share.
/// Half of it breaks lines on surfaces seen along their plane; twice of it lets lines behind a silhouette show through.
const STEEP_LIFT: f64 = 1e-2;

/// Scratch memory of one thread.
struct Desk {
    samples: Samples,
    /// Linear, premultiplied light of each pixel.
    light: Vec<[f32; 4]>,
    coverage: Vec<f32>,
    facets: Facets,
    spots: Spots,
}

/// Largest width and height of a picture, pixels.
/// With the guard beyond it, edge functions stay whole numbers below 2^31; twice of it would need wider ones.
pub const MAX_SIDE_PX: u32 = 8192;

/// Draws the model into a picture of `width x height` pixels (1 to [`MAX_SIDE_PX`] each; the camera must have been
/// framed for them) over `background`, straight sRGB.
///
/// # Errors
/// [`Stopped`] when the watch says stop; it is asked at least once a tile.
///
/// # Panics
/// When an index points past its array.
pub fn render(
    model: &Model<'_>,
    camera: &Camera,
    background: [u8; 4],
    [width, height]: [u32; 2],
    watch: &Watch,
) -> Result<Pixmap, Stopped> {
    let (width, height) = (width.clamp(1, MAX_SIDE_PX), height.clamp(1, MAX_SIDE_PX));
    let model = &BinnedModel::new(model, camera, Grid::of(width, height), watch)?;
    let (columns, n_rows) = (width as usize, height as usize);
    let mut bytes = vec![0; columns * n_rows * 4];
    let encoding = &*ENCODING;
    let paper = premultiplied(background);
    bytes.par_chunks_mut(TILE * columns * 4).enumerate().try_for_each(|(row, band)| {
        let mut tiles: Vec<Vec<&mut [u8]>> = (0..columns.div_ceil(TILE)).map(|_| Vec::with_capacity(TILE)).collect();
        for line in band.chunks_mut(columns * 4) {
            line.chunks_mut(TILE * 4).zip(&mut tiles).for_each(|(part, tile)| tile.push(part));
        }
        let n_columns = tiles.len();
        tiles.par_iter_mut().enumerate().try_for_each_init(
            || Desk::new(model),
            |desk, (column, lines)| {
                watch.check()?;
                let tile = row * n_columns + column;
                let origin = [column, row].map(|i| i32::try_from(i * TILE).expect("pictures are bounded"));
                if desk.draw(model, tile, origin, paper, watch)? {
                    for (y, line) in lines.iter_mut().enumerate() {
                        for (pixel, light) in line.chunks_exact_mut(4).zip(&desk.light[y * TILE..]) {
                            pixel.copy_from_slice(&encoding.pixel(*light));
                        }
                    }
                } else {
                    let pixels = lines.iter_mut().flat_map(|line| line.chunks_exact_mut(4));
                    pixels.for_each(|pixel| pixel.copy_from_slice(&background));
                }
                Ok(())
            },
        )
    })?;
    Ok(Pixmap { width, height, bytes })
}

impl Desk {
    fn new(model: &BinnedModel<'_>) -> Self {
        let n = TILE * TILE;
        Self {
            samples: Samples::new(),
            light: vec![[0.0; 4]; n],
            coverage: vec![0.0; n],
            facets: Facets::default(),
            spots: Spots::new(model.lamps.as_ref().map_or([0.0; 3], |lamps| lamps.outside)),
        }
    }

    /// Draws one tile into `self.light`; `false` when nothing touches it.
    fn draw(
        &mut self,
        model: &BinnedModel<'_>,
        tile: usize,
        origin: [i32; 2],
        paper: [f32; 4],
        watch: &Watch,
    ) -> Result<bool, Stopped> {
        let surface = model.touches(tile);
        if !surface && model.layers.iter().all(|layer| layer.tile(tile).next().is_none()) {
            return Ok(false);
        }
        self.samples.clear();
        // outsides mostly hide the insides behind them
        for is_back in [false, true] {
            for (n, id) in model.tile(tile, is_back, self.samples.farthest()).enumerate() {
                if n % 4096 == 4095 {
                    watch.check()?;
                    watch.advance(forecast::rows(self.samples.done()));
                }
                self.samples.draw(model.corners(id), id, origin);
            }
        }
        watch.advance(forecast::rows(self.samples.done()));
        match &model.lamps {
            Some(lamps) if surface => self.illuminate(model, lamps, paper, origin),
            _ => self.light.fill(paper),
        }
        for layer in &model.layers {
            self.stroke(model, layer, tile, origin, watch)?;
        }
        Ok(true)
    }

    /// Lights what is seen of the surface, once for each triangle in a pixel, at the centre of its samples there; what
    /// is left of the pixel shows the paper.
    fn illuminate(&mut self, model: &BinnedModel<'_>, lamps: &Lamps, paper: [f32; 4], origin: [i32; 2]) {
        self.facets.clear();
        let corner = origin.map(|o| o as f32);
        for (pixel, owners) in (0_u32..).zip(&self.samples.owner) {
            let [x, y] = [(pixel % SIDE) as f32, (pixel / SIDE) as f32];
            let mut rest = held_by(owners, NOBODY);
            self.light[pixel as usize] = paper.map(|c| c * CENTRES[rest][2]);
            while rest != ALL {
                let owner = owners[rest.trailing_ones() as usize];
                let held = held_by(owners, owner);
                rest |= held;
                let (facet, tint) = self.facets.of(model, owner, origin);
                let [right, down, share] = CENTRES[held];
                let place = [x + right, y + down];
                let paint = model.paint.as_ref().zip(tint).map(|(paint, tint)| paint.color(tint, place));
                let finished = model.finisher.as_ref().map(|finisher| {
                    let normal = |place| facet.normal(place);
                    finisher.color(paint.unwrap_or(lamps.outside), normal, place, corner, facet.back)
                });
                if let Some(color) = finished.or(paint) {
                    self.spots.color(color);
                }
                let global = [corner[0] + place[0], corner[1] + place[1]];
                self.spots.push((pixel, share), facet.normal(place), global, facet.back);
                if self.spots.full() {
                    shine(&mut self.spots, model, lamps, &mut self.light);
                }
            }
        }
        shine(&mut self.spots, model, lamps, &mut self.light);
    }

    /// Draws a layer of lines: first the coverage of all of them, then their colour once, so that joints do not show.
    fn stroke(
        &mut self,
        model: &BinnedModel<'_>,
        layer: &Layer,
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
        for (light, &cover) in self.light.iter_mut().zip(&self.coverage).filter(|(_, cover)| **cover > 0.0) {
            let rest = 1.0 - cover * layer.light[3];
            *light = std::array::from_fn(|k| cover * layer.light[k] + rest * light[k]);
        }
        Ok(())
    }
}

/// Adds the light of the waiting spots: their colours as they are where the surface has a finish.
fn shine(spots: &mut Spots, model: &BinnedModel<'_>, lamps: &Lamps, light: &mut [[f32; 4]]) {
    if model.finisher.is_some() {
        spots.shown(light);
    } else {
        lamps.illuminate(spots, light);
    }
}

/// All samples of a pixel, as bits.
const ALL: usize = (1 << SAMPLES) - 1;

/// The samples that `owner` has, as bits.
fn held_by(owners: &[u32; SAMPLES], owner: u32) -> usize {
    (0..SAMPLES).fold(0, |held, s| held | (usize::from(owners[s] == owner) << s))
}

/// For each set of samples: its centre in the pixel, right and down, and its share of the pixel.
const CENTRES: [[f32; 3]; ALL + 1] = {
    let mut centres = [[0.0; 3]; ALL + 1];
    let mut held = 1;
    while held <= ALL {
        let (mut n, mut x, mut y, mut s) = (0, 0, 0, 0);
        while s < SAMPLES {
            if held >> s & 1 == 1 {
                (n, x, y) = (n + 1, x + PLACES[s][0], y + PLACES[s][1]);
            }
            s += 1;
        }
        let eighths = 8.0 * n as f32;
        centres[held] = [x as f32 / eighths, y as f32 / eighths, n as f32 / SAMPLES as f32];
        held += 1;
    }
    centres
};

/// What hides lines: the samples of a tile.
struct Veil<'a> {
    model: &'a BinnedModel<'a>,
    samples: &'a Samples,
    reach_px: f32,
    lift: [f32; 2],
    steep: [f32; 2],
    known: u32,
    slope: f32,
}

impl<'a> Veil<'a> {
    fn new(model: &'a BinnedModel<'a>, samples: &'a Samples, half_px: f32) -> Self {
        let nearer = model.camera.nearer();
        #[expect(clippy::cast_possible_truncation, reason = "a lift needs no last digit")]
        let lifted = |share: f64| nearer.map(|c| (c * share * model.camera.radius) as f32);
        Self {
            model,
            samples,
            reach_px: half_px + 1.0,
            lift: lifted(LIFT),
            steep: lifted(STEEP_LIFT),
            known: NOBODY,
            slope: 0.0,
        }
    }

    /// How much of a pixel, 0 to 1, shows something of this depth, lifted a little so that lines on a surface lie over
    /// it also where the surface is steep.
    fn seen(&mut self, pixel: usize, depth: f32) -> f32 {
        let near = self.lift[0] + self.lift[1] * depth * depth;
        let most = self.steep[0] + self.steep[1] * depth * depth;
        let mut n = 0_u8;
        for s in 0..SAMPLES {
            let owner = self.samples.owner[pixel][s];
            let surface = self.samples.depth[pixel][s];
            if owner == NOBODY || depth + near >= surface {
                n += 1;
            } else if depth + most >= surface {
                if owner != self.known {
                    let [x, y] = slope(&self.model.corners(owner));
                    #[expect(clippy::cast_possible_truncation, reason = "a lift needs no last digit")]
                    let steepness = (x.abs() + y.abs()) as f32;
                    (self.known, self.slope) = (owner, steepness);
                }
                n += u8::from(depth + near + self.slope * self.reach_px >= surface);
            }
        }
        f32::from(n) / SAMPLES as f32
    }
}
