//! The routes: one line a resource, whose file has its handlers.

use tower_http::compression::CompressionLayer;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::app::Shared;
use super::{analyses, artifacts, catalogue, estimate, health, jobs, pages, render, validate};

/// All routes and their descriptions.
pub(super) fn all() -> OpenApiRouter<Shared> {
    // artifacts are answered as they are, or their ETag would not be strong; other texts are compressed
    let artifacts = OpenApiRouter::new().routes(routes!(render::render)).routes(routes!(artifacts::artifact));
    let texts = OpenApiRouter::new()
        .routes(routes!(jobs::job, jobs::forget))
        .routes(routes!(estimate::estimate))
        .routes(routes!(validate::validate))
        .routes(routes!(analyses::analyse))
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
    OpenApiRouter::new().merge(artifacts).merge(texts)
}
