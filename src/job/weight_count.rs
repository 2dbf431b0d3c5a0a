//! How many weights there may be.

use super::complete::Job;
use super::input::Input;
use crate::output::surface;
use crate::scheme::forecast::Forecast;
use crate::scheme::operator::Role;
use crate::shape::polygon::Polygon;
use crate::shape::topology::Topology;

/// Rows of a point in a step, at most: what of it is left over by the last upsampling, what it moves by, and itself.
const ROWS: u128 = 3;
/// Entries for a point in a step of a mesh, at most, but for those that grow with the squares of valences and of sizes
/// of faces. A ring of quads has 9, a vertex of butterfly schemes 13, a push-back with its three tables 2 + 4 + 2.
/// Half of it would be passed by words over C and P; twice of it refuses results half as large as the limits.
const MESH_ENTRIES: u128 = 16;
/// How often the square of a valence or of the size of a face counts in a step, at most: for each of the edges around
/// it a row over all of them, and once more with their opposite corners.
const SQUARES: u128 = 4;

/// Rows and entries of the weights of a job after so many levels, at most.
pub(super) fn most(job: &Job, forecast: &Forecast, level: usize) -> [u128; 2] {
    if !job.outputs.iter().any(|output| output.format.is_of_weights()) {
        return [0; 2];
    }
    let (points, n_steps) = made(job, forecast, level);
    let last = forecast.levels.get(level).map_or(0, |count| count.vertices);
    let (an_entry, apart) = match &*job.input {
        Input::Polygons(polygons) => of_polygons(job, polygons),
        Input::Mesh(mesh) => (MESH_ENTRIES, SQUARES * squares(&mesh.topology)),
    };
    let [limits, around] = limit_rows(job);
    let split = forecast.levels.get(level).map_or(0, |count| count.split_vertices);
    let results = last.saturating_mul(1 + limits).saturating_add(split.saturating_mul(limits));
    let rows = points.saturating_mul(ROWS).saturating_add(results);
    let entries = points.saturating_mul(an_entry).saturating_add(n_steps.saturating_mul(apart));
    // a result repeats a point, or is made of those around it
    let of_limits = results.saturating_add(apart).saturating_mul(1 + limits.min(1) * around.max(an_entry));
    [rows, entries.saturating_add(of_limits)]
}

/// Rows that follow for the limit of a point, its place and two tangents, and entries of each where nets are regular.
fn limit_rows(job: &Job) -> [u128; 2] {
    let rows = |[positions, normals]: [bool; 2]| u128::from(positions) + 2 * u128::from(normals);
    let limits = job.outputs.iter().map(|output| rows(surface::limit(&output.options))).max().unwrap_or(0);
    let rings = 1 + job.plan.word.cycle.iter().filter(|letter| letter.facts().role != Role::Upsample).count() as u128;
    [limits, (2 * rings + 1).pow(2)]
}

/// Points of all nets up to a level, and steps; exact for the last level.
fn made(job: &Job, forecast: &Forecast, level: usize) -> (u128, u128) {
    let n_steps = job.steps().iter().filter(|step| step.level as usize <= level).count() as u128;
    if level + 1 >= forecast.levels.len() {
        return (forecast.work, n_steps);
    }
    let at = |step: u32| forecast.levels.get(step as usize).map_or(0, |count| count.vertices);
    let steps = job.steps().iter().filter(|step| step.level as usize <= level);
    // between two operators there may be twice as many, as triangles have twice as many faces as vertices
    let points = steps.map(|step| at(step.level).saturating_mul(2)).fold(0, u128::saturating_add);
    (points, n_steps)
}

/// Entries for a point of polygons in a step, at most: those of the widest mask. And those in addition near their ends,
/// where each entry that reaches beyond is reflected, perhaps several times.
fn of_polygons(job: &Job, polygons: &[Polygon]) -> (u128, u128) {
    /// What has no mask looks at so many points: a push-back with its tables, or the widest rule of a point at an end.
    const LEAST: u128 = 8;
    let (mut duals, mut most) = (0, LEAST);
    for step in job.steps() {
        duals = if step.letter.facts().role == Role::Upsample { 0 } else { duals };
        let window = step.letter.operator.window(&step.letter.settings, duals);
        most = window.map_or(most, |window| most.max(u128::from(window.last.abs_diff(window.first)) + 1));
        duals += u32::from(step.letter.shifts());
    }
    // rows at two ends, or on both sides of corners
    let ends = |polygon: &Polygon| 2 * (u128::from(!polygon.closed) + polygon.corners.len() as u128);
    let reflected = |polygon: &Polygon| ends(polygon) * most.div_ceil((polygon.len() as u128).max(2) - 1);
    let apart = polygons.iter().map(reflected).fold(0, u128::saturating_add);
    (most + 2, apart.saturating_mul(most * most))
}

/// The sum of the squares of all valences and of the sizes of all faces.
fn squares(topology: &Topology) -> u128 {
    let square = |n: usize| (n as u128).saturating_mul(n as u128);
    let vertices = (0..topology.n_vertices()).map(|v| square(topology.ring(v).count() + 1));
    let faces = (0..topology.n_faces()).map(|f| square(topology.face(f).len()));
    vertices.chain(faces).fold(0, u128::saturating_add)
}
