//! Requests for analyses, and their answers with every number named.

mod bounds;
mod curve;
mod figure;
mod markdown;
mod matrices;
mod scan;
mod written;

pub use bounds::{LevelBoundAnswer, PolygonSurveyAnswer};
pub use curve::{
    CertificateAnswer, ChangingAnswer, ConclusionAnswer, LevelMaskAnswer, MaskAnswer, NumberAnswer, ReductionAnswer,
    SchemeAnswer, SmoothnessAnswer, ValuesAnswer,
};
pub use matrices::{MatricesAnswer, MatricesRequest, MatrixAnswer, PowersAnswer, SmallPolygon, StepMatrixAnswer};
pub use scan::{ExactAnswer, ScanAnswer, ScanIntervalAnswer, ScanRequest, ScanValueAnswer};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::input::{InputRequest, Purpose};
use super::plan::PlanRequest;
use super::surface_analysis::SurfaceAnswer;
use super::tube_analysis::{TubeAnswer, TubeRequest};
use super::variants::{InputSchema, PlanSchema};
use super::{object, whole};
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::{
    AnalysedVertices, Analysis, Findings, Form, Input, Inquiry, RequestedFindings, SchemeFindings, SurfaceAnalysis,
    TubeAnalysis, is_for_meshes,
};
use crate::watch::{Stopped, Watch};

/// A question about a plan: what can be said of its scheme.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AnalysisRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1, default = 1)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub spec: Option<u64>,
    /// The plan, as in a job; its scheme for polygons is analysed, or that for meshes.
    #[serde(deserialize_with = "object::one")]
    #[schema(value_type = PlanSchema)]
    pub plan: PlanRequest,
    /// Most products of matrices that the search for the joint spectral radius looks at; 100,000 when left out, and
    /// 10,000 at each value of a scan. The more there are, the narrower the intervals.
    #[schema(minimum = 0, maximum = 10_000_000, default = 100_000)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub nodes: Option<u64>,
    /// Asks for values of the basic limit function at the multiples of `arity^-grid`.
    #[schema(minimum = 0, maximum = 14)]
    pub grid: Option<u32>,
    /// Asks for the matrices of one step on a small polygon: `true` for a closed one of five points, or what it is
    /// like.
    pub matrices: Option<MatricesRequest>,
    /// Asks what is proved at each of many values of a parameter instead.
    pub scan: Option<ScanRequest>,
    /// Asks about the scheme for surfaces, at vertices of these valences. Plans for meshes alone are analysed at 3 to
    /// 12 when it is left out.
    #[schema(max_items = 64)]
    pub valences: Option<Vec<u64>>,
    /// Asks about boundary vertices with these numbers of faces, from 1 to 24, of a scheme for surfaces; 1 to 6, or
    /// those that the mesh has, when it is left out.
    #[schema(max_items = 64)]
    pub boundaries: Option<Vec<u64>>,
    /// Asks what becomes of a straight tube whose rings are tagged as latitude lines.
    #[serde(default, deserialize_with = "object::optional")]
    pub tube: Option<TubeRequest>,
    /// A mesh or polygons, as in a job: tells how close levels come to the limit, and what is known of extraordinary
    /// vertices.
    #[serde(default, deserialize_with = "object::optional")]
    #[schema(value_type = Option<InputSchema>)]
    pub input: Option<InputRequest>,
}

impl AnalysisRequest {
    /// Checks the request; `form` is the form of its answer.
    ///
    /// # Errors
    /// Every fault found.
    pub fn resolve(self, form: Form, watch: &Watch) -> Result<Inquiry, Vec<Fault>> {
        let spec = self.spec.filter(|spec| *spec != 1);
        let unknown = spec.map(|spec| Fault::new("/spec", format!("{spec} is unknown; this server speaks 1")));
        match (self.inquiry(form, watch), unknown) {
            (Ok(inquiry), None) => Ok(inquiry),
            (inquiry, unknown) => Err(unknown.into_iter().chain(inquiry.err().unwrap_or_default()).collect()),
        }
    }

