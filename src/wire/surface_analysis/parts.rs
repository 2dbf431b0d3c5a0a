//! Parts of answers about surfaces that vertices inside and on the boundary share.

use serde::Serialize;
use utoipa::ToSchema;

use crate::analysis::surface::{Criterion, PlaneNet, Status, Weight};

/// Weights of masks that are smaller are left out: rounding.
/// It is some thousand roundings of 1. Half and twice of it decide alike, as weights are products of few fractions.
const NONE: f64 = 1e-12;

/// Points in the plane and the faces between them.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct NetAnswer {
    /// The points.
    pub points: Vec<[f64; 2]>,
    /// The faces, counter-clockwise, by the indices of their points.
    pub faces: Vec<Vec<usize>>,
}

/// A criterion.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct CriterionAnswer {
    /// What is to hold.
    pub criterion: &'static str,
    /// `proved`, `supported`, `disproved` or `open`.
    pub status: &'static str,
}

impl NetAnswer {
    /// Points and faces of a net.
    pub(super) fn new((points, faces): &PlaneNet) -> Self {
        Self { points: points.clone(), faces: faces.clone() }
    }
}

impl CriterionAnswer {
    /// What is known of a statement.
    pub(super) fn new(criterion: &Criterion) -> Self {
        Self { criterion: criterion.statement, status: name(criterion.status) }
    }
}

/// The name of what is known.
pub(super) fn name(status: Status) -> &'static str {
    match status {
        Status::Proved => "proved",
        Status::Supported => "supported",
        Status::Disproved => "disproved",
        Status::Open => "open",
    }
}

/// Whether a weight is more than rounding.
pub(super) fn is_there(weight: &Weight) -> bool {
    weight.values.iter().any(|x| x.abs() > NONE)
}

/// The sector coordinates of a weight, `center` for the middle.
pub(super) fn coordinates(weight: &Weight) -> String {
    weight.point.map_or_else(|| "center".to_owned(), |[i, j]| format!("{i},{j}"))
}
