//! GET /v1/jobs/{id}: how a job stands that outlasted its request.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};

use super::answer::address;
use super::problem::{self, Problem};
use super::segment::Segment;
use super::{App, Shared};
use crate::job::key::Key;
use crate::service::computation::{Failure, Phase, Timings};
use crate::service::jobs::{Record, State as Standing};
use crate::wire::answer::{CostAnswer, JobAnswer, OutputAnswer, ReachedAnswer, TimingsAnswer};

/// How a job stands: state, progress, timings, cost, outputs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job, 64 hexadecimal digits")),
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

/// How a job stands, if it is known.
pub(super) fn answer(app: &Arc<App>, id: &Key) -> Option<JobAnswer> {
    let record = app.desk.jobs.get(id)?;
    let (state, progress, timings, error) = standing(&record.state);
    let job = record.admitted.job();
    let output = |output: &crate::job::Output| {
        let key = job.key(output);
        OutputAnswer {
            name: output.name.clone(),
            format: output.format.name(),
            key: key.to_string(),
            href: address(key, output.format),
        }
    };
    Some(JobAnswer {
        id: record.id.to_string(),
        state,
        progress,
        attempts: record.attempts,
        timings_ms: timings.map(milliseconds),
        cost: CostAnswer::new(record.admitted.estimate()),
        outputs: job.outputs.iter().map(output).collect(),
        error,
        warnings: warnings(&record),
        reached: job.reached.map(ReachedAnswer::from),
    })
}

fn standing(state: &Standing) -> (&'static str, f64, Option<Timings>, Option<String>) {
    match state {
        Standing::Active(interest) => {
            let computation = &interest.computation;
            let state = if matches!(computation.phase(), Phase::Queued) { "queued" } else { "running" };
            (state, computation.progress(), Some(computation.timings()), None)
        }
        Standing::Done(_, timings) => ("done", 1.0, Some(*timings), None),
        Standing::Failed(Failure::Cancelled) => ("cancelled", 0.0, None, None),
        Standing::Failed(Failure::Impossible(fault)) => ("failed", 0.0, None, Some(fault.to_string())),
        Standing::Failed(Failure::TimedOut(limit)) => {
            ("failed", 0.0, None, Some(format!("it ran for {} s, the most this server allows", limit.as_secs())))
        }
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
