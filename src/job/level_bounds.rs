//! Bounds of the distance of levels from the limit, for analyses of inputs.

use crate::analysis::NoLevel;
use crate::watch::Stopped;

/// The divisor of a bound that gives the tolerance for the next level. Most schemes divide distances by 4 per level,
/// and bounds exceed the true distances by up to a factor of 10. Half of it would request some levels twice; twice of
/// it would skip levels.
const TOLERANCE_DIVISOR: f64 = 2.0;

/// Levels with their bounds, or the reason for which these are unknown.
pub(super) type LevelBounds = Result<Vec<(u32, f64)>, String>;

/// Returns bounds of the distance of levels from the limit, up to a level; each is within a tolerance that the
/// preceding level does not meet. `reach` finds the first level within a tolerance, and its bound. The first tolerance
/// is four times the greatest of the coordinates, since any net is within its extent of its limit.
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
                    // a tolerance within the bound of a level may sharpen that bound
                    found.pop();
                }
                found.push((level, bound));
                tolerance = bound / TOLERANCE_DIVISOR;
            }
            Err(NoLevel::Stopped(stopped)) => return Err(stopped),
            Err(NoLevel::Refused(reason)) if found.is_empty() => return Ok(Err(reason)),
            Err(NoLevel::Refused(_)) => break,
        }
    }
    Ok(Ok(found))
}
