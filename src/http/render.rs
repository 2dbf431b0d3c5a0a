//! POST /v1/render: one job with one output, answered with the bytes.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::Response;

use super::answer::{self, Artifact, Lost};
use super::app::{App, SharedApp};
use super::body::Sent;
use super::client::Client;
use super::content::Notation;
use super::early::Early;
use super::memo::RememberedRequest;
use super::negotiate::{self, ByteRange};
use super::problem::Problem;
use super::reading::ReadJob;
use super::variants::coded;
use super::{jobs, reading, streaming, working};
use crate::job::ResolvedLevel;
use crate::job::key::Key;
use crate::job::limits::Admitted;
use crate::service::driving::{self, stored_result};
use crate::service::job_key::JobKey;
use crate::service::peer::Paid;
use crate::service::task::Render;
use crate::wire::JobRequest;
use crate::wire::query::name_of;

/// Renders a job with one output and answers with its bytes.
///
/// The body is a job, or a mesh file of a type that /v1/readers lists; then, and only then, the query says the rest of
/// the job: `preset`, `word`, `levels`, `format`, `boundary`, `ends`, `seed`, and by names with dots everything else,
/// such as `parameters.w=1/16`, `output.width=800`, `input.weld=0`, `levels.tolerance=0.01`. Lists are one text with
/// commas, or JSON. The body may be compressed by gzip or zstd (`Content-Encoding`).
///
/// Without `outputs`, `Accept` chooses the format; with them it has to allow theirs, or the answer is 406.
/// `Prefer: wait=N` (default 30 s, at most 300 s) bounds the wait; after it the answer is 202 with the address of the
/// job.
///
/// A result of more than `keep_at_most_bytes` (see /v1/limits) is sent while it is made and not kept, unless the query
/// says `keep=true` or `Prefer` says `respond-async`. `Content-Length` is there where the length is known beforehand.
/// An answer that ends early is no result.
#[utoipa::path(
    post, path = "/v1/render", tag = "jobs",
    params(
        ("Prefer" = Option<String>, Header,
            description = "`wait=N` waits N seconds at most, `respond-async` alone not at all"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
        ("keep" = Option<bool>, Query,
            description = "`true` keeps the result even where it has more than `keep_at_most_bytes`"),
    ),
    request_body = JobRequest,
    responses(
        (status = 200, description = "The bytes of the result, in the format that `outputs` or `Accept` asks for; \
            where `levels` is a tolerance, `Planish-Level` and `Planish-Bound` say what it led to"),
        (status = 202, description = "Not finished in time; `Location` has the job",
            body = crate::wire::standing::JobAnswer),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn render(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    RawQuery(query): RawQuery,
    early: Early,
) -> Result<Response, Problem> {
    let (sent, identity) = (early.sent?, early.identity);
    let notation = sent.notation.clone();
    let wanted = ResultRequest { sent, identity, keep: streaming::asks_to_keep(query.as_deref())? };
    let answered = rendered(&app, &client, &headers, wanted).await;
    answered.map_err(|problem| match notation {
        Notation::Job | Notation::JobAs(_) => problem,
        Notation::File(..) => problem.at(name_of),
    })
}

/// A request for a result.
#[derive(Debug)]
pub(super) struct ResultRequest {
    /// The body of the request.
    pub(super) sent: Sent,
    /// The identity of the request.
    pub(super) identity: Option<Key>,
    /// Whether the result is to be stored, however large it is.
    pub(super) keep: bool,
}

/// Answers with the result of a job, or with 202 and the location of the job.
pub(super) async fn rendered(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    wanted: ResultRequest,
) -> Result<Response, Problem> {
    let ResultRequest { sent, identity: request, keep } = wanted;
    if let Some(response) = again(app, client, headers, request).await {
        return Ok(response);
    }
    let read = read(app, client, headers, sent).await?;
    let known = RememberedRequest::of(&read.job);
    if read.job.detail_keys().next().is_some() {
        return referring(app, client, headers, read, known).await;
    }
    if let Some(tag) = negotiate::has_already(headers, &known.key) {
        return Ok(not_modified(&known, tag));
    }
    if let Some(manifest) = app.desk.find_artifact(known.key, client.peer()).await {
        if let Some(tag) = negotiate::has_kept(headers, &known.key) {
            return Ok(not_modified(&known, tag));
        }
        // a damaged artifact has been dropped from the store, and is computed again
        match whole(app, headers, Artifact::kept(manifest, client.peer()), &known).await {
            Err(Lost::Gone) => {}
            answered => {
                remember(app, request, &known);
                return Ok(answered?);
            }
        }
    }
    let ReadJob { job, input, sent } = read;
    let admitted = reading::admit(app, client.peer(), job).await?;
    remember(app, request, &known);
    let mut patience = negotiate::patience(headers);
    if !keep && streaming::streams(app, &admitted, patience) {
        let streamed = streaming::streamed(app, client, admitted.clone(), input.clone(), patience.0).await?;
        if let Some(mut response) = streamed {
            add_resolved_level(known.reached, response.headers_mut());
            return Ok(response);
        }
        // no bytes came in time: the result is computed for a later request, if it can be stored
        streaming::check_kept(app, &admitted).map_err(|_| streaming::too_busy())?;
        patience.0 = Duration::ZERO;
    }
    streaming::check_kept(app, &admitted)?;
    made(app, client, headers, patience, (admitted, input, sent), known).await
}

/// Answers a job whose result refers to further files: it is computed or found like others, and a record of the job is
/// kept, from which the files are computed when they are requested.
async fn referring(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    ReadJob { job, input, sent }: ReadJob,
    known: RememberedRequest,
) -> Result<Response, Problem> {
    let admitted = reading::admit(app, client.peer(), job).await?;
    streaming::check_kept(app, &admitted)?;
    let tag = negotiate::has_already(headers, &known.key);
    let patience = negotiate::patience(headers);
    let answered = made(app, client, headers, patience, (admitted, input, sent), known.clone()).await?;
    let is_here = answered.status() == StatusCode::OK;
    Ok(tag.filter(|_| is_here).map_or(answered, |tag| not_modified(&known, tag)))
}

/// Remembers a request whose job was admitted, now or when its result was made.
fn remember(app: &Arc<App>, request: Option<Key>, known: &RememberedRequest) {
    if let Some(request) = request {
        app.memo.put(request, known.clone());
    }
}

/// Answers a repeated request whose result is in memory.
async fn again(app: &Arc<App>, client: &Client, headers: &HeaderMap, request: Option<Key>) -> Option<Response> {
    let known = app.memo.get(&request?)?;
    let manifest = app.desk.at_hand(&known.key, client.peer())?;
    if let Some(tag) = negotiate::has_kept(headers, &known.key) {
        return Some(not_modified(&known, tag));
    }
    whole(app, headers, Artifact::kept(manifest, client.peer()), &known).await.ok()
}

/// Computes the artifact, and answers with it or, if that takes longer than `patience`, with the location of the job.
async fn made(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    (patience, said): (Duration, bool),
    (admitted, input, sent): (Arc<Admitted>, Arc<Paid>, Sent),
    known: RememberedRequest,
) -> Result<Response, Problem> {
    let job = admitted.job();
    let id = JobKey { tenant: client.tenant(), id: job.id() };
    let entries = job.entries(&job.outputs[0]);
    let summary = |sent: &Sent| working::summary(&admitted, sent);
    // the further files are computed from the record
    let refers = job.detail_keys().next().is_some();
    // another request may have computed it during the forecast
    if let Some(manifest) = app.desk.at_hand(&known.key, client.peer())
        && let Ok(response) = whole(app, headers, Artifact::kept(manifest.clone(), client.peer()), &known).await
    {
        if refers {
            app.desk.record(id, summary(&sent), vec![stored_result(&manifest)], client.peer())?;
        }
        return Ok(response);
    }
    let interest = app.desk.compute(Arc::new(Render::new(admitted.clone(), 0, Some(input))), client.peer())?;
    let computation = interest.computation.clone();
    match tokio::time::timeout(patience, computation.outcome()).await {
        Ok(Ok(outcome)) => {
            if refers {
                app.desk.record(id, summary(&sent), vec![driving::computed_result(&outcome)], client.peer())?;
            }
            let found = Artifact::made(&outcome, interest.provenance, client.peer());
            Ok(whole(app, headers, found, &known).await?)
        }
        Ok(Err(failure)) => Err(Problem::of_failure(failure, |fault| entries.fault(fault))),
        Err(_) => {
            app.desk.detach(id, summary(&sent), interest, (client.peer(), entries)).await?;
            jobs::later(app, &id, said.then_some(patience.as_secs()))
        }
    }
}

async fn whole(
    app: &Arc<App>,
    headers: &HeaderMap,
    found: Artifact,
    known: &RememberedRequest,
) -> Result<Response, Lost> {
    let found = coded(app, headers, found).await;
    let mut head = answer::headers(&found, &known.address);
    add_resolved_level(known.reached, &mut head);
    answer::bytes(app, found, head, ByteRange::Whole).await
}

/// Reads and checks the job, and computes its keys.
pub(super) async fn read(app: &Arc<App>, client: &Client, headers: &HeaderMap, sent: Sent) -> Result<ReadJob, Problem> {
    let headers = headers.clone();
    reading::job(app, client.peer(), sent, 1, move |request| negotiate::settle(&headers, request)).await
}

/// Adds the level that a tolerance or "auto" resolved to, and for a tolerance the bound of the distance from the limit.
fn add_resolved_level(reached: Option<ResolvedLevel>, headers: &mut HeaderMap) {
    let Some(reached) = reached else { return };
    headers.insert(HeaderName::from_static("planish-level"), reached.level.into());
    if let Some(Ok(bound)) = reached.bound.map(|bound| HeaderValue::try_from(bound.to_string())) {
        headers.insert(HeaderName::from_static("planish-bound"), bound);
    }
}

fn not_modified(known: &RememberedRequest, tag: String) -> Response {
    let mut headers = HeaderMap::new();
    add_resolved_level(known.reached, &mut headers);
    headers.insert(HeaderName::from_static("cache-status"), HeaderValue::from_static("planish; hit"));
    answer::not_modified(headers, tag, &known.address)
}
