//! Clipping of triangles and segments that reach behind the camera or far beyond the picture.

use super::camera::{Camera, Projection};
use super::project::GUARD_BAND;

/// A corner of a clipped polygon: its view coordinates and its barycentric coordinates in the original triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClippedCorner {
    /// The view coordinates, which [`Camera::view`] computes.
    pub(super) seen: [f64; 4],
    /// Barycentric coordinates in the original triangle.
    pub(super) shares: [f64; 3],
}

impl Camera {
    /// Returns the segment from `a` to `b` (model units) in pixel coordinates: the part in front of the camera and
    /// within 2,048 pixels of the picture, if there is one.
    pub fn segment(&self, a: [f64; 3], b: [f64; 3]) -> Option<[[f64; 2]; 2]> {
        let ends = segment(self, [self.view(a), self.view(b)])?.map(|end| self.pixel(end));
        ends.iter().flatten().all(|x| x.is_finite()).then_some(ends)
    }
}

/// Factor of the distance of the clipping plane to that of the near plane. Half the margin is still more than rounding
/// adds for corners a billion times as far away; twice of it would not be visible either.
const CLIPPING_FACTOR: f64 = 1.0 + 1e-6;

/// Returns the signed distances of a point from the near plane and from the left, right, top and bottom of the guard
/// band; they are not negative inside.
/// The band is drawn in by a pixel, and the near plane a little, so that rounding leaves every result inside.
fn distances(camera: &Camera, [x, y, w, _]: [f64; 4]) -> [f64; 5] {
    let near = if camera.projection == Projection::Perspective { w - camera.near * CLIPPING_FACTOR } else { 1.0 };
    let reach_x = (0.5 * camera.size_px[0] + GUARD_BAND - 1.0) * w;
    let reach_y = (0.5 * camera.size_px[1] + GUARD_BAND - 1.0) * w;
    [near, reach_x + x, reach_x - x, reach_y + y, reach_y - y]
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

/// Returns the part of a triangle (view coordinates) inside near plane and guard band: a convex polygon of up to eight
/// corners, empty when nothing remains or a coordinate is not finite. Source: I. Sutherland, G. Hodgman, CACM 17
/// (1974), 32-42.
pub(super) fn polygon(camera: &Camera, triangle: [[f64; 4]; 3]) -> Vec<ClippedCorner> {
    if triangle.iter().flatten().any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut corners: Vec<ClippedCorner> =
        (0..3).map(|i| ClippedCorner { seen: triangle[i], shares: unit[i] }).collect();
    for plane in 0..5 {
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (i, here) in corners.iter().enumerate() {
            let next = &corners[(i + 1) % corners.len()];
            let (a, b) = (distances(camera, here.seen)[plane], distances(camera, next.seen)[plane]);
            if a >= 0.0 {
                kept.push(*here);
            }
            if (a >= 0.0) != (b >= 0.0) {
                let t = a / (a - b);
                kept.push(ClippedCorner {
                    seen: [0, 1, 2, 3].map(|k| mix(here.seen[k], next.seen[k], t)),
                    shares: [0, 1, 2].map(|k| mix(here.shares[k], next.shares[k], t)),
                });
            }
        }
        corners = kept;
    }
    corners
}

/// Returns the part of a segment (view coordinates) inside near plane and guard band.
pub(super) fn segment(camera: &Camera, [a, b]: [[f64; 4]; 2]) -> Option<[[f64; 4]; 2]> {
    let (da, db) = (distances(camera, a), distances(camera, b));
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for (&u, &v) in da.iter().zip(&db) {
        match (u >= 0.0, v >= 0.0) {
            (true, true) => {}
            (false, true) => start = start.max(u / (u - v)),
            (true, false) => end = end.min(u / (u - v)),
            (false, false) => return None,
        }
    }
    let at = |t: f64| [0, 1, 2, 3].map(|k| mix(a[k], b[k], t));
    let ends = [at(start), at(end)];
    (start <= end && ends.iter().flatten().all(|x| x.is_finite())).then_some(ends)
}
