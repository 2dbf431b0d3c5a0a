//! Analyses: the question, and the answer with every number named.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::input::{InputRequest, Purpose};
use super::object;
use super::plan::PlanRequest;
use super::surface_analysis::SurfaceAnswer;
use super::tube_analysis::{TubeAnswer, TubeRequest};
use super::variants::PlanSchema;
use crate::analysis::Level;
use crate::analysis::smoothness::{BasicFunction, Report, Smoothness, Symbol, Weights};
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::{Analysis, Findings, Inquiry, SurfaceAnalysis, TubeAnalysis, is_for_meshes};
use crate::math::exact::{Exact, rounded};
use crate::math::mask::Mask;
use crate::math::spectrum::Eigenvalue;
use crate::watch::{Stopped, Watch};

/// A question about a plan: what can be said of its scheme.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AnalysisRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1, default = 1)]
    pub spec: Option<u64>,
    /// The plan, as in a job; its scheme for polygons is analysed, or that for meshes.
    #[serde(deserialize_with = "object::one")]
    #[schema(value_type = PlanSchema)]
    pub plan: PlanRequest,
    /// Most products of matrices that the search for the joint spectral radius looks at; 100,000 when left out. The
    /// more there are, the narrower the intervals.
    #[schema(minimum = 0, maximum = 10_000_000, default = 100_000)]
    pub nodes: Option<u64>,
    /// Asks for values of the basic limit function at the multiples of `arity^-grid`.
    #[schema(minimum = 0, maximum = 14)]
    pub grid: Option<u32>,
    /// Asks about the scheme for surfaces, at vertices of these valences. Plans for meshes alone are analysed at 3 to
    /// 12 when it is left out.
    #[schema(max_items = 64)]
    pub valences: Option<Vec<u64>>,
    /// Asks what becomes of a straight tube whose rings are tagged as latitude lines.
    #[serde(default, deserialize_with = "object::optional")]
    pub tube: Option<TubeRequest>,
    /// A mesh, as in a job: tells how close levels come to its limit, and what is known of its extraordinary vertices.
    #[serde(default, deserialize_with = "object::optional")]
    #[schema(value_type = Option<InputRequest>)]
    pub input: Option<InputRequest>,
}

impl AnalysisRequest {
    /// Checks the question.
    ///
    /// # Errors
    /// Every fault found.
    pub fn resolve(self, watch: &Watch) -> Result<Inquiry, Vec<Fault>> {
        let spec = self.spec.filter(|spec| *spec != 1);
        let unknown = spec.map(|spec| Fault::new("/spec", format!("{spec} is unknown; this server speaks 1")));
        match (self.inquiry(watch), unknown) {
            (Ok(inquiry), None) => Ok(inquiry),
            (inquiry, unknown) => Err(unknown.into_iter().chain(inquiry.err().unwrap_or_default()).collect()),
        }
    }

    fn inquiry(self, watch: &Watch) -> Result<Inquiry, Vec<Fault>> {
        let plan = self.plan.resolve();
        if let Some(tube) = self.tube {
            let others = [
                ("/grid", self.grid.is_some()),
                ("/valences", self.valences.is_some()),
                ("/input", self.input.is_some()),
            ];
            if let Some((place, _)) = others.into_iter().find(|(_, given)| *given) {
                return Err(vec![Fault::new(place, "this is another question than \"tube\"; leave one of them out")]);
            }
            let tube = TubeAnalysis::new(&plan, tube.resolve(), self.nodes, watch);
            return tube.map(|tube| Inquiry::Tube(Box::new(tube)));
        }
        let input = match self.input.map(|input| input.resolve(Purpose::Refine, &ReadLimits::default())).transpose() {
            Ok(resolved) => resolved.map(|resolved| resolved.input),
            Err(found) => return Err(under("/input", found)),
        };
        if input.as_ref().is_some_and(|input| input.mesh().is_none()) {
            let detail = "analyses look at meshes; of polygons /v1/estimate tells what a tolerance takes";
            return Err(vec![Fault::new("/input", detail)]);
        }
        if self.valences.is_none() && input.is_none() && !is_for_meshes(&plan) {
            return Analysis::new(&plan, self.nodes, self.grid, watch).map(|curve| Inquiry::Curve(Box::new(curve)));
        }
        if self.grid.is_some() {
            let detail = "values of basic limit functions are those of curves; leave it out, or the valences";
            return Err(vec![Fault::new("/grid", detail)]);
        }
        let surface = SurfaceAnalysis::new(&plan, self.valences.as_deref(), self.nodes, input, watch);
        surface.map(|surface| Inquiry::Surface(Box::new(surface)))
    }
}

