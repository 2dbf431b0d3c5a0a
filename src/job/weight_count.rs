//! Upper bounds of the number of weights.

use super::complete::Job;
use super::input::Input;
use crate::output::surface;
use crate::scheme::forecast::Forecast;
use crate::scheme::operator::Role;
use crate::shape::polygon::Polygon;
use crate::shape::topology::Topology;

/// Maximum number of rows per point and step: the difference from the anchor, the displacement, and the point itself.
const MAX_ROWS_A_STEP: u128 = 3;
/// Maximum number of entries per point and step of a mesh, apart from those that grow with squares of valences and face
/// sizes. A ring of quads has 9, a regular vertex of triangles at most 13, a push-back with its three tables 2 + 4 + 2.
/// Half of it would be exceeded by words over C and P; twice of it would refuse results half as large as the limits.
const MESH_ENTRIES: u128 = 16;
/// Multiplicity of the square of a valence or face size in a step: for each of the edges around it a row over all of
/// them, and once more with their opposite corners.
const ROWS_A_SQUARE: u128 = 4;

/// Returns upper bounds of the rows and entries of the weights of a job after `level` levels.
pub(super) fn most(job: &Job, forecast: &Forecast, level: usize) -> [u128; 2] {
    if !job.outputs.iter().any(|output| output.format.is_of_weights()) {
        return [0; 2];
    }
    let (points, n_steps) = made(job, forecast, level);
    let last = forecast.levels.get(level).map_or(0, |count| count.vertices);
    let (an_entry, apart) = match &*job.input {
        Input::Polygons(polygons) => of_polygons(job, polygons),
        Input::Mesh(mesh) => (MESH_ENTRIES, ROWS_A_SQUARE * squares(&mesh.topology)),
    };
    let [limits, around] = limit_rows(job);
    let split = forecast.levels.get(level).map_or(0, |count| count.split_vertices);
    let results = last.saturating_mul(1 + limits).saturating_add(split.saturating_mul(limits));
    let rows = points.saturating_mul(MAX_ROWS_A_STEP).saturating_add(results);
    let entries = points.saturating_mul(an_entry).saturating_add(n_steps.saturating_mul(apart));
    // a result is a copy of a point, or a sum over those around it
    let of_limits = results.saturating_add(apart).saturating_mul(1 + limits.min(1) * around.max(an_entry));
    [rows, entries.saturating_add(of_limits)]
}

/// Returns the number of rows for the limit of a point (its position and two tangents), and of entries of each in
/// regular nets.
fn limit_rows(job: &Job) -> [u128; 2] {
    let rows = |[positions, normals]: [bool; 2]| u128::from(positions) + 2 * u128::from(normals);
    let limits = job.outputs.iter().map(|output| rows(surface::limit(&output.options))).max().unwrap_or(0);
    let rings = 1 + job.plan.word.cycle.iter().filter(|letter| letter.facts().role != Role::Upsample).count() as u128;
    [limits, (2 * rings + 1).pow(2)]
}

/// Returns the number of points of all nets up to a level, and of steps; exact for the last level.
fn made(job: &Job, forecast: &Forecast, level: usize) -> (u128, u128) {
    let n_steps = job.steps().iter().filter(|step| step.level as usize <= level).count() as u128;
    if level + 1 >= forecast.levels.len() {
        return (forecast.work, n_steps);
    }
    let at = |step: u32| forecast.levels.get(step as usize).map_or(0, |count| count.vertices);
    let steps = job.steps().iter().filter(|step| step.level as usize <= level);
    // between two operators there may be twice as many points, as triangles have twice as many faces as vertices
    let points = steps.map(|step| at(step.level).saturating_mul(2)).fold(0, u128::saturating_add);
    (points, n_steps)
}

/// Returns upper bounds of the entries per point of polygons in a step, those of the widest mask, and of the additional
/// entries near ends, where each entry beyond the end is reflected, perhaps several times.
fn of_polygons(job: &Job, polygons: &[Polygon]) -> (u128, u128) {
    /// Number of points that a step without mask reads: a push-back with its tables, or the widest rule at an end.
    const LEAST_POINTS_READ: u128 = 8;
    let (mut duals, mut most) = (0, LEAST_POINTS_READ);
    for step in job.steps() {
        duals = if step.letter.facts().role == Role::Upsample { 0 } else { duals };
        let range = step.letter.operator.mask_range(&step.letter.settings, duals);
        most = range.map_or(most, |range| most.max(u128::from(range.last.abs_diff(range.first)) + 1));
        duals += u32::from(step.letter.shifts());
    }
    // rows at two ends, or on both sides of corners
    let ends = |polygon: &Polygon| 2 * (u128::from(!polygon.closed) + polygon.corners.len() as u128);
    let reflected = |polygon: &Polygon| ends(polygon) * most.div_ceil((polygon.len() as u128).max(2) - 1);
    let apart = polygons.iter().map(reflected).fold(0, u128::saturating_add);
    (most + 2, apart.saturating_mul(most * most))
}

/// Returns the sum of the squares of all valences and face sizes.
fn squares(topology: &Topology) -> u128 {
    let square = |n: usize| (n as u128).saturating_mul(n as u128);
    let vertices = (0..topology.n_vertices()).map(|v| square(topology.ring(v).count() + 1));
    let faces = (0..topology.n_faces()).map(|f| square(topology.face(f).len()));
    vertices.chain(faces).fold(0, u128::saturating_add)
}
