//! From the body of a request to a job: read, checked and completed in the lane for reading, searched for where a tolerance
//! is asked for.

use std::io::Write;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::App;
use super::body::Sent;
use super::problem::{self, Problem};
use super::requests::Client;
use crate::analysis::curve::Reached;
use crate::fault::Fault;
use crate::job::key::Key;
use crate::job::limits::{Admitted, in_bytes};
use crate::job::{Job, Report, RunError, SearchError};
use crate::service::computation::{Failure, Outcome, Phase};
use crate::service::peer::{Kind, Paid};
use crate::service::pool::Lane;
use crate::service::task::{Cost, Task};
use crate::watch::Watch;
use crate::wire::read::{read, weight};
use crate::wire::{JobRequest, RequestDraft};

/// Media type of what a search has found, which is no result of a job.
const FOUND_MEDIA_TYPE: &str = "application/vnd.planish.search+json";
/// What a search has found takes less than this.
const FOUND_BYTES: u128 = 4 << 10;
/// Searches that cannot come to more work than this begin in the short lane: 13 s at 100 ns a unit, which curves have.
const SHORT_SEARCH: u128 = 1 << 27;
/// What checking a draft that was searched for takes, as a share of its input.
const COMPLETING: u64 = 2;

/// A request that was read.
#[derive(Debug)]
pub(super) struct Asked {
    /// The job.
    pub(super) job: Job,
    /// Keys of its outputs.
    pub(super) keys: Vec<Key>,
    /// The memory of its input.
    pub(super) input: Arc<Paid>,
    /// The request as it was sent.
    pub(super) sent: Sent,
}

/// A request that is read as far as that goes without a search.
enum Step {
    Complete(Box<Asked>),
    Search(Arc<RequestDraft>, Arc<Paid>, Sent),
}

/// Reads a job of so many outputs at most; `prepare` may name one where the request names none.
///
/// # Errors
/// Whatever is wrong with the request; 503 when too much is being read already.
pub(super) async fn job(
    app: &Arc<App>,
    client: &Client,
    sent: Sent,
    most_outputs: usize,
    prepare: impl FnOnce(&mut JobRequest) -> Result<(), Problem> + Send + 'static,
) -> Result<Asked, Problem> {
    let (desk, peer, limits) = (app.desk.clone(), client.peer(), app.desk.limits.reading());
    let bytes = weight(sent.bytes.len() as u64);
    let step = app.desk.read(client.peer(), bytes, move |_| {
        let mut request: JobRequest = read(&sent.bytes)?;
        prepare(&mut request)?;
        let n = request.outputs.len();
        let draft = request.draft_within(&limits);
        if n > most_outputs {
            let detail = format!("{n} outputs; /v1/render answers one, send one job for each");
            let many = std::iter::once(Fault::new("/outputs", detail));
            return Err(Problem::invalid(many.chain(draft.err().unwrap_or_default()).collect()));
        }
        let draft = draft.map_err(Problem::invalid)?;
        let (bytes, inputs) = (draft.input_bytes(), &desk.account.inputs);
        if bytes > inputs.capacity / 2 {
            return Err(too_large("the input takes", bytes, inputs.capacity / 2));
        }
        let input = desk.peers.charge(inputs, Kind::InputBytes, peer, bytes);
        let input = Arc::new(input.map_err(|_| desk.pool.busy(Lane::Long))?);
        if draft.needs_search() {
            return Ok(Step::Search(Arc::new(draft), input, sent));
        }
        Ok(Step::Complete(Box::new(complete(draft, None, input, sent)?)))
    });
    match step.await?? {
        Step::Complete(asked) => Ok(*asked),
        Step::Search(draft, input, sent) => {
            let found = search(app, client, &draft, &input).await?;
            let bytes = COMPLETING * draft.input_bytes();
            let completing = app
                .desk
                .read(client.peer(), bytes, move |_| complete(Arc::unwrap_or_clone(draft), Some(found), input, sent));
            completing.await?
        }
    }
}

/// The refusal of something that takes more memory than there ever is for it.
fn too_large(what: &str, needs: u64, has: u64) -> Problem {
    let (needs, has) = (in_bytes(needs.into()), in_bytes(has.into()));
    let remedy = "send a smaller one, or raise --max-memory-bytes";
    Problem::new(problem::TOO_LARGE, format!("{what} {needs} of memory; this server has {has} for that: {remedy}"))
}

