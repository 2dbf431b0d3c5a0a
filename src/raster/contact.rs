//! The contact shadow of a model on the ground: soft, below parts near the ground, independent of the lamps.
//!
//! A map of the ground stores the smallest height of the model above each cell. Parts near the ground darken the cell,
//! and the map is smoothed twice: a little for parts that touch the ground, more for parts that are higher.

#![expect(clippy::cast_precision_loss, reason = "cells are counted in hundreds")]
#![expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]
#![expect(clippy::cast_sign_loss, reason = "places are clamped to the map before the cast")]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use multiversion::multiversion;
use rayon::prelude::*;

use super::bins::TILE;
use super::camera::{Camera, Projection, unit};
use super::model::{Model, TriangleAppearance};
use crate::math::functions::{cos, sin};
use crate::math::vector::{Vector, cross, dot, minus, plus, times};
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
/// Reach of the shadow beyond the model, as a fraction of half its longer side; about as much as a picture's margin.
const SHADOW_REACH: f64 = 0.3;
/// Height up to which parts darken the ground, as a fraction of half the longer side of the model. Half of it leaves
/// the shadows of feet only; twice of it makes a shadow of the whole model.
const DARKENING_HEIGHT: f32 = 0.4;
/// Height up to which parts touch the ground and cast the dark shadow of contact, as a fraction of half the longer
/// side. Half of it leaves thin lines below round parts; twice of it darkens the ground below parts that clearly hover.
const TOUCHING_HEIGHT: f32 = 0.1;
/// Fractions of the light removed below parts that touch the ground, and below parts just above it. They are a matter
/// of taste: halves are hardly visible, and twice of them is black.
const SHADOW_DARKNESS: [f32; 2] = [0.5, 0.36];
/// Height up to which parts count as supporting the model in the test whether it stands, as a fraction of the height of
/// the model. Half of it lets models on rough feet fall; twice of it lets balls of few faces stand on their edges.
const SOLE_HEIGHT: f64 = 0.03;
/// Height below which a model is a flat sheet, which lies rather than stands, as a fraction of its longer side. Half of
/// it gives plates a shadow; twice of it takes the shadow from low boxes.
const SHEET_THICKNESS: f64 = 0.05;
/// Least distance of the centroid from the edge of the supporting area, as a fraction of half the longer side; it tells
/// an area from a line or a point. Half of it lets models stand that nearly tip over; twice of it lets models on one
/// thin leg fall.
const FIRM_STAND: f64 = 0.01;
/// Number of horizontal directions in which the extent of the supporting area from the centroid is determined. Half of
/// it lets models stand whose centroid is beyond a side of a triangle of feet; twice of it takes twice as long.
const TOUCH_DIRECTIONS: usize = 16;

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

/// The model above the ground in coordinates of its own: two horizontal directions and up, from its centre, in units of
/// half its longer side.
struct GroundFrame<'a> {
    axes: [Vector; 3],
    middle: Vector,
    half: f64,
    height: f64,
    triangles: &'a [[u32; 3]],
    places: Vec<[f32; 3]>,
    /// Whether a triangle has this vertex.
    is_used: Vec<AtomicBool>,
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
        let mut shadow = frame.seen(camera);
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

    /// Returns the darkness at a place of the map, in cells, interpolated between four of them.
    fn blended(&self, [u, v]: [f64; 2]) -> f32 {
        let (left, above) = (u as usize, v as usize);
        let (u, v) = ((u - left as f64) as f32, (v - above as f64) as f32);
        let (right, below) = ((left + 1).min(self.cells - 1), (above + 1).min(self.cells - 1));
        let cell = |x: usize, y: usize| self.dark[y * self.cells + x];
        let upper = cell(left, above) + u * (cell(right, above) - cell(left, above));
        let lower = cell(left, below) + u * (cell(right, below) - cell(left, below));
        upper + v * (lower - upper)
    }
}

impl ShadowRow<'_> {
    /// Returns the fraction of its light that the ground loses at the pixels of a row of a tile, from `first` on.
    pub(super) fn dark(&self, first: usize) -> [f32; TILE] {
        let [left, _, right, _] = self.shadow.reach_px;
        if first >= right || first + TILE <= left {
            return [0.0; TILE];
        }
        let ([columns, rows], shares) = on_map(self, first as f64);
        let mut dark = [0.0; TILE];
        for (i, dark) in dark.iter_mut().enumerate().filter(|(i, _)| shares[*i] > 0.0) {
            let share = shares[i];
            *dark = self.shadow.blended([columns[i], rows[i]]) * share * share * (3.0 - 2.0 * share);
        }
        dark
    }
}

