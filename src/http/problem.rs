//! Errors: every refusal as problem+json (RFC 9457), with a remedy.

use std::any::Any;
use std::time::Duration;

use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};

use super::trace::current_id;
use crate::fault::{Fault, cut, shortened};
use crate::job::JobFault;
use crate::job::limits::Refusal;
use crate::service::accepting::NotAccepted;
use crate::service::computation::Failure;
use crate::service::driving::Unreadable;
use crate::service::pool::Busy;
use crate::service::read_lane::ReadRefusal;
use crate::wire::answer::{FaultAnswer, ProblemAnswer};
use crate::wire::read::ReadError;

/// Maximum number of bytes of the faults in one answer: some hundred faults, more than a client mends at once. With the
/// detail, in which every character may be escaped by six, the whole answer stays below 64 KiB. Half or twice of it
/// halves or doubles the listed faults; twice of it passes 64 KiB.
const MAX_FAULT_BYTES: usize = 32 << 10;
/// Maximum number of characters of a detail: a place and a sentence of maximum length. Half of it may cut a sentence;
/// twice of it, escaped, would pass 64 KiB with the faults.
const MAX_PROBLEM_DETAIL: usize = 4000;

/// Retry-After for a shared store that did not answer: as long as the service leaves it alone after a failure. Half of
/// it makes clients ask in vain; twice of it makes them wait longer than necessary.
const RETRY_AFTER: Duration = Duration::from_secs(5);

/// A kind of problem: its slug, title and status, and the explanation on its page.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProblemKind {
    pub(super) slug: &'static str,
    pub(super) title: &'static str,
    pub(super) status: StatusCode,
    pub(super) doc: &'static str,
}

macro_rules! kinds {
    ($($name:ident: $slug:literal, $status:ident, $title:literal, $doc:literal;)*) => {
        $(pub(super) const $name: ProblemKind =
            ProblemKind { slug: $slug, title: $title, status: StatusCode::$status, doc: $doc };)*
        /// All kinds, for their pages.
        pub(super) const KINDS: &[ProblemKind] = &[$($name),*];
    };
}

