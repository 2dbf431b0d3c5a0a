//! The survey of a mesh beside the analysis of its scheme: the distance of levels from the limit, extraordinary
//! vertices, and warnings about the plan's parameters.

use std::collections::BTreeMap;

use super::input::Input;
use super::level_bounds::{LevelBounds, level_bounds};
use super::polygon_survey::CHECKED_LEVELS;
use crate::analysis::surface::{Extraordinary, RegularSmoothness, SurfaceStudy};
use crate::analysis::tolerance::{self, VertexPlacement};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::watch::{Stopped, Watch};

/// Maximum level for which bounds are given. Each level is four times as close as the one before, so that three show
/// the trend. Half as many show less; twice as many take sixty times as long.
const MAX_MESH_LEVEL: u32 = 3;
/// Maximum number of faces of a mesh for which bounds are given; a level of such a mesh takes less than a second. Half
/// as many would refuse common control meshes; twice as many would take twice as long.
const MAX_SURVEYED_FACES: usize = 8192;
/// A mesh with its plan.
#[derive(Debug)]
pub(super) struct Surveyed {
    pub(super) input: Input,
    pub(super) plan: Plan,
}

/// The result of the survey of a mesh.
#[derive(Debug)]
pub struct Survey {
    /// Levels with upper bounds of their distance from the limit in model units, or the reason for which there are
    /// none.
    pub bounds: LevelBounds,
    /// Extraordinary vertices and faces, by valence.
    pub extraordinary: BTreeMap<usize, Extraordinary>,
    /// Boundary vertices, by number of faces.
    pub on_boundary: BTreeMap<usize, Extraordinary>,
    /// Warnings, as sentences.
    pub warnings: Vec<String>,
}

impl Surveyed {
    /// Returns the mesh.
    pub(super) fn mesh(&self) -> Option<&Mesh> {
        self.input.mesh()
    }

    /// Surveys the mesh.
    pub(super) fn survey(
        &self,
        study: &SurfaceStudy,
        smoothness: &RegularSmoothness,
        watch: &Watch,
    ) -> Result<Option<Survey>, Stopped> {
        let Some(mesh) = self.mesh() else { return Ok(None) };
        let mut warnings = mesh.warnings();
        warnings.extend(self.plan.schedule(CHECKED_LEVELS).err().map(|fault| fault.detail));
        if smoothness.disproved_c == Some(0) {
            warnings.push("the scheme does not converge in regular nets; choose tamer parameters".into());
        } else if smoothness.proved_c < 0 {
            warnings.push("the scheme is not known to converge in regular nets".into());
        }
        let (extraordinary, on_boundary) = (study.survey(&mesh.topology), study.on_boundary(&mesh.topology));
        Ok(Some(Survey { bounds: self.bounds(mesh, watch)?, extraordinary, on_boundary, warnings }))
    }

    /// Returns bounds of the distance of levels from the limit; each is within a tolerance that the preceding level
    /// does not meet.
    fn bounds(&self, mesh: &Mesh, watch: &Watch) -> Result<LevelBounds, Stopped> {
        if mesh.topology.n_faces() > MAX_SURVEYED_FACES {
            let n = mesh.topology.n_faces();
            return Ok(Err(format!(
                "the mesh has {n} faces; bounds are told of those with up to {MAX_SURVEYED_FACES}"
            )));
        }
        level_bounds(mesh.positions.iter(), MAX_MESH_LEVEL, |tolerance| {
            let reached = tolerance::reach(mesh, &self.plan, &[VertexPlacement::Refined], tolerance, watch)?;
            Ok((reached.level, reached.bound))
        })
    }
}
