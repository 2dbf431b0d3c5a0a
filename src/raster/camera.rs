//! The camera: its position, how it frames a set of points, and the projection of points to the picture.

use rayon::prelude::*;

use super::axes::axis_rows;
use super::extents::{NO_BOX, bounding_box, farthest};
use crate::math::functions::{cos, sin, tan};
use crate::math::sharing::is_small;
use crate::math::vector::{Vector, cross, dot, minus, plus, reduce, times};

/// The kind of projection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// Distant objects look smaller.
    Perspective,
    /// Parallel rays.
    Orthographic,
}

/// The view that a client requests; [`Camera::framing`] fills in the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Perspective or parallel rays.
    pub projection: Projection,
    /// Rotation about the up axis, in radians; with up = y, 0 looks from +z and a quarter turn from +x.
    pub azimuth_rad: f64,
    /// Elevation above the horizon, in radians.
    pub elevation_rad: f64,
    /// Vertical angle of view, in radians (perspective only).
    pub fov_rad: f64,
    /// Magnification about the centre of the picture; 1 fills it.
    pub zoom: f64,
    /// Position of the camera, in model units; if given, the angles are ignored.
    pub eye: Option<[f64; 3]>,
    /// The point in the centre of the picture, in model units; if `None`, the points are centred.
    pub target: Option<[f64; 3]>,
    /// The direction that points up in the picture.
    pub up: [f64; 3],
}

impl Default for View {
    /// Returns the view from the front right, a little above, with a narrow lens; y is up, as in glTF.
    fn default() -> Self {
        Self {
            projection: Projection::Perspective,
            azimuth_rad: 0.6,
            elevation_rad: 0.42,
            fov_rad: 0.5,
            zoom: 1.0,
            eye: None,
            target: None,
            up: [0.0, 1.0, 0.0],
        }
    }
}

/// Margin on each side of the picture, as a fraction of its smaller side. A matter of taste that all pictures share:
/// half of it puts outlines at the edge, twice of it leaves a quarter of the picture empty. A change affects all
/// pictures.
const PICTURE_MARGIN: f64 = 0.06;
/// Least radius of a scene as a share of its largest coordinate, so that a point far out is not magnified until its
/// rounding shows. Half and twice of it draw scenes as small as that twice and half as large.
const LEAST_RADIUS_SHARE: f64 = 1e-9;
/// The squared sine of the angle between the line of sight and up, up to which they count as parallel: a millionth of
/// a radian. Half and twice of it turn the picture at slightly other angles; far below, rounding would turn it.
const UPWARD_SINE_SQUARED: f64 = 1e-12;
/// Distance of the near plane as a share of the radius of the scene. Half of it halves the precision of depths; twice
/// of it cuts more off what a camera within the scene sees.
const NEAR_SHARE: f64 = 1e-4;
/// Least extent of a scene across and along the line of sight as a share of its radius, for lines and points seen end
/// on. Half and twice of it magnify such scenes twice and half as much.
const LEAST_EXTENT_SHARE: f64 = 1e-3;

/// A camera. Pixel coordinates have their origin in the upper left corner, with y downwards.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    pub(super) eye: Vector,
    pub(super) right: Vector,
    pub(super) up: Vector,
    pub(super) forward: Vector,
    /// The up direction of the model.
    pub(super) sky: Vector,
    pub(super) projection: Projection,
    /// Pixels per model unit, at distance one (perspective) or everywhere (orthographic).
    pub(super) focal_px: f64,
    /// Width and height of the picture, in pixels.
    pub(super) size_px: [f64; 2],
    /// Distance of the near plane in model units (perspective).
    pub(super) near: f64,
    /// Depth of the plane through the eye, and its decrease per model unit (orthographic).
    pub(super) fall: [f64; 2],
    /// Half the largest extent of the framed points, in model units.
    pub(super) radius: f64,
}

/// Points that a thread looks at together. Half of it makes tasks of few microseconds; twice of it leaves threads idle
/// where points are few.
const POINTS_A_TASK: usize = 4096;

