//! Builds the scene that an output of a job shows.

use std::sync::{Arc, OnceLock};

use super::complete::Job;
use super::curves;
use super::error::RunError;
use super::input::Input;
use super::output::Output;
use super::report::Report;
use super::weights;
use super::work::{KeepWork, Refined, refined};
use crate::analysis::curve;
use crate::output::scene::{Control, Curve, Detail, Notes, Scene, Shape};
use crate::output::{FormatError, left_out, shows_distances};
use crate::refine::{RefinedMesh, StreamedMesh};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::scheme::tags::Boundary;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::watch::{Stage, Watch};

/// A consumer of the scene of a job.
pub(super) type Show<'a> = &'a mut dyn FnMut(&Scene<'_>) -> Result<(), FormatError>;

/// Builds the scene that an output of a job shows, refined while it is read if `on_demand`, and passes it to `show`.
///
/// # Errors
/// [`RunError`].
pub(super) fn show(
    (job, on_demand): (&Job, bool),
    output: &Output,
    kept: &dyn KeepWork,
    watch: &Watch,
    show: Show<'_>,
) -> Result<Report, RunError> {
    if output.format.is_of_weights() {
        return weighed(job, output, watch, show);
    }
    match &*job.input {
        Input::Polygons(polygons) => draw(job, polygons, output, watch, show),
        Input::Mesh(mesh) => form((job, on_demand), (mesh, output), kept, watch, show),
    }
}

/// Shows the weights of the points, beside the control shape.
fn weighed(job: &Job, output: &Output, watch: &Watch, show: Show<'_>) -> Result<Report, RunError> {
    let (weights, warnings) = weights::weigh(job, output, watch)?;
    let control: Box<dyn Control> = match &*job.input {
        Input::Polygons(polygons) => Box::new(ControlPolygons { polygons, curves: OnceLock::new() }),
        Input::Mesh(mesh) => Box::new(ControlMesh { mesh, plan: &job.plan, refined: OnceLock::new(), other: None }),
    };
    let (shape, control) = (control.shape(), &*control);
    let (coordinate_system, notes) = (job.coordinate_system, &Notes::default());
    let scene =
        Scene { shape, control, warnings: &warnings, coordinate_system, notes, weights: Some(&weights), details: &[] };
    shown(&scene, output, watch, show)
}

/// Refines and shows polygons.
fn draw(job: &Job, polygons: &[Polygon], output: &Output, watch: &Watch, show: Show<'_>) -> Result<Report, RunError> {
    let refined = curves::refine_all(polygons, (&job.plan, job.levels, job.steps()), output, watch)?;
    let warnings = curve::warnings(&job.plan, job.levels, watch).map_err(RunError::Stopped)?;
    let control = &ControlPolygons { polygons, curves: OnceLock::new() };
    let shape = Shape::Curves(&refined);
    let (coordinate_system, notes) = (job.coordinate_system, &Notes::default());
    let scene = Scene { shape, control, warnings: &warnings, coordinate_system, notes, weights: None, details: &[] };
    shown(&scene, output, watch, show)
}

/// Refines and shows a mesh.
fn form(
    (job, on_demand): (&Job, bool),
    (mesh, output): (&Mesh, &Output),
    kept: &dyn KeepWork,
    watch: &Watch,
    show: Show<'_>,
) -> Result<Report, RunError> {
    let mesh = &*mesh.at_frame(output.frame);
    let other = other_surface(job, output, kept, watch)?;
    let control = &ControlMesh { mesh, plan: &job.plan, refined: OnceLock::new(), other: other.as_deref() };
    let (coordinate_system, notes) = (job.coordinate_system, &Notes::default());
    if output.format.is_of_limit() {
        let (shape, warnings) = (control.shape(), mesh.warnings());
        let scene =
            Scene { shape, control, warnings: &warnings, coordinate_system, notes, weights: None, details: &[] };
        return shown(&scene, output, watch, show);
    }
    if on_demand {
        let streamed = StreamedMesh::of(mesh, &job.plan, job.steps(), watch);
        let streamed = streamed.map_err(|error| RunError::of_limit(error.into(), mesh.attributes.as_ref(), ""))?;
        let Some(streamed) = streamed else { return Err(RunError::too_large()) };
        let (shape, warnings) = (Shape::Mesh(&streamed), mesh.warnings());
        let scene =
            Scene { shape, control, warnings: &warnings, coordinate_system, notes, weights: None, details: &[] };
        return shown(&scene, output, watch, show);
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
    let of_other = other.iter().flat_map(|other| &other.warnings).map(|warning| format!("distance_to: {warning}"));
    let warnings = &refined.warnings.iter().cloned().chain(of_other).collect::<Vec<String>>();
    shown(
        &Scene { shape, control, warnings, coordinate_system, notes, weights: None, details: &details },
        output,
        watch,
        show,
    )
}

/// Refines the surface of another job from which an output measures distances.
fn other_surface(
    job: &Job,
    output: &Output,
    kept: &dyn KeepWork,
    watch: &Watch,
) -> Result<Option<Arc<Refined>>, RunError> {
    let Some(other) = job.other.as_ref().filter(|_| shows_distances(&output.options)) else { return Ok(None) };
    let shape = &other.outputs[0];
    let Some(mesh) = other.input.mesh() else { return Ok(None) };
    let found = refined(other, &mesh.at_frame(shape.frame), shape, kept, watch);
    found.map(Some).map_err(|error| match error {
        RunError::Impossible(fault) => RunError::of_request(other.entries(shape).fault(fault).under("/distance_to")),
        other => other,
    })
}

fn shown(scene: &Scene<'_>, output: &Output, watch: &Watch, show: Show<'_>) -> Result<Report, RunError> {
    watch.enter(Stage::Encode);
    show(scene)?;
    let left_out = if let Shape::Mesh(mesh) = scene.shape {
        left_out::all(output.format, mesh.attachments(), &mesh.tags(), &output.options)
    } else {
        Vec::new()
    };
    Ok(Report { warnings: scene.warnings.iter().cloned().chain(scene.notes.take()).chain(left_out).collect() })
}

/// The control polygons.
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

/// The control mesh.
#[derive(Debug)]
struct ControlMesh<'a> {
    mesh: &'a Mesh,
    plan: &'a Plan,
    refined: OnceLock<RefinedMesh>,
    other: Option<&'a Refined>,
}

impl Control for ControlMesh<'_> {
    fn shape(&self) -> Shape<'_> {
        Shape::Mesh(self.refined.get_or_init(|| {
            let net = MeshNet::new(self.mesh.topology.clone(), &[], &self.mesh.holes, Boundary::EdgeOnly);
            RefinedMesh::documented(&net, self.mesh.positions.clone().into())
        }))
    }

    fn measured_from(&self) -> Shape<'_> {
        self.other.map_or_else(|| self.shape(), |other| Shape::Mesh(&other.mesh))
    }

    fn mesh(&self) -> Option<&Mesh> {
        Some(self.mesh)
    }

    fn plan(&self) -> Option<&Plan> {
        Some(self.plan)
    }
}
