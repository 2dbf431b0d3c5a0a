//! What is asked of a mesh beside the scheme that refines it: how close levels come to the limit, what is
//! extraordinary, and what is to be known of the plan's parameters.

use std::collections::BTreeMap;

use super::input::Input;
use crate::analysis::NoLevel;
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
/// By what bounds are divided for the tolerance that asks for the next level.
/// Most schemes divide by 4 a level, and bounds are up to 10 times what is true. Half of it asks for some levels twice;
/// twice of it leaves out levels.
const CLOSER: f64 = 2.0;
/// Levels whose parameters are looked at.
/// An alpha of 1e6 is below 1e-3 after as many. Half of it misses poles of functions behind larger ones; twice of it
/// finds no more.
const LEVELS: u32 = 32;

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
    pub bounds: Result<Vec<(u32, f64)>, String>,
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
    fn bounds(&self, mesh: &Mesh, watch: &Watch) -> Result<Result<Vec<(u32, f64)>, String>, Stopped> {
        if mesh.topology.n_faces() > MAX_FACES {
            let n = mesh.topology.n_faces();
            return Ok(Err(format!("the mesh has {n} faces; bounds are told of those with up to {MAX_FACES}")));
        }
        let mut found: Vec<(u32, f64)> = Vec::new();
        // any net is within its extent of its limit
        let mut tolerance = mesh.positions.iter().fold(1e-6, |most: f64, x| most.max(4.0 * x.abs()));
        while found.last().is_none_or(|last| last.0 < MAX_LEVEL && last.1 > 0.0) {
            match tolerance::reach(mesh, &self.plan, &[Placed::Refined], tolerance, watch) {
                Ok(reached) => {
                    if found.last().is_some_and(|last| last.0 == reached.level) {
                        // a tolerance within the bound of a level may sharpen it
                        found.pop();
                    }
                    found.push((reached.level, reached.bound));
                    tolerance = reached.bound / CLOSER;
                }
                Err(NoLevel::Stopped(stopped)) => return Err(stopped),
                Err(NoLevel::Refused(reason)) if found.is_empty() => return Ok(Err(reason)),
                Err(NoLevel::Refused(_)) => break,
            }
        }
        Ok(Ok(found))
    }
}
