//! The program of a refinement: what depends on connectivity, tags and plan, and serves all positions of a mesh alike.

use super::error::RefineError;
use super::mesh::{carrying, numbers, refine_by_rows};
use super::refined::RefinedMesh;
use super::seams::{refined_places_by, seam_sweeps};
use super::start::mesh_net;
use super::sweep::Sweep;
use super::swept::swept;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// How a mesh is refined patch by patch, where it is.
#[derive(Debug)]
pub struct Program {
    points: Option<Sweep>,
    /// The same of each thing with seams.
    places: Vec<Option<Sweep>>,
}

impl Program {
    /// The program of a mesh, whatever the positions of its vertices and the numbers that they carry.
    pub fn of(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> Self {
        Self { points: Sweep::of(&mesh_net(mesh, plan), plan, steps), places: seam_sweeps(mesh, plan, steps) }
    }

    /// Refines a mesh with its channels, all by the same rows, and the values of its corners by the same scheme. The
    /// program has to be that of a mesh with the same connectivity and tags, of this plan and these steps.
    ///
    /// # Errors
    /// [`RefineError`].
    pub fn refine(
        &self,
        mesh: &Mesh,
        plan: &Plan,
        steps: &[Scheduled],
        watch: &Watch,
    ) -> Result<RefinedMesh, RefineError> {
        let (net, points) = (mesh_net(mesh, plan), numbers(mesh));
        let refined = match swept(&net, &points, plan, steps, self.points.as_ref(), watch)? {
            Some((net, numbers)) => {
                let places = refined_places_by(&self.places, mesh, plan, steps, watch)?;
                carrying(mesh, &net, RefinedMesh::documented, numbers, places)
            }
            None => refine_by_rows(mesh, plan, steps, watch)?,
        };
        Ok(if steps.is_empty() { refined.with_tags(mesh.tags()) } else { refined })
    }

    /// How the points are refined patch by patch, where they are.
    pub(crate) fn points(&self) -> Option<&Sweep> {
        self.points.as_ref()
    }

    /// Whether anything is refined patch by patch.
    pub fn is_swept(&self) -> bool {
        self.points.is_some() || self.places.iter().any(Option::is_some)
    }

    /// Bytes that it holds, a little more rather than less.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.places.iter().chain([&self.points]).flatten().map(Sweep::bytes).sum::<usize>()
    }
}

/// Refines a mesh with its channels, all by the same rows, and the values of its corners by the same scheme.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    Program::of(mesh, plan, steps).refine(mesh, plan, steps, watch)
}
