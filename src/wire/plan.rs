//! The plan as clients write it.

use serde::{Deserialize, Deserializer};
use utoipa::ToSchema;

use super::choice::choice;
use super::literal::WireFields;
use super::{schema, whole};
use crate::scheme::extent::Ends;
use crate::scheme::plan::PlanInput;
use crate::scheme::tags::Boundary;

/// Reads an optional field that must be a text if present; null is refused.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    String::deserialize(deserializer).map(Some)
}

/// How the input is refined: a preset or a word.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanRequest {
    /// Name of a preset, see `/v1/presets`.
    #[serde(default, deserialize_with = "given")]
    pub preset: Option<String>,
    /// A word over operators, see `/v1/operators`.
    #[serde(default, deserialize_with = "given")]
    pub word: Option<String>,
    /// Parameters of the preset, or of the word: numbers, constant expressions, expressions.
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: WireFields,
    /// Boundary rule of meshes; `edge-and-corner` when left out.
    pub boundary: Option<BoundaryRequest>,
    /// End rule of open polygons; `clamped` when left out.
    pub ends: Option<EndsRequest>,
    /// Seed of random perturbation; without effect on plans that have none.
    #[schema(schema_with = schema::seed)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub seed: Option<u64>,
}

choice! {
    /// Boundary rule of meshes.
    pub enum BoundaryRequest means Boundary {
        /// Boundary curves by the curve rule; vertices with one face keep their place.
        EdgeAndCorner = "edge-and-corner",
        /// Boundary curves by the curve rule.
        EdgeOnly = "edge-only",
        /// As `edge-only`, and faces that touch the boundary are not shown.
        None = "none",
    }
}

choice! {
    /// End rule of open polygons.
    pub enum EndsRequest means Ends {
        /// The curve starts and ends at the end points.
        Clamped = "clamped",
        /// Only points whose whole stencil exists.
        Natural = "natural",
    }
}

impl PlanRequest {
    /// Converts the plan, which is then resolved for its input.
    pub fn resolve(self) -> PlanInput {
        PlanInput {
            preset: self.preset,
            word: self.word,
            parameters: self.parameters.0,
            boundary: self.boundary.map(Into::into).unwrap_or_default(),
            ends: self.ends.map(Into::into).unwrap_or_default(),
            seed: self.seed.unwrap_or(0),
        }
    }
}
