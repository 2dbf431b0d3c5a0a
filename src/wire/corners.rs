//! Values of face corners as clients write them.

use serde::Deserialize;
use utoipa::ToSchema;

use super::choice::choice;
use super::{fixed, schema, whole};
use crate::shape::check::FaceList;
use crate::shape::seams::{Interpolation, SeamsInput, UvsInput};

/// Texture coordinates of face corners, refined by the scheme of the mesh.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct UvsRequest {
    /// Values, `n x 2`; the second coordinate points up.
    #[serde(deserialize_with = "fixed::list")]
    #[schema(schema_with = schema::uv_values)]
    pub values: Vec<[f64; 2]>,
    /// For each face of the mesh the values at its corners, in their order. Neighbours are joined where both have the
    /// same values at both ends of their edge; all other edges are seams.
    #[serde(deserialize_with = "whole::lists")]
    #[schema(schema_with = schema::corner_values)]
    pub faces: Vec<Vec<u64>>,
    /// Where values are interpolated linearly; `all` when left out.
    pub interpolation: Option<InterpolationRequest>,
}

choice! {
    /// Where values of corners are interpolated linearly.
    pub enum InterpolationRequest means Interpolation {
        /// Nowhere: boundaries and seams are smooth curves.
        None = "none",
        /// Corners, where a region has one face, keep their values.
        CornersOnly = "corners-only",
        /// Corners where a region has one face, and places where three regions or more meet, keep their values.
        CornersPlus1 = "corners-plus1",
        /// Corners where a region has one face, places where three regions or more meet, places where a seam ends
        /// inside, and both sides of a corner where two regions meet keep their values.
        CornersPlus2 = "corners-plus2",
        /// All boundaries and seams are interpolated linearly.
        Boundaries = "boundaries",
        /// Values are interpolated linearly everywhere.
        All = "all",
    }
}

impl UvsRequest {
    pub(super) fn resolve(self) -> UvsInput {
        let interpolation = self.interpolation.map_or(Interpolation::All, Into::into);
        UvsInput { values: self.values, seams: SeamsInput { faces: face_list(&self.faces), interpolation } }
    }
}

/// Converts faces to 32-bit indices; larger indices become `u32::MAX`, which is out of range in every mesh and every
/// list of values.
pub(super) fn face_list(faces: &[Vec<u64>]) -> FaceList {
    faces.iter().map(|face| face.iter().map(|&v| u32::try_from(v).unwrap_or(u32::MAX))).collect()
}
