//! From the body of a request to a job: read, checked and completed in the reading lane, with a search for the level if
//! a tolerance is requested.

use std::io::Write;
use std::sync::Arc;

use axum::body::Bytes;
use serde::{Deserialize, Serialize};

use super::app::App;
use super::blobs::attached;
use super::body::Sent;
use super::problem::{self, Problem};
use crate::analysis::curve::Reached;
use crate::fault::Fault;
use crate::job::key::Key;
use crate::job::limits::Admitted;
use crate::job::{Draft, Job, KeepWork, Report, RunError, Search, SearchError};
use crate::math::amounts::in_bytes;
use crate::service::peer::{Paid, Peer, QuotaKind};
use crate::service::pool::{Lack, Lane};
use crate::service::task::{Cost, Task};
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::read::reading_memory;

/// Media type of the result of a search, which is stored like an artifact but is no result of a job.
const SEARCH_MEDIA_TYPE: &str = "application/vnd.planish.search+json";
/// Upper bound of the result of a search in bytes. It bounds only the memory booked beforehand; half of it is still far
/// more than a level and a number need.
const SEARCH_ANSWER_BYTES: u128 = 4 << 10;
/// Maximum work of searches that begin in the short lane: 13 s at 100 ns per unit, as on curves. Half of it sends the
/// searches of curves to the long lane; twice of it lets some of surfaces begin in the short one.
const SHORT_SEARCH: u128 = 1 << 27;
/// Memory for completing a job after a search, in multiples of the size of its search. It is charged while keys and
/// schedules are made. 2 is more than that takes; half of it is less than hashing a large input needs.
const COMPLETING_FACTOR: u64 = 2;

/// A job that was read from a request.
#[derive(Debug)]
pub(super) struct ReadJob {
    /// The job.
    pub(super) job: Job,
    /// The memory of the job's input.
    pub(super) input: Arc<Paid>,
    /// The request as it was sent.
    pub(super) sent: Sent,
}

/// A request that is read and checked as far as that is possible without a search.
pub(super) enum ReadStage {
    Complete(Box<ReadJob>),
    Search(Arc<Search>, Arc<Paid>, Sent),
}

/// Reads a job with at most `most_outputs` outputs; `prepare` may add one if the request names none.
///
/// # Errors
/// Every fault of the request; 503 if too much is being read already.
pub(super) async fn job(
    app: &Arc<App>,
    peer: Peer,
    sent: Sent,
    most_outputs: usize,
    prepare: impl FnOnce(&mut JobRequest) -> Result<(), Problem> + Send + 'static,
) -> Result<ReadJob, Problem> {
    match draft(app, peer, sent, most_outputs, prepare).await? {
        ReadStage::Complete(asked) => Ok(*asked),
        ReadStage::Search(search, input, sent) => {
            let reached = reached(app, peer, &search, &input).await?;
            let completing = app.desk.read(peer, COMPLETING_FACTOR * search.bytes(), move |_| {
                let job = Arc::unwrap_or_clone(search).complete(reached).map_err(Problem::invalid)?;
                Ok(ReadJob { job, input, sent })
            });
            completing.await?
        }
    }
}

/// Reads a job like [`job`], but leaves the search to the caller.
///
/// # Errors
/// As [`job`].
pub(super) async fn draft(
    app: &Arc<App>,
    peer: Peer,
    sent: Sent,
    most_outputs: usize,
    prepare: impl FnOnce(&mut JobRequest) -> Result<(), Problem> + Send + 'static,
) -> Result<ReadStage, Problem> {
    let (desk, limits) = (app.desk.clone(), app.desk.limits.reading());
    let sent = attached(app, peer, sent).await?;
    let bytes = reading_memory(sent.length());
    let step = app.desk.read(peer, bytes, move |_| {
        let mut request = sent.request()?;
        prepare(&mut request)?;
        let n = request.outputs.len();
        let draft = request.draft_within(&limits);
        if n > most_outputs {
            let detail = format!("{n} outputs; /v1/render answers one, send one job for each");
            let many = std::iter::once(Fault::new("/outputs", detail));
            return Err(Problem::invalid(many.chain(draft.err().unwrap_or_default()).collect()));
        }
        let draft = draft.map_err(Problem::invalid)?;
        let (bytes, inputs) = (draft.bytes(), &desk.account.inputs);
        if bytes > inputs.capacity / 2 {
            return Err(too_large("the input takes", bytes, inputs.capacity / 2));
        }
        let input = desk.peers.charge(inputs, QuotaKind::InputBytes, peer, bytes);
        let input = Arc::new(input.map_err(|_| desk.pool.busy(Lane::Long, Lack::Inputs))?);
        Ok(match draft {
            Draft::Job(job) => ReadStage::Complete(Box::new(ReadJob { job: *job, input, sent })),
            Draft::Search(search) => ReadStage::Search(Arc::from(search), input, sent),
        })
    });
    step.await?
}

