//! The contact shadow of a model on the ground: soft, below parts near the ground, independent of the lamps.
//!
//! A map of the ground stores the smallest height of the model above each cell. Parts near the ground darken the cell,
//! and the map is smoothed twice: a little for parts that touch the ground, more for parts that are higher.

#![expect(clippy::cast_precision_loss, reason = "cells are counted in hundreds")]
#![expect(clippy::cast_possible_truncation, reason = "light needs no more than f32, and places are within the map")]
#![expect(clippy::cast_sign_loss, reason = "places are clamped to the picture before the cast")]

use multiversion::multiversion;

use super::bins::TILE;
use super::camera::{Camera, Projection};
use super::ground::{GroundFrame, SHADOW_REACH};
use super::height_map::darkness;
use super::model::{Model, TriangleAppearance};
use super::pixmap::{whole_below, whole_number};
use crate::math::vector::{Vector, dot, minus, plus, times};
use crate::watch::{Stopped, Watch};

/// When a model has a shadow on the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// The model never has a shadow.
    None,
    /// If the model stands on the ground: the centre of its surface is above the convex hull of its parts near the
    /// ground, and it is not a flat sheet.
    Stood,
    /// The model always has a shadow.
    Always,
}

/// Number of cells along the side of the map. Half as many blur the feet; twice as many take four times as long.
const SHADOW_CELLS: usize = 192;
/// Smallest number of cells along the side of the map, for models with many overlapping triangles. Half of it leaves no
/// shape of the shadow; twice of it takes up to four times as long.
const FEWEST_CELLS: usize = 24;
/// Number of sampled places of triangles above which the map is made coarser: 30 ms. Half or twice of it makes maps of
/// stacks of large triangles coarser or finer.
const MAX_SAMPLED_PLACES: u64 = 1 << 23;
/// Width of the band along the edge of the picture in which the shadow fades out, as a share of the smaller side, of
/// which the model keeps 0.06 free. At half of it shadows seem cut off; at twice of it those at the margin fade.
const FADE_WIDTH: f64 = 0.045;

/// The shadow of a model on the ground.
#[derive(Debug)]
pub(super) struct Shadow {
    /// Origin and direction of the ray at the centre of the picture, and their increments per pixel to the right and
    /// down.
    origin: [Vector; 3],
    ray: [Vector; 3],
    middle_px: [f64; 2],
    /// The pixels from which the map may be visible: left, top, right, bottom; the last two are excluded.
    reach_px: [usize; 4],
    cells: usize,
    /// The darkness of each cell, from 0 to 1, row after row.
    dark: Vec<f32>,
}

/// The shadow in a row of pixels.
pub(super) struct ShadowRow<'a> {
    shadow: &'a Shadow,
    /// Distance from the upper or lower edge of the picture, pixels.
    edge_px: f64,
    /// Origin and direction of the ray at the left end, and their increments per pixel.
    origin: [Vector; 2],
    ray: [Vector; 2],
}

impl Shadow {
    /// Computes the shadow of a model, if it has one and the camera sees the ground from above.
    pub(super) fn of(
        model: &Model<'_>,
        camera: &Camera,
        ground: Ground,
        watch: &Watch,
    ) -> Result<Option<Self>, Stopped> {
        if ground == Ground::None || matches!(model.surface, TriangleAppearance::Unseen) {
            return Ok(None);
        }
        let Some(frame) = GroundFrame::of(model, camera.sky) else { return Ok(None) };
        watch.check()?;
        if ground == Ground::Stood && !frame.is_stood_on() {
            return Ok(None);
        }
        let mut shadow = Self::seen(&frame, camera);
        // from below, or along the ground, the shadow is not visible
        let is_above = match camera.projection {
            Projection::Perspective => shadow.origin[0][2] > 0.0,
            Projection::Orthographic => shadow.ray[0][2] < -1e-3,
        };
        if !is_above {
            return Ok(None);
        }
        loop {
            let most = if shadow.cells > FEWEST_CELLS { MAX_SAMPLED_PLACES } else { u64::MAX };
            if let Some(heights) = frame.heights(shadow.cells, most, watch)? {
                shadow.dark = darkness(&heights, shadow.cells);
                return Ok(Some(shadow));
            }
            shadow.cells /= 2;
        }
    }

