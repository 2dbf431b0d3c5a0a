//! POST and GET /v1/batches, GET and DELETE /v1/batches/{id}, its events and its cancellation: lists of jobs, and
//! grids.

use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

use super::address::address;
use super::app::{App, SharedApp};
use super::client::Client;
use super::content::AcceptedBodies;
use super::feed::{self, Followed};
use super::problem::{self, Problem};
use super::segment::PathSegment;
use super::{batch_checks, body, jobs, negotiate, posting};
use crate::service::accepting::NotAccepted;
use crate::service::batches::BatchStanding;
use crate::service::job_key::{JobKey, Priority};
use crate::service::jobs::JobPhase;
use crate::service::lent::Lent;
use crate::service::peer::Peer;
use crate::wire::batch::BatchRequest;
use crate::wire::batch_standing::{BatchAnswer, BatchProgress, BatchesAnswer};

/// Accepts a batch: a list of jobs, or a template and a grid whose every combination of values is a job.
///
/// All jobs are checked first; a fault points into the job (`/jobs/7/levels`), into the template, or to the value of an
/// axis (`/grid/0/values/2`). Then they are done as jobs of /v1/jobs are, a few at a time; one that fails leaves the
/// others, and the batch is `failed` in the end. The same batch posted again is the same resource; one that failed or
/// was cancelled is begun again (`attempts`), and what is done of it is not done twice. An accepted batch outlasts its
/// request, its client, and, where the service has a data directory, the process.
#[utoipa::path(
    post, path = "/v1/batches", tag = "jobs",
    params(
        ("Prefer" = Option<String>, Header, description = "`wait=N` waits N seconds at most for the end of the batch"),
        ("priority" = Option<String>, Query,
            description = "`batch` (default): its jobs stand back behind interactive ones; or `interactive`"),
        ("queue_timeout_s" = Option<u64>, Query,
            description = "Longest time that each job may wait for its turn; it fails after it"),
        ("run_timeout_s" = Option<u64>, Query,
            description = "Longest time from the turn of each job to its end; it fails after it"),
    ),
    request_body = BatchRequest,
    responses(
        (status = 200, description = "It is done already, or was within the wait, or has failed in it",
            body = BatchAnswer),
        (status = 202, description = "It is accepted; `Location` is where it stands", body = BatchAnswer),
    )
)]
pub(super) async fn post_batch(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    RawQuery(query): RawQuery,
    body: Body,
) -> Result<Response, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    let terms = posting::terms(query.as_deref().unwrap_or_default(), Priority::Batch).map_err(Problem::invalid)?;
    let (id, layout) = batch_checks::read(&app, client.peer(), &sent).await?;
    let batch = JobKey { tenant: client.tenant(), id };
    if app.desk.batches.join(&batch) {
        app.desk.batches.written(batch).await.map_err(NotAccepted::from)?;
    } else {
        let request = batch_checks::checked(&app, &client, &sent, layout).await?;
        app.desk.accept_batch(batch, request, terms, client.peer()).await?;
    }
    let (patience, said) = negotiate::patience(&headers);
    if said && !patience.is_zero() {
        let ended = app.desk.batches.get(&batch).map(|batch| batch.ended.subscribe());
        posting::wait(ended, patience).await;
    }
    let standing = app.desk.batch_standing(&batch).ok_or_else(unknown)?;
    let status = if standing.phase.is_settled() { StatusCode::OK } else { StatusCode::ACCEPTED };
    let response = state_response(&app, client.peer(), status, &standing)?;
    Ok(jobs::with_location(response, &format!("/v1/batches/{id}"), said.then_some(patience.as_secs())))
}

/// How a batch stands: counts, and each of its jobs with state, cache and outputs.
#[utoipa::path(
    get, path = "/v1/batches/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "How it stands", body = BatchAnswer),
    )
)]
pub(super) async fn batch(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<Response, Problem> {
    let standing = client.named(&id).and_then(|batch| app.desk.batch_standing(&batch)).ok_or_else(unknown)?;
    state_response(&app, client.peer(), StatusCode::OK, &standing)
}

/// Batches, the newest first, by pages, without their jobs.
#[utoipa::path(
    get, path = "/v1/batches", tag = "jobs",
    params(
        ("limit" = Option<u64>, Query, description = "Most batches of the page, 1 to 100; 50 when left out",
            example = 20),
        ("cursor" = Option<String>, Query, description = "`next` of the page before"),
    ),
    responses(
        (status = 200, description = "A page of them", body = BatchesAnswer, example = json!({ "batches": [] })),
    )
)]
pub(super) async fn list_batches(
    State(app): State<SharedApp>,
    client: Client,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let (before, limit) = jobs::page(query.as_deref().unwrap_or_default())?;
    let (batches, is_more) = app.desk.batches.page(client.tenant(), before, limit);
    let next = batches.last().filter(|_| is_more).map(|batch| batch.number.to_string());
    let brief = |batch| BatchAnswer::brief(&app.desk.standing_of_batch(batch));
    let batches = batches.into_iter().map(brief).collect();
    Ok(([(header::CACHE_CONTROL, "no-cache")], axum::Json(BatchesAnswer { batches, next })).into_response())
}

