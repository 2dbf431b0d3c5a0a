//! What is asked of polygons beside the scheme that refines them: how close levels come to the limit, and what is to be
//! known of the plan's parameters.

use super::input::Input;
use super::level_bounds::{LevelBounds, level_bounds};
use crate::analysis::curve;
use crate::scheme::plan::Plan;
use crate::watch::{Stopped, Watch};

/// Most levels of which bounds are told.
/// Each comes four times as close as the one before as a rule. Half of it tells less; twice of it ends where rounding
/// begins.
const MAX_LEVEL: u32 = 8;
/// Most points of polygons of which bounds are told.
/// Searches measure up to 16,384 points. Half of it refuses polygons that others draw; twice of it takes twice as long.
pub(super) const MAX_POINTS: usize = 16_384;
/// Levels whose parameters are looked at.
/// An alpha of 1e6 is below 1e-3 after as many. Half of it misses poles of functions behind larger ones; twice of it
/// finds no more.
pub(super) const LEVELS: u32 = 32;

/// Polygons, and their plan as it is.
#[derive(Debug, Clone)]
pub(super) struct SurveyedPolygons {
    pub(super) input: Input,
    pub(super) plan: Plan,
}

/// What is found of polygons.
#[derive(Debug, Clone)]
pub struct PolygonSurvey {
    /// Levels, and how far all polygons are from their limits at most, model units; or why that is not known.
    pub bounds: LevelBounds,
    /// What is to be known, in sentences.
    pub warnings: Vec<String>,
}

impl SurveyedPolygons {
    /// What is found of the polygons.
    pub(super) fn survey(&self, watch: &Watch) -> Result<PolygonSurvey, Stopped> {
        let later = self.plan.schedule(LEVELS).err().map(|fault| fault.detail);
        let mut warnings: Vec<String> = later.into_iter().collect();
        warnings.extend(curve::warnings(&self.plan, 1, watch)?);
        let Input::Polygons(polygons) = &self.input else {
            return Ok(PolygonSurvey { bounds: Ok(Vec::new()), warnings });
        };
        let n = self.input.n_points();
        if n > MAX_POINTS {
            let refused = format!("the polygons have {n} points; bounds are told of those with up to {MAX_POINTS}");
            return Ok(PolygonSurvey { bounds: Err(refused), warnings });
        }
        let coordinates = polygons.iter().flat_map(|polygon| &polygon.points);
        let bounds = level_bounds(coordinates, MAX_LEVEL, |tolerance| {
            curve::reach(polygons, &self.plan, tolerance, watch).map(|reached| (reached.level, reached.bound))
        })?;
        Ok(PolygonSurvey { bounds, warnings })
    }
}
