//! Levels and how close they come to the limit, as analyses tell them of inputs.

use crate::analysis::NoLevel;
use crate::watch::Stopped;

/// By what bounds are divided for the tolerance that asks for the next level.
/// Most schemes divide by 4 a level, and bounds are up to 10 times what is true. Half of it asks for some levels twice;
/// twice of it leaves out levels.
const CLOSER: f64 = 2.0;

/// Levels with their bounds, or why they are not known.
pub(super) type LevelBounds = Result<Vec<(u32, f64)>, String>;

/// Bounds of the distance of levels from the limit, each within a tolerance that the one before does not meet, up to a
/// level. `reach` finds the first level within a tolerance, and its bound; the first tolerance is four times the
/// greatest of some coordinates, as any net is within its extent of its limit.
pub(super) fn level_bounds<'a>(
    coordinates: impl Iterator<Item = &'a f64>,
    last: u32,
    reach: impl Fn(f64) -> Result<(u32, f64), NoLevel>,
) -> Result<LevelBounds, Stopped> {
    let mut found: Vec<(u32, f64)> = Vec::new();
    let mut tolerance = coordinates.fold(1e-6, |most: f64, x| most.max(4.0 * x.abs()));
    while found.last().is_none_or(|(level, bound)| *level < last && *bound > 0.0) {
        match reach(tolerance) {
            Ok((level, bound)) => {
                if found.last().is_some_and(|last| last.0 == level) {
                    // a tolerance within the bound of a level may sharpen it
                    found.pop();
                }
                found.push((level, bound));
                tolerance = bound / CLOSER;
            }
            Err(NoLevel::Stopped(stopped)) => return Err(stopped),
            Err(NoLevel::Refused(reason)) if found.is_empty() => return Ok(Err(reason)),
            Err(NoLevel::Refused(_)) => break,
        }
    }
    Ok(Ok(found))
}
