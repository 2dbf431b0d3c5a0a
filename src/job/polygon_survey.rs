//! The survey of polygons beside the analysis of their scheme: the distance of levels from the limit, and warnings
//! about the plan's parameters.

use super::input::Input;
use super::level_bounds::{LevelBounds, level_bounds};
use crate::analysis::curve;
use crate::scheme::plan::Plan;
use crate::watch::{Stopped, Watch};

/// Maximum level for which bounds are given. Each level is usually four times as close as the one before. Half as many
/// show less; twice as many reach the limits of rounding.
const MAX_POLYGON_LEVEL: u32 = 8;
/// Maximum number of points of polygons for which bounds are given; searches measure up to 16,384 points. Half as many
/// would refuse polygons that can be drawn; twice as many would take twice as long.
pub(super) const MAX_SURVEYED_POINTS: usize = 16_384;
/// Number of levels whose parameters are checked; an alpha of 1e6 is then below 1e-3. Half as many would miss poles of
/// functions at small values; twice as many would find no more.
pub(super) const CHECKED_LEVELS: u32 = 32;

/// Polygons with their plan.
#[derive(Debug, Clone)]
pub(super) struct SurveyedPolygons {
    pub(super) input: Input,
    pub(super) plan: Plan,
}

/// The result of the survey of polygons.
#[derive(Debug, Clone)]
pub struct PolygonSurvey {
    /// Levels with upper bounds of the distance of all polygons from their limits in model units, or the reason for
    /// which there are none.
    pub bounds: LevelBounds,
    /// Warnings, as sentences.
    pub warnings: Vec<String>,
}

impl SurveyedPolygons {
    /// Surveys the polygons.
    pub(super) fn survey(&self, watch: &Watch) -> Result<PolygonSurvey, Stopped> {
        let later = self.plan.schedule(CHECKED_LEVELS).err().map(|fault| fault.detail);
        let mut warnings: Vec<String> = later.into_iter().collect();
        warnings.extend(curve::warnings(&self.plan, 1, watch)?);
        let Input::Polygons(polygons) = &self.input else {
            return Ok(PolygonSurvey { bounds: Ok(Vec::new()), warnings });
        };
        let n = self.input.n_points();
        if n > MAX_SURVEYED_POINTS {
            let refused =
                format!("the polygons have {n} points; bounds are told of those with up to {MAX_SURVEYED_POINTS}");
            return Ok(PolygonSurvey { bounds: Err(refused), warnings });
        }
        let coordinates = polygons.iter().flat_map(|polygon| &polygon.points);
        let bounds = level_bounds(coordinates, MAX_POLYGON_LEVEL, |tolerance| {
            curve::reach(polygons, &self.plan, tolerance, watch).map(|reached| (reached.level, reached.bound))
        })?;
        Ok(PolygonSurvey { bounds, warnings })
    }
}
