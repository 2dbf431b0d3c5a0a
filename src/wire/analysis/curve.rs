//! The answer of an analysis of a curve scheme, with every number named.

use serde::Serialize;
use utoipa::ToSchema;

use super::bounds::PolygonSurveyAnswer;
use super::matrices::MatricesAnswer;
use crate::analysis::LevelMask;
use crate::analysis::smoothness::{
    BasicFunction, Reduction, Smoothness, SmoothnessCertificate, SmoothnessReport, Symbol,
};
use crate::analysis::theorems::{Decay, Theorem};
use crate::job::SchemeFindings;
use crate::math::exact::{Exact, ExactSequence, rounded};
use crate::math::mask::Mask;
use crate::math::spectrum::Eigenvalue;

/// What can be said of a plan whose mask changes from level to level.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ChangingAnswer {
    /// `curve`.
    pub kind: &'static str,
    /// New points for each old one in one application of the cycle.
    pub arity: i64,
    /// The first levels, until their masks no longer differ from the static limit.
    pub levels: Vec<LevelMaskAnswer>,
    /// By what the distance of a level from the static limit is multiplied at the next, as the last levels show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// Whether every level refines samples of cos and sin with its own spacing alpha to combinations of such samples.
    pub exponentials: bool,
    /// The scheme at alpha 0, to which the levels come close.
    pub static_limit: SchemeAnswer,
    /// What follows for the plan itself.
    pub conclusion: ConclusionAnswer,
    /// What is known of the polygons that were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<PolygonSurveyAnswer>,
}

/// One level.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct LevelMaskAnswer {
    /// The parameter spacing that enters its first upsampling, radians.
    pub alpha: f64,
    /// Its mask.
    pub mask: MaskAnswer,
    /// The order of its sum rules.
    pub sum_rules: usize,
    /// The norm of its difference from the static limit: the greatest sum of sizes in a residue class.
    pub distance: f64,
}

/// What follows from the static limit for the levels that come close to it.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ConclusionAnswer {
    /// The largest k for which limits are C^k by the theorem, -1 where it says nothing.
    pub proved_c: i64,
    /// The least order r of the sum rules of the levels that are listed and of the static limit.
    pub sum_rules: i64,
    /// The theorem.
    pub theorem: &'static str,
    /// The theorems of the first paper, and what they prove here.
    pub theorems: Vec<TheoremAnswer>,
    /// The bound (11) of its theorem 3: level h, from 0 on, differs from the static limit by at most c gamma^h in the
    /// norm of `distance`, as far as levels are listed; absent where distances do not shrink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decay: Option<DecayAnswer>,
    /// What it rests on beyond what was computed here.
    pub assumptions: Vec<String>,
}

/// A theorem held against a plan.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct TheoremAnswer {
    /// Where it is printed.
    pub name: &'static str,
    /// Whether all that it asks for was found.
    pub applies: bool,
    /// What was found of what it asks for.
    pub because: String,
    /// What it proves where it applies.
    pub proves: &'static str,
}

/// A geometric bound.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct DecayAnswer {
    /// The factor c.
    pub c: f64,
    /// The ratio gamma, below 1.
    pub gamma: f64,
}

