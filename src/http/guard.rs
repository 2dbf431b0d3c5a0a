//! What every request passes: the check of its host, and headers that keep browsers from guessing.

use axum::extract::{Request, State};
use axum::http::{HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::Shared;
use super::problem::{self, Problem};
use crate::math::parameter::shortened;

/// On a loopback address only loopback names are answered, against DNS rebinding.
pub(super) async fn check_host(State(app): State<Shared>, request: Request, next: Next) -> Response {
    if app.settings.listen.ip().is_loopback()
        && let Some(host) = request.headers().get(header::HOST).map(|value| value.to_str().unwrap_or("?"))
        && !is_loopback(host)
    {
        let detail = format!("this server listens on a loopback address and is not known as \"{}\"", shortened(host));
        return Problem::new(problem::HOST, detail).into_response();
    }
    next.run(request).await
}

fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or(""),
        None => host.rsplit_once(':').map_or(host, |(name, _)| name),
    };
    name.eq_ignore_ascii_case("localhost") || name.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

/// Headers of every answer.
pub(super) async fn headers(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    response.headers_mut().insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    response
}
