//! The ground below a model: whether the model stands on it, and how dark its parts make it.

#![expect(clippy::cast_precision_loss, reason = "directions are counted in dozens")]
#![expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use multiversion::multiversion;
use rayon::prelude::*;

use super::axes::{AxisRows, along, axis_rows};
use super::camera::unit;
use super::model::Model;
use crate::kept::Kept;
use crate::math::functions::{cos, sin};
use crate::math::vector::{Vector, cross, plus, times};

/// Reach of the shadow beyond the model, as a fraction of half its longer side; about as much as a picture's margin.
pub(super) const SHADOW_REACH: f64 = 0.3;

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

/// A place: two horizontal coordinates, the height, and 0. Four numbers fill a vector register.
pub(super) type GroundPlace = [f32; 4];

/// The model above the ground in coordinates of its own: two horizontal directions and up, from its centre, in units of
/// half its longer side.
pub(super) struct GroundFrame<'a> {
    pub(super) axes: [Vector; 3],
    pub(super) middle: Vector,
    pub(super) half: f64,
    height: f64,
    pub(super) triangles: &'a [[u32; 3]],
    /// The places of the vertices in these coordinates.
    pub(super) places: Kept<GroundPlace>,
    /// Whether a triangle has this vertex.
    is_used: Vec<AtomicBool>,
}

/// Number of triangles or vertices that a thread processes at a time, and of each part of the sum of the centroid. With
/// half of it tasks are many for their little work; with twice of it models of some ten thousands of triangles leave
/// threads idle.
pub(super) const ITEMS_PER_TASK: usize = 1 << 14;

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
        let rows = axis_rows(axes);
        let is_used = used(model);
        let parts = model.positions.par_chunks(ITEMS_PER_TASK).zip(is_used.par_chunks(ITEMS_PER_TASK));
        let join = |a: [[f64; 4]; 2], b: [[f64; 4]; 2]| {
            [[0, 1, 2, 3].map(|k| a[0][k].min(b[0][k])), [0, 1, 2, 3].map(|k| a[1][k].max(b[1][k]))]
        };
        let [low, high] = parts.map(|(points, is_used)| extent(&rows, points, is_used)).reduce(|| NOWHERE, join);
        let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]);
        if !(half > 1e-100 && half < 1e100) {
            return None;
        }
        let level = [0, 1].map(|k| times(0.5 * (low[k] + high[k]), axes[k]));
        let middle = plus(plus(level[0], level[1]), times(low[2], sky));
        let mut places = Kept::to_overwrite(model.positions.len());
        let parts = model.positions.par_chunks(ITEMS_PER_TASK).zip(places.par_chunks_mut(ITEMS_PER_TASK));
        parts.for_each(|(points, places)| place(&rows, (middle, half), points, places));
        let height = (high[2] - low[2]) / half;
        Some(Self { axes, middle, half, height, triangles: model.triangles, places, is_used })
    }

    /// Returns the centroid of the surface projected to the ground: the mean of the centres of its triangles, weighted
    /// by area, summed in parts whose boundaries depend on the number of triangles only.
    fn centre(&self) -> [f64; 2] {
        let of = |list: &[[u32; 3]]| weighed(&self.places, list);
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
        let of = |(places, is_used): (&[GroundPlace], &[AtomicBool])| {
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
}

/// The least and the largest coordinates of no points.
const NOWHERE: [[f64; 4]; 2] = [[f64::INFINITY; 4], [f64::NEG_INFINITY; 4]];

/// Returns the least and the largest coordinates along the axes of those points that a triangle has. Points that are no
/// numbers do not count. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn extent(rows: &AxisRows, points: &[Vector], is_used: &[AtomicBool]) -> [[f64; 4]; 2] {
    let [mut low, mut high] = NOWHERE;
    for (&point, is_used) in points.iter().zip(is_used) {
        let p = along(rows, point);
        let is_finite = (p[0].abs() < f64::INFINITY) & (p[1].abs() < f64::INFINITY) & (p[2].abs() < f64::INFINITY);
        if is_finite & is_used.load(Ordering::Relaxed) {
            for k in 0..4 {
                low[k] = if p[k] < low[k] { p[k] } else { low[k] };
                high[k] = if p[k] > high[k] { p[k] } else { high[k] };
            }
        }
    }
    [low, high]
}

/// Finds the places of points in units of `half` from `middle`. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn place(rows: &AxisRows, (middle, half): (Vector, f64), points: &[Vector], places: &mut [GroundPlace]) {
    for (place, point) in places.iter_mut().zip(points) {
        let along = along(rows, [point[0] - middle[0], point[1] - middle[1], point[2] - middle[2]]);
        for k in 0..4 {
            place[k] = (along[k] / half) as f32;
        }
    }
}

/// Returns the sum of the centres of triangles on the ground, weighted by area, and the sum of the areas, both times 2.
/// Triangles without an area that is a number do not count. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn weighed(places: &[GroundPlace], triangles: &[[u32; 3]]) -> Vector {
    let mut sums = [0.0; 4];
    let mut areas = 0.0;
    for &[a, b, c] in triangles {
        let (a, b, c) = (&places[a as usize], &places[b as usize], &places[c as usize]);
        let [mut u, mut v, mut all, mut across] = [[0.0; 4]; 4];
        for k in 0..4 {
            let (a, b, c) = (f64::from(a[k]), f64::from(b[k]), f64::from(c[k]));
            (u[k], v[k], all[k]) = (b - a, c - a, a + b + c);
        }
        for (k, (next, last)) in [(1, 2), (2, 0), (0, 1), (3, 3)].into_iter().enumerate() {
            across[k] = u[next] * v[last] - u[last] * v[next];
        }
        let area = (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt();
        if area < f64::INFINITY {
            let third = area / 3.0;
            for k in 0..4 {
                sums[k] += third * all[k];
            }
            areas += area;
        }
    }
    [sums[0], sums[1], areas]
}