/// Returns the places on the map, in cells, of the pixels of a row of a tile, and by how much of its width each pixel
/// is inside the band along the edge of the picture, which is 0 for those that do not see the map. Wider vectors give
/// the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn on_map<'a>(row: &ShadowRow<'a>, first: f64) -> ([[f64; TILE]; 2], [f32; TILE]) {
    let shadow = row.shadow;
    let [left, _, right, _] = shadow.reach_px.map(|px| px as f64);
    let (cells, last) = (shadow.cells as f64, shadow.cells as f64 - 1.0);
    let middle_px = shadow.middle_px;
    let fade_px = FADE_WIDTH * 2.0 * middle_px[0].min(middle_px[1]);
    let mut places = [[0.0; TILE]; 2];
    let mut shares = [0.0; TILE];
    for i in 0..TILE {
        let x = first + f64::from(i as u32);
        let along = |v: &[Vector; 2], k: usize| v[0][k] + x * v[1][k];
        let way = -along(&row.origin, 2) / along(&row.ray, 2);
        let place = [0, 1].map(|k| along(&row.origin, k) + way * along(&row.ray, k));
        for k in 0..2 {
            let cell = (0.5 * place[k] + 0.5) * cells - 0.5;
            let cell = if cell > 0.0 { cell } else { 0.0 };
            places[k][i] = if cell < last { cell } else { last };
        }
        let edge_px = middle_px[0] - (x + 0.5 - middle_px[0]).abs();
        let edge_px = if edge_px < row.edge_px { edge_px } else { row.edge_px };
        let inside = edge_px / fade_px;
        let inside = if inside < 1.0 { inside } else { 1.0 };
        let is_seen = [x >= left, x < right, way > 0.0, place[0].abs() < 1.0, place[1].abs() < 1.0];
        shares[i] = is_seen.iter().fold(inside as f32, |share, is_seen| if *is_seen { share } else { 0.0 });
    }
    (places, shares)
}

/// Number of triangles or vertices that a thread processes at a time, and of each part of the sum of the centroid. With
/// half of it tasks are many for their little work; with twice of it models of some ten thousands of triangles leave
/// threads idle.
const ITEMS_PER_TASK: usize = 1 << 14;

/// Returns for each vertex of a model whether a triangle has it.
fn used(model: &Model<'_>) -> Vec<AtomicBool> {
    let is_used: Vec<AtomicBool> = model.positions.iter().map(|_| AtomicBool::new(false)).collect();
    let mark =
        |list: &[[u32; 3]]| list.iter().flatten().for_each(|&v| is_used[v as usize].store(true, Ordering::Relaxed));
    model.triangles.par_chunks(ITEMS_PER_TASK).for_each(mark);
    is_used
}

