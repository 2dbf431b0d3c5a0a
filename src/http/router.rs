//! The router of a service: its routes, and the layers that all requests pass.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderName, Method, header};
use axum::middleware;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::cors::{AllowOrigin, CorsLayer};
use utoipa::{OpenApi, openapi};
use utoipa_axum::router::OpenApiRouter;

use super::app::App;
use super::document::{ApiDocument, completed};
use super::{guard, metrics, problem, routes};
use crate::config::{CorsOrigins, Settings};

/// Returns the OpenAPI document of the interface.
pub fn document() -> openapi::OpenApi {
    let described = OpenApiRouter::with_openapi(ApiDocument::openapi()).merge(routes::all());
    completed(described.into_openapi())
}

/// Returns the OpenAPI document as text, in the form in which it is committed.
///
/// # Panics
/// Never: the document is plain data.
pub fn document_text() -> String {
    let mut text = document().to_pretty_json().expect("the document is plain data");
    text.push('\n');
    text
}

/// Creates the router of a service.
pub fn router(app: Arc<App>) -> Router {
    let (router, _) = routes::all().split_for_parts();
    router
        .fallback(problem::no_such_page)
        .method_not_allowed_fallback(problem::method_not_allowed)
        .layer(DefaultBodyLimit::disable())
        .layer(middleware::from_fn_with_state(app.clone(), guard::check_key))
        .layer(middleware::from_fn_with_state(app.clone(), metrics::counted))
        .layer(CatchPanicLayer::custom(problem::panicked))
        .layer(middleware::from_fn_with_state(app.clone(), guard::check_head))
        .layer(cors(&app.settings))
        .layer(middleware::from_fn(guard::headers))
        .with_state(app)
}

/// Returns the CORS layer: pages from the origins of the settings may send requests; cookies are not involved.
fn cors(settings: &Settings) -> CorsLayer {
    let (origins, address) = (settings.cors_origins.clone(), settings.listen.ip());
    let origin = match origins {
        CorsOrigins::Any => AllowOrigin::any(),
        origins => {
            AllowOrigin::predicate(move |origin, _| origin.to_str().is_ok_and(|origin| origins.allows(origin, address)))
        }
    };
    let exposed = ["etag", "location", "content-location", "cache-status", "server-timing", "retry-after"];
    let exposed = exposed.into_iter().chain([
        "planish-warnings",
        "planish-level",
        "planish-bound",
        "preference-applied",
        "accept-ranges",
        "content-range",
        "ratelimit",
        "ratelimit-policy",
        "traceparent",
    ]);
    CorsLayer::new()
        .allow_origin(origin)
        .allow_methods([Method::GET, Method::HEAD, Method::POST, Method::DELETE, Method::OPTIONS])
        .allow_headers([
            header::CONTENT_TYPE,
            header::CONTENT_ENCODING,
            header::ACCEPT,
            header::AUTHORIZATION,
            header::IF_NONE_MATCH,
            header::RANGE,
            header::IF_RANGE,
            HeaderName::from_static("last-event-id"),
            HeaderName::from_static("prefer"),
            HeaderName::from_static("traceparent"),
        ])
        .expose_headers(exposed.map(HeaderName::from_static).collect::<Vec<_>>())
        .max_age(Duration::from_hours(24))
}
