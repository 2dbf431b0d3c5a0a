//! The answer about boundary vertices of a surface scheme.

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use super::parts::{CriterionAnswer, MAX_EIGENVALUES, NetAnswer, mask, name};
use crate::analysis::surface::{BoundaryReport, Sided, Status, evidence, verdict};

/// What is known of boundary vertices with a number of faces.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct BoundaryAnswer {
    /// The number of faces at the vertex.
    pub faces: usize,
    /// Whether all that is said here holds as well on each side with so many faces of an edge line that stays sharp for
    /// ever; `false` where the scheme has no creases, or other rules for them.
    pub crease: bool,
    /// The largest eigenvalues of the local subdivision matrix.
    pub eigenvalues: Vec<SidedEigenvalueAnswer>,
    /// The weights of the limit position: of `center`, and by sector coordinates `i,j`, i steps along one ray and j
    /// along the next, a number for each sector counter-clockwise; of points `i,0` a number for each ray, which are one
    /// more.
    pub limit_mask: BTreeMap<String, Vec<f64>>,
    /// The weights of the tangent along the boundary, and of one across it, in the same way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent_masks: Option<[BTreeMap<String, Vec<f64>>; 2]>,
    /// The least sine of the corner angles of the characteristic net, but for those of faces at its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characteristic_map_min_sine: Option<f64>,
    /// The characteristic net, whose limit is the characteristic map of half a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characteristic_net: Option<NetAnswer>,
    /// Whether limits are C1 there, for almost all nets: `disproved` or `open`, as nothing is proved of boundaries.
    pub c1: &'static str,
    /// What speaks for it: `supported` where every criterion is met as far as numbers and samples show, `disproved` or
    /// `open`.
    pub evidence: &'static str,
    /// What decides about it, each with what is known of it.
    pub criteria: Vec<CriterionAnswer>,
    /// Why nothing is known, where the scheme has no such vertices, or cannot be analysed there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// An eigenvalue at a boundary vertex.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct SidedEigenvalueAnswer {
    /// Its real part.
    pub value: f64,
    /// Its imaginary part, where that is not 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imaginary: Option<f64>,
    /// Whether its eigenvector changes its sign under the reflection that exchanges the two ends of the boundary.
    pub odd: bool,
}

impl BoundaryAnswer {
    /// Creates the answer from a report.
    pub(super) fn new(report: &BoundaryReport) -> Self {
        let eigenvalue = |found: &Sided| SidedEigenvalueAnswer {
            value: found.value.re,
            imaginary: Some(found.value.im).filter(|x| *x != 0.0),
            odd: found.is_odd,
        };
        Self {
            faces: report.faces,
            crease: report.is_side_of_crease,
            eigenvalues: report.eigenvalues.iter().take(MAX_EIGENVALUES).map(eigenvalue).collect(),
            limit_mask: mask(&report.limit_mask),
            tangent_masks: report.tangent_masks.as_ref().map(|both| both.each_ref().map(|of| mask(of))),
            characteristic_map_min_sine: report.least_sine,
            characteristic_net: report.net.as_ref().map(NetAnswer::new),
            c1: name(verdict(&report.criteria)),
            evidence: name(evidence(&report.criteria)),
            criteria: report.criteria.iter().map(CriterionAnswer::new).collect(),
            refused: None,
        }
    }

    /// Creates the answer for boundary vertices without a report.
    pub(super) fn refused(faces: usize, reason: &str) -> Self {
        let [c1, evidence] = [name(Status::Open); 2];
        Self { faces, c1, evidence, refused: Some(reason.to_owned()), ..Self::default() }
    }
}
