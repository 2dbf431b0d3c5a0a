//! The weights that make the points of a result of those of the input.

use crate::math::rows::Rows;

/// How the points of a result are made of those of the input, with every rounding of the refinement.
///
/// The values are the points of the input, then those of the rows, one after another. A row weighs values before it.
/// The last rows are the results: the points, and after them two tangents for each normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Points of the input.
    pub columns: usize,
    /// All rows; the index of a point of the input is its number, that of row `r` is `columns + r`.
    pub rows: Rows,
    /// Points of the result, in the documented order.
    pub vertices: usize,
    /// What the tangents of a mesh are for, if there are any.
    pub normals: Option<NormalWeights>,
    /// Whether points have a last coordinate by which the others are divided at the end.
    pub rational: bool,
}

/// What the rows of tangents are for: the first pairs for the vertices in their order, further ones for further sectors
/// of vertices between sharp edges.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NormalWeights {
    /// For each further pair its vertex.
    pub sectors: Vec<u32>,
    /// How two tangents give a normal.
    pub product: NormalProduct,
}

/// How two tangents give a normal: the same vector with other roundings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalProduct {
    /// The direction of the vector product of their directions.
    OfDirections,
    /// The direction of their vector product.
    OfTangents,
}
