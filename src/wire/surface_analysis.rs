//! The answer of an analysis of a surface scheme, with every number named.

mod boundary;
mod parts;

pub use boundary::{BoundaryAnswer, SidedEigenvalueAnswer};
pub use parts::{CriterionAnswer, NetAnswer};

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use super::analysis::{CertificateAnswer, LevelBoundAnswer, MaskAnswer};
use crate::analysis::smoothness::SmoothnessCertificate;
use crate::analysis::surface::{
    BoundaryReport, Extraordinary, NetKind, PointWeight, Quotient, RegularMask, RegularSmoothness, SmoothnessProof,
    Status, ValenceReport, evidence, verdict,
};
use parts::{MAX_EIGENVALUES, coordinates, is_there, mask, name};

use crate::job::{SurfaceFindings, Survey};
use crate::math::mask::Mask;

/// What can be said of a scheme for surfaces.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct SurfaceAnswer {
    /// `surface`.
    pub kind: &'static str,
    /// Into how many pieces what is analysed divides an edge.
    pub arity: i32,
    /// How often the cycle is applied for that: twice, where one application turns directions.
    pub applications: u32,
    /// The scheme where nothing is extraordinary.
    pub regular: RegularAnswer,
    /// What is known of vertices of each valence, or of faces with as many corners under schemes that put faces in the
    /// place of vertices.
    pub valences: Vec<ValenceAnswer>,
    /// What is known of boundary vertices with each number of faces, and of vertices on creases that stay sharp.
    pub boundaries: Vec<BoundaryAnswer>,
    /// What is known of the mesh that was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<InputSurveyAnswer>,
    /// What the statements rest on beyond what was computed here.
    pub assumptions: Vec<&'static str>,
}

/// What is known of a mesh under the scheme.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct InputSurveyAnswer {
    /// Levels and how far they are from the limit surface at most, as a tolerance of a job measures it; each level that
    /// is told comes at least twice as close as the one before.
    pub bounds: Vec<LevelBoundAnswer>,
    /// Why nothing is told of levels, where that is so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds_refused: Option<String>,
    /// Vertices inside and faces that are extraordinary points of the limit, by valence.
    pub extraordinary: Vec<ExtraordinaryAnswer>,
    /// Boundary vertices by their number of faces.
    pub boundary: Vec<BoundaryVerticesAnswer>,
    /// What is to be known of the mesh, and of parameters at levels to come.
    pub warnings: Vec<String>,
}

/// The extraordinary points of one valence.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ExtraordinaryAnswer {
    /// Their valence.
    pub valence: usize,
    /// Whether limits are C1 there; null where that valence was not looked at.
    pub c1: Option<&'static str>,
    /// How many vertices there are.
    pub n_vertices: usize,
    /// The first 64 of them.
    pub vertices: Vec<u32>,
    /// How many faces there are whose middles are, or become, such points.
    pub n_faces: usize,
    /// The first 64 of them.
    pub faces: Vec<u32>,
}

/// The boundary vertices with one number of faces.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BoundaryVerticesAnswer {
    /// The number of faces at each.
    pub faces: usize,
    /// Whether limits are C1 there; null where that number was not looked at.
    pub c1: Option<&'static str>,
    /// What speaks for it; null where that number was not looked at.
    pub evidence: Option<&'static str>,
    /// How many vertices there are.
    pub n_vertices: usize,
    /// The first 64 of them.
    pub vertices: Vec<u32>,
}