kinds! {
    NOT_JSON: "not-json", BAD_REQUEST, "The body is not JSON",
        "The text of the request ends early or breaks the grammar of JSON. The detail names line and column.";
    NOT_HTTP: "not-http", BAD_REQUEST, "This is no HTTP request",
        "The bytes that arrived break the grammar of HTTP/1.1, or say two things at once about their length.";
    HEAD_TOO_LONG: "head-too-long", REQUEST_HEADER_FIELDS_TOO_LARGE, "The headers are too long",
        "The request's line and its headers have at most 64 KiB together, and there are at most 100 headers.";
    URI_TOO_LONG: "address-too-long", URI_TOO_LONG, "The address is too long",
        "An address has 64 KiB at most, and 8 KiB where it says a job. Jobs are sent in the body of a POST request, \
         where there is more room.";
    INVALID: "invalid-job", UNPROCESSABLE_ENTITY, "The job cannot be done",
        "The body is JSON, but no job: a field is unknown, missing or of the wrong kind, or the parts do not fit each \
         other. Every entry of `errors` points to one fault.";
    TOO_LARGE: "too-large", UNPROCESSABLE_ENTITY, "The result would be too large",
        "The exact counts of the result pass a limit of this server; see /v1/limits, and /v1/estimate to ask first.";
    NOT_ACCEPTABLE: "not-acceptable", NOT_ACCEPTABLE, "Accept allows no format of this job",
        "`Accept` allows no media type that can hold the result, or not that of the output; see /v1/formats.";
    BODY_TOO_LONG: "body-too-long", PAYLOAD_TOO_LARGE, "The body is too long",
        "The body has more bytes than this server reads; see /v1/limits.";
    MEDIA_TYPE: "unsupported-media-type", UNSUPPORTED_MEDIA_TYPE, "The body is of the wrong media type",
        "Jobs are sent as `Content-Type: application/json`, and mesh files, to /v1/render and /v1/blobs, as what \
         /v1/readers lists.";
    CODING: "unsupported-content-coding", UNSUPPORTED_MEDIA_TYPE, "The body is compressed in a way that is not read",
        "The header `Accept-Encoding` of the answer lists the codings that bodies may have.";
    NOT_CODED: "not-coded", BAD_REQUEST, "The body cannot be inflated",
        "The bytes of the body are not what `Content-Encoding` says, or end early.";
    BROKEN_OFF: "broken-off", BAD_REQUEST, "The body broke off",
        "The connection or a chunk ended before the whole body had arrived. Send the request again.";
    NOT_FOUND: "not-found", NOT_FOUND, "There is no such thing here",
        "No page, job, artifact or catalogue entry has this address; see /openapi.json for those that exist.";
    GONE: "gone", GONE, "It was here, but is no longer kept",
        "The artifact left the cache. Send the job again; it will have the same address.";
    METHOD: "method-not-allowed", METHOD_NOT_ALLOWED, "The page does not know this method",
        "The header `Allow` lists the methods that the page knows.";
    RANGE: "range-not-satisfiable", RANGE_NOT_SATISFIABLE, "The range lies beyond the end",
        "The header `Content-Range` tells the length of the artifact.";
    SLOW: "too-slow", REQUEST_TIMEOUT, "The request took too long to arrive",
        "The body stopped arriving for longer than this server waits.";
    BAD_HOST: "bad-host", BAD_REQUEST, "The request does not name its host",
        "HTTP/1.1 asks for exactly one header `Host`: a name or an address, and perhaps a port (RFC 9112, 3.2).";
    TRANSFER_CODING: "unknown-transfer-coding", NOT_IMPLEMENTED, "The body is coded in a way that is not read",
        "Bodies come as they are, with `Content-Length` or as `Transfer-Encoding: chunked` alone (RFC 9112, 6.1).";
    HOST: "wrong-host", FORBIDDEN, "The server is not known by this name",
        "A server that listens on a loopback address answers only to localhost and loopback addresses, so that pages \
         from elsewhere cannot reach it under a name of their own.";
    UNAUTHORIZED: "unauthorized", UNAUTHORIZED, "A key is needed",
        "This server answers those who show a key, as `Authorization: Bearer planish_...`. Its operator makes keys \
         with `planish key add`.";
    FORBIDDEN: "forbidden", FORBIDDEN, "The key does not allow this",
        "Keys have roles: `read` reads results and jobs, `render` also has work done, `admin` also reads the metrics.";
    BAD_LINK: "bad-link", FORBIDDEN, "The signed address opens nothing",
        "A signed address opens one thing until its time is over. One that was altered, has come to its end, or was \
         signed by a key that was revoked is signed again, with `planish sign`.";
    QUOTA: "quota", TOO_MANY_REQUESTS, "You ask for too much at once",
        "One client may send so many requests for work in a minute, and have so many answered at once: \
         `RateLimit-Policy` and `RateLimit` say how many. Come back after the seconds in `Retry-After`.";
    BUSY: "busy", SERVICE_UNAVAILABLE, "Too much is waiting already",
        "The queue is full. Come back after the seconds in `Retry-After`.";
    UNFINISHED: "not-finished", SERVICE_UNAVAILABLE, "The result is not finished",
        "The result is being made. Ask again after the seconds in `Retry-After`.";
    NOT_READY: "not-ready", SERVICE_UNAVAILABLE, "The service is not ready",
        "The small job that the service runs regularly did not succeed lately.";
    AWAY: "store-away", SERVICE_UNAVAILABLE, "The store that servers share does not answer",
        "The upload can neither be kept nor looked for now. Come back after the seconds in `Retry-After`.";
    UNWRITTEN: "unwritten", INSUFFICIENT_STORAGE, "It cannot be kept",
        "The disk of the service does not take what has to outlast it. Results that need not be kept are answered all \
         the same, by /v1/render.";
    TIMED_OUT: "timed-out", UNPROCESSABLE_ENTITY, "The computation took too long",
        "One computation may run for a limited time; see /v1/limits. Ask for fewer levels or a smaller picture.";
    CANCELLED: "cancelled", CONFLICT, "The job was cancelled",
        "Send the job again to have it queued again.";
    INTERNAL: "internal", INTERNAL_SERVER_ERROR, "The service made a mistake",
        "This is a fault of planish, not of the request. Please report it with the `trace_id`.";
}