impl<'a> GroundFrame<'a> {
    /// Returns the frame of a model; `None` if the model has no extent.
    fn of(model: &Model<'a>, sky: Vector) -> Option<Self> {
        let aside = if sky[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let right = unit(cross(sky, aside))?;
        let axes = [right, cross(sky, right), sky];
        let is_used = used(model);
        let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let join = |a: [Vector; 2], b: [Vector; 2]| {
            [[0, 1, 2].map(|k| a[0][k].min(b[0][k])), [0, 1, 2].map(|k| a[1][k].max(b[1][k]))]
        };
        let of = |(points, is_used): (&[Vector], &[AtomicBool])| {
            let used = points.iter().zip(is_used).filter(|(_, is_used)| is_used.load(Ordering::Relaxed));
            used.fold(none, |sum, (&point, _)| {
                let p = axes.map(|axis| dot(axis, point));
                if p[0].is_finite() && p[1].is_finite() && p[2].is_finite() { join(sum, [p, p]) } else { sum }
            })
        };
        let parts = model.positions.par_chunks(ITEMS_PER_TASK).zip(is_used.par_chunks(ITEMS_PER_TASK));
        let [low, high] = parts.map(of).reduce(|| none, join);
        let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]);
        if !(half > 1e-100 && half < 1e100) {
            return None;
        }
        let level = [0, 1].map(|k| times(0.5 * (low[k] + high[k]), axes[k]));
        let middle = plus(plus(level[0], level[1]), times(low[2], sky));
        let place = |&point: &Vector| {
            let from = minus(point, middle);
            axes.map(|axis| (dot(axis, from) / half) as f32)
        };
        let places = model.positions.par_iter().with_min_len(ITEMS_PER_TASK).map(place).collect();
        let height = (high[2] - low[2]) / half;
        Some(Self { axes, middle, half, height, triangles: model.triangles, places, is_used })
    }

    /// Returns the camera in coordinates of the map, whose unit is half its side, with an empty map.
    fn seen(&self, camera: &Camera) -> Shadow {
        let side = self.half * (1.0 + SHADOW_REACH);
        let turned = |v: Vector| self.axes.map(|axis| dot(axis, v) / side);
        let step = 1.0 / camera.focal_px;
        let steps = [turned(times(step, camera.right)), turned(times(-step, camera.up))];
        let (eye, forward) = (turned(minus(camera.eye, self.middle)), turned(camera.forward));
        let (origin, ray) = match camera.projection {
            Projection::Perspective => ([eye, [0.0; 3], [0.0; 3]], [forward, steps[0], steps[1]]),
            Projection::Orthographic => ([eye, steps[0], steps[1]], [forward, [0.0; 3], [0.0; 3]]),
        };
        let corner = |x: f64, y: f64| {
            let across = plus(times(side * x, self.axes[0]), times(side * y, self.axes[1]));
            camera.place(plus(self.middle, across))
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
        Shadow { origin, ray, middle_px, reach_px, cells: SHADOW_CELLS, dark: Vec::new() }
    }

    /// Returns the positions of the corners of a triangle.
    #[inline]
    fn corners(&self, [a, b, c]: [u32; 3]) -> [[f32; 3]; 3] {
        [self.places[a as usize], self.places[b as usize], self.places[c as usize]]
    }

    /// Returns the centroid of the surface projected to the ground: the mean of the centres of its triangles, weighted
    /// by area, summed in parts whose boundaries depend on the number of triangles only.
    fn centre(&self) -> [f64; 2] {
        let of = |list: &[[u32; 3]]| {
            list.iter().fold([0.0; 3], |sum: Vector, &triangle| {
                let [a, b, c] = self.corners(triangle).map(|p| p.map(f64::from));
                let across = cross(minus(b, a), minus(c, a));
                let area = dot(across, across).sqrt();
                let third = area / 3.0;
                let more = [third * (a[0] + b[0] + c[0]), third * (a[1] + b[1] + c[1]), area];
                if area.is_finite() { plus(sum, more) } else { sum }
            })
        };
        let parts: Vec<Vector> = self.triangles.par_chunks(ITEMS_PER_TASK).map(of).collect();
        let [x, y, area] = parts.into_iter().fold([0.0; 3], plus);
        if area > 0.0 { [x / area, y / area] } else { [0.0; 2] }
    }

    /// Returns whether the centroid of the surface is above the convex hull of the parts that touch the ground.
    fn is_stood_on(&self) -> bool {
        if self.height < 2.0 * SHEET_THICKNESS {
            return false;
        }
        let directions: [[f64; 2]; TOUCH_DIRECTIONS] =
            std::array::from_fn(|k| TAU * k as f64 / TOUCH_DIRECTIONS as f64).map(|angle| [cos(angle), sin(angle)]);
        let none = [f64::NEG_INFINITY; TOUCH_DIRECTIONS];
        let join = |a: [f64; TOUCH_DIRECTIONS], b: [f64; TOUCH_DIRECTIONS]| std::array::from_fn(|k| a[k].max(b[k]));
        let sole = (SOLE_HEIGHT * self.height) as f32;
        let [x, y] = self.centre();
        let of = |(places, is_used): (&[[f32; 3]], &[AtomicBool])| {
            let low = places.iter().zip(is_used).filter(|(p, is_used)| p[2] <= sole && is_used.load(Ordering::Relaxed));
            low.fold(none, |far, (p, _)| {
                let (right, ahead) = (f64::from(p[0]) - x, f64::from(p[1]) - y);
                join(far, directions.map(|[x, y]| right * x + ahead * y))
            })
        };
        let parts = self.places.par_chunks(ITEMS_PER_TASK).zip(self.is_used.par_chunks(ITEMS_PER_TASK));
        let far = parts.map(of).reduce(|| none, join);
        far.iter().all(|&far| far > FIRM_STAND)
    }

    /// Returns the corners of a triangle in cells of a map with their heights, unless the triangle is too high.
    #[inline]
    fn over(&self, triangle: [u32; 3], cells: usize) -> Option<[[f32; 3]; 3]> {
        let [a, b, c] = self.corners(triangle);
        if !(a[2] < DARKENING_HEIGHT || b[2] < DARKENING_HEIGHT || c[2] < DARKENING_HEIGHT) {
            return None;
        }
        let half = 0.5 * cells as f32;
        let scale = half / (1.0 + SHADOW_REACH as f32);
        let on_map = |[x, y, height]: [f32; 3]| [x * scale + half, y * scale + half, height];
        let is_finite = |p: [f32; 3]| p[0].is_finite() && p[1].is_finite() && p[2].is_finite();
        (is_finite(a) && is_finite(b) && is_finite(c)).then(|| [on_map(a), on_map(b), on_map(c)])
    }

    /// Returns the least height of the model above each cell; `None` if more than `most` places of triangles would have
    /// to be sampled.
    fn heights(&self, cells: usize, most: u64, watch: &Watch) -> Result<Option<Vec<f32>>, Stopped> {
        let far = || vec![DARKENING_HEIGHT; cells * cells];
        let lower = |mut a: Vec<f32>, b: Vec<f32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = a.min(b));
            a
        };
        let sampled = AtomicU64::new(0);
        let part = self.triangles.len().div_ceil(8).max(ITEMS_PER_TASK);
        let of = |list: &[[u32; 3]]| {
            let mut heights = far();
            for list in list.chunks(4096) {
                watch.check()?;
                let mut n_places = 0;
                for corners in list.iter().filter_map(|&triangle| self.over(triangle, cells)) {
                    n_places += (parts(&corners) as u64 + 1).pow(2) / 2;
                    if n_places > most {
                        break;
                    }
                    lay(&corners, &mut heights, cells);
                }
                if sampled.fetch_add(n_places, Ordering::Relaxed) + n_places > most {
                    break;
                }
            }
            Ok(heights)
        };
        let heights = self.triangles.par_chunks(part).map(of).try_reduce(far, |a, b| Ok::<_, Stopped>(lower(a, b)))?;
        Ok((sampled.into_inner() <= most).then_some(heights))
    }
}

