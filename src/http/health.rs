//! The endpoints that tell whether the process lives, and whether the service works.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use super::app::SharedApp;
use super::problem::{self, Problem};
use crate::service::account::{Share, ShareUsage};

/// The process answers.
#[utoipa::path(
    get, path = "/livez", tag = "operations",
    responses((status = 200, description = "It lives", body = String, content_type = "text/plain",
        example = "alive\n"))
)]
pub(super) async fn livez() -> &'static str {
    "alive\n"
}

/// How ready the service is.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(super) struct Readiness {
    /// True: what is not ready is answered by a problem.
    ready: bool,
    /// Seconds since the canary job last succeeded.
    canary_age_s: f64,
    /// Milliseconds that it took.
    canary_ms: f64,
    /// Computations under way or waiting.
    under_way: usize,
    /// Stores that servers share and that do not answer: the service goes on without them.
    stores_away: Vec<&'static str>,
    /// The shares of the memory, in the order of a request's way.
    memory: Vec<ShareAnswer>,
}

/// A share of the memory.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub(super) struct ShareAnswer {
    /// What it is for.
    name: &'static str,
    /// Bytes it has in all.
    capacity: u64,
    /// Bytes taken now.
    taken: u64,
    /// Most bytes that were taken at once since the start.
    most: u64,
    /// How often a request was refused because it was empty.
    refused: u64,
}

/// A small real job was computed lately, no line and no share of the memory is full, and the disk takes results and the
/// records of jobs.
#[utoipa::path(
    get, path = "/readyz", tag = "operations",
    responses(
        (status = 200, description = "It works", body = Readiness, example = json!({ "ready": true,
            "canary_age_s": 4.2, "canary_ms": 1.5, "under_way": 0, "stores_away": [],
            "memory": [{ "name": "answers", "capacity": 805_306_368, "taken": 0, "most": 20_044, "refused": 0 }] })),
    )
)]
pub(super) async fn readyz(State(app): State<SharedApp>) -> Result<Json<Readiness>, Problem> {
    let not_ready = |detail: String| Err(Problem::new(problem::NOT_READY, detail));
    let (age, took) = match app.canary.last_success() {
        Some((age, took)) if age <= super::canary::STALE_AGE => (age, took),
        Some((age, _)) => return not_ready(format!("the canary job last succeeded {} s ago", age.as_secs())),
        None => return not_ready("the canary job has not succeeded yet".to_owned()),
    };
    let full = app.desk.full();
    if !full.is_empty() {
        return not_ready(format!(
            "there is no room in: {}; cached results are answered all the same",
            full.join(", ")
        ));
    }
    if let Some(trouble) = app.desk.tiers.disk_trouble() {
        let (n, seconds) = (trouble.failures, trouble.duration.as_secs());
        let remedy = "results are answered all the same, but not kept; look at the disk of --data-dir";
        let reason = &trouble.reason;
        return not_ready(format!("the disk has been failing for {seconds} s, {n} writes so far: {reason}; {remedy}"));
    }
    if let Some(trouble) = app.desk.jobs.trouble().or_else(|| app.desk.batches.trouble()) {
        let remedy = "jobs and batches are refused meanwhile, /v1/render answers; look at the disk of --data-dir";
        return not_ready(format!("the records of jobs cannot be written: {trouble}; {remedy}"));
    }
    let share = |share: &Arc<Share>| {
        let ShareUsage { taken, most, refused } = share.usage();
        ShareAnswer { name: share.name, capacity: share.capacity, taken, most, refused }
    };
    Ok(Json(Readiness {
        ready: true,
        canary_age_s: age.as_secs_f64(),
        canary_ms: took.as_secs_f64() * 1000.0,
        under_way: app.desk.n_under_way(),
        stores_away: app.desk.stores().into_iter().filter(|(_, usage)| usage.away).map(|(name, _)| name).collect(),
        memory: app.desk.account.shares().into_iter().map(share).collect(),
    }))
}
