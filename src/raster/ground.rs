//! The ground below a model: whether the model stands on it, and how dark its parts make it.

#![expect(clippy::cast_precision_loss, reason = "cells are counted in hundreds")]
#![expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]
#![expect(clippy::cast_sign_loss, reason = "places are clamped to the map before the cast")]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use super::camera::unit;
use super::model::Model;
use crate::math::functions::{cos, sin};
use crate::math::vector::{Vector, cross, dot, minus, plus, times};
use crate::watch::{Stopped, Watch};

/// Reach of the shadow beyond the model, as a fraction of half its longer side; about as much as a picture's margin.
pub(super) const SHADOW_REACH: f64 = 0.3;

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

/// The model above the ground in coordinates of its own: two horizontal directions and up, from its centre, in units of
/// half its longer side.
pub(super) struct GroundFrame<'a> {
    pub(super) axes: [Vector; 3],
    pub(super) middle: Vector,
    pub(super) half: f64,
    height: f64,
    triangles: &'a [[u32; 3]],
    places: Vec<[f32; 3]>,
    /// Whether a triangle has this vertex.
    is_used: Vec<AtomicBool>,
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
    pub(super) fn of(model: &Model<'a>, sky: Vector) -> Option<Self> {
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
                let p = [dot(axes[0], point), dot(axes[1], point), dot(axes[2], point)];
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
            [dot(axes[0], from), dot(axes[1], from), dot(axes[2], from)].map(|along| (along / half) as f32)
        };
        let places = model.positions.par_iter().with_min_len(ITEMS_PER_TASK).map(place).collect();
        let height = (high[2] - low[2]) / half;
        Some(Self { axes, middle, half, height, triangles: model.triangles, places, is_used })
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
    pub(super) fn is_stood_on(&self) -> bool {
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
    pub(super) fn heights(&self, cells: usize, most: u64, watch: &Watch) -> Result<Option<Vec<f32>>, Stopped> {
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
                for &triangle in list {
                    let Some(corners) = self.over(triangle, cells) else { continue };
                    let n_parts = parts(&corners);
                    n_places += (n_parts as u64 + 1).pow(2) / 2;
                    if n_places > most {
                        break;
                    }
                    lay(&corners, n_parts, &mut heights, cells);
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
pub(super) fn darkness(heights: &[f32], cells: usize) -> Vec<f32> {
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
    if longest <= 1.0 { 1 } else { longest.ceil() as usize }
}

/// Lowers the cells below a triangle, whose sides have `n` parts, to its height there. A triangle smaller than a cell
/// counts as a single place.
fn lay(corners: &[[f32; 3]; 3], n: usize, heights: &mut [f32], cells: usize) {
    let mut low = |[x, y, height]: [f32; 3]| {
        let [x, y] = [x, y].map(|u| (u.max(0.0) as usize).min(cells - 1));
        let least = &mut heights[y * cells + x];
        *least = least.min(height);
    };
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
    let reach = reach.min(cells);
    let mut sums = vec![0.0; map.len()];
    let add = |sums: &mut [f32], row: &[f32]| sums.iter_mut().zip(row).for_each(|(sum, cell)| *sum += cell);
    let scale = |sums: &mut [f32]| sums.iter_mut().for_each(|sum| *sum *= share);
    for _ in 0..3 {
        // each sum from left to right, then from top to bottom, those of a row side by side
        for (row, sums) in map.chunks(cells).zip(sums.chunks_mut(cells)) {
            sums.fill(0.0);
            (1..=reach).rev().for_each(|left| add(&mut sums[left..], row));
            (0..=reach).for_each(|right| add(sums, &row[right..]));
            scale(sums);
        }
        for (y, row) in map.chunks_mut(cells).enumerate() {
            row.fill(0.0);
            let (first, last) = (y.saturating_sub(reach), (y + reach).min(cells - 1));
            sums[first * cells..(last + 1) * cells].chunks(cells).for_each(|sums| add(row, sums));
            scale(row);
        }
    }
    map
}