/// Combines the results of `of` for parts of all points; `none` is the result for no points.
fn joined<T: Copy + Send + Sync>(
    points: &[&[Vector]],
    none: T,
    of: impl Fn(&[Vector]) -> T + Send + Sync,
    join: impl Fn(T, T) -> T + Sync + Send + Copy,
) -> T {
    if is_small(points.iter().map(|list| list.len()).sum()) {
        return points.iter().fold(none, |found, list| join(found, of(list)));
    }
    let parts = points.par_iter().flat_map(|list| list.par_chunks(POINTS_A_TASK));
    parts.map(of).reduce(|| none, join)
}

/// Returns the centre and half the largest side of the bounding box of finite points; `([0, 0, 0], 1)` if there are
/// none.
fn bounds(points: &[&[Vector]]) -> (Vector, f64) {
    let join = |[a, b]: [Vector; 2], [c, d]: [Vector; 2]| {
        [[0, 1, 2].map(|i| a[i].min(c[i])), [0, 1, 2].map(|i| b[i].max(d[i]))]
    };
    let [low, high] = joined(points, NO_BOX, bounding_box, join);
    if low[0] > high[0] {
        return ([0.0; 3], 1.0);
    }
    let centre = [0, 1, 2].map(|i| 0.5 * low[i] + 0.5 * high[i]);
    let half = (0..3).map(|i| 0.5 * high[i] - 0.5 * low[i]).fold(0.0, f64::max);
    let largest = low.iter().chain(&high).fold(0.0, |m: f64, x| m.max(x.abs()));
    let radius = half.max(LEAST_RADIUS_SHARE * largest);
    (centre, if radius > 1e-150 { radius.min(1e150) } else { 1.0 })
}

/// Returns a vector multiplied by the inverse of its length; `None` if it has no direction. The bits differ from those
/// of [`direction`](crate::math::vector::direction), which divides by the length.
pub(super) fn unit(mut v: Vector) -> Option<Vector> {
    let length = reduce(&mut v)?;
    (length >= 1.0).then(|| times(1.0 / length, v))
}

/// Returns right, up and forward of a camera at the angles of `view`.
fn orbit(view: &View) -> [Vector; 3] {
    let sky = unit(view.up).unwrap_or([0.0, 1.0, 0.0]);
    let axis = if sky[0].abs() < 0.999 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, -1.0] };
    let side = unit(minus(axis, times(dot(axis, sky), sky))).unwrap_or([0.0, 0.0, 1.0]);
    let front = cross(side, sky);
    let (sa, ca) = (sin(view.azimuth_rad), cos(view.azimuth_rad));
    let (se, ce) = (sin(view.elevation_rad), cos(view.elevation_rad));
    let around = plus(times(ca, front), times(sa, side));
    let right = minus(times(ca, side), times(sa, front));
    let toward = plus(times(ce, around), times(se, sky));
    [right, minus(times(ce, sky), times(se, around)), times(-1.0, toward)]
}

/// Returns right, up and forward of a camera at `eye` that looks at `target`, or those of the angles if both coincide.
fn aimed(view: &View, eye: Vector, target: Vector) -> [Vector; 3] {
    let Some(forward) = unit(minus(target, eye)) else { return orbit(view) };
    let sky = unit(view.up).unwrap_or([0.0, 1.0, 0.0]);
    let sideways = |up: Vector| {
        let right = cross(forward, up);
        if dot(right, right) > UPWARD_SINE_SQUARED { unit(right) } else { None }
    };
    let right = sideways(sky)
        .or_else(|| sideways([0.0, 0.0, 1.0]))
        .or_else(|| sideways([1.0, 0.0, 0.0]))
        .unwrap_or([1.0, 0.0, 0.0]);
    [right, cross(right, forward), forward]
}

