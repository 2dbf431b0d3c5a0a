//! POST /v1/jobs: jobs with one or more outputs, computed in a queue.

use std::time::Duration;

use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;
use axum::response::Response;
use tokio::sync::watch;

use super::app::SharedApp;
use super::client::Client;
use super::content::AcceptedBodies;
use super::problem::Problem;
use super::working::{self, AdmittedJob};
use super::{body, jobs, negotiate};
use crate::fault::{Fault, did_you_mean, shortened};
use crate::service::accepting::NotAccepted;
use crate::service::job_key::{JobKey, JobTerms, Priority};
use crate::service::jobs::{Holder, JobState};
use crate::wire::posted::PostedJob;
use crate::wire::query::repeated;
use crate::wire::standing::JobAnswer;

/// Maximum time that a job may be given to wait or to run, in seconds: a day. Half of it refuses night runs that begin
/// at noon; twice of it keeps jobs whose clients are long gone.
const MAX_JOB_SECONDS: u64 = 24 * 60 * 60;

/// Accepts a job with up to 64 outputs, or an analysis, and has it done in its turn.
///
/// The id of the job is the hash of the names and keys of its outputs: the same job posted again is the same resource,
/// and is not done twice. One that failed or was cancelled is done once more (`attempts`). An accepted job outlasts its
/// request, its client, and, where the service has a data directory, the process.
///
/// Without `Prefer` the answer comes at once; `Prefer: wait=N` waits N seconds at most for the end.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "jobs",
    params(
        ("Prefer" = Option<String>, Header, description = "`wait=N` waits N seconds at most for the end of the job"),
        ("priority" = Option<String>, Query,
            description = "`interactive` (default), or `batch`: stands back behind interactive jobs"),
        ("queue_timeout_s" = Option<u64>, Query,
            description = "Longest time that the job may wait for its turn; it fails after it"),
        ("run_timeout_s" = Option<u64>, Query,
            description = "Longest time from the job's turn to its end; it fails after it"),
    ),
    request_body = PostedJob,
    responses(
        (status = 200, description = "It is done already, or was within the wait, or has failed in it",
            body = JobAnswer),
        (status = 202, description = "It is accepted; `Location` is where it stands", body = JobAnswer),
    )
)]
pub(super) async fn post(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    RawQuery(query): RawQuery,
    body: Body,
) -> Result<Response, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    let terms = terms(query.as_deref().unwrap_or_default(), Priority::Interactive).map_err(Problem::invalid)?;
    let asked = working::read_job(&app, client.peer(), &headers, sent).await?;
    let job = JobKey { tenant: client.tenant(), id: asked.id() };
    match app.desk.jobs.join(&job, Holder::Client) {
        Some(JobState::Active) => app.desk.jobs.written(job).await.map_err(NotAccepted::from)?,
        Some(_) => {}
        None => {
            let AdmittedJob { summary, tasks: _ } = asked.work(&app, client.peer()).await?;
            let made = app.desk.all_kept(&summary, client.peer()).await;
            app.desk.accept(job, summary, terms, (client.peer(), Holder::Client), made).await?;
        }
    }
    let (patience, said) = negotiate::patience(&headers);
    if said && !patience.is_zero() {
        // a record would hold an interest in the computation
        wait(app.desk.jobs.get(&job).map(|record| record.ended.subscribe()), patience).await;
    }
    jobs::accepted(&app, &job, said.then_some(patience.as_secs()))
}

/// Waits for the end of a job or batch, for at most `patience`.
pub(super) async fn wait(ended: Option<watch::Receiver<bool>>, patience: Duration) {
    let Some(mut ended) = ended else { return };
    let _ = tokio::time::timeout(patience, ended.wait_for(|ended| *ended)).await;
}

/// Parses the terms of a job from the query; its priority defaults to `usual`.
///
/// # Errors
/// Every fault of the query.
pub(super) fn terms(query: &str, usual: Priority) -> Result<JobTerms, Vec<Fault>> {
    let (mut terms, mut faults) = (JobTerms { priority: usual, ..JobTerms::default() }, repeated(query));
    for (name, value) in form_urlencoded::parse(query.as_bytes()) {
        let place = format!("?{}", shortened(&name));
        match &*name {
            "priority" => {
                if let Some(priority) = Priority::ALL.into_iter().find(|priority| priority.name() == value) {
                    terms.priority = priority;
                } else {
                    let detail = format!("\"{}\" is no priority; give interactive or batch", shortened(&value));
                    faults.push(Fault::new(place, detail));
                }
            }
            "queue_timeout_s" => keep(seconds(place, &value), &mut terms.queue_timeout_s, &mut faults),
            "run_timeout_s" => keep(seconds(place, &value), &mut terms.run_timeout_s, &mut faults),
            _ => {
                let known = ["priority", "queue_timeout_s", "run_timeout_s"];
                let meant = did_you_mean(&name, known);
                let detail = format!("it is unknown; {meant}known are {}", known.join(", "));
                faults.push(Fault::new(place, detail));
            }
        }
    }
    if faults.is_empty() { Ok(terms) } else { Err(faults) }
}

fn keep(found: Result<u64, Fault>, place: &mut Option<u64>, faults: &mut Vec<Fault>) {
    match found {
        Ok(value) => *place = Some(value),
        Err(fault) => faults.push(fault),
    }
}

fn seconds(place: String, text: &str) -> Result<u64, Fault> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let found = text.parse().ok().filter(|seconds| is_number && (1..=MAX_JOB_SECONDS).contains(seconds));
    found.ok_or_else(|| {
        let detail = format!("\"{}\" is no number of seconds from 1 to {MAX_JOB_SECONDS}", shortened(text));
        Fault::new(place, detail)
    })
}
