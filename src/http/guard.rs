//! What every request passes: the check of its host, and headers that keep browsers from guessing.

use axum::extract::{Request, State};
use axum::http::{HeaderValue, Version, header, request};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::app::Shared;
use super::problem::{self, Problem};
use crate::config::Settings;
use crate::config::authority::Authority;
use crate::fault::shortened;

/// Every request names one host; on a loopback address only loopback names are answered, against DNS rebinding.
pub(super) async fn check_host(State(app): State<Shared>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    match hosts(&parts, &app.settings) {
        Ok(()) => next.run(Request::from_parts(parts, body)).await,
        Err(problem) => problem.into_response(),
    }
}

/// Checks the host that the header names, and the one that an absolute address names in its place.
pub(super) fn hosts(request: &request::Parts, settings: &Settings) -> Result<(), Problem> {
    let only_loopback = settings.listen.ip().is_loopback();
    let bad = |detail: &str| {
        let remedy = "send one like \"Host: localhost:8080\"";
        Problem::new(problem::BAD_HOST, format!("{detail}; {remedy}"))
    };
    let mut values = request.headers.get_all(header::HOST).iter();
    let header = match (values.next(), values.next()) {
        (Some(value), None) => Some(value.to_str().map_err(|_| bad("the header Host is no ASCII text"))?),
        // before 1.1, HTTP knew no such header
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

/// Headers of every answer.
pub(super) async fn headers(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    response.headers_mut().insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    response
}
