//! The job as clients write it.

use serde::Deserialize;
use utoipa::ToSchema;

use super::input::{InputRequest, Resolved};
use super::levels::LevelsRequest;
use super::object;
use super::output::{OutputRequest, outputs};
use super::plan::PlanRequest;
use crate::analysis::curve::Reached;
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::key::Key;
use crate::job::{Draft, Job, SearchCost, SearchError};
use crate::output::ShapeKind;
use crate::watch::Watch;

/// A job: what is refined, how, how often, and what is answered.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1, default = 1)]
    pub spec: Option<u64>,
    /// What is refined: exactly one kind of input.
    #[serde(deserialize_with = "object::one")]
    pub input: InputRequest,
    /// How it is refined; may be left out together with `levels`, to convert or draw the input as it is.
    #[serde(default, deserialize_with = "object::optional")]
    pub plan: Option<PlanRequest>,
    /// How often the plan's cycle is applied, or how close to the limit it is to come; has to be given where there is a
    /// plan.
    pub levels: Option<LevelsRequest>,
    /// What is answered, 1 to 64 results; without any, /v1/render goes by `Accept`.
    #[serde(default)]
    #[schema(max_items = 64)]
    pub outputs: Vec<OutputRequest>,
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

    /// Checks the request as a whole and searches for the level of a tolerance; mesh files may be as large as `limits` say.
    ///
    /// # Errors
    /// All faults found in input and outputs, or, where these are right, in the plan.
    pub fn resolve_within(self, limits: &ReadLimits) -> Result<Job, Vec<Fault>> {
        let draft = self.draft_within(limits)?;
        let found = draft.search(&Watch::new()).map_err(|error| match error {
            SearchError::Refused(fault) => vec![fault],
            SearchError::Stopped(stopped) => vec![Fault::new("/levels", stopped.to_string())],
        })?;
        draft.complete(found)
    }

    /// Checks the request as a whole, but for the level of a tolerance; mesh files may be as large as `limits` say.
    ///
    /// # Errors
    /// All faults found in input and outputs, or, where these are right, in the plan.
    pub fn draft_within(self, limits: &ReadLimits) -> Result<RequestDraft, Vec<Fault>> {
        let mut faults = Vec::new();
        if self.spec.is_some_and(|spec| spec != 1) {
            faults.push(Fault::new("/spec", format!("{} is unknown; this server speaks 1", self.spec.unwrap_or(0))));
        }
        let alone = self.input.polygon.is_some();
        let frame = self.input.frame();
        let input = keep(self.input.resolve(limits).map_err(|found| under("/input", found)), &mut faults);
        let outputs = keep(outputs(&self.outputs), &mut faults);
        let says_boundary = self.plan.as_ref().is_some_and(|plan| plan.boundary.is_some());
        let mut plan = self.plan.map(PlanRequest::resolve);
        let Some(Resolved { input, boundary }) = input else { return Err(faults) };
        // the plan's word on the boundary stands over the file's
        if let (Some(plan), Some(boundary), false) = (&mut plan, boundary, says_boundary) {
            plan.boundary = boundary;
        }
        // a plan is looked at even where the outputs are wrong, so that all faults come together
        match Draft::new(input, plan.as_ref(), self.levels.map(|levels| levels.0), outputs.unwrap_or_default()) {
            Ok(draft) if faults.is_empty() => Ok(RequestDraft { draft: draft.framed(frame), alone }),
            Ok(_) => Err(faults),
            Err(found) => Err(faults.into_iter().chain(as_written(found, alone)).collect()),
        }
    }
}

/// A request that is checked, but for the level of a tolerance; see [`Draft`].
#[derive(Debug, Clone)]
pub struct RequestDraft {
    draft: Draft,
    /// Whether the input is a polygon that stands in no list.
    alone: bool,
}

impl RequestDraft {
    /// Bytes that the input takes in memory.
    pub fn input_bytes(&self) -> u64 {
        self.draft.input_bytes()
    }

    /// Whether a level has to be searched for before the job is complete.
    pub fn needs_search(&self) -> bool {
        self.draft.needs_search()
    }

    /// The key of the search, for whoever remembers answers and refusals; `None` where nothing is searched for.
    pub fn search_key(&self) -> Option<Key> {
        self.draft.search_key()
    }

    /// What the search takes at most.
    pub fn search_cost(&self) -> SearchCost {
        self.draft.search_cost()
    }

    /// Searches for the level of a tolerance; `None` where the levels were given as a number.
    ///
    /// # Errors
    /// [`SearchError`].
    pub fn search(&self, watch: &Watch) -> Result<Option<Reached>, SearchError> {
        self.draft.search(watch)
    }

    /// The job, with what the search has found.
    ///
    /// # Errors
    /// Every fault that shows at this level, with pointers into the request.
    pub fn complete(self, found: Option<Reached>) -> Result<Job, Vec<Fault>> {
        self.draft.complete(found).map_err(|faults| as_written(faults, self.alone).collect())
    }
}

/// Faults with their pointers as the request is written: a polygon alone stands in no list.
fn as_written(faults: Vec<Fault>, alone: bool) -> impl Iterator<Item = Fault> {
    faults.into_iter().map(move |fault| match fault.pointer.strip_prefix("/input/polygons/0/") {
        Some(inside) if alone => Fault { pointer: format!("/input/polygon/{inside}"), ..fault },
        _ => fault,
    })
}

fn keep<T>(result: Result<T, Vec<Fault>>, faults: &mut Vec<Fault>) -> Option<T> {
    result.map_err(|found| faults.extend(found)).ok()
}