/// A refusal.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    kind: ProblemKind,
    detail: String,
    errors: Vec<Fault>,
    retry_after: Option<Duration>,
}

impl Problem {
    pub(super) fn new(kind: ProblemKind, detail: impl Into<String>) -> Self {
        Self { kind, detail: detail.into(), errors: Vec::new(), retry_after: None }
    }

    /// Returns the refusal because a shared store does not answer.
    pub(super) fn away() -> Self {
        let detail = "the store that has the uploads does not answer; ask again";
        Self { retry_after: Some(RETRY_AFTER), ..Self::new(AWAY, detail) }
    }

    /// Returns whether the problem is of this kind.
    pub(super) fn is(&self, kind: ProblemKind) -> bool {
        self.kind.slug == kind.slug
    }

    /// Returns the answer as bytes of HTTP/1.1, for clients that the router does not answer; it closes the connection.
    fn written(self) -> Vec<u8> {
        let (status, retry_after) = (self.kind.status, self.retry_after);
        let body = serde_json::to_vec(&self.answer()).expect("a problem is plain text and numbers");
        let retry_after =
            retry_after.map_or_else(String::new, |time| format!("retry-after: {}\r\n", time.as_secs().max(1)));
        let mut written = format!(
            "HTTP/1.1 {status}\r\ncontent-type: application/problem+json\r\ncache-control: no-store\r\n\
             x-content-type-options: nosniff\r\n{retry_after}content-length: {}\r\nconnection: close\r\n\r\n",
            body.len()
        )
        .into_bytes();
        written.extend(body);
        written
    }

    /// Returns the body of the answer, and logs it.
    fn answer(self) -> ProblemAnswer {
        let n_faults = self.errors.len();
        let errors = listed(self.errors);
        let detail = cut(&self.detail, MAX_PROBLEM_DETAIL);
        let detail = match errors.len() {
            n if n < n_faults => format!("{detail}; errors lists the first {n}"),
            _ => detail.into_owned(),
        };
        let answer = ProblemAnswer {
            kind: format!("/docs/problems/{}", self.kind.slug),
            title: self.kind.title.to_owned(),
            status: self.kind.status.as_u16(),
            detail,
            errors,
            trace_id: current_id(),
        };
        tracing::info!(trace_id = answer.trace_id, status = answer.status, detail = answer.detail, "refused");
        answer
    }

    /// Returns the refusal of an invalid job, with all its faults.
    pub(super) fn invalid(errors: Vec<Fault>) -> Self {
        let detail = match errors.as_slice() {
            [one] => one.to_string(),
            [first, ..] => format!("{first} (and {} more, see errors)", errors.len() - 1),
            [] => "the job cannot be done".to_owned(),
        };
        Self { errors, ..Self::new(INVALID, detail) }
    }

    /// Returns the same refusal with its places renamed by `name_of`, for requests that are not written as jobs.
    pub(super) fn at(self, name_of: impl Fn(&str) -> String) -> Self {
        let named = |fault: Fault| Fault { pointer: name_of(&fault.pointer), ..fault };
        let errors: Vec<Fault> = self.errors.into_iter().map(named).collect();
        if self.kind.slug == INVALID.slug { Self::invalid(errors) } else { Self { errors, ..self } }
    }

