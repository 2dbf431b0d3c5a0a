//! What computations leave for later ones: refined meshes, and programs of refinement. Results do not depend on it.

use std::fmt;
use std::sync::Arc;

use super::complete::Job;
use super::error::RunError;
use super::key::{self, Key};
use super::output::Output;
use crate::analysis::limit::{LimitError, LimitRequest, refine_mesh_to_limit};
use crate::output::surface;
use crate::refine::{Program, RefinedMesh};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Something that a computation can take from an earlier one.
#[derive(Debug, Clone)]
pub enum Work {
    /// How meshes with some connectivity and tags are refined by a plan.
    Program(Arc<Program>),
    /// A mesh, refined.
    Refined(Arc<Refined>),
}

/// A refined mesh, and what is to be said of it.
#[derive(Debug)]
pub struct Refined {
    /// The mesh.
    pub mesh: RefinedMesh,
    /// What the client should know, in sentences.
    pub warnings: Vec<String>,
}

impl Work {
    /// Bytes that it holds, a little more rather than less.
    pub fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Program(program) => program.bytes(),
            Self::Refined(refined) => refined.mesh.bytes() + refined.warnings.iter().map(String::len).sum::<usize>(),
        };
        bytes as u64
    }
}

/// Where work is kept, if it is.
pub trait KeepWork: fmt::Debug + Sync {
    /// The work of a key, if it is still here.
    fn find(&self, key: &Key) -> Option<Work>;

    /// Offers work under a key; how long it stays is left open.
    fn keep(&self, key: Key, work: Work);
}

/// Keeps no work.
#[derive(Debug, Clone, Copy, Default)]
pub struct KeepNothing;

impl KeepWork for KeepNothing {
    fn find(&self, _key: &Key) -> Option<Work> {
        None
    }

    fn keep(&self, _key: Key, _work: Work) {}
}

/// The mesh of a job as an output shows it, refined now or before.
///
/// # Errors
/// [`RunError`].
pub(super) fn refined(
    job: &Job,
    mesh: &Mesh,
    output: &Output,
    kept: &dyn KeepWork,
    watch: &Watch,
) -> Result<Arc<Refined>, RunError> {
    let key = job.refined_key(output).filter(|_| !job.steps().is_empty());
    if let Some(Work::Refined(found)) = key.and_then(|key| kept.find(&key)) {
        return Ok(found);
    }
    let [positions, normals] = surface::limit(&output.options);
    let asked = LimitRequest { positions, normals };
    let refined = if asked.anything() {
        refine_mesh_to_limit(mesh, &job.plan, job.levels, asked, watch)
    } else {
        let refined = program(job, mesh, kept).refine(mesh, &job.plan, job.steps(), watch);
        refined.map(|refined| (refined, Vec::new())).map_err(LimitError::from)
    };
    let option = if positions { "/positions" } else { "/normals" };
    let (refined, found) = refined.map_err(|error| RunError::of_limit(error, mesh.attributes.as_ref(), option))?;
    let refined = Arc::new(Refined { mesh: refined, warnings: [mesh.warnings(), found].concat() });
    if let Some(key) = key {
        kept.keep(key, Work::Refined(refined.clone()));
    }
    Ok(refined)
}

/// The program by which the mesh of a job is refined, made now or before.
fn program(job: &Job, mesh: &Mesh, kept: &dyn KeepWork) -> Arc<Program> {
    let key = key::program(&job.input, &job.plan, job.levels);
    if let Some(Work::Program(found)) = key.and_then(|key| kept.find(&key)) {
        return found;
    }
    let program = Arc::new(Program::of(mesh, &job.plan, job.steps()));
    if let Some(key) = key.filter(|_| program.is_swept()) {
        kept.keep(key, Work::Program(program.clone()));
    }
    program
}
