//! The weights by which the points of a job's result depend on those of its input.

use super::complete::Job;
use super::curves;
use super::entry::{JobFault, JobPart};
use super::error::RunError;
use super::input::Input;
use super::output::Output;
use crate::analysis::curve::{self, LimitRows, NoLimit};
use crate::analysis::limit::{LimitRequest, NoWeights, weigh_mesh_to_limit};
use crate::math::rows::collect;
use crate::output::surface;
use crate::refine::{Recorder, RefineError, documented, weigh_mesh, weigh_polygon};
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::shape::weights::Weights;
use crate::watch::Watch;

/// Returns the weights of the points that an output shows, and warnings as sentences. Applied in order, the weights
/// give the points with the same bits.
///
/// # Errors
/// [`RunError`].
pub(super) fn weigh(job: &Job, output: &Output, watch: &Watch) -> Result<(Weights, Vec<String>), RunError> {
    match &*job.input {
        Input::Polygons(polygons) => {
            let warnings = curve::warnings(&job.plan, job.levels, watch).map_err(RunError::Stopped)?;
            Ok((of_polygons(job, polygons, output, watch)?, warnings))
        }
        Input::Mesh(mesh) => Ok((of_mesh(job, mesh, output, watch)?, mesh.warnings())),
    }
}

fn of_polygons(job: &Job, polygons: &[Polygon], output: &Output, watch: &Watch) -> Result<Weights, RunError> {
    let columns = polygons.iter().map(Polygon::len).sum();
    let mut recorder = Recorder::new(columns);
    let no_limit = |error| RunError::Impossible(JobFault::new(JobPart::Plan, "", NoLimit::Plan(error)));
    let limit = curves::moves_points(output).then(|| LimitRows::of(&job.plan, job.levels).map_err(no_limit));
    let limit = limit.transpose()?;
    let mut first = 0;
    for (i, polygon) in polygons.iter().enumerate() {
        let of_shape = |error: RefineError| RunError::of_shape(error, polygon.attributes.as_ref(), i);
        let points = first..first + polygon.len();
        first = points.end;
        let net = weigh_polygon(&mut recorder, (polygon, points), &job.plan, job.steps(), watch).map_err(of_shape)?;
        match &limit {
            Some(rows) => {
                let rows = collect(&curve::positions(&net, rows));
                (0..rows.len()).for_each(|r| recorder.add(&rows, r, None));
            }
            None => recorder.end(),
        }
    }
    let vertices = recorder.n_results();
    let rational = polygons.iter().any(|polygon| polygon.rational);
    Ok(Weights { columns, rows: recorder.finish(), vertices, normals: None, rational })
}

fn of_mesh(job: &Job, mesh: &Mesh, output: &Output, watch: &Watch) -> Result<Weights, RunError> {
    let (attributes, columns) = (mesh.attributes.as_ref(), mesh.topology.n_vertices());
    let mut recorder = Recorder::new(columns);
    let [positions, normals] = surface::limit(&output.options);
    let asked = LimitRequest { positions, normals };
    if asked.anything() {
        let option = if positions { "/positions" } else { "/normals" };
        let found = weigh_mesh_to_limit(&mut recorder, mesh, &job.plan, job.levels, asked, watch);
        let normals = found.map_err(|error| match error {
            NoWeights::Limit(error) => RunError::of_limit(error, attributes, option),
            error @ NoWeights::Normals(_) => RunError::Impossible(JobFault::new(JobPart::Output, "/normals", error)),
        })?;
        let pairs = normals.as_ref().map_or(0, |normals| normals.sectors.len());
        let vertices = (recorder.n_results() - 2 * pairs) / if normals.is_some() { 3 } else { 1 };
        return Ok(Weights { columns, rows: recorder.finish(), vertices, normals, rational: false });
    }
    let net = weigh_mesh(&mut recorder, mesh, &job.plan, job.steps(), watch);
    let net = net.map_err(|error| RunError::of_shape(error, attributes, 0))?;
    let vertices = recorder.points().len();
    recorder.arrange(documented(&net, vertices).into_iter());
    recorder.end();
    Ok(Weights { columns, rows: recorder.finish(), vertices, normals: None, rational: false })
}
