//! Work of computations that later ones may reuse: refined meshes, and programs of refinement. Results do not depend on
//! it.

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

/// Work that a computation can take over from an earlier one.
#[derive(Debug, Clone)]
pub enum Work {
    /// The program by which meshes with some connectivity and tags are refined.
    Program(Arc<Program>),
    /// A refined mesh.
    Refined(Arc<Refined>),
}

/// A refined mesh with its warnings.
#[derive(Debug)]
pub struct Refined {
    /// The mesh.
    pub mesh: RefinedMesh,
    /// Warnings to the client, as sentences.
    pub warnings: Vec<String>,
}

impl Work {
    /// Returns the memory in bytes of the work, rounded up rather than down.
    pub fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Program(program) => program.bytes(),
            Self::Refined(refined) => refined.mesh.bytes() + refined.warnings.iter().map(String::len).sum::<usize>(),
        };
        bytes as u64
    }
}

/// A store of work that may be reused.
pub trait KeepWork: fmt::Debug + Sync {
    /// Returns the work of a key, if it is still kept.
    fn find(&self, key: &Key) -> Option<Work>;

    /// Offers work under a key; the store decides how long to keep it.
    fn keep(&self, key: Key, work: Work);
}

/// A store that keeps nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct KeepNothing;

impl KeepWork for KeepNothing {
    fn find(&self, _key: &Key) -> Option<Work> {
        None
    }

    fn keep(&self, _key: Key, _work: Work) {}
}

/// Returns the mesh of a job as an output shows it, refined now or before.
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

/// Returns the program by which the mesh of a job is refined, prepared now or before.
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