/// Returns the extents of points to the right, left, top and bottom, each reduced by `tangent x distance`, then forward
/// and backward.
fn reach(points: &[&[Vector]], centre: Vector, [right, up, forward]: [Vector; 3], tangent: [f64; 2]) -> [f64; 6] {
    let join = |mut a: [[f64; 4]; 4], b: [[f64; 4]; 4]| {
        a.iter_mut().flatten().zip(b.as_flattened()).for_each(|(a, b)| *a = if b > a { *b } else { *a });
        a
    };
    let (rows, tangents) = (axis_rows([right, up, forward]), [tangent[0], tangent[1], 0.0, 0.0]);
    let of = |points: &[Vector]| farthest(&rows, centre, &tangents, points);
    let [ahead, back, reduced, reduced_back] = joined(points, [[f64::NEG_INFINITY; 4]; 4], of, join);
    let found = [reduced[0], reduced_back[0], reduced[1], reduced_back[1], ahead[2], back[2]];
    if found.iter().all(|x| x.is_finite()) { found } else { [0.0; 6] }
}

impl Camera {
    /// Returns the camera that shows all of `points` as large as a picture of `width x height` pixels allows, under the
    /// requested view. Works for any number of points and any finite coordinates.
    pub fn framing(view: &View, points: &[&[[f64; 3]]], width: u32, height: u32) -> Self {
        let (centre, radius) = bounds(points);
        let size_px = [f64::from(width.max(1)), f64::from(height.max(1))];
        let axes = view.eye.map_or_else(|| orbit(view), |eye| aimed(view, eye, view.target.unwrap_or(centre)));
        let margin = PICTURE_MARGIN * size_px[0].min(size_px[1]);
        let half = [0.5 * size_px[0] - margin, 0.5 * size_px[1] - margin];
        let mut camera = Self {
            eye: view.eye.unwrap_or(centre),
            right: axes[0],
            up: axes[1],
            forward: axes[2],
            sky: unit(view.up).unwrap_or([0.0, 1.0, 0.0]),
            projection: view.projection,
            focal_px: 0.0,
            size_px,
            near: radius * NEAR_SHARE,
            fall: [1.0, 0.0],
            radius,
        };
        match view.projection {
            Projection::Perspective => camera.frame_perspective(view, points, centre, half),
            Projection::Orthographic => camera.frame_orthographic(view, points, centre, half),
        }
        camera.focal_px = (camera.focal_px * view.zoom).clamp(1e-200, 1e200);
        camera
    }

    fn frame_perspective(&mut self, view: &View, points: &[&[Vector]], centre: Vector, half: [f64; 2]) {
        self.focal_px = 0.5 * self.size_px[1] / tan(0.5 * view.fov_rad.clamp(1e-3, 3.0));
        if view.eye.is_some() {
            return;
        }
        let tangent = [half[0] / self.focal_px, half[1] / self.focal_px];
        let [right, left, top, bottom, _, back] = reach(points, centre, [self.right, self.up, self.forward], tangent);
        let [x, y] = view.target.map_or([0.5 * (right - left), 0.5 * (top - bottom)], |target| {
            let to = minus(target, centre);
            [dot(to, self.right), dot(to, self.up)]
        });
        let across = (right - x).max(left + x) / tangent[0];
        let along = (top - y).max(bottom + y) / tangent[1];
        let distance = across.max(along).max(back + 0.05 * self.radius);
        self.eye = plus(plus(centre, times(x, self.right)), plus(times(y, self.up), times(-distance, self.forward)));
    }

    fn frame_orthographic(&mut self, view: &View, points: &[&[Vector]], centre: Vector, half: [f64; 2]) {
        let [right, left, top, bottom, front, back] =
            reach(points, centre, [self.right, self.up, self.forward], [0.0; 2]);
        let [x, y] = view.eye.or(view.target).map_or([0.5 * (right - left), 0.5 * (top - bottom)], |given| {
            let to = minus(given, centre);
            [dot(to, self.right), dot(to, self.up)]
        });
        let least = LEAST_EXTENT_SHARE * self.radius;
        let scale_x = half[0] / (right - x).max(left + x).max(least);
        let scale_y = half[1] / (top - y).max(bottom + y).max(least);
        self.focal_px = scale_x.min(scale_y);
        let span = (front + back).max(least);
        let start = plus(centre, times(-back, self.forward));
        self.eye = plus(start, plus(times(x, self.right), times(y, self.up)));
        self.fall = [1.0, 0.999 / span];
    }

