//! GET and DELETE /v1/jobs/{id}: how a job stands that outlasted its request, and its end.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::address::address;
use super::app::{App, Shared};
use super::problem::{self, Problem};
use super::segment::Segment;
use crate::job::key::Key;
use crate::service::computation::{Failure, Phase, Timings};
use crate::service::jobs::{Record, State as Standing};
use crate::wire::answer::{CostAnswer, JobAnswer, OutputAnswer, ReachedAnswer, TimingsAnswer};

/// How a job stands: state, progress, timings, cost, outputs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "How it stands", body = JobAnswer),
    )
)]
pub(super) async fn job(State(app): State<Shared>, Segment(id): Segment) -> Response {
    let answer = Key::parse(&id).and_then(|id| answer(&app, &id));
    let Some(answer) = answer else {
        let detail = "there is no job of this id; send the job to /v1/render, it has the same id each time";
        return Problem::new(problem::NOT_FOUND, detail).into_response();
    };
    let active = matches!(answer.state, "queued" | "running");
    let mut response = axum::Json(answer).into_response();
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    if active {
        response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    }
    response
}

/// Forgets a job; when it is still under way and nobody else waits for its result, it is cancelled.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 204, description = "It is forgotten"),
    )
)]
pub(super) async fn forget(State(app): State<Shared>, Segment(id): Segment) -> Response {
    if Key::parse(&id).is_some_and(|id| app.desk.jobs.remove(&id)) {
        return StatusCode::NO_CONTENT.into_response();
    }
    Problem::new(problem::NOT_FOUND, "there is no job of this id, or it is forgotten already").into_response()
}

/// How a job stands, if it is known.
pub(super) fn answer(app: &Arc<App>, id: &Key) -> Option<JobAnswer> {
    let record = app.desk.jobs.get(id)?;
    let (state, progress, timings, error) = standing(&record);
    let summary = &record.summary;
    let (name, format, key) = (&summary.output.0, summary.output.1, summary.output.2);
    let output =
        OutputAnswer { name: name.clone(), format: format.name(), key: key.to_string(), href: address(key, format) };
    Some(JobAnswer {
        id: record.id.to_string(),
        state,
        progress,
        attempts: record.attempts,
        timings_ms: timings.map(milliseconds),
        cost: CostAnswer::new(&summary.estimate),
        outputs: vec![output],
        error,
        warnings: warnings(&record),
        reached: summary.reached.map(ReachedAnswer::from),
    })
}

fn standing(record: &Record) -> (&'static str, f64, Option<Timings>, Option<String>) {
    match &record.state {
        Standing::Active(interest) => {
            let computation = &interest.computation;
            let state = if matches!(computation.phase(), Phase::Queued) { "queued" } else { "running" };
            (state, computation.progress(), Some(computation.timings()), None)
        }
        Standing::Done(_, timings) => ("done", 1.0, Some(*timings), None),
        Standing::Failed(Failure::Cancelled) => ("cancelled", 0.0, None, None),
        Standing::Failed(Failure::Impossible(fault)) => {
            ("failed", 0.0, None, Some(record.summary.entries.fault(fault.clone()).to_string()))
        }
        Standing::Failed(Failure::TimedOut(limit)) => {
            ("failed", 0.0, None, Some(format!("it ran for {} s, the most this server allows", limit.as_secs())))
        }
        Standing::Failed(Failure::Busy(_)) => (
            "failed",
            0.0,
            None,
            Some("there was no place for work as long as it came to be; send it again".to_owned()),
        ),
        Standing::Failed(Failure::Internal(_)) => {
            ("failed", 0.0, None, Some("a fault of planish; please report it".to_owned()))
        }
    }
}

fn warnings(record: &Record) -> Vec<String> {
    match &record.state {
        Standing::Done(manifest, _) => manifest.warnings.clone(),
        _ => Vec::new(),
    }
}

fn milliseconds(timings: Timings) -> TimingsAnswer {
    let ms = |duration: Duration| duration.as_secs_f64() * 1000.0;
    TimingsAnswer {
        queue: ms(timings.queue),
        refine: ms(timings.refine),
        render: ms(timings.render),
        encode: ms(timings.encode),
    }
}