    /// Returns the camera in coordinates of the map, whose unit is half its side, with an empty map.
    fn seen(ground: &GroundFrame<'_>, camera: &Camera) -> Self {
        let side = ground.half * (1.0 + SHADOW_REACH);
        let turned = |v: Vector| ground.axes.map(|axis| dot(axis, v) / side);
        let step = 1.0 / camera.focal_px;
        let steps = [turned(times(step, camera.right)), turned(times(-step, camera.up))];
        let (eye, forward) = (turned(minus(camera.eye, ground.middle)), turned(camera.forward));
        let (origin, ray) = match camera.projection {
            Projection::Perspective => ([eye, [0.0; 3], [0.0; 3]], [forward, steps[0], steps[1]]),
            Projection::Orthographic => ([eye, steps[0], steps[1]], [forward, [0.0; 3], [0.0; 3]]),
        };
        let corner = |x: f64, y: f64| {
            let across = plus(times(side * x, ground.axes[0]), times(side * y, ground.axes[1]));
            camera.place(plus(ground.middle, across))
        };
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)];
        let all = [0, 0, camera.size_px[0] as usize, camera.size_px[1] as usize];
        let box_of = |low: [f64; 2], high: [f64; 2]| {
            [low[0] as usize, low[1] as usize, high[0] as usize + 2, high[1] as usize + 2]
        };
        // a map that reaches behind the camera may be visible anywhere
        let reach_px = corners.iter().copied().collect::<Option<Vec<_>>>().map_or(all, |corners| {
            let least = |k: usize| corners.iter().map(|corner| corner[k]).fold(f64::INFINITY, f64::min);
            let most = |k: usize| corners.iter().map(|corner| corner[k]).fold(0.0, f64::max);
            box_of([least(0), least(1)], [most(0), most(1)])
        });
        let middle_px = camera.size_px.map(|side| 0.5 * side);
        Self { origin, ray, middle_px, reach_px, cells: SHADOW_CELLS, dark: Vec::new() }
    }

    /// Returns the shadow in a row of the picture, if it reaches that row.
    pub(super) fn row(&self, y: usize) -> Option<ShadowRow<'_>> {
        let [_, top, _, bottom] = self.reach_px;
        let down = y as f64 + 0.5 - self.middle_px[1];
        let left = 0.5 - self.middle_px[0];
        let start = |v: &[Vector; 3]| [plus(v[0], plus(times(left, v[1]), times(down, v[2]))), v[1]];
        let edge_px = self.middle_px[1] - down.abs();
        let row = || ShadowRow { shadow: self, edge_px, origin: start(&self.origin), ray: start(&self.ray) };
        (y >= top && y < bottom).then(row)
    }
}

impl ShadowRow<'_> {
    /// Returns the fraction of its light that the ground loses at the pixels of a row of a tile, from `first` on, or
    /// `None` if no pixel loses any.
    pub(super) fn dark(&self, first: usize) -> Option<[f32; TILE]> {
        let [left, _, right, _] = self.shadow.reach_px;
        if first >= right || first + TILE <= left {
            return None;
        }
        let map = on_map(self, first as f64);
        let dark = &self.shadow.dark;
        let mut around = [[0.0; TILE]; 4];
        for i in (0..TILE).filter(|i| map.share[*i] > 0.0) {
            let (cell, right) = (map.cell[i] as usize, map.right[i] as usize);
            let below = cell + map.below[i] as usize;
            let found = [dark[cell], dark[cell + right], dark[below], dark[below + right]];
            (around[0][i], around[1][i], around[2][i], around[3][i]) = (found[0], found[1], found[2], found[3]);
        }
        let dark = blended(&map, &around);
        dark.iter().any(|dark| *dark > 0.0).then_some(dark)
    }
}

/// Where the pixels of a row of a tile see the map of the ground.
struct OnMap {
    /// The cell whose centre is to the left of the place and above it.
    cell: [u32; TILE],
    /// How many cells after it that to the right comes, and that below: 0 at the edge of the map.
    right: [u32; TILE],
    below: [u32; TILE],
    /// How far the place is from the centre of the cell to that of the next, to the right and down.
    way: [[f32; TILE]; 2],
    /// By how much of its width each pixel is inside the band along the edge of the picture; 0 for pixels that do not
    /// see the map.
    share: [f32; TILE],
}

/// Returns where the pixels of a row of a tile see the map. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn on_map<'a>(row: &ShadowRow<'a>, first: f64) -> OnMap {
    let shadow = row.shadow;
    let [left, _, right, _] = shadow.reach_px.map(|px| px as f64);
    let (cells, last) = (shadow.cells as f64, shadow.cells as f64 - 1.0);
    let middle_px = shadow.middle_px;
    let fade_px = FADE_WIDTH * 2.0 * middle_px[0].min(middle_px[1]);
    let none = [0; TILE];
    let mut map = OnMap { cell: none, right: none, below: none, way: [[0.0; TILE]; 2], share: [0.0; TILE] };
    for i in 0..TILE {
        let x = first + f64::from(i as u32);
        let along = |v: &[Vector; 2], k: usize| v[0][k] + x * v[1][k];
        let way = -along(&row.origin, 2) / along(&row.ray, 2);
        let place = [0, 1].map(|k| along(&row.origin, k) + way * along(&row.ray, k));
        let mut corner = [0.0; 2];
        for k in 0..2 {
            let cell = (0.5 * place[k] + 0.5) * cells - 0.5;
            let cell = if cell > 0.0 { cell } else { 0.0 };
            let cell = if cell < last { cell } else { last };
            corner[k] = whole_below(cell);
            map.way[k][i] = (cell - corner[k]) as f32;
        }
        map.cell[i] = whole_number(corner[1] * cells + corner[0]);
        map.right[i] = u32::from(corner[0] < last);
        map.below[i] = if corner[1] < last { shadow.cells as u32 } else { 0 };
        let edge_px = middle_px[0] - (x + 0.5 - middle_px[0]).abs();
        let edge_px = if edge_px < row.edge_px { edge_px } else { row.edge_px };
        let inside = edge_px / fade_px;
        let inside = if inside < 1.0 { inside } else { 1.0 };
        let is_seen = [x >= left, x < right, way > 0.0, place[0].abs() < 1.0, place[1].abs() < 1.0];
        map.share[i] = is_seen.iter().fold(inside as f32, |share, is_seen| if *is_seen { share } else { 0.0 });
    }
    map
}

