//! Vertices in the picture: sub-pixel coordinates, depth, and on which sides of the picture they lie.

#![expect(clippy::cast_possible_truncation, reason = "only values inside of the guard band count")]
#![expect(
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop,
    reason = "loops without branches are vector code"
)]

use multiversion::multiversion;
use rayon::prelude::*;

use super::camera::{Camera, Projection};
use super::pixmap::{whole_below, whole_number};
use crate::kept::{Kept, KeptValue};
use crate::math::vector::Vector;

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

impl KeptValue for Vertex {
    const UNSPECIFIED: Self = if cfg!(debug_assertions) {
        Self { x: i32::MAX, y: i32::MAX, depth: f32::NAN, sides: u32::MAX }
    } else {
        Self { x: 0, y: 0, depth: 0.0, sides: 0 }
    };
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

/// Points that are projected together: four 64-bit numbers fill a vector register of 256 bits, and eight of 32 bits.
/// Half of it leaves half of the latter empty; twice of it needs four registers for each number.
const BLOCK_POINTS: usize = 8;

/// A number for each of some points.
type PointRow<T> = [T; BLOCK_POINTS];

/// The vertices of some points, number by number.
struct VertexRows {
    x: PointRow<i32>,
    y: PointRow<i32>,
    depth: PointRow<f32>,
    sides: PointRow<u32>,
}

impl VertexRows {
    #[inline]
    fn vertex(&self, i: usize) -> Vertex {
        Vertex { x: self.x[i], y: self.y[i], depth: self.depth[i], sides: self.sides[i] }
    }
}

/// Returns the vertices of up to eight points in view coordinates (see [`Camera::view`]).
pub(super) fn vertices_of<const N: usize>(camera: &Camera, seen: [[f64; 4]; N]) -> [Vertex; N] {
    let mut rows = [[0.0; BLOCK_POINTS]; 4];
    for (i, seen) in seen.iter().enumerate() {
        (0..4).for_each(|k| rows[k][i] = seen[k]);
    }
    let placed = placed_rows(camera, &rows);
    std::array::from_fn(|i| placed.vertex(i))
}

/// Returns all vertices, computed in parallel.
pub(super) fn vertices(camera: &Camera, positions: &[Vector]) -> Kept<Vertex> {
    /// Points that a thread projects at a time. Half of it makes tasks of less than 50 us; twice of it leaves threads
    /// idle where points are few.
    const POINTS_A_TASK: usize = 4096;
    let mut vertices = Kept::to_overwrite(positions.len());
    let tasks = positions.par_chunks(POINTS_A_TASK).zip(vertices.par_chunks_mut(POINTS_A_TASK));
    tasks.for_each(|(positions, vertices)| project(camera, positions, vertices));
    vertices
}

/// Projects points. There are no branches in the loops over eight of them, so that these are vector code; wider vectors
/// give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn project(camera: &Camera, positions: &[Vector], vertices: &mut [Vertex]) {
    for (points, vertices) in positions.chunks(BLOCK_POINTS).zip(vertices.chunks_mut(BLOCK_POINTS)) {
        let mut seen = [[0.0; BLOCK_POINTS]; 4];
        for (i, point) in points.iter().enumerate() {
            let of = camera.view(*point);
            (seen[0][i], seen[1][i], seen[2][i], seen[3][i]) = (of[0], of[1], of[2], of[3]);
        }
        let placed = placed(camera, &seen);
        for (i, vertex) in vertices.iter_mut().enumerate() {
            *vertex = placed.vertex(i);
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn placed_rows(camera: &Camera, seen: &[PointRow<f64>; 4]) -> VertexRows {
    placed(camera, seen)
}

/// Returns the vertices of points in view coordinates.
// callers that are compiled for wider vectors need it to be, too
#[inline(always)]
fn placed(camera: &Camera, seen: &[PointRow<f64>; 4]) -> VertexRows {
    // coordinates are shifted by this, so that they are positive and casts round down on both sides of zero
    const SHIFT: f64 = 2.0 * GUARD_BAND;
    let is_perspective = camera.projection == Projection::Perspective;
    let [width, height] = camera.size_px;
    let row = [0; BLOCK_POINTS];
    let mut rows = VertexRows { x: row, y: row, depth: [0.0; BLOCK_POINTS], sides: [0; BLOCK_POINTS] };
    for i in 0..BLOCK_POINTS {
        let (w, z) = (seen[2][i], seen[3][i]);
        let [x, y] = camera.pixel([seen[0][i], seen[1][i], w, z]);
        let is_finite = (x.abs() < f64::INFINITY) & (y.abs() < f64::INFINITY) & (z.abs() < f64::INFINITY);
        let is_behind = !is_finite | (is_perspective & (w < camera.near));
        let is_near = (x > -GUARD_BAND) & (x < width + GUARD_BAND) & (y > -GUARD_BAND) & (y < height + GUARD_BAND);
        let is_placed = is_near & !is_behind;
        let sides = if x < 0.0 { LEFT } else { 0 } | if x > width { RIGHT } else { 0 };
        let sides = sides | if y < 0.0 { ABOVE } else { 0 } | if y > height { BELOW } else { 0 };
        let sides = sides | if is_near { 0 } else { FAR_OUT };
        rows.sides[i] = if is_behind { BEHIND } else { sides };
        let snapped = |pixels: f64| {
            let pixels = if is_placed { pixels } else { 0.0 };
            let steps = whole_number(whole_below((pixels + SHIFT) * f64::from(STEPS_A_PIXEL) + 0.5));
            let steps = steps.cast_signed() - SHIFT as i32 * STEPS_A_PIXEL;
            if is_placed { steps } else { 0 }
        };
        (rows.x[i], rows.y[i]) = (snapped(x), snapped(y));
        let depth = camera.depth(z);
        rows.depth[i] = if is_placed { depth as f32 } else { 0.0 };
    }
    rows
}

#[cfg(test)]
mod tests {
    use proptest::collection;
    use proptest::prelude::*;

    use super::*;
    use crate::raster::camera::View;

    /// The vertex of a point, by casts and branches.
    fn vertex(camera: &Camera, point: Vector) -> Vertex {
        let seen = camera.view(point);
        let [x, y] = camera.pixel(seen);
        let in_front = camera.projection == Projection::Orthographic || seen[2] >= camera.near;
        if !(in_front && x.is_finite() && y.is_finite() && seen[3].is_finite()) {
            return Vertex { sides: BEHIND, ..Vertex::default() };
        }
        let [width, height] = camera.size_px;
        let beyond = [(x < 0.0, LEFT), (x > width, RIGHT), (y < 0.0, ABOVE), (y > height, BELOW)];
        let sides = beyond.iter().filter(|(is, _)| *is).fold(0, |sides, (_, side)| sides | side);
        let is_near = |u: f64, side: f64| u > -GUARD_BAND && u < side + GUARD_BAND;
        if !(is_near(x, width) && is_near(y, height)) {
            return Vertex { sides: sides | FAR_OUT, ..Vertex::default() };
        }
        let snapped = |pixels: f64| (pixels * f64::from(STEPS_A_PIXEL) + 0.5).floor() as i32;
        Vertex { x: snapped(x), y: snapped(y), depth: camera.depth(seen[3]) as f32, sides }
    }

    proptest! {
        #[test]
        fn points_are_projected_together_as_each_of_them_alone(
            points in collection::vec(prop::array::uniform3(-3.0..3.0), 1..40),
            scale in prop::sample::select(vec![0.3, 1.0, 10.0, 1e300]),
            strange in (0..40_usize, prop::num::f64::ANY),
            is_orthographic in any::<bool>(),
        ) {
            let projection = if is_orthographic { Projection::Orthographic } else { Projection::Perspective };
            let view = View { projection, ..View::default() };
            let camera = Camera::framing(&view, &[&[[-1.0; 3], [1.0; 3]]], 640, 480);
            let mut points: Vec<Vector> = points.iter().map(|point| point.map(|u| scale * u)).collect();
            if let Some(point) = points.get_mut(strange.0) {
                point[1] = strange.1;
            }
            let placed = vertices(&camera, &points);
            let numbers = |vertex: &Vertex| (vertex.x, vertex.y, vertex.depth.to_bits(), vertex.sides);
            for (point, found) in points.iter().zip(&*placed) {
                prop_assert_eq!(numbers(found), numbers(&vertex(&camera, *point)), "{:?}", point);
            }
        }
    }
}
