//! How large the sides of faces are in a picture.

use super::options::Options;
use crate::raster::{Camera, Projection, View};

/// The points of an input and edges between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Model units.
    pub points: Vec<[f64; 3]>,
    /// Their ends.
    pub edges: Vec<[u32; 2]>,
    /// Whether all points are in the plane of the first two coordinates, which then is drawn from above.
    pub is_flat: bool,
}

/// The root of the mean square of the lengths of the edges in the picture, pixels; 0 where none is seen. Edges behind
/// the camera or far outside the picture do not count.
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
    let camera = Camera::framing(if outline.is_flat { &flat } else { &asked }, &[&outline.points], width, height);
    let length = |&[a, b]: &[u32; 2]| {
        let [a, b] = [a, b].map(|point| camera.place(outline.points[point as usize]));
        a.zip(b).map(|([ax, ay], [bx, by])| (bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    };
    let (n, sum) = outline.edges.iter().filter_map(length).fold((0.0_f64, 0.0), |(n, sum), s| (n + 1.0, sum + s));
    (sum / n.max(1.0)).sqrt()
}