/// What can be said of one scheme.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct SchemeAnswer {
    /// `curve`.
    pub kind: &'static str,
    /// New points for each old one.
    pub arity: i64,
    /// The mask a: new point j is the sum over i of `a[j - arity i]` times old point i.
    pub mask: MaskAnswer,
    /// For each residue r modulo the arity the weights of new point r, by the index of the old point.
    pub sub_masks: Vec<MaskAnswer>,
    /// Order K of the sum rules: the symbol has the factor (1 + z + ... + z^(arity-1))^K; 0 when the weights of some
    /// new point do not sum to 1.
    pub sum_rules: usize,
    /// What is left of the symbol: a(z) = arity (sigma/arity)^K b(z) with sigma = 1 + z + ... + z^(arity-1), b(1) = 1.
    pub residual: MaskAnswer,
    /// Largest degree of polynomials among the limits, -1 when there is none.
    pub generation_degree: i64,
    /// Largest degree of polynomials that are limits of their own samples, at parameters shifted by `shift`.
    pub reproduction_degree: i64,
    /// The parameter shift a'(1)/arity.
    pub shift: NumberAnswer,
    /// The interval outside which the basic limit function is 0.
    pub support: [f64; 2],
    /// Most control points that have a say in one limit point.
    pub influence: i64,
    /// How smooth limits are.
    pub smoothness: SmoothnessAnswer,
    /// The weights of the limit point at index 0, by the index of the point; absent where convergence is not proved, or
    /// the mask is very long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_mask: Option<MaskAnswer>,
    /// The weights of the derivative there, with neighbours at a distance of 1; absent where C^1 is not proved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent_mask: Option<MaskAnswer>,
    /// The real parts of the eigenvalues of the local matrix, the largest first.
    pub local_eigenvalues: Vec<f64>,
    /// Their imaginary parts, where some are not 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub local_eigenvalues_imaginary: Option<Vec<f64>>,
    /// Values of the basic limit function, where they were asked for and convergence is proved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub basic_limit_function: Option<ValuesAnswer>,
    /// Values of its derivatives, the first one first, as far as they are proved to be continuous; three at most.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub derivatives: Vec<ValuesAnswer>,
    /// The matrices of one step, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matrices: Option<MatricesAnswer>,
    /// What is known of the polygons that were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<PolygonSurveyAnswer>,
}

/// Numbers with indices.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct MaskAnswer {
    /// Index of the first number.
    pub first: i64,
    /// The numbers, rounded to f64.
    pub values: Vec<f64>,
    /// The numbers as fractions; absent where they are not known exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<Vec<String>>,
}

/// A number, and as a fraction where it is known exactly.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct NumberAnswer {
    /// Rounded to f64.
    pub value: f64,
    /// As a fraction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<String>,
}

/// Values on a grid.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ValuesAnswer {
    /// The parameter of the first value.
    pub from: f64,
    /// The distance of parameters.
    pub step: f64,
    /// The values.
    pub values: Vec<f64>,
}

/// How smooth limits are. What is called proved is: bounds are exact or rounded outwards.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct SmoothnessAnswer {
    /// Proofs by norms: limits are C^k as the norm of l steps of the difference scheme with mask (sigma/arity)^(K-1-k)
    /// b is below 1.
    pub certificates: Vec<CertificateAnswer>,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    pub proved_c: i64,
    /// The smallest k for which it is disproved that limits are C^k; null where nothing is.
    pub disproved_c: Option<i64>,
    /// The Hoelder exponent of the basic limit function is at least the first and, with stable shifts, at most the
    /// second number; null where the scheme has no sum rules.
    pub holder: Option<[f64; 2]>,
    /// Bounds of the joint spectral radius rho of the residual's matrices, from below and above; the exponent is
    /// `K - 1 - log_arity(rho)`.
    pub joint_spectral_radius: Option<[f64; 2]>,
    /// The product of matrices, by their numbers, with an eigenvalue that proves the lower bound; empty where it is the
    /// mean of all matrices.
    pub extremal_word: Vec<usize>,
    /// The norm in which the upper bound was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub norm: Option<&'static str>,
    /// Products of matrices that were looked at for the upper bound.
    pub nodes: u64,
    /// Whether the integer shifts of the basic limit function are proved to be stable: sub-symbols without a common
    /// zero, and no zeros of the residual on cycles of roots of unity.
    pub stable: bool,
    /// Where they are not, the scheme with stable shifts of whose basic limit function that of this scheme is a
    /// combination: both are C^k for the same k, so that `disproved_c` and the upper end of `holder` are those of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reduction: Option<ReductionAnswer>,
    /// What the statements rest on beyond what was computed exactly.
    pub assumptions: Vec<&'static str>,
}

