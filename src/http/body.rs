//! Request bodies: bounded in length and in silence, read as JSON on the blocking pool when they are long.

use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, header};
use http_body_util::BodyExt;
use serde::de::DeserializeOwned;

use super::App;
use super::problem::{self, Problem};
use crate::job::limits::in_bytes;
use crate::wire::read::read;

/// Bodies up to this length are parsed where they arrive; longer ones on the blocking pool.
const SHORT_BYTES: usize = 16 << 10;

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
pub(super) async fn collect(app: &App, headers: &HeaderMap, body: Body) -> Result<Bytes, Problem> {
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
    let announced = headers.get(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse::<u64>().ok());
    if let Some(length) = announced.filter(|length| *length > limit) {
        return Err(too_long(length));
    }
    let silence = Duration::from_secs(app.settings.body_timeout_s);
    let mut body = body;
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

fn check_media_type(headers: &HeaderMap) -> Result<(), Problem> {
    if let Some(encoding) =
        headers.get(header::CONTENT_ENCODING).filter(|value| !value.as_bytes().eq_ignore_ascii_case(b"identity"))
    {
        let detail = format!("Content-Encoding {encoding:?} is not read; send the JSON as it is");
        return Err(Problem::new(problem::MEDIA_TYPE, detail));
    }
    let given = headers.get(header::CONTENT_TYPE).map(|value| value.to_str().unwrap_or("?"));
    let essence = given.map(|value| value.split(';').next().unwrap_or("").trim().to_ascii_lowercase());
    match essence.as_deref() {
        Some("application/json") => Ok(()),
        Some(other) => {
            let detail = format!("Content-Type is {other}; send the job as Content-Type: application/json");
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
        None => {
            let detail = "Content-Type is missing; send the job as Content-Type: application/json";
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
    }
}
