//! What a job takes, made of what it does. The unit is a row of a table of weights, 100 ns.
//!
//! The constants are measured on one core of a server of 2020, release build, and rounded up: a row of a refinement with its
//! points 100 ns, a byte of a result 10 ns (pictures are counted by their pixels), drawing as `raster::Forecast` says.

use super::{Input, Job};
use crate::output::{Counts, Size, surface};
use crate::shape::topology::Topology;

/// Rows in a millisecond.
const ROWS_A_MS: u128 = 10_000;
/// Bytes of a result that are made in a millisecond.
const BYTES_A_MS: u128 = 100_000;
/// Rows for each pair of faces around a vertex, or of corners of a face, where limits are asked for: all vertices around it
/// have patches with all of these faces, and rows over them. Measured around 10,000 triangles.
const ROWS_A_PAIR: u128 = 2;

/// Rows besides those of the refinement: drawing, and the patches of limits.
pub(super) fn rows(job: &Job, counts: &Counts) -> u128 {
    let mesh = if let Input::Mesh(mesh) = &job.input { Some(mesh) } else { None };
    let drawn = job.outputs.iter().map(|output| output.format.work(mesh, counts, &output.options));
    let limits = job.outputs.iter().filter(|output| surface::limit(&output.options) != [false; 2]).count() as u128;
    let pairs = if limits > 0 { mesh.map_or(0, |mesh| pairs(&mesh.topology)) } else { 0 };
    drawn.fold(limits.saturating_mul(pairs).saturating_mul(ROWS_A_PAIR), u128::saturating_add)
}

/// Milliseconds on one core, roughly.
pub(super) fn milliseconds(rows: u128, sizes: &[Size]) -> u128 {
    let bytes = sizes.iter().fold(0, |sum: u128, size| sum.saturating_add(size.bytes()));
    rows / ROWS_A_MS + bytes / BYTES_A_MS + 1
}

/// Pairs of faces around a vertex, or of corners of a face, of all vertices and faces that have more than a few.
fn pairs(topology: &Topology) -> u128 {
    /// Most faces around a vertex that are counted with the other rows.
    const FEW: usize = 16;
    let square = |n: usize| if n > FEW { (n as u128).saturating_mul(n as u128) } else { 0 };
    let vertices = (0..topology.n_vertices()).map(|v| square(topology.ring(v).count()));
    let faces = (0..topology.n_faces()).map(|f| square(topology.face(f).len()));
    vertices.chain(faces).fold(0, u128::saturating_add)
}
