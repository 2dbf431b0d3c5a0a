//! Lines and discs, anti-aliased and hidden behind surfaces.

#![expect(clippy::cast_possible_truncation, reason = "values are checked to lie inside the guard band before the cast")]
#![expect(clippy::cast_sign_loss, reason = "values are clamped to the tile before the cast")]
#![expect(clippy::cast_precision_loss, reason = "pixel numbers and counts are small or need no last digit")]

use rayon::prelude::*;

use super::bins::{Bins, TILE, TileGrid, TileRect};
use super::camera::Camera;
use super::clip;
use super::model::{Crowding, Strokes};
use super::pixmap::premultiplied;
use crate::watch::{Stopped, Watch};

/// A segment in the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSegment {
    /// Pixel coordinates of both ends.
    pub(super) ends: [[f32; 2]; 2],
    /// Depths of both ends.
    pub(super) depths: [f32; 2],
}

/// One list of strokes, projected and sorted into tiles.
#[derive(Debug)]
pub(super) struct StrokeLayer {
    segments: Vec<PixelSegment>,
    runs: Vec<Bins>,
    half_px: f32,
    /// Linear light, premultiplied.
    pub(super) light: [f32; 4],
    /// The opacity of lines behind a surface.
    hidden: f32,
}

/// Discs lie over what stands before them by less than this many of their radii, so that one on a surface is whole
/// where its centre is seen.
/// Half of it lets slopes of 45 degrees bite into discs; twice of it lets discs behind thin bodies show through.
const DISC_LIFT: f64 = 2.0;

fn projected(camera: &Camera, strokes: &Strokes<'_>, [a, b]: [u32; 2]) -> Option<PixelSegment> {
    let ends = [a, b].map(|i| camera.view(strokes.positions[i as usize]));
    let ends = clip::segment(camera, ends)?;
    let places = ends.map(|e| camera.pixel(e));
    let half_px = if a == b { 0.5 * f64::from(strokes.width_px) } else { 0.0 };
    let depths = ends.map(|e| {
        let depth = camera.depth(e[3]);
        let [constant, square] = camera.nearer();
        let radius = half_px * e[2] / camera.scale();
        (depth + (constant + square * depth * depth) * DISC_LIFT * radius) as f32
    });
    let finite = places.iter().flatten().all(|x| x.is_finite()) && depths.iter().all(|d| d.is_finite());
    finite.then(|| PixelSegment { ends: places.map(|p| p.map(|x| x as f32)), depths })
}

impl PixelSegment {
    fn touches(&self, grid: TileGrid, half_px: f32) -> Option<TileRect> {
        let [[ax, ay], [bx, by]] = self.ends;
        let reach = half_px + 1.0;
        let low = |u: f32, v: f32| (u.min(v) - reach).floor() as i32;
        let high = |u: f32, v: f32| (u.max(v) + reach).floor() as i32;
        TileRect::of(grid, [low(ax, bx), low(ay, by), high(ax, bx), high(ay, by)])
    }

