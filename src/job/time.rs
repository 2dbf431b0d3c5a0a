//! The time of a job, estimated from its work. The unit is a row of a weight table, 100 ns.
//!
//! The constants are measured on one core with a release build, and rounded up: a row of a refinement with its points
//! 100 ns, a byte of a result 10 ns (pictures are counted by their pixels), drawing as `raster::RasterForecast` says.

use super::complete::Job;
use crate::analysis::limit::sees_whole_fans;
use crate::output::{Counts, Size, surface};
use crate::shape::mesh::Mesh;
use crate::shape::topology::Topology;

/// Rows per millisecond, of 100 ns each, as measured (see the head of this file). Half of it predicts twice the time,
/// and sends jobs to the long lane that take half of what makes them long; twice of it lets jobs of twice that time
/// hold up short ones.
const ROWS_A_MS: u128 = 10_000;
/// Bytes of a result written per millisecond, of 10 ns each, as measured (see the head of this file). Half and twice of
/// it change the prediction as those of [`ROWS_A_MS`] do, where a result has ten bytes or more for each row.
const BYTES_A_MS: u128 = 100_000;
/// Rows per pair of faces around a vertex, or of corners of a face, if limits are requested and all vertices around it
/// have discs with all of these faces and rows over them, or if something is sharp, so that the walks from its faces
/// differ. Finding a vertex of a disc takes some 50 ns, in each of a few levels, twice with its row.
const ROWS_A_PAIR: u128 = 3;

/// Returns the rows besides those of the refinement: for drawing, and for the discs of limits.
pub(super) fn rows(job: &Job, counts: &Counts) -> u128 {
    let mesh = job.input.mesh();
    let drawn = job.outputs.iter().map(|output| output.format.work(mesh, counts, &output.options));
    let limits = job.outputs.iter().filter(|output| surface::limit(&output.options) != [false; 2]).count() as u128;
    let far = sees_whole_fans(&job.plan.word.cycle);
    let counted = |mesh: &&Mesh| limits > 0 && (far || !mesh.creases.is_empty() || mesh.directions.is_some());
    let pairs = mesh.filter(counted).map_or(0, |mesh| pairs(&mesh.topology));
    drawn.fold(limits.saturating_mul(pairs).saturating_mul(ROWS_A_PAIR), u128::saturating_add)
}

/// Returns the approximate time in milliseconds on one core.
pub(super) fn milliseconds(rows: u128, sizes: &[Size]) -> u128 {
    let bytes = sizes.iter().fold(0, |sum: u128, size| sum.saturating_add(size.bytes()));
    rows / ROWS_A_MS + bytes / BYTES_A_MS + 1
}

/// Returns the number of pairs of faces around a vertex, or of corners of a face, over all large vertices and faces.
fn pairs(topology: &Topology) -> u128 {
    /// Maximum number of faces around a vertex that is covered by the other rows. Half of it counts the pairs of
    /// valences 9 to 16 twice; twice of it leaves out up to 1,024 pairs of a vertex.
    const COVERED_VALENCE: usize = 16;
    let square = |n: usize| if n > COVERED_VALENCE { (n as u128).saturating_mul(n as u128) } else { 0 };
    let vertices = (0..topology.n_vertices()).map(|v| square(topology.ring(v).count()));
    let faces = (0..topology.n_faces()).map(|f| square(topology.face(f).len()));
    vertices.chain(faces).fold(0, u128::saturating_add)
}
