//! Requests for the matrices of one step, and their answers in the form of the lecture.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::analysis::matrices::{Matrix, StepMatrices, StepMatrix};
use crate::analysis::smoothness::Powers;
use crate::job::{FoundMatrices, RequestedMatrices};
use crate::math::exact::Exact;
use crate::scheme::operator::Role;

/// Whether the matrices of one step are asked for, and of which polygon.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum MatricesRequest {
    /// `true` asks for the matrices of a polygon of five points, and for three powers.
    Asked(bool),
    /// The polygon whose matrices are asked for, and the number of powers.
    Of(SmallPolygon),
}

/// A polygon, and how many powers of the local matrix are shown.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SmallPolygon {
    /// Points of the polygon; 5 when left out.
    #[schema(minimum = 1, maximum = 16, default = 5)]
    pub points: Option<u32>,
    /// Whether the last point is joined to the first; `true` when left out. Open polygons have the ends of the plan.
    #[schema(default = true)]
    pub closed: Option<bool>,
    /// Powers of the local matrix; 3 when left out.
    #[schema(minimum = 1, maximum = 8, default = 3)]
    pub powers: Option<u32>,
}

impl MatricesRequest {
    pub(super) fn resolve(self) -> Option<RequestedMatrices> {
        let (points, closed, powers) = match self {
            Self::Asked(false) => return None,
            Self::Asked(true) => (None, None, None),
            Self::Of(SmallPolygon { points, closed, powers }) => (points, closed, powers),
        };
        let (points, powers) = (points.unwrap_or(5), powers.unwrap_or(3));
        Some(RequestedMatrices { points, closed: closed.unwrap_or(true), powers })
    }
}

/// The matrices of one step on a small polygon.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct MatricesAnswer {
    /// Points of the polygon.
    pub points: u32,
    /// Whether it is closed.
    pub closed: bool,
    /// The operators of the first level in their order.
    pub steps: Vec<StepMatrixAnswer>,
    /// The product of all: new points are this times the points of the polygon.
    pub product: MatrixAnswer,
    /// The square part of the product, without ends, that one step maps to itself, and its powers; of the static limit
    /// where masks change from level to level.
    pub local: PowersAnswer,
}

/// An operator as a matrix.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct StepMatrixAnswer {
    /// Its letter in words, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operator: Option<char>,
    /// Its name in the catalogue.
    pub name: &'static str,
    /// What it does: `splitting`, `averaging` or `push-back`.
    pub role: &'static str,
    /// Row j has the weights of the points before it for new point j.
    pub matrix: MatrixAnswer,
    /// What a push-back adds: the weights of the points that entered the last splitting.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coarse: Option<MatrixAnswer>,
}

/// A matrix, row by row.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct MatrixAnswer {
    /// Its rows, rounded to f64.
    pub rows: Vec<Vec<f64>>,
    /// Its rows as fractions; absent where they are not known exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<Vec<Vec<String>>>,
}

/// A local matrix and its powers.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PowersAnswer {
    /// Index of the first point, of rows and of columns.
    pub first: i64,
    /// The matrix, its square, and so on.
    pub powers: Vec<MatrixAnswer>,
    /// What the powers come close to: the limit mask in every row; absent where convergence is not proved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<MatrixAnswer>,
}

impl MatricesAnswer {
    pub(super) fn new(found: &FoundMatrices<'_>, known: bool) -> Self {
        let FoundMatrices { points, closed, of_steps: StepMatrices { steps, product }, powers } = found;
        Self {
            points: *points,
            closed: *closed,
            steps: steps.iter().map(StepMatrixAnswer::new).collect(),
            product: MatrixAnswer::new(product, true),
            local: PowersAnswer::new(powers, known),
        }
    }
}

impl StepMatrixAnswer {
    fn new(step: &StepMatrix) -> Self {
        let role = match step.role {
            Role::Upsample => "splitting",
            Role::Average | Role::Smooth => "averaging",
            Role::PushBack => "push-back",
        };
        Self {
            operator: step.letter,
            name: step.name,
            role,
            matrix: MatrixAnswer::new(&step.points, true),
            coarse: step.coarse.as_ref().map(|coarse| MatrixAnswer::new(coarse, true)),
        }
    }
}

impl MatrixAnswer {
    fn new(matrix: &Matrix, known: bool) -> Self {
        let texts = |row: &Vec<Exact>| row.iter().map(ToString::to_string).collect();
        let exact = matrix.exact.as_ref().filter(|_| known).map(|rows| rows.iter().map(texts).collect());
        Self { rows: matrix.rows.clone(), exact }
    }
}

impl PowersAnswer {
    fn new(powers: &Powers, known: bool) -> Self {
        let matrix = |rows: &Vec<Vec<Exact>>| MatrixAnswer::new(&Matrix::exact(rows.clone()), known);
        Self {
            first: powers.first,
            powers: powers.powers.iter().map(matrix).collect(),
            limit: powers.limit.as_ref().map(matrix),
        }
    }
}