/// What can be said of a plan.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(untagged)]
pub enum AnalysisAnswer {
    /// All levels have the same mask.
    Stationary(Box<SchemeAnswer>),
    /// The mask changes from level to level.
    Changing(Box<ChangingAnswer>),
    /// The scheme is one for surfaces.
    Surface(Box<SurfaceAnswer>),
    /// The question was about a tube.
    Tube(Box<TubeAnswer>),
}

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
    /// The theorem.
    pub theorem: &'static str,
    /// What it rests on beyond what was computed here.
    pub assumptions: Vec<String>,
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
    /// What the statements rest on beyond what was computed exactly.
    pub assumptions: Vec<&'static str>,
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
const THEOREM: &str = "Dyn and Levin 1995: level schemes whose distances from a convergent static scheme have a finite \
                       sum converge; where each of them has two sum rules, limits are C1 when those of the static \
                       scheme are (Zhang and Wang 2002, theorem 3, as corrected)";

impl AnalysisAnswer {
    /// The answer to a question.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn of(inquiry: &Inquiry, watch: &Watch) -> Result<Self, Stopped> {
        Ok(match inquiry {
            Inquiry::Curve(analysis) => Self::new(&analysis.run(watch)?),
            Inquiry::Surface(analysis) => Self::Surface(Box::new(SurfaceAnswer::new(&analysis.run(watch)?))),
            Inquiry::Tube(analysis) => Self::Tube(Box::new(TubeAnswer::new(&analysis.run(watch)?))),
        })
    }

    fn new(findings: &Findings<'_>) -> Self {
        let scheme = SchemeAnswer::new(&findings.report, findings.values.as_ref());
        if findings.levels.is_empty() {
            return Self::Stationary(Box::new(scheme));
        }
        let proved = findings.report.smoothness.proved_c;
        let two = findings.levels.iter().all(|level| level.order >= 2);
        let conclusion = ConclusionAnswer {
            proved_c: proved.min(i64::from(two)),
            theorem: THEOREM,
            assumptions: vec![
                "the masks of later levels go on coming closer as those of the levels listed do".to_owned(),
                "sum rules of levels were checked in f64".to_owned(),
            ],
        };
        Self::Changing(Box::new(ChangingAnswer {
            kind: "curve",
            arity: scheme.arity,
            levels: findings.levels.iter().map(LevelMaskAnswer::new).collect(),
            rate: findings.rate,
            exponentials: findings.levels.iter().all(|level| level.keeps_circles),
            static_limit: scheme,
            conclusion,
        }))
    }
}

impl LevelMaskAnswer {
    fn new(level: &Level) -> Self {
        let mask = MaskAnswer::rounded(&level.mask);
        Self { alpha: level.alpha, mask, sum_rules: level.order, distance: level.distance }
    }
}

impl SchemeAnswer {
    pub(super) fn new(report: &Report, values: Option<&BasicFunction>) -> Self {
        let symbol = &report.symbol;
        let known = symbol.is_exact;
        let weights = |weights: &Weights| MaskAnswer::new(weights.first, &weights.values, known);
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
            basic_limit_function: values.map(|values| ValuesAnswer::new(values, symbol.arity)),
        }
    }
}

/// The weights of new point r: old point i has the weight `a[r - d i]`.
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
        let certificate =
            |c: &crate::analysis::smoothness::Certificate| CertificateAnswer { k: c.k, l: c.l, norm: c.norm };
        let rounded = (!known).then_some(ROUNDED);
        let unstable = (radius.is_some() && !smoothness.is_stable).then_some(UNSTABLE);
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
