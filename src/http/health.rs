//! Whether the service lives, and whether it works.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::Shared;
use super::problem::{self, Problem};

/// The process answers.
#[utoipa::path(get, path = "/livez", tag = "operations", responses((status = 200, description = "It lives", body = String, content_type = "text/plain")))]
pub(super) async fn livez() -> &'static str {
    "alive\n"
}

/// How ready the service is.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub(super) struct Readiness {
    /// True: what is not ready is answered by a problem.
    ready: bool,
    /// Seconds since the canary job last succeeded.
    canary_age_s: f64,
    /// Milliseconds that it took.
    canary_ms: f64,
    /// Computations under way or waiting.
    under_way: usize,
}

/// A small real job was computed lately.
#[utoipa::path(
    get, path = "/readyz", tag = "operations",
    responses(
        (status = 200, description = "It works", body = Readiness),
    )
)]
pub(super) async fn readyz(State(app): State<Shared>) -> Response {
    match app.canary.last_success() {
        Some((age, took)) if age <= super::canary::STALE => {
            let readiness = Readiness {
                ready: true,
                canary_age_s: age.as_secs_f64(),
                canary_ms: took.as_secs_f64() * 1000.0,
                under_way: app.desk.n_under_way(),
            };
            (StatusCode::OK, Json(readiness)).into_response()
        }
        Some((age, _)) => {
            let detail = format!("the canary job last succeeded {} s ago", age.as_secs());
            Problem::new(problem::NOT_READY, detail).into_response()
        }
        None => Problem::new(problem::NOT_READY, "the canary job has not succeeded yet").into_response(),
    }
}
