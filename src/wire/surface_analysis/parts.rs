//! Parts of answers about surfaces that inner and boundary vertices share.

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use crate::analysis::surface::{Criterion, PlaneNet, PointWeight, Status};

/// Maximum number of eigenvalues listed for a vertex, the largest first. Those that decide are among the first ten at
/// any valence. Half as many would show less of the rest; twice as many would make answers longer.
pub(super) const MAX_EIGENVALUES: usize = 16;
/// Weights of masks below this size are omitted as rounding errors. It is some thousand roundings of 1. Half or twice
/// of it would decide alike, as weights are products of few fractions.
const NEGLIGIBLE_WEIGHT: f64 = 1e-12;

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
    /// Creates the answer from the points and faces of a net.
    pub(super) fn new((points, faces): &PlaneNet) -> Self {
        Self { points: points.clone(), faces: faces.clone() }
    }
}

impl CriterionAnswer {
    /// Creates the answer from a criterion.
    pub(super) fn new(criterion: &Criterion) -> Self {
        Self { criterion: criterion.statement, status: name(criterion.status) }
    }
}

/// Returns the name of a status.
pub(super) fn name(status: Status) -> &'static str {
    match status {
        Status::Proved => "proved",
        Status::Supported => "supported",
        Status::Disproved => "disproved",
        Status::Open => "open",
    }
}

/// Whether a weight exceeds rounding errors.
pub(super) fn is_there(weight: &PointWeight) -> bool {
    weight.values.iter().any(|x| x.abs() > NEGLIGIBLE_WEIGHT)
}

/// Returns the sector coordinates of a weight, `center` for the centre.
pub(super) fn coordinates(weight: &PointWeight) -> String {
    weight.point.map_or_else(|| "center".to_owned(), |[i, j]| format!("{i},{j}"))
}

/// Returns the weights that exceed rounding errors, by sector coordinates.
pub(super) fn mask(weights: &[PointWeight]) -> BTreeMap<String, Vec<f64>> {
    let there = weights.iter().filter(|weight| is_there(weight));
    there.map(|weight| (coordinates(weight), weight.values.clone())).collect()
}
