//! Answers about the state of batches.

use serde::Serialize;
use utoipa::ToSchema;

use super::standing::{OutputAnswer, state, warnings};
use crate::service::batches::{BatchStanding, PhaseCounts};
use crate::service::jobs::{JobPhase, JobState, Product};

/// How a batch stands.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BatchAnswer {
    /// Id of the batch.
    pub id: String,
    /// Where it stands; `failed` when some of its jobs were not done.
    #[schema(pattern = "^(queued|running|done|failed|cancelled)$")]
    pub state: &'static str,
    /// Share of the work done, from 0 to 1, where every job counts as much.
    pub progress: f64,
    /// How many of its jobs stand where.
    pub counts: CountsAnswer,
    /// How often it was begun.
    pub attempts: u32,
    /// Which jobs its jobs stand behind.
    #[schema(pattern = "^(interactive|batch)$")]
    pub priority: &'static str,
    /// Where all results are together, once nothing more will happen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub archive: Option<String>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Its jobs in their order; left out in lists of batches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub items: Option<Vec<ItemAnswer>>,
}

/// The progress of a batch, as the data of a progress event.
#[derive(Debug, Clone, Serialize)]
pub struct BatchProgress {
    state: &'static str,
    progress: f64,
    counts: CountsAnswer,
}

/// How many jobs of a batch stand where.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct CountsAnswer {
    /// The number of all jobs of the batch.
    pub total: u64,
    /// The number of jobs that wait for their turn.
    pub queued: u64,
    /// The number of jobs that are being computed.
    pub running: u64,
    /// The number of jobs whose outputs were all made.
    pub done: u64,
    /// The number of jobs that failed.
    pub failed: u64,
    /// The number of jobs that were cancelled.
    pub cancelled: u64,
    /// The number of jobs whose results were there before the batch asked for them.
    pub cache_hits: u64,
}

/// One job of a batch.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ItemAnswer {
    /// Its place in the batch, from 0.
    pub index: u64,
    /// Which value of each axis of the grid it has, from 0; left out for a list of jobs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<u64>,
    /// Where it stands.
    #[schema(pattern = "^(queued|running|done|failed|cancelled)$")]
    pub state: &'static str,
    /// The job, once it was put in line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<String>,
    /// Share of its work that is done, where it is under way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub progress: Option<f64>,
    /// Whether its results were there before the batch asked for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(pattern = "^(hit|miss)$")]
    pub cache: Option<&'static str>,
    /// Its outputs, as far as they are known.
    pub outputs: Vec<OutputAnswer>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What the client should know about its results.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// Batches, the newest first.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BatchesAnswer {
    /// How they stand, without their jobs.
    pub batches: Vec<BatchAnswer>,
    /// The `cursor` of the next page, where there are more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

impl BatchAnswer {
    /// Creates the answer without the items.
    pub fn brief(standing: &BatchStanding) -> Self {
        let (batch, id) = (&standing.batch, standing.batch.batch.id);
        Self {
            id: id.to_string(),
            state: state(&standing.phase),
            progress: standing.progress,
            counts: CountsAnswer::new(standing),
            attempts: batch.attempts,
            priority: batch.terms.priority.name(),
            archive: standing.phase.is_settled().then(|| format!("/v1/batches/{id}/archive.zip")),
            error: standing.phase.reason().map(str::to_owned),
            items: None,
        }
    }

    /// Creates the answer with the items; `href` returns the address of an output.
    pub fn new(standing: &BatchStanding, href: impl Fn(&Product) -> String) -> Self {
        let items = (0..standing.batch.items.len()).map(|at| ItemAnswer::new(standing, at, &href)).collect();
        Self { items: Some(items), ..Self::brief(standing) }
    }
}

impl BatchProgress {
    /// Creates the progress of a batch.
    pub fn new(standing: &BatchStanding) -> Self {
        Self { state: state(&standing.phase), progress: standing.progress, counts: CountsAnswer::new(standing) }
    }
}

impl CountsAnswer {
    fn new(standing: &BatchStanding) -> Self {
        let PhaseCounts { queued, running, done, failed, cancelled, hits } = standing.counts;
        let total = standing.batch.items.len() as u64;
        Self { total, queued, running, done, failed, cancelled, cache_hits: hits }
    }
}

impl ItemAnswer {
    fn new(standing: &BatchStanding, at: usize, href: impl Fn(&Product) -> String) -> Self {
        let (item, under_way) = (&standing.batch.items[at], standing.under_way[at].as_ref());
        let output = |product: &Product, made| OutputAnswer::new(product, made, href(product));
        let (name, outputs, warned) = match (&item.ending, under_way) {
            (Some(ending), _) => {
                let outputs = ending.outputs.iter().map(|(product, made)| output(product, made.as_ref()));
                let warned = warnings(ending.outputs.iter().filter_map(|(_, made)| made.as_ref()));
                (ended(&ending.state), outputs.collect(), warned)
            }
            (None, Some(job)) => {
                let outputs = job.record.summary.products.iter().zip(&job.record.made);
                let outputs = outputs.map(|(product, made)| output(product, made.as_ref())).collect();
                (state(&job.phase), outputs, warnings(job.record.made.iter().flatten()))
            }
            (None, None) => ("queued", Vec::new(), Vec::new()),
        };
        let error = match item.ending.as_ref().map(|ending| &ending.state) {
            Some(JobState::Failed(reason)) => Some(reason.clone()),
            _ => None,
        };
        let coordinates = standing.batch.request.layout.coordinates(at);
        Self {
            index: at as u64,
            at: coordinates.into_iter().map(|at| at as u64).collect(),
            state: name,
            job: item.job.map(|job| job.to_string()),
            progress: under_way.map(|job| job.progress),
            cache: item.job.map(|_| if item.is_hit { "hit" } else { "miss" }),
            outputs,
            error,
            warnings: warned,
        }
    }
}

/// Returns the name of the final state of a job; "running" if it is still active.
pub fn ended(state: &JobState) -> &'static str {
    super::standing::state(&JobPhase::of(state, true))
}
