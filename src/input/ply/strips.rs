//! Triangle strips as in the Stanford scans: lists of vertices in which a negative number begins a new strip.

use super::body::Body;
use super::header::{Element, Scalar};
use crate::input::collect::{MeshBuilder, vertex_index};

/// Reads the triangles of a `tristrips` element with counter-clockwise orientation. Degenerate triangles, which join
/// strips, are left out. Other properties are skipped.
pub(super) fn read(element: &Element, body: &mut impl Body, mesh: &mut MeshBuilder) -> Result<(), String> {
    let n = mesh.mesh.positions.len();
    for _ in 0..element.count {
        for property in &element.properties {
            let list = property.list.filter(|_| property.holds_corners() && property.kind == Scalar::I32);
            let Some(sizes) = list else {
                body.pass(property)?;
                continue;
            };
            // the last two vertices, and the number of vertices since the strip began
            let (mut last, mut length) = ([0; 2], 0_usize);
            for _ in 0..body.size(sizes, property.kind)? {
                let number = body.scalar(property.kind)?;
                if number < 0.0 {
                    length = 0;
                    continue;
                }
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole, at least 0")]
                let vertex = vertex_index(number as u64, n).map_err(|detail| format!("{}: {detail}", body.place()))?;
                let [a, b] = if length.is_multiple_of(2) { last } else { [last[1], last[0]] };
                if length > 1 && a != b && b != vertex && vertex != a {
                    mesh.face(&[a, b, vertex])?;
                }
                last = [last[1], vertex];
                length += 1;
            }
        }
    }
    Ok(())
}