/// Cancels a batch: its jobs that nobody else wants are cancelled, and what is done stays. The batch stays known;
/// posted again, what is missing is done.
#[utoipa::path(
    post, path = "/v1/batches/{id}/cancel", tag = "jobs",
    params(("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "It had come to its end before", body = BatchAnswer),
        (status = 202, description = "It is cancelled", body = BatchAnswer),
    )
)]
pub(super) async fn cancel_batch(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<Response, Problem> {
    let batch = client.named(&id).ok_or_else(unknown)?;
    let status = if app.desk.cancel_batch(&batch) { StatusCode::ACCEPTED } else { StatusCode::OK };
    app.desk.batch_written(&batch).await?;
    let standing = app.desk.batch_standing(&batch).ok_or_else(unknown)?;
    state_response(&app, client.peer(), status, &standing)
}

/// Forgets a batch; when it is still under way it is cancelled. Its results and the jobs that are done stay.
#[utoipa::path(
    delete, path = "/v1/batches/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 204, description = "It is forgotten"),
    )
)]
pub(super) async fn forget_batch(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<StatusCode, Problem> {
    let batch = client.named(&id).filter(|batch| app.desk.forget_batch(batch)).ok_or_else(unknown)?;
    app.desk.batch_written(&batch).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// What happens to a batch, as it happens: the events, numbers and heartbeat of /v1/jobs/{id}/events, with `progress`
/// telling state, progress and counts.
#[utoipa::path(
    get, path = "/v1/batches/{id}/events", tag = "jobs",
    params(
        ("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2"),
        ("Last-Event-ID" = Option<String>, Header, description = "The number of the last event that the client saw"),
    ),
    responses(
        (status = 200, description = "The events; the data of `state` and `done` is a `BatchAnswer`",
            body = serde_json::Value, content_type = "text/event-stream",
            example = "id: 4294968297\nevent: progress\ndata: {\"state\":\"running\",\"progress\":0.0}\n\n"),
        (status = 204, description = "The client has seen the end"),
    )
)]
pub(super) async fn batch_events(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let batch = client.named(&id).ok_or_else(unknown)?;
    let standing = app.desk.batch_standing(&batch).ok_or_else(unknown)?;
    let ended = standing.batch.ended.subscribe();
    let look: feed::StateLookup = Box::new(move |app| Some(Box::new(app.desk.batch_standing(&batch)?)));
    feed::stream(&app, (&client, &headers), Box::new(standing), ended, look)
}

impl Followed for BatchStanding {
    fn sequence(&self) -> u64 {
        Self::sequence(self)
    }

    fn phase(&self) -> &JobPhase {
        &self.phase
    }

    fn whole(&self) -> Value {
        json!(answer(self))
    }

    fn progress(&self) -> Value {
        json!(BatchProgress::new(self))
    }
}

/// Returns the answer about an unknown batch.
pub(super) fn unknown() -> Problem {
    Problem::new(
        problem::NOT_FOUND,
        "there is no batch of this id; send it to /v1/batches, it has the same id each time",
    )
}

fn answer(standing: &BatchStanding) -> BatchAnswer {
    BatchAnswer::new(standing, |product| address(product.key, product.format))
}

/// Returns the answer with the state of a batch; its memory is charged to the client.
fn state_response(
    app: &Arc<App>,
    peer: Peer,
    status: StatusCode,
    standing: &BatchStanding,
) -> Result<Response, Problem> {
    let text = Bytes::from(json!(answer(standing)).to_string());
    let paid = app.desk.charge_answer(peer, text.len() as u64)?;
    let kind = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-cache")];
    let mut response = (status, kind, Body::from(Lent::new(text, paid))).into_response();
    if !standing.phase.is_settled() {
        response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    }
    Ok(response)
}