/// A basic limit function as a combination of shifts of that of a scheme with stable shifts.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ReductionAnswer {
    /// The mask of the scheme with stable shifts.
    pub mask: MaskAnswer,
    /// The weights q of its shifts: the basic limit function at x is the sum of `q[j]` times the other one at x - j.
    pub combination: MaskAnswer,
}

/// A proof that limits are C^k.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct CertificateAnswer {
    /// The order k of the derivative that is continuous.
    pub k: usize,
    /// Steps of the difference scheme.
    pub l: u32,
    /// The norm of so many steps, below 1.
    pub norm: f64,
}

const ROUNDED: &str = "some weight is not known as a fraction: what is said holds for the scheme beside it, within \
                       rounding, that has its sum rules exactly";
const UNSTABLE: &str = "the shifts of the basic limit function are not proved to be stable, so that nothing is \
                        disproved and the upper end of the Hoelder exponent is no bound";
const THEOREM: &str = "Charina, Conti, Guglielmi and Protasov 2017, theorem 2: limits of schemes that come close to a \
                       static one whose differences prove C^k are C^k where they have approximate sum rules of order \
                       k + 1; with r exact ones at each level, and distances that shrink by gamma, that is where k < r \
                       or gamma arity^(k - r) < 1 (Zhang and Wang 2002, theorem 3, says it of k = 0)";

impl ChangingAnswer {
    /// Creates the answer for a plan whose static limit is known.
    pub(super) fn new(findings: &SchemeFindings<'_>, scheme: SchemeAnswer) -> Self {
        let (input, static_limit) = (scheme.input, SchemeAnswer { input: None, ..scheme });
        let conclusion = ConclusionAnswer {
            proved_c: findings.proved_c,
            sum_rules: findings.sum_rules,
            theorem: THEOREM,
            theorems: findings.theorems.iter().map(TheoremAnswer::new).collect(),
            decay: findings.decay.map(|Decay { c, gamma }| DecayAnswer { c, gamma }),
            assumptions: vec![
                "the masks of later levels go on coming closer as those of the levels listed do".to_owned(),
                "sum rules of levels were checked in f64".to_owned(),
            ],
        };
        Self {
            kind: "curve",
            arity: static_limit.arity,
            levels: findings.levels.iter().map(LevelMaskAnswer::new).collect(),
            rate: findings.rate,
            exponentials: findings.levels.iter().all(|level| level.keeps_circles),
            static_limit,
            conclusion,
            input,
        }
    }
}

impl TheoremAnswer {
    fn new(theorem: &Theorem) -> Self {
        let Theorem { name, applies, because, proves } = theorem;
        Self { name, applies: *applies, because: because.clone(), proves }
    }
}

impl LevelMaskAnswer {
    fn new(level: &LevelMask) -> Self {
        let mask = MaskAnswer::rounded(&level.mask);
        Self { alpha: level.alpha, mask, sum_rules: level.order, distance: level.distance }
    }
}

impl SchemeAnswer {
    /// Creates the answer for a scheme.
    pub(in crate::wire) fn new(findings: &SchemeFindings<'_>) -> Self {
        let SchemeFindings { report, values, derivatives, matrices, survey, .. } = findings;
        let symbol = &report.symbol;
        Self {
            basic_limit_function: values.as_ref().map(|values| ValuesAnswer::new(values, symbol.arity)),
            derivatives: derivatives.iter().map(|values| ValuesAnswer::new(values, symbol.arity)).collect(),
            matrices: matrices.as_ref().map(|matrices| MatricesAnswer::new(matrices, symbol.is_exact)),
            input: survey.as_ref().map(PolygonSurveyAnswer::new),
            ..Self::of_report(report)
        }
    }

