//! GET and HEAD /v1/artifacts/{id}.{ext}: immutable bytes.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::address::{etag, of_extension};
use super::answer::{self, Artifact, Lost};
use super::app::{App, SharedApp};
use super::client::Client;
use super::negotiate;
use super::problem::{self, Problem};
use super::segment::PathSegment;
use super::variants::coded;
use super::working::{self, ParsedJob};
use crate::job::Form;
use crate::job::key::Key;
use crate::output::{FORMATS, Format};
use crate::service::job_key::Tenant;
use crate::service::jobs::Record;
use crate::service::peer::Peer;

/// The bytes of an artifact: immutable, with a strong `ETag` and byte ranges.
#[utoipa::path(
    get, path = "/v1/artifacts/{file}", tag = "jobs",
    params(
        ("file" = String, Path, description = "Key of the artifact (64 hexadecimal digits), a dot, and the extension \
            of its format",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2.obj"),
        ("Range" = Option<String>, Header, description = "One range of bytes, `bytes=first-last`"),
        ("If-Range" = Option<String>, Header, description = "An ETag; where it is another, `Range` is ignored"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
        ("Accept-Encoding" = Option<String>, Header, description = "Codings that the client reads, of `zstd`, `br` \
            and `gzip`; ranges are those of the coded bytes"),
    ),
    responses(
        (status = 200, description = "The bytes"),
        (status = 206, description = "The part of them that `Range` asked for"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn artifact(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(file): PathSegment,
    method: Method,
    mut headers: HeaderMap,
) -> Result<Response, Problem> {
    if method == Method::HEAD {
        headers.remove(header::RANGE); // ranges are for GET alone (RFC 9110, 14.2)
    }
    let unknown = || {
        let detail =
            "there is no artifact of this name; an address is /v1/artifacts/{64 hexadecimal digits}.{extension}";
        Problem::new(problem::NOT_FOUND, detail)
    };
    let (id, extension) = file.split_once('.').ok_or_else(unknown)?;
    let key = Key::parse(id).ok_or_else(unknown)?;
    if let Some(manifest) = app.desk.find_artifact(key, client.peer()).await {
        // a damaged artifact has been dropped from the store, and is computed again if its job is known
        match respond_with(&app, &key, extension, &headers, Artifact::kept(manifest, client.peer())).await? {
            Err(Lost::Gone) => {}
            answered => return Ok(answered?),
        }
    }
    let found = made_again(&app, client.peer(), client.tenant(), &key).await?;
    Ok(respond_with(&app, &key, extension, &headers, found).await??)
}

/// Returns the answer about an artifact that was found.
async fn respond_with(
    app: &Arc<App>,
    key: &Key,
    extension: &str,
    headers: &HeaderMap,
    found: Artifact,
) -> Result<Result<Response, Lost>, Problem> {
    let of_formats = FORMATS.iter().map(|format| (format.media_type(), format.extension()));
    let of_forms = Form::ALL.iter().map(|form| (form.media_type(), form.extension()));
    let fits = |(media_type, _): &(&str, &str)| *media_type == found.manifest.media_type;
    let extensions: Vec<&str> = of_formats.chain(of_forms).filter(fits).map(|(_, extension)| extension).collect();
    if !extensions.contains(&extension) {
        let right = extensions.first().map(|right| of_extension(key, right)).unwrap_or_default();
        return Err(Problem::new(problem::NOT_FOUND, format!("the artifact has another extension: {right}")));
    }
    let address = format!("/v1/artifacts/{key}.{extension}");
    let lasting = HeaderValue::from_static("public, max-age=31536000, immutable");
    if let Some(tag) = negotiate::has_kept(headers, key) {
        let mut head = answer::headers(&found, &address);
        head.insert(header::CACHE_CONTROL, lasting);
        head.remove(header::CONTENT_TYPE);
        if let Ok(tag) = HeaderValue::try_from(tag) {
            head.insert(header::ETAG, tag);
        }
        return Ok(Ok((StatusCode::NOT_MODIFIED, head).into_response()));
    }
    let found = coded(app, headers, found).await;
    let mut head = answer::headers(&found, &address);
    head.insert(header::CACHE_CONTROL, lasting);
    let range = negotiate::range(headers, &etag(key, found.coding()), found.sent().length);
    Ok(answer::bytes(app, found, head, range).await)
}

/// Computes an artifact again that is no longer stored, if its job, or a batch with this job, is known.
///
/// # Errors
/// An artifact whose job is unknown, and every reason to refuse the job now.
pub(super) async fn made_again(app: &Arc<App>, peer: Peer, tenant: Tenant, key: &Key) -> Result<Artifact, Problem> {
    let Some((request, format)) = request_of(app, tenant, key) else {
        let detail = "this artifact is not kept here; send its job to /v1/render, and it will have this address";
        return Err(Problem::new(problem::NOT_FOUND, detail));
    };
    // the job was valid when it was accepted, so what it refers to has left, such as an upload
    let outdated = |problem: Problem| match problem.faults() {
        Ok(faults) => {
            let why = faults.first().map_or_else(String::new, ToString::to_string);
            Problem::new(problem::GONE, format!("the result is no longer kept, and cannot be made again: {why}"))
        }
        Err(problem) => problem,
    };
    let mut asked = working::read_again(app, peer, request, format).await.map_err(outdated)?;
    if let ParsedJob::Render(read) = &mut asked
        && let Some(detail) = read.job.detail(key)
    {
        // the key is that of a file to which a result of the job refers
        read.job = detail;
    }
    let work = asked.work(app, peer).await?;
    let gone = || Problem::new(problem::GONE, "the job of this artifact has become another one; send it again");
    let task = work.tasks.into_iter().find(|task| task.key() == *key).ok_or_else(gone)?;
    let interest = app.desk.compute(task.clone(), peer)?;
    let outcome = interest.computation.outcome().await;
    let outcome = outcome.map_err(|failure| Problem::of_failure(failure, |fault| task.fault(fault)))?;
    Ok(Artifact::made(&outcome, interest.provenance, peer))
}

/// Returns the request of a job that made the artifact of this key, and the format of its first output. Artifacts that
/// a job has not made, as it failed or was cancelled, are not computed because a client looks for them.
fn request_of(app: &App, tenant: Tenant, key: &Key) -> Option<(Bytes, &'static dyn Format)> {
    if let Some(record) = app.desk.jobs.of_artifact(tenant, key).filter(Record::may_be_made_again) {
        return Some((record.summary.request.clone(), record.summary.products.first()?.format));
    }
    let (batch, at) = app.desk.batches.of_artifact(tenant, key)?;
    let ending = batch.items.get(at)?.ending.clone()?;
    let text = batch.request.layout.text(&batch.request.text, at);
    Some((text.into(), ending.outputs.first()?.0.format))
}
