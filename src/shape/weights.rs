//! The weights by which the points of a result depend on those of the input.

use crate::math::rows::Rows;

/// The linear dependence of the points of a result on those of the input, with every rounding of the refinement.
///
/// The values are the points of the input, followed by one value per row; a row is a weighted sum of earlier values.
/// The last rows are the results: the points, then two tangents per normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Number of points of the input.
    pub columns: usize,
    /// All rows; value `i` is input point `i` below `columns`, value `columns + r` is that of row `r`.
    pub rows: Rows,
    /// Number of points of the result, in the documented order.
    pub vertices: usize,
    /// What the tangents of a mesh belong to, if it has any.
    pub normals: Option<NormalWeights>,
    /// Whether the last coordinate of a point is a weight by which the others are divided at the end.
    pub rational: bool,
}

/// What the rows of tangents belong to: the first pairs to the vertices in order, further pairs to further sectors of
/// vertices between sharp edges.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NormalWeights {
    /// The vertex of each further pair.
    pub sectors: Vec<u32>,
    /// How two tangents yield a normal.
    pub product: NormalProduct,
}

/// How two tangents yield a normal: the same vector up to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalProduct {
    /// The direction of the cross product of their directions.
    OfDirections,
    /// The direction of their cross product.
    OfTangents,
}
