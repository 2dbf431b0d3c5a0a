//! How often a plan is applied: so many times, or until the result is close to its limit.

use crate::analysis::curve::Reached;
use crate::fault::Fault;
use crate::scheme::plan::MAX_LEVELS;

/// How often a plan is to be applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Levels {
    /// So many times.
    Count(u64),
    /// Until the result is known to be within this distance of the limit, model units.
    Tolerance(f64),
    /// Until faces are about a pixel in the pictures that are asked for.
    Auto,
}

/// A level that a job left to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolved {
    /// The level.
    pub level: u32,
    /// The result is at most this far from the limit, model units, where a tolerance was asked for.
    pub bound: Option<f64>,
}

impl From<Reached> for Resolved {
    fn from(Reached { level, bound }: Reached) -> Self {
        Self { level, bound: Some(bound) }
    }
}

/// Levels that are checked as far as that goes without the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CheckedLevels {
    Count(u32),
    Tolerance(f64),
    Auto,
}

/// Checks the levels of a job that has a plan or not.
///
/// # Errors
/// A fault below the job.
pub(super) fn check(planned: bool, levels: Option<Levels>) -> Result<CheckedLevels, Fault> {
    match levels {
        None if planned => {
            let detail = format!(
                "\"levels\" says how often the plan is applied; give a whole number from 0 to {MAX_LEVELS}, or \
                 {{\"tolerance\": t}}, or \"auto\" for pictures"
            );
            Err(Fault::new("/levels", detail))
        }
        None => Ok(CheckedLevels::Count(0)),
        Some(Levels::Count(levels)) if levels > 0 && !planned => {
            Err(Fault::new("/plan", format!("{levels} levels of what? give a \"plan\", or ask for 0 levels")))
        }
        Some(Levels::Count(levels)) => {
            let allowed = u32::try_from(levels).ok().filter(|&levels| levels <= MAX_LEVELS);
            allowed.map(CheckedLevels::Count).ok_or_else(|| {
                let detail =
                    format!("{levels} levels; at most {MAX_LEVELS} are allowed, and far fewer fit any limit of size");
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