    fn length_px(&self) -> f64 {
        let [[ax, ay], [bx, by]] = self.ends;
        f64::from((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt()
    }
}

impl StrokeLayer {
    /// Projects and bins the strokes in runs whose borders depend on their number only.
    pub(super) fn new(camera: &Camera, grid: TileGrid, strokes: &Strokes<'_>, watch: &Watch) -> Result<Self, Stopped> {
        let half_px = 0.5 * strokes.width_px.clamp(0.5, 512.0);
        let run = strokes.segments.len().div_ceil(64).max(4096);
        let runs: Vec<(Vec<PixelSegment>, Bins, f64)> = strokes
            .segments
            .par_chunks(run)
            .map(|list| {
                watch.check()?;
                let mut segments = Vec::with_capacity(list.len());
                let mut found = Vec::with_capacity(list.len());
                for segment in list.iter().filter_map(|&pair| projected(camera, strokes, pair)) {
                    if let Some(rect) = segment.touches(grid, half_px) {
                        found.push((u32::try_from(segments.len()).expect("a run is short"), rect, 0.0));
                        segments.push(segment);
                    }
                }
                let length = segments.iter().map(PixelSegment::length_px).sum();
                Ok((segments, Bins::sort(grid, &found), length))
            })
            .collect::<Result<_, Stopped>>()?;
        let mut light = premultiplied(strokes.color);
        if strokes.crowding == Crowding::Fade {
            let n: usize = runs.iter().map(|r| r.0.len()).sum();
            let mean = runs.iter().map(|r| r.2).sum::<f64>() / (n.max(1) as f64);
            let opacity = (mean as f32 / (7.0 * half_px)).clamp(0.12, 1.0);
            light = light.map(|c| c * opacity);
        }
        let hidden = strokes.hidden;
        let mut layer = Self { segments: Vec::new(), runs: Vec::new(), half_px, light, hidden };
        for (segments, mut bins, _) in runs {
            bins.shift_from(0, u32::try_from(layer.segments.len()).expect("fewer than 2^32 segments"));
            layer.segments.extend(segments);
            layer.runs.push(bins);
        }
        Ok(layer)
    }

    /// Returns every segment that may touch a tile.
    pub(super) fn tile(&self, tile: usize) -> impl Iterator<Item = &PixelSegment> + '_ {
        self.runs.iter().flat_map(move |bins| bins.tile(tile)).map(|i| &self.segments[i as usize])
    }

    /// Returns half the width of the lines, in pixels.
    pub(super) fn half_px(&self) -> f32 {
        self.half_px
    }

    /// Raises `coverage` (`TILE x TILE`) to that of one segment. `seen(pixel, depth)` returns the fraction of a pixel,
    /// 0 to 1, in which something of this depth is visible.
    pub(super) fn cover(
        &self,
        segment: &PixelSegment,
        origin: [i32; 2],
        coverage: &mut [f32],
        mut seen: impl FnMut(usize, f32) -> f32,
    ) {
        let [ax, ay, bx, by] = [
            segment.ends[0][0] - origin[0] as f32,
            segment.ends[0][1] - origin[1] as f32,
            segment.ends[1][0] - origin[0] as f32,
            segment.ends[1][1] - origin[1] as f32,
        ];
        let (dx, dy) = (bx - ax, by - ay);
        let square = dx * dx + dy * dy;
        let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
        let reach = self.half_px + 0.5;
        let last = TILE as f32 - 1.0;
        let clamped = |v: f32| v.clamp(0.0, TILE as f32) as usize;
        let (top, bottom) = (clamped((ay.min(by) - reach).floor()), (ay.max(by) + reach).min(last));
        let mut y = top;
        while y as f32 <= bottom {
            let py = y as f32 + 0.5;
            let [left, right] = span([ax, ay, dx, dy], py, reach);
            let right = right.min(last);
            let mut x = clamped(left.floor());
            while x as f32 <= right {
                let px = x as f32 + 0.5;
                let t = (((px - ax) * dx + (py - ay) * dy) * inverse).clamp(0.0, 1.0);
                let (ex, ey) = (px - ax - t * dx, py - ay - t * dy);
                let cover = (reach - (ex * ex + ey * ey).sqrt()).min(1.0).min(2.0 * self.half_px);
                let pixel = y * TILE + x;
                if cover > coverage[pixel] {
                    let depth = segment.depths[0] + (segment.depths[1] - segment.depths[0]) * t;
                    let seen = seen(pixel, depth);
                    coverage[pixel] = coverage[pixel].max(cover * (seen + (1.0 - seen) * self.hidden));
                }
                x += 1;
            }
            y += 1;
        }
    }
}

/// Returns the range from left to right in which a line of half-width `reach` may touch the row at height `y`.
fn span([ax, ay, dx, dy]: [f32; 4], y: f32, reach: f32) -> [f32; 2] {
    let whole = [ax.min(ax + dx) - reach, ax.max(ax + dx) + reach];
    if dy.abs() < 1e-3 {
        return whole;
    }
    let pad = reach * (1.0 + (dx / dy).abs()) + 1.0;
    let x = ax + (y - ay) * (dx / dy);
    [whole[0].max(x - pad), whole[1].min(x + pad)]
}