impl InputSurveyAnswer {
    fn new(survey: &Survey, valences: &[ValenceAnswer], boundaries: &[BoundaryAnswer]) -> Self {
        let of_valence = |(&valence, found): (&usize, &Extraordinary)| ExtraordinaryAnswer {
            valence,
            c1: valences.iter().find(|row| row.valence == valence).map(|row| row.c1),
            n_vertices: found.n_vertices,
            vertices: found.vertices.clone(),
            n_faces: found.n_faces,
            faces: found.faces.clone(),
        };
        let of_faces = |(&faces, found): (&usize, &Extraordinary)| {
            let known = boundaries.iter().find(|row| row.faces == faces);
            BoundaryVerticesAnswer {
                faces,
                c1: known.map(|row| row.c1),
                evidence: known.map(|row| row.evidence),
                n_vertices: found.n_vertices,
                vertices: found.vertices.clone(),
            }
        };
        Self {
            bounds: LevelBoundAnswer::all(&survey.bounds),
            bounds_refused: survey.bounds.as_ref().err().cloned(),
            extraordinary: survey.extraordinary.iter().map(of_valence).collect(),
            boundary: survey.on_boundary.iter().map(of_faces).collect(),
            warnings: survey.warnings.clone(),
        }
    }
}

/// The scheme where nothing is extraordinary.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct RegularAnswer {
    /// What the net is made of: `quads`, with four at a vertex, or `triangles`, with six.
    pub faces: &'static str,
    /// Whether faces take the place of vertices.
    pub dual: bool,
    /// The mask a: the new point (x, y) is the sum over old points (i, j) of `a[x - arity i, y - arity j]`. Coordinates
    /// count steps along the two sides of a face at its first corner.
    pub mask: LatticeMaskAnswer,
    /// How often the symbol has the factor `1 + z^u + ... + z^((arity-1) u)` for each direction u.
    pub factors: Vec<FactorAnswer>,
    /// The masks of the two curve schemes whose product the scheme is, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub product: Option<[MaskAnswer; 2]>,
    /// Where the basic limit function is not 0 lies between these ends, along the two sides of a face.
    pub support: [[f64; 2]; 2],
    /// The largest degree of polynomials that are limits of their own samples, -1 where not even constants are.
    pub reproduction_degree: i32,
    /// How smooth limits are.
    pub smoothness: RegularSmoothnessAnswer,
}

/// Weights on a lattice.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct LatticeMaskAnswer {
    /// The coordinates of the first value of the first row.
    pub first: [i32; 2],
    /// The values, one row for each y, along x.
    pub values: Vec<Vec<f64>>,
}

/// A factor of the symbol.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct FactorAnswer {
    /// The direction.
    pub direction: [i32; 2],
    /// How often it is there.
    pub times: u32,
}

/// How smooth limits of regular nets are.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct RegularSmoothnessAnswer {
    /// By what it is proved: `box spline`, as which the limit is known; `product`, of two curve schemes; `norms`, of
    /// difference schemes along two directions; `radius`, the joint spectral radius of what a step leaves of the points
    /// around a cell, up to polynomials.
    pub by: &'static str,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    pub proved_c: i64,
    /// The smallest k for which it is disproved that limits are C^k; null where nothing is.
    pub disproved_c: Option<i64>,
    /// Proofs by norms: l steps of the difference schemes along two directions are contractions, for all derivatives of
    /// the order k.
    pub certificates: Vec<CertificateAnswer>,
    /// How many sum rules the mask has, where neither a box spline nor a product is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sum_rules: Option<i32>,
    /// Bounds of the joint spectral radius rho; the lower one is null where no eigenvalue is proved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_spectral_radius: Option<[Option<f64>; 2]>,
    /// Bounds of the Hoelder exponent, `-log(rho)/log(arity)` up to the sum rules; the upper one is null where shifts
    /// are not known to be stable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holder: Option<[Option<f64>; 2]>,
}

