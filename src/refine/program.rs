//! The program of a refinement: everything that depends only on connectivity, tags and plan, so that it can be reused
//! for other positions of the same mesh.

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

/// The sweeps of a mesh, where it is refined patch by patch.
#[derive(Debug)]
pub struct Program {
    points: Option<Sweep>,
    /// The sweep of each attribute with seams, in the order of `Attachments::places`.
    places: Vec<Option<Sweep>>,
}

impl Program {
    /// Prepares the program of a mesh. It does not depend on the positions of the vertices or on their channels.
    pub fn of(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> Self {
        Self { points: Sweep::of(&mesh_net(mesh, plan), plan, steps), places: seam_sweeps(mesh, plan, steps) }
    }

    /// Refines a mesh with its channels, all by the same rows, and its face-corner values by the same scheme. The
    /// program must have been made for the same connectivity, tags, plan and steps.
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
        let refined = match swept(net, points, plan, steps, self.points.as_ref(), watch)? {
            Some((net, numbers)) => {
                let places = refined_places_by(&self.places, mesh, plan, steps, watch)?;
                carrying(mesh, &net, RefinedMesh::documented, numbers, places)
            }
            None => refine_by_rows(mesh, plan, steps, watch)?,
        };
        Ok(if steps.is_empty() { refined.with_tags(mesh.tags()) } else { refined })
    }

    /// Returns the sweep of the vertices, if they are refined patch by patch.
    pub(crate) fn points(&self) -> Option<&Sweep> {
        self.points.as_ref()
    }

    /// Returns whether the vertices or any face-corner values are refined patch by patch.
    pub fn is_swept(&self) -> bool {
        self.points.is_some() || self.places.iter().any(Option::is_some)
    }

    /// Returns the number of bytes that the program occupies, rounded up rather than down.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.places.iter().chain([&self.points]).flatten().map(Sweep::bytes).sum::<usize>()
    }
}

/// Refines a mesh with its channels, all by the same rows, and its face-corner values by the same scheme.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    Program::of(mesh, plan, steps).refine(mesh, plan, steps, watch)
}
