//! Answers about the state of jobs.

use serde::Serialize;
use utoipa::ToSchema;

use super::answer::ReachedAnswer;
use crate::service::computation::Timings;
use crate::service::jobs::{JobPhase, OutputResult, Predicted, Product, Standing};
use crate::watch::Stage;

/// How a job stands.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct JobAnswer {
    /// Id of the job.
    pub id: String,
    /// Where it stands, and how far it is.
    #[serde(flatten)]
    pub progress: ProgressAnswer,
    /// How often it was queued.
    pub attempts: u32,
    /// Which jobs it stands behind.
    #[schema(pattern = "^(interactive|batch)$")]
    pub priority: &'static str,
    /// Time spent so far, or in all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timings_ms: Option<TimingsAnswer>,
    /// Counts and predicted cost.
    pub cost: CostAnswer,
    /// What it has come to so far, or in all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub actual: Option<ActualAnswer>,
    /// The outputs of the job.
    pub outputs: Vec<OutputAnswer>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What the client should know about the results.
    pub warnings: Vec<String>,
    /// What a tolerance led to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reached: Option<ReachedAnswer>,
}

/// How far a job is: what an event of progress tells.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ProgressAnswer {
    /// Where it stands.
    #[schema(pattern = "^(queued|running|done|failed|cancelled)$")]
    pub state: &'static str,
    /// Share of the work done, from 0 to 1.
    pub progress: f64,
    /// What the computation under way does.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(pattern = "^(refine|sweep|render|encode)$")]
    pub stage: Option<&'static str>,
    /// The level that is being made, where levels are made one after the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// How many jobs come before it, where it waits in line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub queue_position: Option<u64>,
}

/// Jobs, the newest first.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct JobsAnswer {
    /// How they stand.
    pub jobs: Vec<JobAnswer>,
    /// The `cursor` of the next page, where there are more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

/// Time by stage, milliseconds.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct TimingsAnswer {
    /// Waiting for a turn.
    pub queue: f64,
    /// Refining.
    pub refine: f64,
    /// Drawing.
    pub render: f64,
    /// Writing bytes.
    pub encode: f64,
}

/// Predicted cost.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct CostAnswer {
    /// Points or vertices of the result.
    pub vertices: u64,
    /// Faces of the result.
    pub faces: u64,
    /// Memory while it runs, bytes.
    pub memory_bytes: u64,
    /// Time on one core, milliseconds.
    pub time_ms: u64,
}

/// Actual cost.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct ActualAnswer {
    /// Time of all outputs, waiting left out, milliseconds.
    pub time_ms: f64,
    /// Bytes of all outputs.
    pub bytes: u64,
}

/// One output of a job.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct OutputAnswer {
    /// The name of the output.
    pub name: String,
    /// The format of the output.
    pub format: &'static str,
    /// The key of the output: id of the artifact and strong ETag.
    pub key: String,
    /// Where its bytes are, or will be.
    pub href: String,
    /// What became of it.
    #[schema(pattern = "^(pending|done|failed)$")]
    pub state: &'static str,
    /// Its length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// Why it was not made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl JobAnswer {
    /// Creates the answer for a job; `href` returns the address of an output.
    pub fn new(standing: &Standing, href: impl Fn(&Product) -> String) -> Self {
        let record = &standing.record;
        let outputs = record.summary.products.iter().zip(&record.made);
        let outputs = outputs.map(|(product, made)| OutputAnswer::new(product, made.as_ref(), href(product)));
        Self {
            id: record.job.id.to_string(),
            progress: ProgressAnswer::new(standing),
            attempts: record.attempts,
            priority: record.terms.priority.name(),
            timings_ms: Some(TimingsAnswer::from(standing.timings)),
            cost: CostAnswer::from(&record.summary.cost),
            actual: ActualAnswer::new(standing),
            outputs: outputs.collect(),
            error: standing.phase.reason().map(str::to_owned),
            warnings: warnings(record.made.iter().flatten()),
            reached: record.summary.reached.map(ReachedAnswer::from),
        }
    }
}

/// Returns the warnings of all outputs, each text once.
pub(super) fn warnings<'a>(made: impl IntoIterator<Item = &'a OutputResult>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for made in made {
        let OutputResult::Done { warnings, .. } = made else { continue };
        let new: Vec<_> = warnings.iter().filter(|warning| !all.contains(warning)).cloned().collect();
        all.extend(new);
    }
    all
}

/// Returns the name of a phase.
pub(super) fn state(phase: &JobPhase) -> &'static str {
    match phase {
        JobPhase::Queued => "queued",
        JobPhase::Running => "running",
        JobPhase::Done => "done",
        JobPhase::Failed(_) => "failed",
        JobPhase::Cancelled => "cancelled",
    }
}

impl ProgressAnswer {
    /// Creates the progress of a job.
    pub fn new(standing: &Standing) -> Self {
        let state = state(&standing.phase);
        let stage = standing.stage.map(|stage| match stage {
            Stage::Refine => "refine",
            Stage::Sweep => "sweep",
            Stage::Render => "render",
            Stage::Encode => "encode",
        });
        let queue_position = standing.ahead.map(|ahead| ahead as u64);
        Self { state, progress: standing.progress, stage, level: standing.level, queue_position }
    }
}

impl OutputAnswer {
    /// Creates the answer for an output; `href` is its address.
    pub(super) fn new(product: &Product, made: Option<&OutputResult>, href: String) -> Self {
        let (state, bytes, error) = match made {
            None => ("pending", None, None),
            Some(OutputResult::Done { bytes, .. }) => ("done", Some(*bytes), None),
            Some(OutputResult::Failed(reason)) => ("failed", None, Some(reason.clone())),
        };
        let (name, format, key) = (product.name.clone(), product.format.name(), product.key.to_string());
        Self { name, format, key, href, state, bytes, error }
    }
}

impl From<Timings> for TimingsAnswer {
    fn from(timings: Timings) -> Self {
        let [queue, refine, render, encode] =
            [timings.queue, timings.refine, timings.render, timings.encode].map(|time| time.as_secs_f64() * 1000.0);
        Self { queue, refine, render, encode }
    }
}

impl From<&Predicted> for CostAnswer {
    fn from(cost: &Predicted) -> Self {
        let Predicted { vertices, faces, memory_bytes, time_ms } = cost;
        let vertices = vertices.last().copied().unwrap_or(0);
        Self { vertices, faces: *faces, memory_bytes: *memory_bytes, time_ms: *time_ms }
    }
}

impl ActualAnswer {
    fn new(standing: &Standing) -> Option<Self> {
        let made = standing.record.made.iter().flatten();
        let of_one =
            |made: &OutputResult| if let OutputResult::Done { bytes, .. } = made { Some(*bytes) } else { None };
        let bytes: Vec<u64> = made.filter_map(of_one).collect();
        let TimingsAnswer { refine, render, encode, .. } = standing.timings.into();
        (!bytes.is_empty()).then(|| Self { time_ms: refine + render + encode, bytes: bytes.iter().sum() })
    }
}
