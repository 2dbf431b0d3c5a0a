//! The checks that every request passes, of its host and its key, and the headers that keep browsers from guessing
//! media types.

use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{HeaderValue, Version, header, request};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::app::SharedApp;
use super::body::drain;
use super::client::Client;
use super::connections::ConnectionPhase;
use super::problem::{self, Problem};
use crate::config::Settings;
use crate::config::authority::Authority;
use crate::fault::shortened;

/// Maximum length of the line and the headers of a request in bytes, and the size of the buffer in which they arrive.
/// The HTTP library alone takes up to twice of it, as its last read may exceed the buffer. Half of it would refuse
/// addresses of the maximum length; twice of it would let each connection hold twice as much.
pub(super) const MAX_HEAD_BYTES: usize = 64 << 10;

/// Refuses requests whose head is too long, or that do not name exactly one host; on a loopback address it also refuses
/// other than loopback names, against DNS rebinding.
pub(super) async fn check_head(State(app): State<SharedApp>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    match head(&parts, &app.settings) {
        Ok(()) => next.run(Request::from_parts(parts, body)).await,
        Err(problem) => problem.into_response(),
    }
}

/// Checks the length of a request's head, and its hosts.
pub(super) fn head(request: &request::Parts, settings: &Settings) -> Result<(), Problem> {
    let length = length(request);
    if length > MAX_HEAD_BYTES {
        let detail = format!(
            "the request's line and headers have {length} bytes, and a server reads {MAX_HEAD_BYTES}; send fewer or \
             shorter headers"
        );
        return Err(Problem::new(problem::HEAD_TOO_LONG, detail));
    }
    hosts(request, settings)
}

/// Returns the length of the line and the headers of a request, with their separators, in bytes.
fn length(request: &request::Parts) -> usize {
    let fields = request.headers.iter().map(|(name, value)| name.as_str().len() + value.len() + ": \r\n".len());
    let address = request.uri.path_and_query().map_or(1, |path| path.as_str().len());
    request.method.as_str().len() + address + "  HTTP/1.1\r\n\r\n".len() + fields.sum::<usize>()
}

/// Checks the host in the header `Host`, and the host of an absolute request target.
fn hosts(request: &request::Parts, settings: &Settings) -> Result<(), Problem> {
    let only_loopback = settings.listen.ip().is_loopback();
    let bad = |detail: &str| {
        let remedy = "send one like \"Host: localhost:8080\"";
        Problem::new(problem::BAD_HOST, format!("{detail}; {remedy}"))
    };
    let mut values = request.headers.get_all(header::HOST).iter();
    let header = match (values.next(), values.next()) {
        (Some(value), None) => Some(value.to_str().map_err(|_| bad("the header Host is no ASCII text"))?),
        // HTTP/1.0 did not require the header
        (None, _) if request.version < Version::HTTP_11 => None,
        (None, _) => return Err(bad("the request has no header Host")),
        (Some(_), Some(_)) => return Err(bad("the request has more than one header Host")),
    };
    let target = request.uri.authority().map(axum::http::uri::Authority::as_str);
    for host in header.into_iter().chain(target) {
        let wrong = || bad(&format!("\"{}\" is no host with or without a port", shortened(host)));
        let authority = Authority::parse(host).ok_or_else(wrong)?;
        if only_loopback && !authority.is_loopback() {
            let known = "this server listens on a loopback address and is not known as";
            return Err(Problem::new(problem::HOST, format!("{known} \"{}\"", shortened(host))));
        }
    }
    Ok(())
}

/// Refuses requests that the gate refused; replaces `public` by `private` in the Cache-Control of answers to private
/// clients.
pub(super) async fn check_key(State(app): State<SharedApp>, client: Client, request: Request, next: Next) -> Response {
    if let Some(problem) = client.caller.refused {
        if !request.headers().contains_key(header::EXPECT) {
            drain(request.into_body(), Duration::from_secs(app.settings.body_timeout_s)).await;
        }
        client.connection.enter(ConnectionPhase::Working);
        return problem.into_response();
    }
    let is_private = client.is_private();
    let mut response = next.run(request).await;
    let cached = response.headers().get(header::CACHE_CONTROL).and_then(|value| value.to_str().ok());
    if let Some(rest) = cached.and_then(|value| value.strip_prefix("public")).filter(|_| is_private)
        && let Ok(private) = HeaderValue::try_from(format!("private{rest}"))
    {
        response.headers_mut().insert(header::CACHE_CONTROL, private);
    }
    response
}

/// Adds the headers of every answer.
pub(super) async fn headers(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    response.headers_mut().insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    response
}
