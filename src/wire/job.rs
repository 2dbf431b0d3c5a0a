//! The job as clients write it.

use serde::Deserialize;
use utoipa::ToSchema;

use super::input::{InputRequest, Purpose, Resolved};
use super::levels::LevelsRequest;
use super::output::{OutputRequest, outputs};
use super::plan::PlanRequest;
use super::variants::{InputSchema, PlanSchema};
use super::{object, whole};
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::{Draft, Input, Job, Levels, Output, SearchError};
use crate::output::ShapeKind;
use crate::scheme::plan::PlanInput;
use crate::shape::frame::Frame;
use crate::watch::Watch;

/// A job: what is refined, how, how often, and what is answered.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub spec: Option<u64>,
    /// What is refined: exactly one kind of input.
    #[serde(deserialize_with = "object::one")]
    #[schema(value_type = InputSchema)]
    pub input: InputRequest,
    /// How it is refined; may be left out together with `levels`, to convert or draw the input as it is.
    #[serde(default, deserialize_with = "object::optional")]
    #[schema(value_type = Option<PlanSchema>)]
    pub plan: Option<PlanRequest>,
    /// How often the plan's cycle is applied, or how close to the limit it is to come; has to be given where there is a
    /// plan.
    pub levels: Option<LevelsRequest>,
    /// What is answered, 1 to 64 results; without any, /v1/render goes by `Accept`.
    #[serde(default)]
    #[schema(max_items = 64)]
    pub outputs: Vec<OutputRequest>,
    /// How many outputs were left out before these.
    #[serde(skip)]
    pub left_out: usize,
}

impl JobRequest {
    /// What kind of result it has, as far as that can be told before it is checked.
    pub fn shape_kind(&self) -> ShapeKind {
        let first = self.input.polygon.iter().chain(self.input.polygons.iter().flatten()).next();
        match first {
            Some(polygon) if self.input.mesh.is_none() => {
                let dimension = polygon.points.first().map_or(1, Vec::len);
                ShapeKind::Curves { dimension: dimension.saturating_sub(usize::from(polygon.rational)).max(1) }
            }
            _ => ShapeKind::Mesh,
        }
    }

    /// Checks the request as a whole, under the default limits on mesh files.
    ///
    /// # Errors
    /// As [`JobRequest::resolve_within`].
    pub fn resolve(self) -> Result<Job, Vec<Fault>> {
        self.resolve_within(&ReadLimits::default())
    }

    /// Checks the request as a whole and searches for the level of a tolerance; mesh files may be as large as `limits`
    /// say.
    ///
    /// # Errors
    /// All faults found.
    pub fn resolve_within(self, limits: &ReadLimits) -> Result<Job, Vec<Fault>> {
        let search = match self.draft_within(limits)? {
            Draft::Job(job) => return Ok(*job),
            Draft::Search(search) => search,
        };
        let reached = search.run(&Watch::new()).map_err(|error| match error {
            SearchError::Refused(fault) => vec![fault],
            SearchError::Stopped(stopped) => vec![Fault::new("/levels", stopped.to_string())],
        })?;
        search.complete(reached)
    }

    /// Checks the request as a whole, but for the level of a tolerance; mesh files may be as large as `limits` say.
    ///
    /// # Errors
    /// All faults found.
    pub fn draft_within(self, limits: &ReadLimits) -> Result<Draft, Vec<Fault>> {
        let purpose = self.purpose();
        self.parts(purpose, limits).draft()
    }

    /// Checks the request as [`JobRequest::draft_within`], and tells what its parts are as far as these are right. An
    /// input alone is looked at as one that is to be refined.
    pub fn examine(self, limits: &ReadLimits) -> Examined {
        let purpose = if self.outputs.is_empty() { Purpose::Refine } else { self.purpose() };
        let parts = self.parts(purpose, limits);
        let input = parts.input.as_ref().map(|resolved| resolved.input.clone());
        let plan = parts.plan.clone();
        Examined { faults: parts.draft().err().unwrap_or_default(), input, plan }
    }

    /// What becomes of the input.
    fn purpose(&self) -> Purpose {
        if self.plan.is_some() { Purpose::Refine } else { Purpose::Keep }
    }

    /// Checks each part by itself.
    fn parts(self, purpose: Purpose, limits: &ReadLimits) -> Parts {
        let mut faults = Vec::new();
        if self.spec.is_some_and(|spec| spec != 1) {
            faults.push(Fault::new("/spec", format!("{} is unknown; this server speaks 1", self.spec.unwrap_or(0))));
        }
        let kind = self.input.is_one().then(|| self.shape_kind());
        let frame = self.input.frame();
        let input = keep(self.input.resolve(purpose, limits).map_err(|found| under("/input", found)), &mut faults);
        let outputs = keep(outputs(&self.outputs, self.left_out), &mut faults).unwrap_or_default();
        let says_boundary = self.plan.as_ref().is_some_and(|plan| plan.boundary.is_some());
        let mut plan = self.plan.map(PlanRequest::resolve);
        let boundary = input.as_ref().and_then(|input| input.boundary);
        // the plan's word on the boundary stands over the file's
        if let (Some(plan), Some(boundary), false) = (&mut plan, boundary, says_boundary) {
            plan.boundary = boundary;
        }
        Parts { faults, kind, input, frame, plan, levels: self.levels.map(|levels| levels.0), outputs }
    }
}

/// What a request is found to be without refining anything.
#[derive(Debug)]
pub struct Examined {
    /// Everything that is wrong.
    pub faults: Vec<Fault>,
    /// The input, where that is right.
    pub input: Option<Input>,
    /// The plan, unresolved, where there is one.
    pub plan: Option<PlanInput>,
}

/// The parts of a request, each checked by itself, and what is wrong with them.
struct Parts {
    faults: Vec<Fault>,
    /// What the input is, where there is one.
    kind: Option<ShapeKind>,
    input: Option<Resolved>,
    frame: Frame,
    plan: Option<PlanInput>,
    levels: Option<Levels>,
    outputs: Vec<Output>,
}

impl Parts {
    /// Fits the parts to each other. Where one is wrong, the others are looked at all the same, so that all faults come
    /// together.
    fn draft(self) -> Result<Draft, Vec<Fault>> {
        let Self { mut faults, kind, input, frame, plan, levels, outputs } = self;
        let found = match (input, kind) {
            (Some(Resolved { input, entry, .. }), _) => {
                match Draft::new((input, entry, frame), plan.as_ref(), levels, outputs) {
                    Ok(draft) if faults.is_empty() => return Ok(draft),
                    Ok(_) => Vec::new(),
                    Err(found) => found,
                }
            }
            (None, Some(kind)) => Draft::faults_but_for_input(kind, plan.as_ref(), levels, &outputs),
            (None, None) => Vec::new(),
        };
        faults.extend(found);
        Err(faults)
    }
}

fn keep<T>(result: Result<T, Vec<Fault>>, faults: &mut Vec<Fault>) -> Option<T> {
    result.map_err(|found| faults.extend(found)).ok()
}