    fn inquiry(self, form: Form, watch: &Watch) -> Result<Inquiry, Vec<Fault>> {
        let Self { plan, nodes, grid, valences, boundaries, matrices, scan, tube, input, spec: _ } = self;
        let plan = plan.resolve();
        if let Some(tube) = tube {
            let others = [
                ("/grid", grid.is_some()),
                ("/valences", valences.is_some()),
                ("/boundaries", boundaries.is_some()),
                ("/input", input.is_some()),
                ("/matrices", matrices.is_some()),
                ("/scan", scan.is_some()),
            ];
            if let Some((place, _)) = others.into_iter().find(|(_, given)| *given) {
                return Err(vec![Fault::new(place, "this is another question than \"tube\"; leave one of them out")]);
            }
            let tube = TubeAnalysis::new(&plan, tube.resolve(), nodes, watch);
            return tube.map(|tube| Inquiry::Tube(Box::new(tube)));
        }
        let input = match input.map(|input| input.resolve(Purpose::Refine, &ReadLimits::default())).transpose() {
            Ok(resolved) => resolved.map(|resolved| resolved.input),
            Err(found) => return Err(under("/input", found)),
        };
        if input.as_ref().is_some_and(Input::has_own_parameters) {
            let detail = "single points have parameters of their own, so that no rule holds everywhere that could be \
                          analysed; leave \"parameters\" out of the input, or ask with their values in the plan";
            return Err(vec![Fault::new("/input", detail)]);
        }
        let is_of_polygons = input.as_ref().is_some_and(|input| input.mesh().is_none());
        if is_of_polygons && (valences.is_some() || boundaries.is_some()) {
            let detail = "valences and boundaries are those of meshes; give a mesh, or leave them out";
            return Err(vec![Fault::new("/input", detail)]);
        }
        let is_of_curves = input.is_none() && valences.is_none() && boundaries.is_none() && !is_for_meshes(&plan);
        if is_of_polygons || is_of_curves {
            let requested = RequestedFindings {
                nodes,
                grid,
                input,
                matrices: matrices.and_then(MatricesRequest::resolve),
                scan: scan.map(ScanRequest::resolve),
                is_plotted: form.is_figure(),
            };
            return Analysis::new(&plan, &requested, watch).map(|curve| Inquiry::Curve(Box::new(curve)));
        }
        let of_curves = [
            ("grid", grid.is_some(), "values of basic limit functions are those of curves"),
            ("matrices", matrices.is_some(), "the matrices of one step are those of curves"),
            ("scan", scan.is_some(), "scans are of schemes for curves"),
        ];
        if let Some((name, _, why)) = of_curves.into_iter().find(|(_, is_asked, _)| *is_asked) {
            let detail = format!("{why}; leave it out, or the valences, and ask about a scheme for curves");
            return Err(vec![Fault::new(format!("/{name}"), detail)]);
        }
        let around = AnalysedVertices { valences: valences.as_deref(), boundaries: boundaries.as_deref() };
        let surface = SurfaceAnalysis::new(&plan, around, nodes, input, watch);
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
    /// A parameter was scanned.
    Scan(Box<ScanAnswer>),
    /// The scheme is one for surfaces.
    Surface(Box<SurfaceAnswer>),
    /// The question was about a tube.
    Tube(Box<TubeAnswer>),
}

impl AnalysisAnswer {
    /// Runs an analysis and returns its answer.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn of(inquiry: &Inquiry, watch: &Watch) -> Result<Self, Stopped> {
        Ok(match inquiry {
            Inquiry::Curve(analysis) => match analysis.run(watch)? {
                Findings::Scheme(findings) => Self::of_scheme(&findings),
                Findings::Scan(scan, scanned) => Self::Scan(Box::new(ScanAnswer::new(scan, &scanned))),
            },
            Inquiry::Surface(analysis) => Self::Surface(Box::new(SurfaceAnswer::new(&analysis.run(watch)?))),
            Inquiry::Tube(analysis) => Self::Tube(Box::new(TubeAnswer::new(&analysis.run(watch)?))),
        })
    }

    fn of_scheme(findings: &SchemeFindings<'_>) -> Self {
        let scheme = SchemeAnswer::new(findings);
        if findings.levels.is_empty() {
            return Self::Stationary(Box::new(scheme));
        }
        Self::Changing(Box::new(ChangingAnswer::new(findings, scheme)))
    }
}
