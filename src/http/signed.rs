//! GET /v1/r/{signature}/{expiry}/...: resources that a signed address opens to everybody until it expires. The gate
//! has checked the signature.

use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, HeaderValue, Method, Uri, header};
use axum::response::Response;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::read::DeflateDecoder;

use super::app::SharedApp;
use super::body::Sent;
use super::client::{Client, Credentials};
use super::links::{check_length, inflated, respond};
use super::problem::{self, Problem};
use super::render::ResultRequest;
use super::segment::PathSegment;
use super::{artifacts, batches, events, memo, render};
use crate::config::keys::MODEL;
use crate::fault::{Fault, shortened};
use crate::job::key::Key;
use crate::output::FORMATS;

/// Maximum time for which caches may store the result of a signed address, in seconds: as for other addresses of jobs.
const MAX_AGE_S: u64 = 86_400;

/// The path parameters of a signed address: signature, expiry, and one name.
type SignedPath = Result<Path<(String, String, String)>, PathRejection>;

/// Renders the job of a signed address, and answers with the bytes: what `<img>` and `<model-viewer>` show without a
/// key.
///
/// `signature` is the id of a key, a dot, and base64url of HMAC-SHA256 over the lines `GET`, the expiry and the rest of
/// the path, by the link secret of the key; `planish sign` makes it. The rest is the job's JSON as raw deflate (RFC
/// 1951) in base64url, at most 64 KiB, and the extension of its format. A result that is not there in time is answered
/// 503, and is kept for whoever asks again.
#[utoipa::path(
    get, path = "/v1/r/{signature}/{expiry}/{job}", tag = "jobs",
    params(
        ("signature" = String, Path, description = "The id of a key, a dot, and the signature in base64url",
            example = "0123456789ab.X7mGv0l4gk3hVw0bT0zv5mJ8m3mE3v0m0Yw6vQp1r2s"),
        ("expiry" = u64, Path, description = "When the address ends, seconds since 1970", example = 1_893_456_000),
        ("job" = String, Path, description = "The job as JSON, compressed by raw deflate, in base64url; a dot and the \
            extension of its format",
            example = "q1bKzCsoLVGyqlYqyM-pTM_PU7JSKsjPzCspVrKKjjbUMdAxiNWJNtYx0DEEUoY6hrGxOgrJOfnFqSlAJbXVtQA.svg"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
    ),
    responses(
        (status = 200, description = "The bytes of the result"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn signed(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    uri: Uri,
    path: SignedPath,
) -> Result<Response, Problem> {
    let Path((.., job)) = path.map_err(no_text)?;
    shown(&app, &client, headers, &uri, &job).await
}

/// The model of the job of a signed address, `model.gltf`, and the buffers to which it refers: glTF with levels of
/// detail (`lod`), which loaders look for beside it.
///
/// The signature is over the path with `model.gltf`, and opens the buffers of that job as well.
#[utoipa::path(
    get, path = "/v1/r/{signature}/{expiry}/{job}/{file}", tag = "jobs",
    params(
        ("signature" = String, Path, description = "As for jobs in signed addresses",
            example = "0123456789ab.X7mGv0l4gk3hVw0bT0zv5mJ8m3mE3v0m0Yw6vQp1r2s"),
        ("expiry" = u64, Path, description = "When the address ends, seconds since 1970", example = 1_893_456_000),
        ("job" = String, Path, description = "The job as JSON, compressed by raw deflate, in base64url",
            example = "q1bKzCsoLVGyqlYqyM-pTM_PU7JSKsjPzCspVrKKjjbUMdAxiNWJNtYx0DEEUoY6hrGxOgrJOfnFqSlAJbXVtQA"),
        ("file" = String, Path, description = "`model.gltf`, or the name of a buffer that it refers to",
            example = "model.gltf"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
    ),
    responses(
        (status = 200, description = "The model, or the bytes of the buffer"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn signed_model(
    State(app): State<SharedApp>,
    client: Client,
    mut headers: HeaderMap,
    method: Method,
    uri: Uri,
    path: Result<Path<(String, String, String, String)>, PathRejection>,
) -> Result<Response, Problem> {
    let Path((.., job, file)) = path.map_err(no_text)?;
    let named = format!("{job}.gltf");
    if file == MODEL {
        return shown(&app, &client, headers, &uri, &named).await;
    }
    let detail = "the model of this address refers to no such file; its document names its buffers";
    let other = || Problem::new(problem::NOT_FOUND, detail);
    let key = file.strip_suffix(".bin").and_then(Key::parse).ok_or_else(other)?;
    check_length(&uri)?;
    let wanted = wanted_by(&client, &mut headers, &named)?;
    let read = render::read(&app, &client, &headers, wanted.sent).await?;
    read.job.detail_keys().find(|detail| *detail == key).ok_or_else(other)?;
    drop(read);
    artifacts::artifact(State(app), client, PathSegment(file), method, headers).await
}

/// Answers with the result of the job in a signed address.
async fn shown(
    app: &SharedApp,
    client: &Client,
    mut headers: HeaderMap,
    uri: &Uri,
    job: &str,
) -> Result<Response, Problem> {
    check_length(uri)?;
    let wanted = wanted_by(client, &mut headers, job)?;
    let mut response = respond(app, client, &headers, wanted).await?;
    if let (Credentials::Link(expires, ..), true) = (client.caller.shown, response.status().as_u16() < 400) {
        let age = expires.saturating_sub(app.desk.clock().wall().as_secs()).min(MAX_AGE_S);
        if let Ok(kept) = HeaderValue::try_from(format!("public, max-age={age}")) {
            response.headers_mut().insert(header::CACHE_CONTROL, kept);
        }
    }
    Ok(response)
}

/// The events of a job, by a signed address: `EventSource` of browsers sends no keys.
#[utoipa::path(
    get, path = "/v1/r/{signature}/{expiry}/jobs/{id}/events", tag = "jobs",
    params(
        ("signature" = String, Path, description = "As for jobs in signed addresses",
            example = "0123456789ab.X7mGv0l4gk3hVw0bT0zv5mJ8m3mE3v0m0Yw6vQp1r2s"),
        ("expiry" = u64, Path, description = "When the address ends, seconds since 1970", example = 1_893_456_000),
        ("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2"),
        ("Last-Event-ID" = Option<String>, Header, description = "The number of the last event that the client saw"),
    ),
    responses(
        (status = 200, description = "The events, as those of /v1/jobs/{id}/events", body = serde_json::Value,
            content_type = "text/event-stream",
            example = "id: 4294968297\nevent: progress\ndata: {\"state\":\"running\",\"progress\":0.0}\n\n"),
        (status = 204, description = "The client has seen the end"),
    )
)]
pub(super) async fn signed_events(
    app: State<SharedApp>,
    client: Client,
    path: SignedPath,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let Path((.., id)) = path.map_err(no_text)?;
    events::events(app, client, PathSegment(id), headers).await
}

/// The events of a batch, by a signed address.
#[utoipa::path(
    get, path = "/v1/r/{signature}/{expiry}/batches/{id}/events", tag = "jobs",
    params(
        ("signature" = String, Path, description = "As for jobs in signed addresses",
            example = "0123456789ab.X7mGv0l4gk3hVw0bT0zv5mJ8m3mE3v0m0Yw6vQp1r2s"),
        ("expiry" = u64, Path, description = "When the address ends, seconds since 1970", example = 1_893_456_000),
        ("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2"),
        ("Last-Event-ID" = Option<String>, Header, description = "The number of the last event that the client saw"),
    ),
    responses(
        (status = 200, description = "The events, as those of /v1/batches/{id}/events", body = serde_json::Value,
            content_type = "text/event-stream",
            example = "id: 4294968297\nevent: progress\ndata: {\"state\":\"running\",\"progress\":0.0}\n\n"),
        (status = 204, description = "The client has seen the end"),
    )
)]
pub(super) async fn signed_batch_events(
    app: State<SharedApp>,
    client: Client,
    path: SignedPath,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let Path((.., id)) = path.map_err(no_text)?;
    batches::batch_events(app, client, PathSegment(id), headers).await
}

/// The bytes of an artifact, by a signed address.
#[utoipa::path(
    get, path = "/v1/r/{signature}/{expiry}/artifacts/{file}", tag = "jobs",
    params(
        ("signature" = String, Path, description = "As for jobs in signed addresses",
            example = "0123456789ab.X7mGv0l4gk3hVw0bT0zv5mJ8m3mE3v0m0Yw6vQp1r2s"),
        ("expiry" = u64, Path, description = "When the address ends, seconds since 1970", example = 1_893_456_000),
        ("file" = String, Path, description = "As for /v1/artifacts/{file}",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2.obj"),
        ("Range" = Option<String>, Header, description = "One range of bytes, `bytes=first-last`"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
    ),
    responses(
        (status = 200, description = "The bytes"),
        (status = 206, description = "The part of them that `Range` asked for"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn signed_artifact(
    app: State<SharedApp>,
    client: Client,
    path: SignedPath,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let Path((.., file)) = path.map_err(no_text)?;
    artifacts::artifact(app, client, PathSegment(file), method, headers).await
}

fn no_text(_: PathRejection) -> Problem {
    Problem::new(problem::NOT_FOUND, "the address is no text in UTF-8; have it signed again")
}

/// Decodes the job in a signed address. The extension replaces the header `Accept`.
fn wanted_by(client: &Client, headers: &mut HeaderMap, named: &str) -> Result<ResultRequest, Problem> {
    let wrong = |detail: String| Problem::invalid(vec![Fault::new("", detail)]);
    let (job, extension) = named.rsplit_once('.').unwrap_or((named, ""));
    let of_extension = FORMATS.iter().filter(|format| format.extension() == extension);
    let media_types: Vec<&str> = of_extension.map(|format| format.media_type()).collect();
    if media_types.is_empty() {
        let detail = format!("\"{}\" is no extension of a format; /v1/formats lists them", shortened(extension));
        return Err(Problem::new(problem::NOT_FOUND, detail));
    }
    if let Ok(accepted) = HeaderValue::try_from(media_types.join(",")) {
        headers.insert(header::ACCEPT, accepted);
    }
    let bytes = URL_SAFE_NO_PAD.decode(job).map_err(|error| wrong(format!("the job is no base64url: {error}")))?;
    let not_deflated = |error| wrong(format!("the job is not compressed by raw deflate: {error}"));
    let sent = Sent::job(inflated(DeflateDecoder::new(&bytes[..]), not_deflated)?);
    let identity = memo::link_identity(client.tenant(), headers, named);
    Ok(ResultRequest { sent, identity: Some(identity), keep: false })
}
