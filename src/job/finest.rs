//! Finds the level at which faces are about a pixel wide in the pictures of a job.

use super::complete::CheckedJob;
use super::input::Input;
use crate::fault::Fault;
use crate::output::{MAX_LINE_TRIANGLES, Outline, Paper};
use crate::refine::{mesh_net, polygon_net};
use crate::scheme::forecast;
use crate::scheme::plan::MAX_PLAN_LEVELS;
use crate::shape::polygon::Polygon;
use crate::shape::topology::Topology;
use crate::watch::Watch;

/// Maximum number of faces, or points, of the level found. A picture of usual size has fewer pixels. The bound must not
/// depend on the limits of a server, so that the same job gives the same picture everywhere. Half as many would show
/// the faces of models seen from close by; twice as many would take twice the time and memory.
const MAX_FINEST_FACES: u128 = 1 << 21;
/// Lower bound in pixels of the mean side of faces on the last level; it is less than this times the arity. Half of it
/// would refine beyond what is visible; twice of it would show the sides of faces in outlines.
const SIDE_PX: f64 = 1.0;
/// Maximum number of edges to measure; of more edges, an evenly spread selection is measured in about 20 ms. Half of it
/// takes half the time and sees fewer edges; twice of it takes twice the time.
const MAX_EDGES: usize = 1 << 17;

/// Returns the highest level whose faces are on average at least a pixel wide in one of the pictures.
///
/// # Errors
/// A fault below the job, where an output has no pixels or the plan makes no smaller faces.
pub(super) fn level(checked: &CheckedJob) -> Result<u32, Fault> {
    let outline = outline(&checked.input)?;
    let mut widest: f64 = 0.0;
    for output in &checked.outputs {
        let side = output.format.side_px(&outline, checked.coordinate_system, &output.options).ok_or_else(|| {
            let name = output.format.name();
            Fault::new("/levels", format!("\"auto\" is for pictures, {name} has no pixels; give a number of levels"))
        })?;
        widest = widest.max(side);
    }
    let [first, _] = counted(checked, 0)?;
    let in_lines = checked.outputs.iter().any(|output| matches!(output.format.paper(), Some(Paper::Svg | Paper::Pdf)));
    let most_triangles = if in_lines { MAX_LINE_TRIANGLES } else { u128::MAX };
    let mut best = 0;
    for level in 1..=MAX_PLAN_LEVELS {
        let Ok([count, triangles]) = counted(checked, level) else { break };
        if count <= first {
            return Err(Fault::new("/levels", "the plan makes no smaller faces; give a number of levels"));
        }
        #[expect(clippy::cast_precision_loss, reason = "a ratio needs no last digit")]
        let parts = count as f64 / first.max(1) as f64;
        let parts = if checked.input.mesh().is_some() { parts.sqrt() } else { parts };
        // false for sides that are NaN
        let is_wide = widest / parts >= SIDE_PX;
        if count > MAX_FINEST_FACES || triangles > most_triangles || !is_wide {
            break;
        }
        best = level;
    }
    Ok(best)
}

/// Returns the number of faces of a mesh, or of points of polygons, after `levels` levels, and of triangles.
fn counted(checked: &CheckedJob, levels: u32) -> Result<[u128; 2], Fault> {
    let steps = checked.plan.schedule(levels).map_err(|fault| fault.under("/plan"))?;
    let forecast = match &*checked.input {
        Input::Mesh(mesh) => {
            forecast::of_mesh(&mesh_net(mesh, &checked.plan), &steps, 4 * MAX_FINEST_FACES, &Watch::new())
        }
        Input::Polygons(polygons) => {
            let nets: Vec<_> = polygons.iter().map(|polygon| polygon_net(polygon, &checked.plan)).collect();
            forecast::of_polygons(&nets, &steps)
        }
    };
    let forecast = forecast.map_err(|error| Fault::new("/levels", error.to_string()))?;
    let last = forecast.levels.last().copied().unwrap_or_default();
    let triangles = last.corners.saturating_sub(last.faces.saturating_mul(2));
    Ok(if checked.input.mesh().is_some() { [last.faces, triangles] } else { [last.vertices, 0] })
}

/// Returns the points and some edges of the input.
fn outline(input: &Input) -> Result<Outline, Fault> {
    let edges = |topology: &Topology| {
        let stride = topology.n_edges().div_ceil(MAX_EDGES).max(1);
        (0..topology.n_edges()).step_by(stride).map(|edge| topology.ends(edge)).collect()
    };
    match input {
        Input::Mesh(mesh) => {
            let points = mesh.positions.as_chunks::<3>().0.to_vec();
            Ok(Outline { points, edges: edges(&mesh.topology), is_flat: false })
        }
        Input::Polygons(polygons) => {
            let mut outline = Outline { points: Vec::new(), edges: Vec::new(), is_flat: true };
            polygons.iter().try_for_each(|polygon| add(polygon, &mut outline))?;
            Ok(outline)
        }
    }
}

/// Adds the sides of a polygon.
fn add(polygon: &Polygon, outline: &mut Outline) -> Result<(), Fault> {
    let coordinates = polygon.dimension - usize::from(polygon.rational);
    if !(2..=3).contains(&coordinates) {
        let detail =
            format!("\"auto\" is for points of 2 or 3 coordinates, not {coordinates}; give a number of levels");
        return Err(Fault::new("/levels", detail));
    }
    outline.is_flat &= coordinates == 2;
    let first = u32::try_from(outline.points.len()).unwrap_or(u32::MAX);
    let n = u32::try_from(polygon.len()).unwrap_or(u32::MAX);
    for point in polygon.points.chunks_exact(polygon.dimension) {
        let weight = if polygon.rational { point[coordinates] } else { 1.0 };
        outline.points.push(std::array::from_fn(|k| if k < coordinates { point[k] / weight } else { 0.0 }));
    }
    let sides = if polygon.closed { n } else { n.saturating_sub(1) };
    outline.edges.extend((0..sides).map(|i| [first + i, first + (i + 1) % n]));
    Ok(())
}
