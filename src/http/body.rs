//! Request bodies: bounded in length and in silence, read as JSON on the blocking pool when they are long.

use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, header};
use http_body_util::BodyExt;
use serde::de::DeserializeOwned;

use super::App;
use super::problem::{self, Problem};
use crate::job::limits::in_bytes;
use crate::math::parameter::shortened;
use crate::wire::read::read;

/// Bodies up to this length are parsed where they arrive; longer ones on the blocking pool.
const SHORT_BYTES: usize = 16 << 10;

/// Of a body that is refused, so much is read and forgotten at most.
const DRAINED_BYTES: u64 = 64 << 20;

/// Reads the body of a request as JSON.
///
/// # Errors
/// 415, 413, 408, 400, 422.
pub(super) async fn json<T>(app: &App, headers: &HeaderMap, body: Body) -> Result<T, Problem>
where
    T: DeserializeOwned + Send + 'static,
{
    let bytes = collect(app, headers, body).await?;
    off_loop(bytes.len(), move || read(&bytes).map_err(Problem::from)).await
}

/// Runs work on a request of so many bytes here when it is short, on the blocking pool when it is long.
pub(super) async fn off_loop<T: Send + 'static>(
    bytes: usize,
    work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
) -> Result<T, Problem> {
    if bytes <= SHORT_BYTES {
        return work();
    }
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| {
        tracing::error!(%error, "work on a request panicked");
        Err(Problem::new(problem::INTERNAL, "the request made planish fail; please report it"))
    })
}

/// The bytes of a body that says it is JSON.
pub(super) async fn collect(app: &App, headers: &HeaderMap, mut body: Body) -> Result<Bytes, Problem> {
    let collected = collected(app, headers, &mut body).await;
    let is_coming =
        collected.as_ref().is_err_and(|problem| !problem.is(problem::SLOW) && !problem.is(problem::NOT_JSON));
    if is_coming && !headers.contains_key(header::EXPECT) && announced(headers).unwrap_or(0) <= DRAINED_BYTES {
        drain(body, Duration::from_secs(app.settings.body_timeout_s)).await;
    }
    collected
}

/// Reads the rest of a refused body and forgets it: most clients read no answer before they have sent everything.
async fn drain(mut body: Body, most: Duration) {
    let mut left = DRAINED_BYTES;
    let reading = async {
        while let Some(Ok(frame)) = body.frame().await {
            let length = frame.data_ref().map_or(0, Bytes::len) as u64;
            let Some(rest) = left.checked_sub(length) else { return };
            left = rest;
        }
    };
    // a client that takes longer than `most` has to do without the answer
    let _ = tokio::time::timeout(most, reading).await;
}

/// The length that the client says the body has.
fn announced(headers: &HeaderMap) -> Option<u64> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

async fn collected(app: &App, headers: &HeaderMap, body: &mut Body) -> Result<Bytes, Problem> {
    check_media_type(headers)?;
    let limit = app.settings.max_body_bytes;
    let too_long = |length: u64| {
        let detail = format!(
            "the body has {} bytes or more; this server reads {}: send a smaller input",
            length,
            in_bytes(limit.into())
        );
        Problem::new(problem::BODY_TOO_LONG, detail)
    };
    if let Some(length) = announced(headers).filter(|length| *length > limit) {
        return Err(too_long(length));
    }
    let silence = Duration::from_secs(app.settings.body_timeout_s);
    let mut bytes = Vec::new();
    loop {
        let frame = tokio::time::timeout(silence, body.frame()).await.map_err(|_| {
            Problem::new(
                problem::SLOW,
                format!("no byte of the body arrived for {} s; send it again", silence.as_secs()),
            )
        })?;
        let Some(frame) = frame else { return Ok(bytes.into()) };
        let frame = frame.map_err(|_| Problem::new(problem::NOT_JSON, "the body broke off; send it again"))?;
        let Ok(data) = frame.into_data() else { continue };
        if (bytes.len() + data.len()) as u64 > limit {
            return Err(too_long((bytes.len() + data.len()) as u64));
        }
        bytes.extend_from_slice(&data);
    }
}

/// Of the codings that a body may come in, only `chunked` is read, and only alone.
fn check_transfer_coding(headers: &HeaderMap) -> Result<(), Problem> {
    let is_chunked = |value: &HeaderValue| value.as_bytes().trim_ascii().eq_ignore_ascii_case(b"chunked");
    let mut codings = headers.get_all(header::TRANSFER_ENCODING).iter();
    match (codings.next(), codings.next()) {
        (None, _) => Ok(()),
        (Some(coding), None) if is_chunked(coding) => Ok(()),
        (Some(coding), _) => {
            let coding = shortened(coding.to_str().unwrap_or("?"));
            let detail =
                format!("Transfer-Encoding \"{coding}\" is not read; send the JSON as it is, or chunked alone");
            Err(Problem::new(problem::TRANSFER_CODING, detail))
        }
    }
}

fn check_media_type(headers: &HeaderMap) -> Result<(), Problem> {
    check_transfer_coding(headers)?;
    if let Some(encoding) =
        headers.get(header::CONTENT_ENCODING).filter(|value| !value.as_bytes().eq_ignore_ascii_case(b"identity"))
    {
        let encoding = shortened(encoding.to_str().unwrap_or("?"));
        let detail = format!("Content-Encoding \"{encoding}\" is not read; send the JSON as it is");
        return Err(Problem::new(problem::MEDIA_TYPE, detail));
    }
    let given = headers.get(header::CONTENT_TYPE).map(|value| value.to_str().unwrap_or("?"));
    let essence = given.map(|value| value.split(';').next().unwrap_or("").trim().to_ascii_lowercase());
    match essence.as_deref() {
        Some("application/json") => Ok(()),
        Some(other) => {
            let other = shortened(other);
            let detail = format!("Content-Type is {other}; send the job as Content-Type: application/json");
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
        None => {
            let detail = "Content-Type is missing; send the job as Content-Type: application/json";
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
    }
}
