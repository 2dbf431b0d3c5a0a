//! The routes: one line per resource, whose handlers are in the file of the same name.

use axum::routing::get;
use tower_http::compression::CompressionLayer;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::app::SharedApp;
use super::{
    analyses, archive, artifacts, batches, blobs, catalogue, comparison, estimate, evaluation, events, health, jobs,
    links, metrics, pages, play, posting, render, signed, validate,
};

/// Returns all routes with their descriptions.
pub(super) fn all() -> OpenApiRouter<SharedApp> {
    // artifacts and the files of pages have compressed variants with ETags of their own; other texts are compressed
    // while they are sent
    let artifacts = OpenApiRouter::new()
        .routes(routes!(render::render, links::link))
        .routes(routes!(links::kroki))
        .routes(routes!(artifacts::artifact))
        .routes(routes!(signed::signed))
        .routes(routes!(signed::signed_model))
        .routes(routes!(signed::signed_events))
        .routes(routes!(signed::signed_batch_events))
        .routes(routes!(signed::signed_artifact))
        .routes(routes!(events::events))
        .routes(routes!(batches::batch_events))
        .routes(routes!(archive::archive))
        .routes(routes!(blobs::blob))
        .routes(routes!(analyses::analyse))
        .routes(routes!(evaluation::evaluate))
        .route("/", get(play::index))
        .routes(routes!(play::page))
        .routes(routes!(play::file));
    let texts = OpenApiRouter::new()
        .routes(routes!(posting::post, jobs::list))
        .routes(routes!(jobs::job, jobs::forget))
        .routes(routes!(jobs::cancel))
        .routes(routes!(batches::post_batch, batches::list_batches))
        .routes(routes!(batches::batch, batches::forget_batch))
        .routes(routes!(batches::cancel_batch))
        .routes(routes!(blobs::upload))
        .routes(routes!(estimate::estimate))
        .routes(routes!(validate::validate))
        .routes(routes!(comparison::compare))
        .routes(routes!(catalogue::presets))
        .routes(routes!(catalogue::preset))
        .routes(routes!(catalogue::operators))
        .routes(routes!(catalogue::operator))
        .routes(routes!(catalogue::formats))
        .routes(routes!(catalogue::readers))
        .routes(routes!(catalogue::limits))
        .routes(routes!(health::livez))
        .routes(routes!(health::readyz))
        .routes(routes!(metrics::metrics))
        .routes(routes!(pages::openapi))
        .routes(routes!(pages::docs))
        .routes(routes!(pages::problem))
        .layer(CompressionLayer::new());
    OpenApiRouter::new().merge(artifacts).merge(texts)
}