    /// Creates the answer for a scheme without values and matrices.
    pub(in crate::wire) fn of_report(report: &SmoothnessReport) -> Self {
        let symbol = &report.symbol;
        let known = symbol.is_exact;
        let weights = |weights: &ExactSequence| MaskAnswer::new(weights.first, &weights.values, known);
        let eigenvalues: &[Eigenvalue] = report.local_eigenvalues.as_deref().unwrap_or_default();
        let imaginary: Vec<f64> = eigenvalues.iter().map(|x| x.im).collect();
        let shift = symbol.shift();
        Self {
            kind: "curve",
            arity: symbol.arity,
            mask: MaskAnswer::new(symbol.first, &symbol.mask, known),
            sub_masks: (0..symbol.arity).map(|r| sub_mask(symbol, r)).collect(),
            sum_rules: symbol.order,
            residual: MaskAnswer::new(symbol.first, &symbol.residual, known),
            generation_degree: i64::try_from(symbol.order).unwrap_or(0) - 1,
            reproduction_degree: symbol.reproduction_degree(),
            shift: NumberAnswer { value: rounded(&shift), exact: known.then(|| shift.to_string()) },
            support: symbol.support().map(|end| rounded(&end)),
            influence: symbol.influence(),
            smoothness: SmoothnessAnswer::new(&report.smoothness, known),
            limit_mask: report.limit_mask.as_ref().map(weights),
            tangent_mask: report.tangent_mask.as_ref().map(weights),
            local_eigenvalues: eigenvalues.iter().map(|x| x.re).collect(),
            local_eigenvalues_imaginary: imaginary.iter().any(|x| *x != 0.0).then_some(imaginary),
            basic_limit_function: None,
            derivatives: Vec::new(),
            matrices: None,
            input: None,
        }
    }
}

/// Returns the weights of new point r modulo the arity d: old point i has the weight `a[r - d i]`.
fn sub_mask(symbol: &Symbol, r: i64) -> MaskAnswer {
    let d = symbol.arity;
    let first = -(symbol.last() - r).div_euclid(d);
    let last = (r - symbol.first).div_euclid(d);
    let values: Vec<Exact> = (first..=last).map(|i| symbol.at(r - d * i)).collect();
    MaskAnswer::new(first, &values, symbol.is_exact)
}

impl SmoothnessAnswer {
    fn new(smoothness: &Smoothness, known: bool) -> Self {
        let radius = smoothness.radius.as_ref();
        let certificate = |c: &SmoothnessCertificate| CertificateAnswer { k: c.k, l: c.l, norm: c.norm };
        let rounded = (!known).then_some(ROUNDED);
        let is_open = radius.is_some() && !smoothness.is_stable && smoothness.reduction.is_none();
        let unstable = is_open.then_some(UNSTABLE);
        let reduction = |reduction: &Reduction| ReductionAnswer {
            mask: MaskAnswer::new(reduction.symbol.first, &reduction.symbol.mask, true),
            combination: MaskAnswer::new(0, &reduction.combination, true),
        };
        Self {
            certificates: smoothness.certificates.iter().map(certificate).collect(),
            proved_c: smoothness.proved_c,
            disproved_c: smoothness.disproved_c,
            holder: radius.map(|radius| radius.holder),
            joint_spectral_radius: radius.map(|radius| [radius.lower.value, radius.upper.value]),
            extremal_word: radius.map(|radius| radius.lower.word.clone()).unwrap_or_default(),
            norm: radius.map(|radius| radius.upper.norm),
            nodes: radius.map_or(0, |radius| radius.upper.nodes),
            stable: smoothness.is_stable,
            reduction: smoothness.reduction.as_ref().map(reduction),
            assumptions: rounded.into_iter().chain(unstable).collect(),
        }
    }
}

impl MaskAnswer {
    fn new(first: i64, values: &[Exact], known: bool) -> Self {
        let exact = known.then(|| values.iter().map(ToString::to_string).collect());
        Self { first, values: values.iter().map(rounded).collect(), exact }
    }

    fn rounded(mask: &Mask) -> Self {
        Self { first: mask.first.into(), values: mask.values.clone(), exact: None }
    }
}

impl ValuesAnswer {
    fn new(values: &BasicFunction, arity: i64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "arities and indices are small")]
        let (d, first) = (arity as f64, values.first as f64);
        let step = (0..values.grid).fold(1.0, |step, _| step / d);
        Self { from: first * step, step, values: values.values.clone() }
    }
}
