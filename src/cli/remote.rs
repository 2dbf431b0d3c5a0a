//! A client of a remote planish service: it retries while the service is busy, and polls jobs that take longer.

use std::sync::{Arc, Once};
use std::time::Duration;

use reqwest::header::{AUTHORIZATION, CONTENT_TYPE, LOCATION, RETRY_AFTER};
use reqwest::{Client, ClientBuilder, RequestBuilder, Response, StatusCode, Url};
use serde_json::Value;
use tokio::time::{Instant, sleep};

use super::error::{CliError, ExitKind};
use crate::fault::shortened;
use crate::http::trust;

/// Maximum time between two requests, whatever the service asks for. Half of it would send twice as many requests to a
/// service that is restarting; twice of it would notice late that the service is back.
const MAX_RETRY_WAIT: Duration = Duration::from_mins(1);
/// First delay of a retry if the service does not name one; each further delay is twice the last.
const FIRST_WAIT: Duration = Duration::from_millis(500);
/// Number of seconds that one request waits for the result before the job is polled; proxies cut requests that take a
/// minute. Half of it would send twice as many requests; twice of it would be cut by some proxies.
const HELD_S: u64 = 30;
/// Maximum silence of a service during a response: the time that it waits for a result, and some seconds.
const MAX_SILENCE: Duration = Duration::from_secs(HELD_S + 30);
/// Maximum number of bytes read of an error response.
const MAX_REFUSAL: usize = 1 << 20;

/// A remote service.
#[derive(Debug, Clone)]
pub(super) struct Remote {
    client: Client,
    url: String,
    key: Option<String>,
    patience: Duration,
    /// Prints the first retry only; `None` if the command is quiet.
    notes: Option<Arc<Once>>,
}

/// Returns a builder of an HTTP client for the service at the address that this flag gives.
///
/// # Errors
/// When it is no address of a service, or no client can be made.
pub(super) fn client(flag: &str, url: &str) -> Result<ClientBuilder, CliError> {
    let tls = match Url::parse(url).as_ref().map(Url::scheme) {
        Ok("https") => trust::tls(),
        Ok("http") => trust::none(),
        _ => {
            let detail = format!("{flag}: {} is no address; write http://HOST:PORT or https://HOST", shortened(url));
            return Err(CliError::usage(detail));
        }
    };
    Ok(Client::builder().no_proxy().tls_backend_preconfigured(tls.map_err(CliError::other)?))
}

/// The reason why a request failed.
enum Failed {
    /// A temporary failure: the delay that the service asks for, if any, and the reason.
    ForNow(Option<Duration>, String),
    /// A permanent failure.
    ForGood(CliError),
}

impl From<CliError> for Failed {
    fn from(error: CliError) -> Self {
        Self::ForGood(error)
    }
}

impl Remote {
    /// Creates a client of the service at `url`, which gives up a job after `patience`.
    pub(super) fn new(url: &str, key: Option<&str>, patience: Duration, is_quiet: bool) -> Result<Self, CliError> {
        let client = client("--server", url)?.read_timeout(MAX_SILENCE).connect_timeout(Duration::from_secs(10));
        let client = client.build().map_err(CliError::other)?;
        let (url, key) = (url.trim_end_matches('/').to_owned(), key.map(str::to_owned));
        let notes = (!is_quiet).then(|| Arc::new(Once::new()));
        Ok(Self { client, url, key, patience, notes })
    }

    /// Renders a job and returns the bytes of its result; `begun` is when its input was begun.
    pub(super) async fn render(&self, job: &Value, begun: Instant) -> Result<Vec<u8>, CliError> {
        let body = job.to_string();
        let ask = || {
            let request = self.client.post(self.address("/v1/render")).header(CONTENT_TYPE, "application/json");
            request.header("prefer", format!("wait={HELD_S}")).body(body.clone())
        };
        self.patiently(begun, async || {
            let response = self.sent(ask()).await?;
            if response.status() != StatusCode::ACCEPTED {
                return whole(response).await;
            }
            let place = place(&response)
                .ok_or_else(|| self.strange("202 for a job, without a Location on this service where it stands"))?;
            self.followed(&place, begun).await
        })
        .await
    }

    /// Uploads a mesh file and returns its id; `begun` is when its input was begun.
    pub(super) async fn upload(&self, bytes: &[u8], media_type: &str, begun: Instant) -> Result<String, CliError> {
        let ask = || self.client.post(self.address("/v1/blobs")).header(CONTENT_TYPE, media_type).body(bytes.to_vec());
        let answer = self.patiently(begun, async || whole(self.sent(ask()).await?).await).await?;
        let answer: Value = serde_json::from_slice(&answer).map_err(|error| self.strange(&error.to_string()))?;
        answer["id"].as_str().map(str::to_owned).ok_or_else(|| self.strange("an upload has no id"))
    }

    /// Repeats a request after temporary failures, until `patience` has passed since `begun`.
    async fn patiently<T>(&self, begun: Instant, ask: impl AsyncFn() -> Result<T, Failed>) -> Result<T, CliError> {
        let mut wait = FIRST_WAIT;
        loop {
            let (after, why) = match ask().await {
                Ok(answer) => return Ok(answer),
                Err(Failed::ForGood(error)) => return Err(error),
                Err(Failed::ForNow(after, why)) => (after, why),
            };
            let pause = after.unwrap_or(wait).clamp(FIRST_WAIT, MAX_RETRY_WAIT);
            if begun.elapsed() + pause > self.patience {
                let seconds = self.patience.as_secs();
                return Err(CliError::files(format!("{} gave no result within {seconds} s: {why}", self.url)));
            }
            if let Some(notes) = &self.notes {
                let (url, seconds) = (&self.url, self.patience.as_secs());
                notes.call_once(|| eprintln!("planish: {url} is asked again, for up to {seconds} s: {why}"));
            }
            sleep(pause).await;
            wait = wait.saturating_mul(2);
        }
    }

