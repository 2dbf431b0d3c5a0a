//! The HTTP interface: a list of routes, one file a resource.

mod answer;
mod artifacts;
mod body;
mod canary;
mod catalogue;
mod connections;
mod document;
mod estimate;
mod guard;
mod health;
mod jobs;
mod memo;
mod negotiate;
mod pace;
mod pages;
mod problem;
mod reading;
mod render;
mod requests;
mod segment;
pub mod serve;
mod stream;
mod validate;

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderName, Method, header};
use axum::middleware;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::cors::{AllowOrigin, CorsLayer};
use utoipa::OpenApi;
use utoipa::openapi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::config::{CorsOrigins, Settings};
use crate::service::desk::Desk;

pub use canary::Canary;
pub use connections::Connections;
pub use memo::Memo;

/// What every handler knows.
#[derive(Debug)]
pub struct App {
    /// Finds and makes artifacts.
    pub desk: Arc<Desk>,
    /// The settings of this service.
    pub settings: Settings,
    /// The job that shows whether the service works.
    pub canary: Canary,
    /// What was asked lately.
    pub memo: Memo,
    /// The connections that are open.
    pub connections: Arc<Connections>,
}

/// The state of the router.
type Shared = Arc<App>;

/// All routes and the document that describes them.
fn routed() -> OpenApiRouter<Shared> {
    // artifacts are answered as they are, or their ETag would not be strong; other texts are compressed
    let artifacts = OpenApiRouter::new().routes(routes!(render::render)).routes(routes!(artifacts::artifact));
    let texts = OpenApiRouter::new()
        .routes(routes!(jobs::job, jobs::forget))
        .routes(routes!(estimate::estimate))
        .routes(routes!(validate::validate))
        .routes(routes!(catalogue::presets))
        .routes(routes!(catalogue::preset))
        .routes(routes!(catalogue::operators))
        .routes(routes!(catalogue::operator))
        .routes(routes!(catalogue::formats))
        .routes(routes!(catalogue::readers))
        .routes(routes!(catalogue::limits))
        .routes(routes!(health::livez))
        .routes(routes!(health::readyz))
        .routes(routes!(pages::openapi))
        .routes(routes!(pages::problem))
        .routes(routes!(pages::index))
        .layer(CompressionLayer::new());
    OpenApiRouter::with_openapi(document::Document::openapi()).merge(artifacts).merge(texts)
}

/// The OpenAPI document of the interface.
pub fn document() -> openapi::OpenApi {
    document::completed(routed().into_openapi())
}

/// The router of a service.
pub fn router(app: Arc<App>) -> Router {
    let (router, _) = routed().split_for_parts();
    router
        .fallback(problem::no_such_page)
        .method_not_allowed_fallback(problem::method_not_allowed)
        .layer(DefaultBodyLimit::disable())
        .layer(CatchPanicLayer::custom(problem::panicked))
        .layer(middleware::from_fn_with_state(app.clone(), guard::check_host))
        .layer(cors(&app.settings))
        .layer(middleware::from_fn(guard::headers))
        .with_state(app)
}

/// Pages of the origins that the settings name may ask; no cookies are involved.
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
    ]);
    CorsLayer::new()
        .allow_origin(origin)
        .allow_methods([Method::GET, Method::HEAD, Method::POST, Method::DELETE, Method::OPTIONS])
        .allow_headers([
            header::CONTENT_TYPE,
            header::ACCEPT,
            header::IF_NONE_MATCH,
            header::RANGE,
            header::IF_RANGE,
            HeaderName::from_static("prefer"),
        ])
        .expose_headers(exposed.map(HeaderName::from_static).collect::<Vec<_>>())
        .max_age(Duration::from_hours(24))
}
