//! Runs an admitted job: refine, then write one output.

use std::io::Write;

use super::limits::Admitted;
use super::{Input, Output, curves};
use crate::analysis::curve;
use crate::analysis::limit::{LimitError, LimitRequest, refine_mesh_to_limit};
use crate::fault::Fault;
use crate::output::FormatError;
use crate::output::scene::{Curve, Scene, Shape};
use crate::output::surface;
use crate::refine::{RefineError, RefinedMesh, refine_mesh};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::step::StepError;
use crate::scheme::tags::Boundary;
use crate::shape::attributes::Attributes;
use crate::shape::mesh::Mesh;
use crate::watch::{Stage, Stopped, Watch};

/// What a run has to say besides the bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// What the client should know about the result, in sentences.
    pub warnings: Vec<String>,
}

/// Why a run ended without a result.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(Stopped),
    /// The job turned out to be impossible: where, and why.
    #[error("{0}")]
    Impossible(Fault),
    /// The bytes could not be taken.
    #[error("writing the result failed: {0}")]
    Io(std::io::Error),
}

impl From<RefineError> for RunError {
    fn from(error: RefineError) -> Self {
        match error {
            RefineError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Impossible(Fault::new("/plan", other.to_string())),
        }
    }
}

impl RunError {
    /// The error of a mesh at `place` below the job whose limit an output asks for.
    fn of_limit(error: LimitError, attributes: Option<&Attributes>, place: &str) -> Self {
        match error {
            LimitError::Refine(error) => Self::of_shape(error, attributes, place),
            error @ LimitError::Unlimited(_) => Self::Impossible(Fault::new("/outputs/0", error.to_string())),
        }
    }

    /// The error of refining a shape at `place` below the job. A kernel without an average, or a compensation beyond its
    /// bound, stands at what it was made of: the kernels or compensations of the points of the shape, else their alphas,
    /// else the function of the plan.
    pub(super) fn of_shape(error: RefineError, attributes: Option<&Attributes>, place: &str) -> Self {
        let name = match &error {
            RefineError::Step { error: StepError::NoAverage { name, .. }, .. } => *name,
            RefineError::Step { error: StepError::LargeCompensation { .. }, .. } => "compensation",
            _ => return error.into(),
        };
        let arrays = attributes.map(Attributes::arrays).unwrap_or_default();
        let given = |wanted: &str| arrays.iter().any(|(name, array)| *name == wanted && array.is_some());
        // along longitude lines there is the kernel of the points, too
        let carried = if name == "compensation" { name } else { "kernel" };
        let place = match [carried, "alpha"].into_iter().find(|name| given(name)) {
            Some(carried) => format!("{place}/parameters/{carried}"),
            None => format!("/plan/parameters/{name}"),
        };
        Self::Impossible(Fault::new(place, error.to_string()))
    }
}

impl From<FormatError> for RunError {
    fn from(error: FormatError) -> Self {
        match error {
            FormatError::Stopped(stopped) => Self::Stopped(stopped),
            FormatError::Io(error) => Self::Io(error),
            FormatError::Unfit(detail) => Self::Impossible(Fault::new("/outputs/0", detail)),
        }
    }
}

/// Computes one output of a job and writes its bytes to `out`: a pure function of the job.
///
/// # Errors
/// [`RunError`].
pub fn run(admitted: &Admitted, output: &Output, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
    let job = admitted.job();
    let steps = job.plan.schedule(job.levels).map_err(|fault| RunError::Impossible(fault.under("/plan")))?;
    watch.enter(Stage::Refine);
    match &job.input {
        Input::Polygons(polygons) => {
            let refined = curves::refine_all(job, polygons, &steps, output, watch)?;
            let control: Vec<Curve> = polygons.iter().map(curves::control).collect::<Result<_, _>>()?;
            let warnings = curve::warnings(&job.plan, job.levels, watch).map_err(RunError::Stopped)?;
            let (shape, control) = (Shape::Curves(&refined), Shape::Curves(&control));
            let scene = Scene { shape, control, warnings: &warnings, frame: job.frame };
            write(&scene, output, out, watch)
        }
        Input::Mesh(mesh) => {
            let [positions, normals] = surface::limit(&output.options);
            let asked = LimitRequest { positions, normals };
            let refined = if asked.anything() {
                refine_mesh_to_limit(mesh, &job.plan, job.levels, asked, watch)
            } else {
                refine_mesh(mesh, &job.plan, &steps, watch)
                    .map(|refined| (refined, Vec::new()))
                    .map_err(LimitError::from)
            };
            let (refined, found) =
                refined.map_err(|error| RunError::of_limit(error, mesh.attributes.as_ref(), "/input/mesh"))?;
            let control = control_mesh(mesh);
            let warnings = &[mesh.warnings.clone(), found].concat();
            let (shape, control) = (Shape::Mesh(&refined), Shape::Mesh(&control));
            let scene = Scene { shape, control, warnings, frame: job.frame };
            write(&scene, output, out, watch)
        }
    }
}

fn write(scene: &Scene<'_>, output: &Output, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
    watch.enter(Stage::Encode);
    output.format.write(scene, &output.options, out, watch)?;
    Ok(Report { warnings: scene.warnings.to_vec() })
}

fn control_mesh(mesh: &Mesh) -> RefinedMesh {
    let net = MeshNet::new(mesh.topology.clone(), &[], &mesh.holes, Boundary::EdgeOnly);
    RefinedMesh::documented(&net, mesh.positions.clone())
}