/// Returns the fraction of its light that each cell loses.
fn darkness(heights: &[f32], cells: usize) -> Vec<f32> {
    let side = cells as f32;
    let soft = |high: f32, share: f32| {
        let weight = |height: &f32| {
            let rest = (1.0 - height / high).max(0.0);
            rest * rest
        };
        smoothed(heights.iter().map(weight).collect(), cells, ((share * side) as usize).max(1))
    };
    let (near, wide) = rayon::join(|| soft(TOUCHING_HEIGHT, 0.011), || soft(DARKENING_HEIGHT, 0.05));
    let mixed = near
        .iter()
        .zip(&wide)
        .map(|(near, wide)| 1.0 - (1.0 - SHADOW_DARKNESS[0] * near) * (1.0 - SHADOW_DARKNESS[1] * wide));
    mixed.collect()
}

/// Returns the number of parts into which each side of a triangle is divided, so that no cell below it is missed.
#[inline]
fn parts(corners: &[[f32; 3]; 3]) -> usize {
    let side = |a: &[f32; 3], b: &[f32; 3]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    let longest =
        side(&corners[0], &corners[1]).max(side(&corners[1], &corners[2])).max(side(&corners[2], &corners[0]));
    (longest.ceil() as usize).max(1)
}

/// Lowers the cells below a triangle to its height there. A triangle smaller than a cell counts as a single place.
fn lay(corners: &[[f32; 3]; 3], heights: &mut [f32], cells: usize) {
    let mut low = |[x, y, height]: [f32; 3]| {
        let [x, y] = [x, y].map(|u| (u.max(0.0) as usize).min(cells - 1));
        let least = &mut heights[y * cells + x];
        *least = least.min(height);
    };
    let n = parts(corners);
    let [a, b, c] = *corners;
    if n == 1 {
        return low(a);
    }
    let step = 1.0 / n as f32;
    let side = |to: [f32; 3]| -> [f32; 3] { std::array::from_fn(|k| step * (to[k] - a[k])) };
    let (right, down) = (side(b), side(c));
    for j in 0..=n {
        for i in 0..=n - j {
            low(std::array::from_fn(|k| a[k] + i as f32 * right[k] + j as f32 * down[k]));
        }
    }
}

/// Returns the map after three box filters of `2 reach + 1` cells, which approximate a Gaussian.
fn smoothed(mut map: Vec<f32>, cells: usize, reach: usize) -> Vec<f32> {
    let share = 1.0 / (2 * reach + 1) as f32;
    let mut turned = vec![0.0; map.len()];
    let mut sums = vec![0.0; cells];
    for _ in 0..6 {
        for (y, row) in map.chunks(cells).enumerate() {
            // each sum from left to right, all of them side by side
            sums.fill(0.0);
            let add = |sums: &mut [f32], row: &[f32]| sums.iter_mut().zip(row).for_each(|(sum, cell)| *sum += cell);
            (1..=reach.min(cells)).rev().for_each(|left| add(&mut sums[left..], row));
            (0..=reach.min(cells)).for_each(|right| add(&mut sums, &row[right..]));
            // transposed, so that rows are columns the next time
            sums.iter().enumerate().for_each(|(x, sum)| turned[x * cells + y] = sum * share);
        }
        std::mem::swap(&mut map, &mut turned);
    }
    map
}
