//! The search for the level that meets a tolerance, a separate computation since it may take long.

use super::complete::{CheckedJob, Job};
use super::input::Input;
use super::key::{self, Key};
use super::output::Output;
use super::{curves, size};
use crate::analysis::NoLevel;
use crate::analysis::curve::{self, Reached, reach};
use crate::analysis::tolerance::{self, VertexPlacement};
use crate::fault::Fault;
use crate::watch::{Stopped, Watch};

/// The reason for which a search found no level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// The watch asked the search to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// No level is known to be close enough; the fault names the place in the job and the reason.
    #[error("{0}")]
    Refused(Fault),
}

/// Upper bounds of the cost of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchCost {
    /// Work, in the units of [`Watch::done`].
    pub work: u64,
    /// Memory in bytes.
    pub bytes: u64,
}

/// A job that is checked except for the level, which a tolerance determines.
#[derive(Debug, Clone)]
pub struct Search {
    checked: CheckedJob,
    tolerance: f64,
}

impl Search {
    /// Creates the search for the level of a tolerance.
    ///
    /// # Errors
    /// A fault below the job, if it is known at once that there is no such level.
    pub(super) fn new(checked: CheckedJob, tolerance: f64) -> Result<Self, Fault> {
        match &*checked.input {
            Input::Polygons(_) => {}
            Input::Mesh(mesh) => {
                tolerance::check(mesh, &checked.plan, tolerance).map_err(|reason| at_tolerance(&reason))?;
            }
        }
        Ok(Self { checked, tolerance })
    }

    /// Returns the memory in bytes of the input and the steps of the job.
    pub fn bytes(&self) -> u64 {
        let CheckedJob { input, plan, other, .. } = &self.checked;
        let other = other.as_ref().map_or(0, |other| other.bytes());
        input.bytes().saturating_add(size::of_most_steps(plan)).saturating_add(other)
    }

    /// Returns the outputs of the job.
    pub fn outputs(&self) -> &[Output] {
        &self.checked.outputs
    }

    /// Returns the key of the search, under which answers and refusals can be remembered.
    pub fn key(&self) -> Key {
        let CheckedJob { input, plan, outputs, .. } = &self.checked;
        key::search(input, plan, self.tolerance, &place_names(input, outputs))
    }

    /// Returns upper bounds of the work and the memory of the search.
    pub fn cost(&self) -> SearchCost {
        match &*self.checked.input {
            input @ Input::Polygons(_) => {
                SearchCost { work: curve::MAX_CURVE_WORK, bytes: curve::search_bytes(input.n_points()) }
            }
            Input::Mesh(mesh) => SearchCost { work: tolerance::MAX_MESH_WORK, bytes: tolerance::search_bytes(mesh) },
        }
    }

    /// Finds the level at which all outputs are within the tolerance of their limit, and the bound of their distance.
    ///
    /// # Errors
    /// [`SearchError`], also when no level is known to be close enough.
    pub fn run(&self, watch: &Watch) -> Result<Reached, SearchError> {
        let CheckedJob { input, plan, outputs, .. } = &self.checked;
        match &**input {
            Input::Polygons(polygons) => {
                let factor = factor(outputs);
                let reached = reach(polygons, plan, self.tolerance / factor, watch)?;
                Ok(Reached { bound: factor * reached.bound, ..reached })
            }
            Input::Mesh(mesh) => Ok(tolerance::reach(mesh, plan, &placed(outputs), self.tolerance, watch)?),
        }
    }

    /// Completes the job at the level that was found.
    ///
    /// # Errors
    /// Every fault that shows at this level, with pointers into the request.
    pub fn complete(self, reached: Reached) -> Result<Job, Vec<Fault>> {
        Job::new(self.checked, reached.level, Some(reached.into()), Vec::new())
    }
}

fn at_tolerance(reason: &impl ToString) -> Fault {
    Fault::new("/levels/tolerance", reason.to_string())
}

impl From<NoLevel> for SearchError {
    fn from(error: NoLevel) -> Self {
        match error {
            NoLevel::Stopped(stopped) => Self::Stopped(stopped),
            NoLevel::Refused(why) => Self::Refused(at_tolerance(&why)),
        }
    }
}

/// Returns the factor by which curves must be closer to their limit than the tolerance: limit points are at most the
/// bound away from their points, so that their polygon is within twice the bound.
fn factor(outputs: &[Output]) -> f64 {
    if outputs.iter().any(curves::moves_points) { 2.0 } else { 1.0 }
}

/// Returns the places of a mesh's vertices that outputs show.
fn placed(outputs: &[Output]) -> Vec<VertexPlacement> {
    let moves = |output: &Output| crate::output::surface::limit(&output.options)[0];
    let limit = outputs.iter().any(moves).then_some(VertexPlacement::Limit);
    let refined = (limit.is_none() || !outputs.iter().all(moves)).then_some(VertexPlacement::Refined);
    refined.into_iter().chain(limit).collect()
}

/// Returns the names of the places of points that outputs show, as far as a search depends on them.
fn place_names(input: &Input, outputs: &[Output]) -> Vec<&'static str> {
    match input {
        Input::Polygons(_) if outputs.iter().any(curves::moves_points) => vec!["limit"],
        Input::Polygons(_) => vec!["refined"],
        Input::Mesh(_) => {
            let name = |placed| match placed {
                VertexPlacement::Refined => "refined",
                VertexPlacement::Limit => "limit",
            };
            placed(outputs).into_iter().map(name).collect()
        }
    }
}
