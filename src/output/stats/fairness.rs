//! The fairness of a surface: its curvature, and the angles between normals across edges.

use serde_json::{Value, json};

use crate::math::functions::atan2;
use crate::math::vector::{cross, dot, length, mean};
use crate::output::error::FormatError;
use crate::output::hard_edges::{self, HardEdges};
use crate::output::mesh_curvature::{self, curvatures};
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, Shape};
use crate::output::split_vertices::SplitVertices;
use crate::watch::Watch;

/// Bytes of memory per vertex and per half-edge: curvatures and the weight of each vertex; edges with normals of their
/// faces, of which there are fewer than a third of the half-edges.
pub(super) const FAIRNESS_BYTES: [u128; 2] = [mesh_curvature::CURVATURE_VERTEX_BYTES, 12 + 24 / 3];

/// Maximum number of bytes of the entries.
pub(super) const FAIRNESS_ENTRY_BYTES: u128 = 1_024;

/// Adds entries to a report: `curvature`, whose `gaussian` and `mean` have the least and the greatest value at vertices
/// with their positions, and the mean over the surface (a vertex is weighted by the area of its faces); and
/// `normal_jump`, the largest angle between the normals of two faces at an edge, the ends of that edge and its
/// midpoint, or null if no edge has two faces.
pub(super) fn add(found: &mut Value, mesh: &dyn MeshSource, watch: &Watch) -> Result<(), FormatError> {
    let split = SplitVertices::of(Shape::Mesh(mesh), &HardEdges::default(), watch)?;
    let sides = split.as_ref().map_or(mesh, |split| split);
    let positions = Positions::of_mesh(sides).held(watch)?;
    let rows = positions.rows();
    let bends = curvatures(sides, rows, watch)?;
    found["curvature"] = json!({
        "gaussian": range(&bends.gaussian, &bends.areas, rows),
        "mean": range(&bends.mean, &bends.areas, rows),
    });
    found["normal_jump"] = jump(mesh, rows, watch)?;
    Ok(())
}

/// Returns the range of numbers of vertices; null if no vertex has a positive weight.
fn range(numbers: &[f64], shares: &[f64], rows: &[[f64; 3]]) -> Value {
    let counted = || (0..numbers.len()).filter(|&v| shares[v] > 0.0);
    let Some(first) = counted().next() else { return Value::Null };
    let low = counted().fold(first, |low, v| if numbers[v] < numbers[low] { v } else { low });
    let high = counted().fold(first, |high, v| if numbers[v] > numbers[high] { v } else { high });
    let (sum, area) = counted().fold((0.0, 0.0), |(sum, area), v| (sum + shares[v] * numbers[v], area + shares[v]));
    json!({
        "min": numbers[low] + 0.0,
        "min_at": rows[low].map(|x| x + 0.0),
        "max": numbers[high] + 0.0,
        "max_at": rows[high].map(|x| x + 0.0),
        "mean": sum / area + 0.0,
    })
}

fn jump(mesh: &dyn MeshSource, rows: &[[f64; 3]], watch: &Watch) -> Result<Value, FormatError> {
    let (upright, sides) = hard_edges::faces(mesh, watch)?;
    let mut largest: Option<(f64, [u32; 2])> = None;
    for sides in sides.chunk_by(|a, b| a[..2] == b[..2]) {
        let [[a, b, f], [.., g]] = *sides else { continue };
        let [n, m] = [f, g].map(|face| upright[face as usize]);
        let angle = atan2(length(cross(n, m)), dot(n, m));
        if largest.is_none_or(|(most, _)| angle > most) {
            largest = Some((angle, [a, b]));
        }
    }
    Ok(largest.map_or(Value::Null, |(angle, ends)| {
        let middle = mean(ends.iter().map(|&v| rows[v as usize])).map(|x| x + 0.0);
        json!({ "degrees": angle.to_degrees(), "vertices": ends, "at": middle })
    }))
}
