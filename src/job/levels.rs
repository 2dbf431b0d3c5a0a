//! How often a plan is applied: so many times, or until the result is close to its limit.

use super::{Input, Output, curves};
use crate::fault::Fault;
use crate::refine::curve::{Reached, reach};
use crate::refine::surface::{self, Placed};
use crate::scheme::plan::{MAX_LEVELS, Plan};
use crate::shape::polygon::Polygon;

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

/// The level for curves. Points that move to their limits go as far as the bound at most, so that their polygon is within
/// twice the bound.
fn curves_within(polygons: &[Polygon], plan: &Plan, outputs: &[Output], tolerance: f64) -> Result<Reached, String> {
    let factor = if outputs.iter().any(curves::moves_points) { 2.0 } else { 1.0 };
    let reached = reach(polygons, plan, tolerance / factor).map_err(|error| error.to_string())?;
    Ok(Reached { bound: factor * reached.bound, ..reached })
}

/// Where the outputs of a mesh have its vertices.
fn placed(outputs: &[Output]) -> Vec<Placed> {
    let moves = |output: &Output| crate::output::surface::limit(&output.options)[0];
    let limit = outputs.iter().any(moves).then_some(Placed::Limit);
    let refined = (limit.is_none() || !outputs.iter().all(moves)).then_some(Placed::Refined);
    refined.into_iter().chain(limit).collect()
}

impl Asked {
    /// The number of levels, and how close to the limit they lead all outputs where that was asked for.
    ///
    /// # Errors
    /// A fault below the job, when no level is known to be close enough.
    pub(super) fn resolve(
        self,
        input: &Input,
        plan: &Plan,
        outputs: &[Output],
    ) -> Result<(u32, Option<Reached>), Fault> {
        let tolerance = match self {
            Self::Count(levels) => return Ok((levels, None)),
            Self::Tolerance(tolerance) => tolerance,
        };
        let reached = match input {
            Input::Polygons(polygons) => curves_within(polygons, plan, outputs, tolerance),
            Input::Mesh(mesh) => surface::reach(mesh, plan, &placed(outputs), tolerance).map_err(|e| e.to_string()),
        };
        let reached = reached.map_err(|detail| Fault::new("/levels/tolerance", detail))?;
        Ok((reached.level, Some(reached)))
    }
}
