//! The number of levels of a job: a count, or a tolerance for the distance from the limit.

use crate::analysis::curve::Reached;
use crate::fault::Fault;
use crate::scheme::plan::MAX_PLAN_LEVELS;

/// The number of levels that a client requests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Levels {
    /// A fixed number.
    Count(u64),
    /// As many as are needed to be within this distance of the limit, in model units.
    Tolerance(f64),
    /// As many as make faces about a pixel wide in the requested pictures.
    Auto,
}

/// A level that was found for a job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResolvedLevel {
    /// The level.
    pub level: u32,
    /// Upper bound of the distance of the result from the limit in model units, if a tolerance was requested.
    pub bound: Option<f64>,
}

impl From<Reached> for ResolvedLevel {
    fn from(Reached { level, bound }: Reached) -> Self {
        Self { level, bound: Some(bound) }
    }
}

/// Requested levels, checked as far as possible without the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CheckedLevels {
    Count(u32),
    Tolerance(f64),
    Auto,
}

/// Checks the requested levels of a job; `planned` tells whether it has a plan.
///
/// # Errors
/// A fault below the job.
pub(super) fn check(planned: bool, levels: Option<Levels>) -> Result<CheckedLevels, Fault> {
    match levels {
        None if planned => {
            let detail = format!(
                "\"levels\" says how often the plan is applied; give a whole number from 0 to {MAX_PLAN_LEVELS}, or \
                 {{\"tolerance\": t}}, or \"auto\" for pictures"
            );
            Err(Fault::new("/levels", detail))
        }
        None => Ok(CheckedLevels::Count(0)),
        Some(Levels::Count(levels)) if levels > 0 && !planned => {
            Err(Fault::new("/plan", format!("{levels} levels of what? give a \"plan\", or ask for 0 levels")))
        }
        Some(Levels::Count(levels)) => {
            let allowed = u32::try_from(levels).ok().filter(|&levels| levels <= MAX_PLAN_LEVELS);
            allowed.map(CheckedLevels::Count).ok_or_else(|| {
                let detail = format!(
                    "{levels} levels; at most {MAX_PLAN_LEVELS} are allowed, and far fewer fit any limit of size"
                );
                Fault::new("/levels", detail)
            })
        }
        Some(Levels::Auto) if !planned => {
            Err(Fault::new("/plan", "finer than what? give a \"plan\", or ask for 0 levels"))
        }
        Some(Levels::Auto) => Ok(CheckedLevels::Auto),
        Some(Levels::Tolerance(_)) if !planned => {
            Err(Fault::new("/plan", "close to the limit of what? give a \"plan\", or ask for 0 levels"))
        }
        Some(Levels::Tolerance(tolerance)) if tolerance.is_finite() && tolerance > 0.0 => {
            Ok(CheckedLevels::Tolerance(tolerance))
        }
        Some(Levels::Tolerance(tolerance)) => {
            let detail = format!("{tolerance} is no distance; give a positive number, in model units");
            Err(Fault::new("/levels/tolerance", detail))
        }
    }
}