/// What is known of a valence.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct ValenceAnswer {
    /// The number of edges at the vertex, or of corners of the face.
    pub valence: usize,
    /// The largest eigenvalues of the local subdivision matrix.
    pub eigenvalues: Vec<EigenvalueAnswer>,
    /// The size of the largest eigenvalue besides 1 and the two of Fourier index 1, over that of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subdominant_ratio: Option<f64>,
    /// The weights of the limit position: `center`, and `edge` and `face` for each of the neighbours, or the entries of
    /// one sector by sector coordinates `i,j` where the mask goes beyond them. Weights of 0 are left out.
    pub limit_mask: BTreeMap<String, f64>,
    /// The weights of two tangents that span the tangent plane, by sector coordinates: a number for each sector.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent_masks: Option<[BTreeMap<String, Vec<f64>>; 2]>,
    /// The least sine of the corner angles of the characteristic net, but for those at its middle: above 0 where all
    /// faces are oriented alike and convex.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characteristic_map_min_sine: Option<f64>,
    /// The characteristic net, whose limit is the characteristic map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characteristic_net: Option<NetAnswer>,
    /// Whether limits are C1 there, for almost all nets: `proved`, `disproved` or `open`.
    pub c1: &'static str,
    /// What speaks for it: `proved`, `supported` where some criterion is met as far as numbers and samples show,
    /// `disproved` or `open`.
    pub evidence: &'static str,
    /// What decides about it, each with what is known of it.
    pub criteria: Vec<CriterionAnswer>,
    /// Why nothing is known, where the scheme cannot be analysed at this valence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// An eigenvalue.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct EigenvalueAnswer {
    /// Its real part.
    pub value: f64,
    /// Its imaginary part, where that is not 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imaginary: Option<f64>,
    /// Its Fourier index, from 0 to the valence less 1.
    pub fourier: usize,
}

const WEIGHTS_ASSUMPTION: &str = "weights are those of the scheme as it is written up to 2e-14 of their size";
const ALPHA_ASSUMPTION: &str = "the plan follows alpha; what is said holds for the scheme at alpha = 0, to which its \
                                levels come close";
const TAGS_ASSUMPTION: &str = "what is said of regular nets and of vertices holds where no edges are tagged as \
                               latitude or longitude lines";
const GENERIC_ASSUMPTION: &str = "C1 is meant for almost all nets: those whose tangents are not parallel";

impl SurfaceAnswer {
    /// Creates the answer of an analysis.
    pub(super) fn new(findings: &SurfaceFindings<'_>) -> Self {
        let regular = &findings.study.regular;
        let others = findings
            .follows_alpha
            .then_some(ALPHA_ASSUMPTION)
            .into_iter()
            .chain(findings.drops_tags.then_some(TAGS_ASSUMPTION));
        let valence = |(valence, found): &(usize, Result<ValenceReport, String>)| match found {
            Ok(report) => ValenceAnswer::new(report),
            Err(reason) => ValenceAnswer::refused(*valence, reason),
        };
        let valences: Vec<ValenceAnswer> = findings.valences.iter().map(valence).collect();
        let boundary = |(faces, found): &(usize, Result<BoundaryReport, String>)| match found {
            Ok(report) => BoundaryAnswer::new(report),
            Err(reason) => BoundaryAnswer::refused(*faces, reason),
        };
        let boundaries: Vec<BoundaryAnswer> = findings.boundaries.iter().map(boundary).collect();
        Self {
            kind: "surface",
            arity: regular.arity,
            applications: findings.study.applications(),
            regular: RegularAnswer::new(regular, &findings.smoothness),
            input: findings.survey.as_ref().map(|survey| InputSurveyAnswer::new(survey, &valences, &boundaries)),
            valences,
            boundaries,
            assumptions: [WEIGHTS_ASSUMPTION, GENERIC_ASSUMPTION].into_iter().chain(others).collect(),
        }
    }
}

impl RegularAnswer {
    fn new(regular: &RegularMask, smoothness: &RegularSmoothness) -> Self {
        let range = |axis: usize| {
            let all = || regular.mask.keys().map(|k| k[axis]);
            all().min().unwrap_or(0)..=all().max().unwrap_or(0)
        };
        let at = |x: i32, y: i32| regular.mask.get(&[x, y]).copied().unwrap_or(0.0);
        let row = |y: i32| range(0).map(|x| at(x, y)).collect();
        let mask =
            LatticeMaskAnswer { first: [*range(0).start(), *range(1).start()], values: range(1).map(row).collect() };
        let factor = |(direction, times): (&[i32; 2], &u32)| FactorAnswer { direction: *direction, times: *times };
        let factors = RegularMask::DIRECTIONS.iter().zip(&regular.factors).filter(|(_, times)| **times > 0);
        let curve = |mask: Mask| MaskAnswer { first: mask.first.into(), values: mask.values, exact: None };
        Self {
            faces: if regular.kind == NetKind::Triangles { "triangles" } else { "quads" },
            dual: regular.kind == NetKind::Dual,
            mask,
            factors: factors.map(factor).collect(),
            product: regular.tensor().map(|both| both.map(curve)),
            support: regular.support(),
            reproduction_degree: regular.reproduction_degree(),
            smoothness: RegularSmoothnessAnswer::new(smoothness),
        }
    }
}