    /// Polls a job until it ends or `patience` has passed since `begun`, and fetches its first result.
    async fn followed(&self, place: &str, begun: Instant) -> Result<Vec<u8>, Failed> {
        loop {
            let response = self.sent(self.client.get(self.address(place))).await?;
            let pause = after(&response).unwrap_or(Duration::from_secs(1)).clamp(FIRST_WAIT, MAX_RETRY_WAIT);
            let status = whole(response).await?;
            let status: Value = serde_json::from_slice(&status).map_err(|error| self.strange(&error.to_string()))?;
            match status["state"].as_str() {
                Some("queued" | "running") if begun.elapsed() < self.patience => sleep(pause).await,
                Some("done") => {
                    let href = status["outputs"][0]["href"].as_str();
                    let href = href.ok_or_else(|| self.strange("a job that is done has no result"))?;
                    return whole(self.sent(self.client.get(self.address(href))).await?).await;
                }
                Some("failed") => {
                    let why = status["error"].as_str().unwrap_or("the job failed");
                    return Err(CliError::refused(why).into());
                }
                Some("cancelled") => return Err(CliError::other("the job was cancelled at the service").into()),
                Some("queued" | "running") => {
                    let seconds = self.patience.as_secs();
                    return Err(CliError::files(format!("the job is not finished after {seconds} s")).into());
                }
                _ => return Err(self.strange("a job is in no state that is known").into()),
            }
        }
    }

    fn address(&self, place: &str) -> String {
        format!("{}{place}", self.url)
    }

    fn strange(&self, why: &str) -> CliError {
        CliError::files(format!("{} answers as no planish does: {why}", self.url))
    }

    /// Sends a request and returns the response if its status is a success.
    async fn sent(&self, request: RequestBuilder) -> Result<Response, Failed> {
        let request =
            self.key.iter().fold(request, |request, key| request.header(AUTHORIZATION, format!("Bearer {key}")));
        let response = request.send().await.map_err(|error| transport_error(&error))?;
        let status = response.status();
        if status.is_success() {
            return Ok(response);
        }
        let (after, text) = (after(&response), refusal(response).await);
        match status.as_u16() {
            429 | 502..=504 => Err(Failed::ForNow(after, text.detail)),
            401 | 403 => Err(CliError::usage(format!("--key: {}", text.detail)).into()),
            _ => Err(Failed::ForGood(CliError { kind: text.kind(status), details: text.lines() })),
        }
    }
}

/// The contents of an error response.
struct Refused {
    slug: String,
    detail: String,
    errors: Vec<String>,
}

impl Refused {
    /// Returns the kind of error that the same problem would have locally.
    fn kind(&self, status: StatusCode) -> ExitKind {
        match (self.slug.as_str(), status.as_u16()) {
            ("too-large" | "body-too-long" | "timed-out", _) | (_, 413) => ExitKind::TooLarge,
            (_, 400..500) => ExitKind::Refused,
            _ => ExitKind::Files,
        }
    }

    fn lines(self) -> Vec<String> {
        if self.errors.len() > 1 { self.errors } else { vec![self.detail] }
    }
}

/// Reads a problem document, or the error response of a proxy.
async fn refusal(mut response: Response) -> Refused {
    let (status, mut bytes) = (response.status(), Vec::new());
    while let Ok(Some(chunk)) = response.chunk().await {
        bytes.extend_from_slice(&chunk);
        if bytes.len() > MAX_REFUSAL {
            break;
        }
    }
    let problem: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let error = |error: &Value| match (text(&error["pointer"]), text(&error["detail"])) {
        (pointer, detail) if pointer.is_empty() => detail,
        (pointer, detail) => format!("{pointer}: {detail}"),
    };
    let slug = text(&problem["type"]).rsplit('/').next().unwrap_or_default().to_owned();
    let detail = Some(text(&problem["detail"])).filter(|detail| !detail.is_empty());
    let errors = problem["errors"].as_array().into_iter().flatten().map(error).collect();
    Refused { slug, detail: detail.unwrap_or_else(|| format!("it answers {status}")), errors }
}

/// Reads the whole body of a response.
async fn whole(response: Response) -> Result<Vec<u8>, Failed> {
    Ok(response.bytes().await.map_err(|error| transport_error(&error))?.to_vec())
}

fn transport_error(error: &reqwest::Error) -> Failed {
    Failed::ForNow(None, format!("no answer: {}", innermost(error)))
}

/// Returns the message of the innermost cause of an error; the outer messages add nothing.
pub(super) fn innermost(mut error: &dyn std::error::Error) -> String {
    while let Some(source) = error.source() {
        error = source;
    }
    error.to_string()
}

/// Returns the delay in the header `Retry-After`, in seconds.
fn after(response: &Response) -> Option<Duration> {
    let seconds = response.headers().get(RETRY_AFTER)?.to_str().ok()?.trim().parse().ok()?;
    Some(Duration::from_secs(seconds))
}

/// Returns the path of the job in the header `Location`.
fn place(response: &Response) -> Option<String> {
    let place = response.headers().get(LOCATION)?.to_str().ok()?;
    place.starts_with('/').then(|| place.to_owned())
}
