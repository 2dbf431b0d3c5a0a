//! The search for the level that meets a tolerance: a computation of its own, as it may take long.

use super::complete::{Checked, Job};
use super::input::Input;
use super::key::{self, Key};
use super::output::Output;
use super::{curves, size};
use crate::analysis::NoLevel;
use crate::analysis::curve::{self, Reached, reach};
use crate::analysis::tolerance::{self, Placed};
use crate::fault::Fault;
use crate::watch::{Stopped, Watch};

/// Why a search has found no level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// No level is known to be close enough: where in the job that was asked for, and why.
    #[error("{0}")]
    Refused(Fault),
}

/// What a search takes at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchCost {
    /// Units of work, as [`Watch::done`] counts them.
    pub work: u64,
    /// Bytes.
    pub bytes: u64,
}

/// A job that is checked but for the level that a tolerance asks for.
#[derive(Debug, Clone)]
pub struct Search {
    checked: Checked,
    tolerance: f64,
}

impl Search {
    /// The search for the level of a tolerance.
    ///
    /// # Errors
    /// A fault below the job, where it can be told at once that there is no such level.
    pub(super) fn new(checked: Checked, tolerance: f64) -> Result<Self, Fault> {
        match &*checked.input {
            Input::Polygons(_) => {}
            Input::Mesh(mesh) => {
                tolerance::check(mesh, &checked.plan, tolerance).map_err(|reason| at_tolerance(&reason))?;
            }
        }
        Ok(Self { checked, tolerance })
    }

    /// Bytes that its input and the steps of the job take in memory.
    pub fn bytes(&self) -> u64 {
        let Checked { input, plan, other, .. } = &self.checked;
        let other = other.as_ref().map_or(0, |other| other.bytes());
        input.bytes().saturating_add(size::of_most_steps(plan)).saturating_add(other)
    }

    /// The outputs of the job.
    pub fn outputs(&self) -> &[Output] {
        &self.checked.outputs
    }

    /// The key of the search, for whoever remembers answers and refusals.
    pub fn key(&self) -> Key {
        let Checked { input, plan, outputs, .. } = &self.checked;
        key::search(input, plan, self.tolerance, &place_names(input, outputs))
    }

    /// The work and memory of the search, at most.
    pub fn cost(&self) -> SearchCost {
        match &*self.checked.input {
            input @ Input::Polygons(_) => {
                SearchCost { work: curve::MAX_WORK, bytes: curve::search_bytes(input.n_points()) }
            }
            Input::Mesh(mesh) => SearchCost { work: tolerance::MAX_WORK, bytes: tolerance::search_bytes(mesh) },
        }
    }

    /// The level that leads all outputs within the tolerance of their limit, and how close that is.
    ///
    /// # Errors
    /// [`SearchError`], also when no level is known to be close enough.
    pub fn run(&self, watch: &Watch) -> Result<Reached, SearchError> {
        let Checked { input, plan, outputs, .. } = &self.checked;
        match &**input {
            Input::Polygons(polygons) => {
                let factor = factor(outputs);
                let reached = reach(polygons, plan, self.tolerance / factor, watch)?;
                Ok(Reached { bound: factor * reached.bound, ..reached })
            }
            Input::Mesh(mesh) => Ok(tolerance::reach(mesh, plan, &placed(outputs), self.tolerance, watch)?),
        }
    }

    /// The job at the level that was found.
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

/// By what the distance of curves from their limit is less than that of outputs: points that move to their limits go as
/// far as the bound at most, so that their polygon is within twice the bound.
fn factor(outputs: &[Output]) -> f64 {
    if outputs.iter().any(curves::moves_points) { 2.0 } else { 1.0 }
}

/// Where the outputs of a mesh have its vertices.
fn placed(outputs: &[Output]) -> Vec<Placed> {
    let moves = |output: &Output| crate::output::surface::limit(&output.options)[0];
    let limit = outputs.iter().any(moves).then_some(Placed::Limit);
    let refined = (limit.is_none() || !outputs.iter().all(moves)).then_some(Placed::Refined);
    refined.into_iter().chain(limit).collect()
}

/// Names of the places where outputs have their points, as far as a search depends on them.
fn place_names(input: &Input, outputs: &[Output]) -> Vec<&'static str> {
    match input {
        Input::Polygons(_) if outputs.iter().any(curves::moves_points) => vec!["limit"],
        Input::Polygons(_) => vec!["refined"],
        Input::Mesh(_) => {
            let name = |placed| match placed {
                Placed::Refined => "refined",
                Placed::Limit => "limit",
            };
            placed(outputs).into_iter().map(name).collect()
        }
    }
}