    /// Returns the position of the camera, in model units.
    pub fn eye(&self) -> Vector {
        self.eye
    }

    /// Returns the viewing direction, of length one.
    pub fn forward(&self) -> Vector {
        self.forward
    }

    /// Returns the pixels per model unit, at distance one (perspective) or everywhere (orthographic).
    pub fn scale(&self) -> f64 {
        self.focal_px
    }

    /// Returns whether the camera is on the side of the plane through `point` to which `normal` points.
    pub fn is_before(&self, point: [f64; 3], normal: [f64; 3]) -> bool {
        let towards = match self.projection {
            Projection::Perspective => minus(self.eye, point),
            Projection::Orthographic => times(-1.0, self.forward),
        };
        dot(normal, towards) > 0.0
    }

    /// Returns the direction to the right in the picture, of length one.
    pub fn right(&self) -> [f64; 3] {
        self.right
    }

    /// Returns right and down in pixels times `w`, the divisor `w`, and the distance along the view, in model units.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn view(&self, point: Vector) -> [f64; 4] {
        let r = minus(point, self.eye);
        let z = dot(r, self.forward);
        let w = if self.projection == Projection::Perspective { z } else { 1.0 };
        [self.focal_px * dot(r, self.right), -self.focal_px * dot(r, self.up), w, z]
    }

    /// Returns the position of a point in the picture in pixels, and its nearness: a number that is linear over the
    /// picture and larger for nearer points. `None` if the point is not in front of the camera.
    pub fn seen(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        let seen = self.view(point);
        let nearness = match self.projection {
            Projection::Perspective if seen[2] < self.near => return None,
            Projection::Perspective => self.near / seen[3],
            Projection::Orthographic => -seen[3],
        };
        let [x, y] = self.pixel(seen);
        Some([x, y, nearness]).filter(|seen| seen.iter().all(|x| x.is_finite()))
    }

    /// Returns the point in the plane through the eye that parallel rays show at a pixel.
    pub fn unplaced(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let across = times((x - 0.5 * self.size_px[0]) / self.focal_px, self.right);
        minus(plus(self.eye, across), times((y - 0.5 * self.size_px[1]) / self.focal_px, self.up))
    }

    /// Returns the size in pixels of a model unit across the view at a point; `None` if it is not in front of the
    /// camera.
    pub fn unit_px(&self, point: [f64; 3]) -> Option<f64> {
        let [_, _, w, _] = self.view(point);
        (w > 0.0).then(|| self.focal_px / w)
    }

    /// Returns the depth as it is stored: linear over the picture, larger if nearer, above 0 and at most about 1.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn depth(&self, z: f64) -> f64 {
        match self.projection {
            Projection::Perspective => self.near / z,
            Projection::Orthographic => (self.fall[0] - self.fall[1] * z).clamp(1e-6, 2.0),
        }
    }

    /// Returns `[c0, c2]`: moving a point of depth `d` nearer by one model unit adds about `c0 + c2 * d * d` to its
    /// depth.
    pub(super) fn nearer(&self) -> [f64; 2] {
        match self.projection {
            Projection::Perspective => [0.0, 1.0 / self.near],
            Projection::Orthographic => [self.fall[1], 0.0],
        }
    }

    /// Returns the pixel coordinates of `[X, Y]` divided by `w`.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn pixel(&self, [x, y, w, _]: [f64; 4]) -> [f64; 2] {
        [0.5 * self.size_px[0] + x / w, 0.5 * self.size_px[1] + y / w]
    }
}