fn complete(draft: RequestDraft, found: Option<Reached>, input: Arc<Paid>, sent: Sent) -> Result<Asked, Problem> {
    let job = draft.complete(found).map_err(Problem::invalid)?;
    let keys = job.outputs.iter().map(|output| job.key(output)).collect();
    Ok(Asked { job, keys, input, sent })
}

/// Admits a job, in the lane for reading, as some forecasts count for a while.
pub(super) async fn admit(app: &Arc<App>, client: &Client, job: Job) -> Result<Arc<Admitted>, Problem> {
    let limits = app.desk.limits;
    let bytes = job.forecast_bytes();
    let admitted = app.desk.read(client.peer(), bytes, move |watch| limits.admit_under(job, watch)).await?;
    Ok(Arc::new(admitted?))
}

/// The level that a tolerance leads to: kept from an earlier search, or searched for as other computations are made.
async fn search(
    app: &Arc<App>,
    client: &Client,
    draft: &Arc<RequestDraft>,
    input: &Arc<Paid>,
) -> Result<Reached, Problem> {
    let task = Arc::new(Search { draft: draft.clone(), _input: input.clone() });
    if let Some(manifest) = app.desk.find(task.key()).await
        && let Some(bytes) = app.desk.tiers.part(&manifest, 0).await
    {
        return found(&bytes);
    }
    let (needs, has) = (draft.search_cost().bytes, app.desk.account.long.capacity);
    if needs > has {
        return Err(too_large("the search for the level of this tolerance may take", needs, has));
    }
    let interest = app.desk.compute(task, client.peer())?;
    match interest.computation.finished().await {
        Phase::Done(outcome) => found(&whole(app, &outcome).await?),
        Phase::Failed(failure) => Err(failure.into()),
        Phase::Queued | Phase::Running => Err(Failure::Cancelled.into()),
    }
}

/// The bytes of a small outcome.
async fn whole(app: &Arc<App>, outcome: &Outcome) -> Result<axum::body::Bytes, Problem> {
    let bytes = match &outcome.loose {
        Some(bytes) => Some(bytes.clone()),
        None => app.desk.tiers.part(&outcome.manifest, 0).await,
    };
    bytes.ok_or_else(|| super::answer::Lost::Gone.into())
}

/// What a search has found, as it is kept: refusals are remembered like results.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Found {
    Reached { level: u32, bound: f64 },
    Refused { pointer: String, detail: String },
}

fn found(bytes: &[u8]) -> Result<Reached, Problem> {
    match serde_json::from_slice(bytes) {
        Ok(Found::Reached { level, bound }) => Ok(Reached { level, bound }),
        Ok(Found::Refused { pointer, detail }) => Err(Problem::invalid(vec![Fault::new(pointer, detail)])),
        Err(error) => {
            tracing::error!(%error, "what a search has found cannot be read");
            Err(Problem::new(problem::INTERNAL, "the search failed; this is a fault of planish, please report it"))
        }
    }
}

/// The search for the level that meets a tolerance.
#[derive(Debug)]
struct Search {
    draft: Arc<RequestDraft>,
    _input: Arc<Paid>,
}

impl Task for Search {
    fn key(&self) -> Key {
        self.draft.search_key().expect("a search is made of drafts that need one")
    }

    fn cost(&self) -> Cost {
        let cost = self.draft.search_cost();
        let (work, memory_bytes) = (u128::from(cost.work), u128::from(cost.bytes));
        // searches on curves mostly end in milliseconds; what does not is moved to the long lane
        let time_ms = if work <= SHORT_SEARCH { 1 } else { work / 10_000 };
        Cost { memory_bytes, time_ms, work, result_bytes: FOUND_BYTES }
    }

    fn media_type(&self) -> &str {
        FOUND_MEDIA_TYPE
    }

    fn run(&self, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
        let found = match self.draft.search(watch) {
            Ok(Some(Reached { level, bound })) => Found::Reached { level, bound },
            Ok(None) => unreachable!("drafts without a search are complete"),
            Err(SearchError::Refused(Fault { pointer, detail, .. })) => Found::Refused { pointer, detail },
            Err(SearchError::Stopped(stopped)) => return Err(RunError::Stopped(stopped)),
        };
        let bytes = serde_json::to_vec(&found).expect("numbers and text");
        out.write_all(&bytes).map_err(RunError::Io)?;
        Ok(Report::default())
    }
}