/// Returns the refusal of something that needs more memory than its whole share.
pub(super) fn too_large(what: &str, needs: u64, has: u64) -> Problem {
    Problem::new(problem::TOO_LARGE, too_much(what, needs, has))
}

/// Returns the message that something needs more memory than its whole share.
pub(super) fn too_much(what: &str, needs: u64, has: u64) -> String {
    let (needs, has) = (in_bytes(needs.into()), in_bytes(has.into()));
    format!("{what} {needs} of memory; this server has {has} for that: send a smaller one, or raise --max-memory-bytes")
}

/// Admits a job in the reading lane, as some forecasts take a while to count.
pub(super) async fn admit(app: &Arc<App>, peer: Peer, job: Job) -> Result<Arc<Admitted>, Problem> {
    let limits = app.desk.limits;
    let bytes = job.forecast_bytes();
    let admitted = app.desk.read(peer, bytes, move |watch| limits.admit_under(job, watch)).await?;
    Ok(Arc::new(admitted?))
}

/// Returns the level for a tolerance: stored from an earlier search, or searched for like any other computation.
async fn reached(app: &Arc<App>, peer: Peer, search: &Arc<Search>, input: &Arc<Paid>) -> Result<Reached, Problem> {
    let task = Arc::new(SearchTask { search: search.clone(), _input: input.clone() });
    let found = first_part(app, peer, task, "the search for the level of this tolerance may take").await?;
    parse_reached(&found.ok_or(super::answer::Lost::Gone)?.0)
}

/// Returns the first part of the result of a task without outputs, and whether it was in the cache; `None` if the
/// result has just left the cache. `what` begins the refusal of a task that needs more memory than its share.
pub(super) async fn first_part(
    app: &Arc<App>,
    peer: Peer,
    task: Arc<dyn Task>,
    what: &str,
) -> Result<Option<(Bytes, bool)>, Problem> {
    if let Some(manifest) = app.desk.find_artifact(task.key(), peer).await
        && let Some(bytes) = app.desk.tiers.part(&manifest, 0).await
    {
        return Ok(Some((bytes, true)));
    }
    let (needs, has) = (task.cost().memory_bytes, app.desk.account.long.capacity);
    if needs > u128::from(has) {
        return Err(too_large(what, u64::try_from(needs).unwrap_or(u64::MAX), has));
    }
    let interest = app.desk.compute(task, peer)?;
    let outcome = interest.computation.outcome().await;
    // there are no outputs whose faults would need other pointers
    let outcome = outcome.map_err(|failure| Problem::of_failure(failure, |refused| refused.fault))?;
    let bytes = match &outcome.loose {
        Some(bytes) => Some(bytes.clone()),
        None => app.desk.tiers.part(&outcome.manifest, 0).await,
    };
    Ok(bytes.map(|bytes| (bytes, false)))
}

/// The result of a search as it is stored; refusals are stored like results.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SearchAnswer {
    Reached { level: u32, bound: f64 },
    Refused { pointer: String, detail: String },
}

fn parse_reached(bytes: &[u8]) -> Result<Reached, Problem> {
    match serde_json::from_slice(bytes) {
        Ok(SearchAnswer::Reached { level, bound }) => Ok(Reached { level, bound }),
        Ok(SearchAnswer::Refused { pointer, detail }) => Err(Problem::invalid(vec![Fault::new(pointer, detail)])),
        Err(error) => {
            tracing::error!(%error, "what a search has found cannot be read");
            Err(Problem::new(problem::INTERNAL, "the search failed; this is a fault of planish, please report it"))
        }
    }
}

/// The search for the level that meets a tolerance.
#[derive(Debug)]
struct SearchTask {
    search: Arc<Search>,
    _input: Arc<Paid>,
}

impl Task for SearchTask {
    fn key(&self) -> Key {
        self.search.key()
    }

    fn cost(&self) -> Cost {
        let cost = self.search.cost();
        let (work, memory_bytes) = (u128::from(cost.work), u128::from(cost.bytes));
        // searches on curves mostly end in milliseconds; longer ones are moved to the long lane
        let time_ms = if work <= SHORT_SEARCH { 1 } else { work / 10_000 };
        Cost { memory_bytes, time_ms, work, result_bytes: SEARCH_ANSWER_BYTES }
    }

    fn media_type(&self) -> &str {
        SEARCH_MEDIA_TYPE
    }

    fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        let answer = match self.search.run(watch) {
            Ok(Reached { level, bound }) => SearchAnswer::Reached { level, bound },
            Err(SearchError::Refused(Fault { pointer, detail, .. })) => SearchAnswer::Refused { pointer, detail },
            Err(SearchError::Stopped(stopped)) => return Err(RunError::Stopped(stopped)),
        };
        let bytes = serde_json::to_vec(&answer).expect("numbers and text");
        out.write_all(&bytes).map_err(RunError::Io)?;
        Ok(Report::default())
    }
}