impl RegularSmoothnessAnswer {
    fn new(smoothness: &RegularSmoothness) -> Self {
        let RegularSmoothness { proof, proved_c, disproved_c } = smoothness;
        let answer = |by| Self { by, proved_c: *proved_c, disproved_c: *disproved_c, ..Self::default() };
        let (found, quotient) = match proof {
            SmoothnessProof::BoxSpline => return answer("box spline"),
            SmoothnessProof::Product(_) => return answer("product"),
            SmoothnessProof::Norms(found, quotient) => (found, quotient.as_deref()),
        };
        let by_norms = i64::try_from(found.len()).unwrap_or(0) > *proved_c;
        let certificate = |c: &SmoothnessCertificate| CertificateAnswer { k: c.k, l: c.l, norm: c.norm };
        let radius = |of: &Quotient| {
            let lower = of.radius.lower.as_ref().map(|lower| lower.value);
            [lower, Some(of.radius.upper.value)]
        };
        Self {
            certificates: found.iter().map(certificate).collect(),
            sum_rules: quotient.map(|of| of.sum_rules),
            joint_spectral_radius: quotient.map(radius),
            holder: quotient.map(|of| [Some(of.least_holder), of.most_holder]),
            ..answer(if by_norms { "norms" } else { "radius" })
        }
    }
}

impl ValenceAnswer {
    fn new(report: &ValenceReport) -> Self {
        let eigenvalue = |found: &crate::analysis::surface::LocalEigenvalue| EigenvalueAnswer {
            value: found.value.re,
            imaginary: Some(found.value.im).filter(|x| *x != 0.0),
            fourier: found.fourier,
        };
        Self {
            valence: report.valence,
            eigenvalues: report.eigenvalues.iter().take(MAX_EIGENVALUES).map(eigenvalue).collect(),
            subdominant_ratio: report.ratio,
            limit_mask: limit_mask(&report.limit_mask),
            tangent_masks: report.tangent_masks.as_ref().map(|both| both.each_ref().map(|of| mask(of))),
            characteristic_map_min_sine: report.least_sine,
            characteristic_net: report.net.as_ref().map(NetAnswer::new),
            c1: name(verdict(&report.criteria)),
            evidence: name(evidence(&report.criteria)),
            criteria: report.criteria.iter().map(CriterionAnswer::new).collect(),
            refused: None,
        }
    }

    fn refused(valence: usize, reason: &str) -> Self {
        let [c1, evidence] = [name(Status::Open); 2];
        Self { valence, c1, evidence, refused: Some(reason.to_owned()), ..Self::default() }
    }
}

/// Returns the weights of a limit mask by the names of neighbours, or by sector coordinates if the mask reaches farther
/// or has no centre.
fn limit_mask(mask: &[PointWeight]) -> BTreeMap<String, f64> {
    let there: Vec<&PointWeight> = mask.iter().filter(|weight| is_there(weight)).collect();
    let near = |weight: &&&PointWeight| matches!(weight.point, None | Some([1, 0 | 1]));
    let has_centre = mask.iter().any(|weight| weight.point.is_none());
    let by_name = has_centre && there.iter().filter(near).count() == there.len();
    let key = |weight: &PointWeight| match weight.point {
        Some([1, 0]) if by_name => "edge".to_owned(),
        Some([1, 1]) if by_name => "face".to_owned(),
        _ => coordinates(weight),
    };
    there.into_iter().map(|weight| (key(weight), weight.values[0])).collect()
}
