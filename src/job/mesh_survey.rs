//! What is asked of a mesh beside the scheme that refines it: how close levels come to the limit, what is
//! extraordinary, and what is to be known of the plan's parameters.

use std::collections::BTreeMap;

use super::input::Input;
use super::level_bounds::{LevelBounds, level_bounds};
use super::polygon_survey::LEVELS;
use crate::analysis::surface::{Extraordinary, RegularSmoothness, SurfaceStudy};
use crate::analysis::tolerance::{self, Placed};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::watch::{Stopped, Watch};

/// Most levels of which bounds are told.
/// Each comes four times as close as the one before, so that three tell how it goes on. Half of it tells less; twice of
/// it takes sixty times as long.
const MAX_LEVEL: u32 = 3;
/// Most faces of a mesh of which bounds are told.
/// A level of them is looked at within a second. Half of it refuses common control meshes; twice of it takes twice as
/// long.
const MAX_FACES: usize = 8192;
/// A mesh, and its plan as it is.
#[derive(Debug)]
pub(super) struct Surveyed {
    pub(super) input: Input,
    pub(super) plan: Plan,
}

/// What is found of a mesh.
#[derive(Debug)]
pub struct Survey {
    /// Levels, and how far they are from the limit at most, model units; or why that is not known.
    pub bounds: LevelBounds,
    /// Extraordinary vertices and faces, by valence.
    pub extraordinary: BTreeMap<usize, Extraordinary>,
    /// Boundary vertices, by their number of faces.
    pub on_boundary: BTreeMap<usize, Extraordinary>,
    /// What is to be known, in sentences.
    pub warnings: Vec<String>,
}

impl Surveyed {
    /// Returns the mesh.
    pub(super) fn mesh(&self) -> Option<&Mesh> {
        self.input.mesh()
    }

    /// What is found of the mesh.
    pub(super) fn survey(
        &self,
        study: &SurfaceStudy,
        smoothness: &RegularSmoothness,
        watch: &Watch,
    ) -> Result<Option<Survey>, Stopped> {
        let Some(mesh) = self.mesh() else { return Ok(None) };
        let mut warnings = mesh.warnings();
        warnings.extend(self.plan.schedule(LEVELS).err().map(|fault| fault.detail));
        if smoothness.disproved_c == Some(0) {
            warnings.push("the scheme does not converge in regular nets; choose tamer parameters".into());
        } else if smoothness.proved_c < 0 {
            warnings.push("the scheme is not known to converge in regular nets".into());
        }
        let (extraordinary, on_boundary) = (study.survey(&mesh.topology), study.on_boundary(&mesh.topology));
        Ok(Some(Survey { bounds: self.bounds(mesh, watch)?, extraordinary, on_boundary, warnings }))
    }

    /// Bounds of the distance of levels from the limit, each within a tolerance that the one before does not meet.
    fn bounds(&self, mesh: &Mesh, watch: &Watch) -> Result<LevelBounds, Stopped> {
        if mesh.topology.n_faces() > MAX_FACES {
            let n = mesh.topology.n_faces();
            return Ok(Err(format!("the mesh has {n} faces; bounds are told of those with up to {MAX_FACES}")));
        }
        level_bounds(mesh.positions.iter(), MAX_LEVEL, |tolerance| {
            let reached = tolerance::reach(mesh, &self.plan, &[Placed::Refined], tolerance, watch)?;
            Ok((reached.level, reached.bound))
        })
    }
}