    /// Returns the refusal of a batch because of one of its jobs, with the faults at their places in the batch.
    pub(super) fn placed(self, job: usize, place: impl Fn(Fault) -> Fault) -> Self {
        let is_told = self.kind.slug == INVALID.slug || self.errors.is_empty() && self.retry_after.is_some();
        let detail = if is_told { self.detail } else { format!("job {job}: {}", self.detail) };
        Self { detail, errors: self.errors.into_iter().map(place).collect(), ..self }
    }

    /// Returns the faults of an invalid job.
    ///
    /// # Errors
    /// The problem itself, if it is another one.
    pub(super) fn faults(self) -> Result<Vec<Fault>, Self> {
        if self.is(INVALID) && !self.errors.is_empty() { Ok(self.errors) } else { Err(self) }
    }
}

impl From<ReadError> for Problem {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::NotJson(detail) => Self::new(NOT_JSON, detail),
            ReadError::Unfit(faults) => Self::invalid(faults),
        }
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Impossible(faults) => Self::invalid(faults),
            Refusal::TooLarge { detail, faults } => Self { errors: faults, ..Self::new(TOO_LARGE, detail) },
            Refusal::Stopped => Self::new(TIMED_OUT, "the forecast of the job was stopped; ask for fewer levels"),
        }
    }
}

impl From<Busy> for Problem {
    fn from(busy: Busy) -> Self {
        let seconds = busy.retry_after.as_secs().max(1);
        let detail = format!("{}; come back in {seconds} s", busy.lack);
        Self { retry_after: Some(busy.retry_after), ..Self::new(BUSY, detail) }
    }
}

impl From<NotAccepted> for Problem {
    fn from(error: NotAccepted) -> Self {
        match error {
            NotAccepted::Busy(busy) => busy.into(),
            NotAccepted::Unwritten(detail) => {
                let detail = format!("{detail}; look at the disk of --data-dir, and send the job again then");
                Self { retry_after: Some(Duration::from_secs(10)), ..Self::new(UNWRITTEN, detail) }
            }
        }
    }
}

impl From<ReadRefusal> for Problem {
    fn from(unread: ReadRefusal) -> Self {
        match unread {
            ReadRefusal::Busy(busy) => busy.into(),
            // reading has no outputs whose faults would need other pointers
            ReadRefusal::Failed(failure) => Self::of_failure(failure, |refused| refused.fault),
        }
    }
}

impl Problem {
    /// Converts the refusal of a job that was accepted before: to be read again later, or never.
    pub(super) fn unreadable(self) -> Unreadable {
        match self.retry_after {
            Some(pause) => Unreadable::Later(pause),
            None => Unreadable::Never(cut(&self.detail, MAX_PROBLEM_DETAIL).into_owned()),
        }
    }

    /// Returns the answer 503 of a GET whose result is not ready: a 2xx could be taken for the result.
    pub(super) fn unfinished() -> Self {
        let detail = "the result is being made and will be kept; ask again in 1 s";
        Self { retry_after: Some(Duration::from_secs(1)), ..Self::new(UNFINISHED, detail) }
    }

    /// Returns the refusal of a client that exceeds its quota.
    pub(super) fn quota(detail: String, retry_after: Duration) -> Self {
        Self { retry_after: Some(retry_after), ..Self::new(QUOTA, detail) }
    }

    pub(super) fn cancelled() -> Self {
        Self::new(CANCELLED, "the job was cancelled; send it again to have it queued again")
    }

