//! The size of the sides of faces in a picture.

use super::options::Options;
use crate::raster::{Camera, Projection, View};

/// The points of an input and the edges between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The points, model units.
    pub points: Vec<[f64; 3]>,
    /// The indices of the two ends of each edge.
    pub edges: Vec<[u32; 2]>,
    /// Whether all points are in the plane of the first two coordinates, which is then drawn from above.
    pub is_flat: bool,
}

/// Returns the root mean square of the lengths of the edges in the picture, pixels; 0 if none is visible. Edges behind
/// the camera or far outside the picture are ignored.
pub(crate) fn side_px(outline: &Outline, options: &Options<'_>) -> f64 {
    let asked = options.view();
    let flat = View {
        projection: Projection::Orthographic,
        azimuth_rad: 0.0,
        elevation_rad: 0.0,
        eye: None,
        up: [0.0, 1.0, 0.0],
        ..asked
    };
    let [width, height] = options.size;
    let view = if outline.is_flat { &flat } else { &asked };
    let camera = match options.corners() {
        Some(corners) => Camera::framing(view, &[&corners], width, height),
        None => Camera::framing(view, &[&outline.points], width, height),
    };
    let length = |&[a, b]: &[u32; 2]| {
        let [a, b] = [a, b].map(|point| camera.place(outline.points[point as usize]));
        a.zip(b).map(|([ax, ay], [bx, by])| (bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    };
    let (n, sum) = outline.edges.iter().filter_map(length).fold((0.0_f64, 0.0), |(n, sum), s| (n + 1.0, sum + s));
    (sum / n.max(1.0)).sqrt()
}
