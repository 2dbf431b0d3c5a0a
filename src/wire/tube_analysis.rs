//! Requests for the analysis of a straight tube under a plan with latitude lines, and their answers.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::analysis::SchemeAnswer;
use crate::job::{TubeFindings, TubeInput};

/// A tube whose rings are one regular polygon, moved along its axis, and tagged as latitude lines.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TubeRequest {
    /// Vertices of a ring.
    #[schema(minimum = 3, maximum = 1_000_000)]
    pub vertices: u64,
    /// How often a ring goes round: 1 when left out, more for stars.
    #[schema(minimum = 1, default = 1)]
    pub turns: Option<u64>,
    /// The radius of the control rings, model units; asks for the limit radius.
    pub control_radius: Option<f64>,
    /// The radius of the pipe that is wanted, model units; asks for the control radius, or, with one, for the delta
    /// from 0 to 1 that leads there.
    pub limit_radius: Option<f64>,
}

/// What becomes of a tube.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct TubeAnswer {
    /// `tube`.
    pub kind: &'static str,
    /// Vertices of a ring.
    pub vertices: u64,
    /// The angle between neighbours on a ring, radians.
    pub alpha: f64,
    /// The push-back factor; that of the plan, or the one that leads from the control radius to the wanted one.
    pub delta: f64,
    /// The limit radius over the control radius: the product over levels h of `g + delta (1 - g)`, with `g = cos(t/2)
    /// cos(t/4)^(2 k - 2)`, `t = alpha / 2^h` and k averages after each U; 1 for delta 1, and `sin(alpha)/alpha
    /// (2 sin(alpha/2)/alpha)^(2 k - 2)` for delta 0.
    pub factor: f64,
    /// The radius of the control rings, where one of the radii was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_radius: Option<f64>,
    /// The radius of the limit circles, where one of the radii was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_radius: Option<f64>,
    /// The curve scheme along latitude lines, at alpha 0.
    pub along: SchemeAnswer,
    /// The curve scheme across latitude lines, at alpha 0.
    pub across: SchemeAnswer,
}

impl TubeRequest {
    /// Returns the input of the analysis.
    pub(super) fn resolve(self) -> TubeInput {
        let Self { vertices, turns, control_radius, limit_radius } = self;
        TubeInput { vertices, turns: turns.unwrap_or(1), control_radius, limit_radius }
    }
}

impl TubeAnswer {
    /// Creates the answer of an analysis.
    pub(super) fn new(found: &TubeFindings) -> Self {
        let TubeInput { vertices, control_radius, limit_radius, .. } = found.asked;
        let both = limit_radius.zip(control_radius);
        let factor = both.map_or(found.factor, |(limit, control)| limit / control);
        Self {
            kind: "tube",
            vertices,
            alpha: found.theta,
            delta: found.wanted_delta.unwrap_or(found.delta),
            factor,
            control_radius: control_radius.or(limit_radius.map(|radius| radius / factor)),
            limit_radius: limit_radius.or(control_radius.map(|radius| radius * factor)),
            along: SchemeAnswer::of_report(&found.along),
            across: SchemeAnswer::of_report(&found.across),
        }
    }
}
