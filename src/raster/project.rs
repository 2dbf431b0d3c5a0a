//! Vertices in the picture: sub-pixel coordinates, depth, and on which sides of the picture they lie.

#![expect(clippy::cast_possible_truncation, reason = "values are checked to lie inside the guard band before the cast")]

use rayon::prelude::*;

use super::camera::{Camera, Projection};

/// Sub-pixel steps a pixel. Exact whole-number coverage needs coordinates on this lattice.
/// Half of it moves vertices by up to 1/256 of a pixel; twice of it takes a bit from the range of edge functions.
pub(super) const STEPS_A_PIXEL: i32 = 256;

/// How far beyond the picture coordinates stay exact, pixels. With pictures of at most 8,192 pixels a side, this keeps
/// edge functions inside a tile below 2^31.
/// Half of it clips more triangles than need be; twice of it would overflow edge functions of the largest pictures.
pub(super) const GUARD_BAND: f64 = 2048.0;

/// Left of the picture.
pub(super) const LEFT: u32 = 1;
/// Right of the picture.
pub(super) const RIGHT: u32 = 2;
/// Above the picture.
pub(super) const ABOVE: u32 = 4;
/// Below the picture.
pub(super) const BELOW: u32 = 8;
/// Behind the near plane, or not a number: the coordinates do not count.
pub(super) const BEHIND: u32 = 16;
/// Outside the guard band: the coordinates do not count.
pub(super) const FAR_OUT: u32 = 32;

/// A vertex in the picture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Vertex {
    /// Horizontal position in sub-pixel steps, [`STEPS_A_PIXEL`] per pixel.
    pub(super) x: i32,
    /// Vertical position in sub-pixel steps, downwards.
    pub(super) y: i32,
    /// Depth; larger is nearer.
    pub(super) depth: f32,
    /// The sides of the picture beyond which the vertex lies, as flags.
    pub(super) sides: u32,
}

impl Camera {
    /// Returns the pixel coordinates of a point (model units) in the picture; `None` if it is behind the camera or more
    /// than 2,048 pixels outside the picture.
    pub fn place(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let seen = self.view(point);
        let in_front = self.projection == Projection::Orthographic || seen[2] >= self.near;
        let place = self.pixel(seen);
        let near = (0..2).all(|k| place[k] > -GUARD_BAND && place[k] < self.size_px[k] + GUARD_BAND);
        (in_front && near).then_some(place)
    }
}

/// Returns the vertex of a point in view coordinates (see [`Camera::view`]).
pub(super) fn vertex(camera: &Camera, seen: [f64; 4]) -> Vertex {
    let behind = Vertex { sides: BEHIND, ..Vertex::default() };
    let [x, y] = camera.pixel(seen);
    let perspective = camera.projection == Projection::Perspective;
    let in_front = if perspective { seen[2] >= camera.near } else { true };
    if !(in_front && x.is_finite() && y.is_finite() && seen[3].is_finite()) {
        return behind;
    }
    let [width, height] = camera.size_px;
    let mut sides = 0;
    sides |= if x < 0.0 { LEFT } else { 0 };
    sides |= if x > width { RIGHT } else { 0 };
    sides |= if y < 0.0 { ABOVE } else { 0 };
    sides |= if y > height { BELOW } else { 0 };
    let near_picture = x > -GUARD_BAND && x < width + GUARD_BAND && y > -GUARD_BAND && y < height + GUARD_BAND;
    if !near_picture {
        return Vertex { sides: sides | FAR_OUT, ..Vertex::default() };
    }
    Vertex { x: snapped(x), y: snapped(y), depth: camera.depth(seen[3]) as f32, sides }
}

/// Rounds to the nearest step; shifted first, so that the cast rounds down on both sides of zero.
fn snapped(pixels: f64) -> i32 {
    let shift = 2.0 * GUARD_BAND;
    ((pixels + shift) * f64::from(STEPS_A_PIXEL) + 0.5) as i32 - (shift as i32) * STEPS_A_PIXEL
}

/// Returns all vertices, computed in parallel.
pub(super) fn vertices(camera: &Camera, positions: &[[f64; 3]]) -> Vec<Vertex> {
    positions.par_iter().with_min_len(4096).map(|&p| vertex(camera, camera.view(p))).collect()
}
