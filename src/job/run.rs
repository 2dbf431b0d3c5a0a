//! Runs an admitted job: refine, then write one output.

use std::io::Write;
use std::sync::OnceLock;

use super::complete::Job;
use super::curves;
use super::error::RunError;
use super::input::Input;
use super::limits::Admitted;
use super::output::Output;
use super::work::{KeepNothing, KeepWork, refined};
use crate::analysis::curve;
use crate::output::scene::{Control, Curve, Detail, Scene, Shape};
use crate::refine::{RefinedMesh, StreamedMesh};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::tags::Boundary;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::watch::{Stage, Watch};

/// What a run has to say besides the bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// What the client should know about the result, in sentences.
    pub warnings: Vec<String>,
}

/// Computes one output of a job and writes its bytes to `out`: a pure function of the job.
///
/// # Errors
/// [`RunError`].
pub fn run(admitted: &Admitted, output: &Output, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
    run_keeping(admitted, output, &KeepNothing, out, watch)
}

/// Computes one output of a job as [`run`] does, from work that is kept of earlier computations as far as it is, and
/// offers what it makes itself to later ones.
///
/// # Errors
/// [`RunError`].
pub fn run_keeping(
    admitted: &Admitted,
    output: &Output,
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let job = admitted.job();
    watch.enter(Stage::Refine);
    match &job.input {
        Input::Polygons(polygons) => draw(job, polygons, output, out, watch),
        Input::Mesh(mesh) => form(admitted, (mesh, output), kept, out, watch),
    }
}

/// Refines and writes polygons.
fn draw(
    job: &Job,
    polygons: &[Polygon],
    output: &Output,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let refined = curves::refine_all(polygons, (&job.plan, job.levels, job.steps()), output, watch)?;
    let warnings = curve::warnings(&job.plan, job.levels, watch).map_err(RunError::Stopped)?;
    let control = &ControlPolygons { polygons, curves: OnceLock::new() };
    let shape = Shape::Curves(&refined);
    let scene = Scene { shape, control, warnings: &warnings, frame: job.frame, details: &[] };
    write(&scene, output, out, watch)
}

/// Refines and writes a mesh.
fn form(
    admitted: &Admitted,
    (mesh, output): (&Mesh, &Output),
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let job = admitted.job();
    let mesh = &*mesh.at_frame(output.frame);
    let control = &ControlMesh { mesh, refined: OnceLock::new() };
    if admitted.estimate().on_demand {
        let streamed = StreamedMesh::of(mesh, &job.plan, job.steps(), watch);
        let streamed = streamed.map_err(|error| RunError::of_limit(error.into(), mesh.attributes.as_ref(), ""))?;
        let Some(streamed) = streamed else { return Err(RunError::too_large()) };
        let (shape, warnings) = (Shape::Mesh(&streamed), mesh.warnings());
        let scene = Scene { shape, control, warnings: &warnings, frame: job.frame, details: &[] };
        return write(&scene, output, out, watch);
    }
    let refined = &*refined(job, mesh, output, kept, watch)?;
    let shape = Shape::Mesh(&refined.mesh);
    let jobs = job.details(output);
    let coarser = jobs.iter().filter(|coarser| coarser.levels != job.levels);
    let coarser: Result<Vec<_>, RunError> =
        coarser.map(|coarser| self::refined(coarser, mesh, &coarser.outputs[0], kept, watch)).collect();
    let coarser = coarser?;
    let shapes = coarser.iter().map(|coarser| Shape::Mesh(&coarser.mesh)).chain([shape]);
    let address = |job: &Job| format!("{}.{}", job.keys()[0], job.outputs[0].format.extension());
    let details: Vec<Detail<'_>> = jobs
        .iter()
        .zip(shapes)
        .map(|(job, shape)| Detail { shape, options: &job.outputs[0].options, uri: address(job) })
        .collect();
    let (warnings, frame) = (&refined.warnings, job.frame);
    write(&Scene { shape, control, warnings, frame, details: &details }, output, out, watch)
}

fn write(scene: &Scene<'_>, output: &Output, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
    watch.enter(Stage::Encode);
    output.format.write(scene, &output.options, out, watch)?;
    let carried = if let Shape::Mesh(mesh) = scene.shape { mesh.attachments() } else { Attachments::none() };
    let left_out = output.format.leaves_out(carried, &output.options);
    Ok(Report { warnings: scene.warnings.iter().cloned().chain(left_out).collect() })
}

/// Polygons as they were given.
#[derive(Debug)]
struct ControlPolygons<'a> {
    polygons: &'a [Polygon],
    curves: OnceLock<Vec<Curve>>,
}

impl Control for ControlPolygons<'_> {
    fn shape(&self) -> Shape<'_> {
        Shape::Curves(self.curves.get_or_init(|| self.polygons.iter().map(curves::control).collect()))
    }
}

/// A mesh as it was given.
#[derive(Debug)]
struct ControlMesh<'a> {
    mesh: &'a Mesh,
    refined: OnceLock<RefinedMesh>,
}

impl Control for ControlMesh<'_> {
    fn shape(&self) -> Shape<'_> {
        Shape::Mesh(self.refined.get_or_init(|| {
            let net = MeshNet::new(self.mesh.topology.clone(), &[], &self.mesh.holes, Boundary::EdgeOnly);
            RefinedMesh::documented(&net, self.mesh.positions.clone().into())
        }))
    }

    fn mesh(&self) -> Option<&Mesh> {
        Some(self.mesh)
    }
}