    /// Converts the failure of a computation; `written` returns the place of a fault in the request.
    pub(super) fn of_failure(failure: Failure, written: impl FnOnce(JobFault) -> Fault) -> Self {
        match failure {
            Failure::Cancelled => Self::cancelled(),
            Failure::Impossible(fault) => Self::invalid(vec![written(fault)]),
            Failure::TimedOut(limit) => {
                let seconds = limit.as_secs();
                let remedy = "ask for fewer levels or a smaller picture";
                let ran = format!("the computation ran for {seconds} s, the most this server allows");
                Self::new(TIMED_OUT, format!("{ran}; {remedy}"))
            }
            Failure::Busy(busy) => busy.into(),
            Failure::Internal(error) => {
                tracing::error!(%error, "a computation failed");
                Self::new(INTERNAL, "the computation failed; this is a fault of planish, please report it")
            }
        }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let (status, retry_after, is_coding) = (self.kind.status, self.retry_after, self.is(CODING));
        let is_unknown = self.is(UNAUTHORIZED);
        let body = serde_json::to_vec(&self.answer()).expect("a problem is plain text and numbers");
        let mut headers = HeaderMap::new();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        if let Some(retry_after) = retry_after {
            headers.insert(header::RETRY_AFTER, retry_after.as_secs().max(1).into());
        }
        if is_unknown {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer realm=\"planish\""));
        }
        if is_coding {
            // says that the coding is refused, not the media type (RFC 9110, 12.5.3)
            headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static("gzip, zstd"));
        }
        (status, headers, body).into_response()
    }
}

/// Returns the first faults, as many as fit into one answer.
fn listed(faults: Vec<Fault>) -> Vec<FaultAnswer> {
    let mut left = MAX_FAULT_BYTES;
    let fitting = faults.into_iter().map(FaultAnswer::from).take_while(|fault| {
        let length = serde_json::to_string(fault).expect("a fault is plain text").len();
        left.checked_sub(length).map(|rest| left = rest).is_some()
    });
    fitting.collect()
}

/// Returns the answer to a request without a route.
pub(super) async fn no_such_page(uri: Uri) -> Problem {
    let path = shortened(uri.path());
    Problem::new(NOT_FOUND, format!("there is no page {path}; /openapi.json lists those that exist"))
}

/// Returns the answer to a method that a route does not support.
pub(super) async fn method_not_allowed(method: Method, uri: Uri) -> Problem {
    let path = shortened(uri.path());
    let posted = ["/v1/render", "/v1/estimate", "/v1/validate", "/v1/analyses", "/v1/compare", "/v1/evaluate"];
    let remedy = if posted.contains(&path.as_str()) {
        "send a job with POST"
    } else {
        "the header Allow lists the methods it knows"
    };
    Problem::new(METHOD, format!("{path} does not know {}; {remedy}", shortened(method.as_str())))
}

/// Returns the bytes for a client whose connection is not admitted.
pub(super) fn crowded() -> Vec<u8> {
    let busy = Problem {
        retry_after: Some(Duration::from_secs(1)),
        ..Problem::new(BUSY, "all connections wait for answers already; come back in 1 s")
    };
    busy.written()
}

/// Returns the bytes that replace the HTTP library's refusal of an invalid request.
pub(super) fn unreadable(refusal: &[u8]) -> Vec<u8> {
    let is = |status: &[u8]| refusal.strip_prefix(b"HTTP/1.1 ").is_some_and(|rest| rest.starts_with(status));
    let problem = if is(b"431") {
        Problem::new(HEAD_TOO_LONG, "the head has more than 64 KiB or 100 headers; send fewer or shorter ones")
    } else if is(b"414") {
        Problem::new(URI_TOO_LONG, "the request's address is longer than 64 KiB; send the job in a body")
    } else {
        Problem::new(NOT_HTTP, "what was sent is no request of HTTP/1.1; send one line, headers, an empty line, a body")
    };
    problem.written()
}

/// Returns the answer after a panic in a handler.
#[expect(clippy::needless_pass_by_value, reason = "the signature is that of the panic layer")]
pub(super) fn panicked(panic: Box<dyn Any + Send>) -> Response {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    tracing::error!(panic = %cut(text.unwrap_or("no message"), MAX_PROBLEM_DETAIL), "a handler panicked");
    Problem::new(INTERNAL, "the request made planish fail; this is a fault of planish, please report it")
        .into_response()
}
