//! Forecasts the work of drawing a picture of a mesh from the position of the input in it.

use super::lines;
use super::options::Options;
use crate::output::counts::Counts;
use crate::raster::RasterForecast;
use crate::shape::mesh::Mesh;

/// Maximum number of input faces that are projected, in about 50 ms; of more faces, an evenly spread selection is. Half
/// of it takes half the time and is less exact; twice of it takes twice the time.
const MAX_PROJECTED_FACES: usize = 1 << 18;
/// Number of corners of faces whose normals and edges are found in the time of a row: 50 ns each. Half of it predicts
/// twice the time for them; twice of it half the time.
const CORNERS_A_ROW: u128 = 2;

/// Returns the work in rows of a table, 100 ns each. The refined mesh covers about the same part of the picture as the
/// input, face by face, as both are framed alike.
pub(crate) fn work(input: &Mesh, counts: &Counts, options: &Options<'_>) -> u128 {
    if !lines::shows_body(options) {
        return 0;
    }
    let topology = &input.topology;
    let points = input.positions.as_chunks::<3>().0;
    let camera = options.camera(&[points], options.size_beside(0));
    let triangles = (topology.n_half_edges()).saturating_sub(2 * topology.n_faces()).max(1);
    let stride = topology.n_faces().div_ceil(MAX_PROJECTED_FACES).max(1);
    let parts = (real(counts.triangles()) / real(triangles as u128)).max(1.0);
    let mut forecast = RasterForecast::of(options.size);
    for face in (0..topology.n_faces()).step_by(stride).map(|f| topology.face(f)) {
        for pair in face[1..].windows(2) {
            forecast.add(&camera, [face[0], pair[0], pair[1]].map(|v| points[v as usize]), parts);
        }
    }
    u128::from(forecast.rows(real(stride as u128))).saturating_add(counts.half_edges / CORNERS_A_ROW)
}

#[expect(clippy::cast_precision_loss, reason = "a forecast needs no last digit")]
fn real(n: u128) -> f64 {
    n as f64
}