/// Returns the fraction of its light that the ground loses at the pixels of a row of a tile, interpolated between the
/// darkness of four cells around each: above, right of that, below, and right of that. Wider vectors give the same
/// bits.
#[multiversion(targets("x86_64+avx2"))]
fn blended(map: &OnMap, around: &[[f32; TILE]; 4]) -> [f32; TILE] {
    let mut dark = [0.0; TILE];
    for i in 0..TILE {
        let (right, down, share) = (map.way[0][i], map.way[1][i], map.share[i]);
        let upper = around[0][i] + right * (around[1][i] - around[0][i]);
        let lower = around[2][i] + right * (around[3][i] - around[2][i]);
        let blended = (upper + down * (lower - upper)) * share * share * (3.0 - 2.0 * share);
        dark[i] = if share > 0.0 { blended } else { 0.0 };
    }
    dark
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::ShadingNormals;
    use crate::raster::camera::View;

    /// The darkness of the ground at a pixel of a row, by casts, for itself.
    fn darkness_at(row: &ShadowRow<'_>, x: usize) -> f32 {
        let shadow = row.shadow;
        let along = |v: &[Vector; 2], k: usize| v[0][k] + x as f64 * v[1][k];
        let way = -along(&row.origin, 2) / along(&row.ray, 2);
        let place = [0, 1].map(|k| along(&row.origin, k) + way * along(&row.ray, k));
        let [left, _, right, _] = shadow.reach_px;
        if x < left || x >= right || way <= 0.0 || place.iter().any(|u| u.abs() >= 1.0) {
            return 0.0;
        }
        let last = shadow.cells - 1;
        let [u, v] = place.map(|u| ((0.5 * u + 0.5) * shadow.cells as f64 - 0.5).clamp(0.0, last as f64));
        let (across, down) = (u as usize, v as usize);
        let (right, below) = ((across + 1).min(last), (down + 1).min(last));
        let cell = |x: usize, y: usize| shadow.dark[y * shadow.cells + x];
        let (u, v) = ((u - across as f64) as f32, (v - down as f64) as f32);
        let upper = cell(across, down) + u * (cell(right, down) - cell(across, down));
        let lower = cell(across, below) + u * (cell(right, below) - cell(across, below));
        let fade_px = FADE_WIDTH * 2.0 * shadow.middle_px[0].min(shadow.middle_px[1]);
        let edge_px = shadow.middle_px[0] - (x as f64 + 0.5 - shadow.middle_px[0]).abs();
        let share = (edge_px.min(row.edge_px) / fade_px).min(1.0) as f32;
        if share > 0.0 { (upper + v * (lower - upper)) * share * share * (3.0 - 2.0 * share) } else { 0.0 }
    }

    #[test]
    fn the_shadow_of_a_row_is_that_of_each_of_its_pixels() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.3, 0.2, 1.0], [0.5, 1.0, 0.4]];
        let triangles = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let surface = TriangleAppearance::Lit([200; 4]);
        let normals = ShadingNormals::Planes;
        let model = Model { positions: &positions, triangles: &triangles, normals, surface, strokes: &[] };
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let view = View { projection, zoom: 0.7, ..View::default() };
            let camera = Camera::framing(&view, &[&positions], 200, 150);
            let shadow = Shadow::of(&model, &camera, Ground::Always, &Watch::new()).expect("nobody says stop");
            let shadow = shadow.expect("the ground is seen from above");
            let mut n_dark = 0;
            for (y, row) in (0..150).filter_map(|y| Some((y, shadow.row(y)?))) {
                for first in (0..200).step_by(TILE) {
                    let found = row.dark(first).unwrap_or([0.0; TILE]);
                    for (x, found) in (first..).zip(found) {
                        let expected = darkness_at(&row, x);
                        assert_eq!(found.to_bits(), expected.to_bits(), "pixel {x}, {y}: {found}, {expected}");
                        n_dark += usize::from(found > 0.0);
                    }
                }
            }
            assert!(n_dark > 1000, "{n_dark} pixels are dark");
        }
    }
}
