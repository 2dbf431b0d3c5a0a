//! Control polygons as clients write them.

use serde::Deserialize;
use utoipa::ToSchema;

use super::result_entries::PassedOver;
use super::{object, schema, whole};
use crate::fault::{Fault, under};
use crate::shape::attributes::Attributes;
use crate::shape::polygon::Polygon;

/// Maximum number of polygons of one job.
pub(crate) const MAX_POLYGONS: usize = 4096;

/// Number of faults after which no more polygons are checked.
const MAX_POLYGON_FAULTS: usize = 20;

/// A control polygon.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PolygonRequest {
    /// Points, all of the same 1 to 4 coordinates.
    #[schema(schema_with = schema::points)]
    pub points: Vec<Vec<f64>>,
    /// Whether the last point is joined to the first.
    #[serde(default)]
    pub closed: bool,
    /// Indices of points that keep their place.
    #[serde(default, deserialize_with = "whole::list")]
    pub corners: Vec<u64>,
    /// Whether points are homogeneous: the last coordinate is a weight, by which the others are divided after refining.
    #[serde(default)]
    pub rational: bool,
    /// Tangents of the points, of any length but 0, for presets that use them (`incenter`); without them each is that
    /// of the circle through the point and its neighbours.
    #[schema(schema_with = schema::tangents)]
    pub tangents: Option<Vec<Vec<f64>>>,
    /// Indices of points whose tangents stay as they are.
    #[serde(default, deserialize_with = "whole::list")]
    pub pinned: Vec<u64>,
    /// Parameters that points carry: each a list of one number a point.
    #[serde(default, deserialize_with = "object::optional")]
    pub parameters: Option<Box<PointParameters>>,
    /// What a `json` result says of curvature, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub discrete_curvature: PassedOver,
    /// Warnings of a `json` result, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub warnings: PassedOver,
}

/// Parameters that points carry; each beats the plan's.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PointParameters {
    /// Parameter spacing, radians.
    pub alpha: Option<Vec<f64>>,
    /// Kernel.
    pub kernel: Option<Vec<f64>>,
    /// Compensation.
    pub compensation: Option<Vec<f64>>,
    /// Push-back factor.
    pub delta: Option<Vec<f64>>,
}

pub(super) fn polygons(requests: Vec<PolygonRequest>) -> Result<Vec<Polygon>, Vec<Fault>> {
    if requests.is_empty() || requests.len() > MAX_POLYGONS {
        let detail = format!("{} polygons; 1 to {MAX_POLYGONS} are allowed", requests.len());
        return Err(vec![Fault::new("", detail)]);
    }
    let mut faults = Vec::new();
    let mut found = Vec::with_capacity(requests.len());
    for (i, request) in requests.into_iter().enumerate() {
        match request.resolve() {
            Ok(polygon) => found.push(polygon),
            Err(wrong) => faults.extend(under(&format!("/{i}"), wrong)),
        }
        if faults.len() >= MAX_POLYGON_FAULTS {
            break;
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

impl PointParameters {
    /// Returns the parameters as points and vertices carry them.
    pub(super) fn attributes(self) -> Attributes {
        let Self { alpha, kernel, compensation, delta } = self;
        Attributes { alpha, kernel, compensation, delta }
    }
}

impl PolygonRequest {
    pub(super) fn resolve(self) -> Result<Polygon, Vec<Fault>> {
        let polygon = Polygon::new(&self.points, self.closed, &self.corners)?;
        let polygon = if self.rational { polygon.rational()? } else { polygon };
        let polygon = polygon.steered(self.tangents.as_deref(), &self.pinned)?;
        match self.parameters {
            None => Ok(polygon),
            Some(parameters) => polygon.carrying(parameters.attributes()),
        }
    }
}
