//! Bounds of the distances between the levels of an input and its limit.

use serde::Serialize;
use utoipa::ToSchema;

use crate::job::PolygonSurvey;

/// How close a level comes.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct LevelBoundAnswer {
    /// The level.
    pub level: u32,
    /// The distance, model units.
    pub bound: f64,
}

/// What is known of polygons under the plan.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PolygonSurveyAnswer {
    /// Levels and how far they are from the limit curves at most, as a tolerance of a job measures it; each level that
    /// is told comes at least twice as close as the one before.
    pub bounds: Vec<LevelBoundAnswer>,
    /// Why nothing is told of levels, where that is so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds_refused: Option<String>,
    /// What is to be known of the plan, and of parameters at levels to come.
    pub warnings: Vec<String>,
}

impl LevelBoundAnswer {
    /// Converts the bounds of all levels; none if they are not known.
    pub(in crate::wire) fn all(bounds: &Result<Vec<(u32, f64)>, String>) -> Vec<Self> {
        bounds.iter().flatten().map(|&(level, bound)| Self { level, bound }).collect()
    }
}

impl PolygonSurveyAnswer {
    /// Creates the answer from a survey.
    pub(super) fn new(survey: &PolygonSurvey) -> Self {
        let PolygonSurvey { bounds, warnings } = survey;
        let bounds_refused = bounds.as_ref().err().cloned();
        Self { bounds: LevelBoundAnswer::all(bounds), bounds_refused, warnings: warnings.clone() }
    }
}
