//! How often a plan is applied: so many times, or until the result is close to its limit.

use super::{Input, Output, curves};
use crate::analysis::curve::{self, Reached, reach};
use crate::analysis::tolerance::{self, Placed};
use crate::fault::Fault;
use crate::scheme::plan::{MAX_LEVELS, Plan};
use crate::watch::{Stopped, Watch};

/// How often a plan is to be applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Levels {
    /// So many times.
    Count(u64),
    /// Until the result is known to be within this distance of the limit, model units.
    Tolerance(f64),
}

/// The same, checked as far as that goes without the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Asked {
    Count(u32),
    Tolerance(f64),
}

/// Checks what is asked for of a job that has a plan or not.
///
/// # Errors
/// A fault below the job.
pub(super) fn check(planned: bool, levels: Option<Levels>) -> Result<Asked, Fault> {
    match levels {
        None if planned => {
            let detail = format!(
                "\"levels\" says how often the plan is applied; give a whole number from 0 to {MAX_LEVELS}, or \
                 {{\"tolerance\": t}}"
            );
            Err(Fault::new("/levels", detail))
        }
        None => Ok(Asked::Count(0)),
        Some(Levels::Count(levels)) if levels > 0 && !planned => {
            Err(Fault::new("/plan", format!("{levels} levels of what? give a \"plan\", or ask for 0 levels")))
        }
        Some(Levels::Count(levels)) => {
            let allowed = u32::try_from(levels).ok().filter(|&levels| levels <= MAX_LEVELS);
            allowed.map(Asked::Count).ok_or_else(|| {
                let detail =
                    format!("{levels} levels; at most {MAX_LEVELS} are allowed, and far fewer fit any limit of size");
                Fault::new("/levels", detail)
            })
        }
        Some(Levels::Tolerance(_)) if !planned => {
            Err(Fault::new("/plan", "close to the limit of what? give a \"plan\", or ask for 0 levels"))
        }
        Some(Levels::Tolerance(tolerance)) if tolerance.is_finite() && tolerance > 0.0 => {
            Ok(Asked::Tolerance(tolerance))
        }
        Some(Levels::Tolerance(tolerance)) => {
            let detail = format!("{tolerance} is no distance; give a positive number, in model units");
            Err(Fault::new("/levels/tolerance", detail))
        }
    }
}

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SearchCost {
    /// Units of work, as [`Watch::done`] counts them.
    pub work: u64,
    /// Bytes.
    pub bytes: u64,
}

/// The error of a search that has a reason of its own, or was stopped.
fn refused(stopped: Option<Stopped>, reason: &impl ToString) -> SearchError {
    match stopped {
        Some(stopped) => SearchError::Stopped(stopped),
        None => SearchError::Refused(Fault::new("/levels/tolerance", reason.to_string())),
    }
}

/// By what the distance of curves from their limit is less than that of outputs: points that move to their limits go as far
/// as the bound at most, so that their polygon is within twice the bound.
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
pub(super) fn place_names(input: &Input, outputs: &[Output]) -> Vec<&'static str> {
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

impl Asked {
    /// Whether a search could find a level, as far as that can be told at once.
    ///
    /// # Errors
    /// A fault below the job.
    pub(super) fn check(self, input: &Input, plan: &Plan) -> Result<(), Fault> {
        let Self::Tolerance(tolerance) = self else { return Ok(()) };
        let checked = match input {
            Input::Polygons(_) => Ok(()),
            Input::Mesh(mesh) => tolerance::check(mesh, plan, tolerance),
        };
        checked.map_err(|reason| Fault::new("/levels/tolerance", reason.to_string()))
    }

    /// What the search takes at most.
    pub(super) fn cost(self, input: &Input) -> SearchCost {
        match (self, input) {
            (Self::Count(_), _) => SearchCost::default(),
            (Self::Tolerance(_), Input::Polygons(_)) => {
                SearchCost { work: curve::MAX_WORK, bytes: curve::search_bytes(input.n_points()) }
            }
            (Self::Tolerance(_), Input::Mesh(mesh)) => {
                SearchCost { work: tolerance::MAX_WORK, bytes: tolerance::search_bytes(mesh) }
            }
        }
    }

    /// How close to the limit a level leads all outputs, and that level, where a tolerance was asked for.
    ///
    /// # Errors
    /// [`SearchError`], also when no level is known to be close enough.
    pub(super) fn search(
        self,
        input: &Input,
        plan: &Plan,
        outputs: &[Output],
        watch: &Watch,
    ) -> Result<Option<Reached>, SearchError> {
        let Self::Tolerance(tolerance) = self else { return Ok(None) };
        let reached = match input {
            Input::Polygons(polygons) => {
                let factor = factor(outputs);
                let reached = reach(polygons, plan, tolerance / factor, watch);
                let reached = reached.map_err(|error| refused(error.stopped(), &error))?;
                Reached { bound: factor * reached.bound, ..reached }
            }
            Input::Mesh(mesh) => {
                let reached = tolerance::reach(mesh, plan, &placed(outputs), tolerance, watch);
                reached.map_err(|error| refused(error.stopped(), &error))?
            }
        };
        Ok(Some(reached))
    }
}
