//! The sections of a mesh: a list of polylines for each plane.

use super::row::vectors;
use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::numbers::{REAL_BYTES, total};
use crate::output::positions::Positions;
use crate::output::scene::MeshSource;
use crate::output::sections::{Polyline, planes, section};
use crate::output::stream::Stream;

/// Returns the maximum number of bytes of the entry: each triangle gives at most one segment for each plane, and each
/// segment may be a polyline of its own.
pub(super) fn size(counts: &Counts, options: &Values) -> u128 {
    let planes = planes(options).len() as u128;
    let frame = br#","sections":[]"#.len() as u128;
    let polyline = br#"{"points":[],"closed":false},"#.len() as u128;
    let point = 3 + 3 * (REAL_BYTES + 1);
    let segments = planes.saturating_mul(counts.triangles());
    if planes == 0 { 0 } else { total(&[(1, frame), (planes, 3), (segments, polyline + 2 * point)]) }
}

/// Writes the entry after a comma, if sections are requested.
pub(super) fn write(mesh: &dyn MeshSource, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let planes = planes(options);
    if planes.is_empty() {
        return Ok(());
    }
    let positions = Positions::of_mesh(mesh).held(stream.watch)?;
    stream.bytes(br#","sections":["#)?;
    for (i, plane) in planes.iter().enumerate() {
        stream.bytes(if i > 0 { b",[" } else { b"[" })?;
        for (j, polyline) in section(mesh, positions.rows(), plane, stream.watch)?.iter().enumerate() {
            stream.bytes(if j > 0 { b"," } else { b"" })?;
            write_polyline(polyline, stream)?;
        }
        stream.bytes(b"]")?;
    }
    stream.bytes(b"]")
}

fn write_polyline(polyline: &Polyline, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#"{"points":["#)?;
    stream.rows(&polyline.points, vectors)?;
    stream.bytes(format!(r#"],"closed":{}}}"#, polyline.closed).as_bytes())
}
