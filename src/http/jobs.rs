//! GET /v1/jobs, GET and DELETE /v1/jobs/{id}, POST /v1/jobs/{id}/cancel: the states of jobs, cancelling and
//! forgetting.

use std::sync::Arc;

use axum::extract::{RawQuery, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::address::address;
use super::app::{App, SharedApp};
use super::client::Client;
use super::problem::{self, Problem};
use super::segment::PathSegment;
use crate::fault::{Fault, shortened};
use crate::service::accepting::NotAccepted;
use crate::service::job_key::JobKey;
use crate::service::jobs::Standing;
use crate::wire::query::repeated;
use crate::wire::standing::{JobAnswer, JobsAnswer};

/// Default number of jobs on a page; [`LARGEST_PAGE`] is the maximum. Half of it needs more requests; twice of it
/// answers up to 4 MiB at once, for jobs of 64 outputs.
const JOBS_PER_PAGE: usize = 50;
const LARGEST_PAGE: u64 = 100;

/// How a job stands: state, stage, level, progress, place in line, timings, cost, outputs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "How it stands", body = JobAnswer),
    )
)]
pub(super) async fn job(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<Response, Problem> {
    let standing = client.named(&id).and_then(|job| app.desk.standing(&job)).ok_or_else(unknown)?;
    Ok(state_response(StatusCode::OK, &standing))
}

/// Jobs, the newest first, by pages.
#[utoipa::path(
    get, path = "/v1/jobs", tag = "jobs",
    params(
        ("limit" = Option<u64>, Query, description = "Most jobs of the page, 1 to 100; 50 when left out",
            example = 20),
        ("cursor" = Option<String>, Query, description = "`next` of the page before"),
    ),
    responses((status = 200, description = "A page of them", body = JobsAnswer, example = json!({ "jobs": [] })))
)]
pub(super) async fn list(
    State(app): State<SharedApp>,
    client: Client,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let (before, limit) = page(query.as_deref().unwrap_or_default())?;
    let (records, is_more) = app.desk.jobs.page(client.tenant(), before, limit);
    let next = records.last().filter(|_| is_more).map(|record| record.number.to_string());
    let jobs = records.into_iter().map(|record| answer(&app.desk.standing_of(record))).collect();
    Ok(([(header::CACHE_CONTROL, "no-cache")], axum::Json(JobsAnswer { jobs, next })).into_response())
}

/// Cancels a job: what nobody else waits for ends within 65,536 rows or one tile. The job stays known; posted again, it
/// is done once more.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
        example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "It had come to its end before", body = JobAnswer),
        (status = 202, description = "It is cancelled", body = JobAnswer),
    )
)]
pub(super) async fn cancel(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<Response, Problem> {
    let job = client.named(&id).ok_or_else(unknown)?;
    let status = if app.desk.cancel(&job) { StatusCode::ACCEPTED } else { StatusCode::OK };
    app.desk.jobs.written(job).await.map_err(NotAccepted::from)?;
    Ok(state_response(status, &app.desk.standing(&job).ok_or_else(unknown)?))
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
pub(super) async fn forget(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
) -> Result<StatusCode, Problem> {
    let unknown = || Problem::new(problem::NOT_FOUND, "there is no job of this id, or it is forgotten already");
    let job = client.named(&id).filter(|job| app.desk.forget(job)).ok_or_else(unknown)?;
    app.desk.jobs.written(job).await.map_err(NotAccepted::from)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Returns the answer about an unknown job.
pub(super) fn unknown() -> Problem {
    let detail = "there is no job of this id; send the job to /v1/jobs or /v1/render, it has the same id each time";
    Problem::new(problem::NOT_FOUND, detail)
}

/// Returns the state of a job as clients see it.
pub(super) fn answer(standing: &Standing) -> JobAnswer {
    JobAnswer::new(standing, |product| address(product.key, product.format))
}

/// Returns the answer with the state of a job.
fn state_response(status: StatusCode, standing: &Standing) -> Response {
    let head = [(header::CACHE_CONTROL, "no-cache")];
    let mut response = (status, head, axum::Json(answer(standing))).into_response();
    if !standing.phase.is_settled() {
        response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    }
    response
}

/// Returns the answer to a posted job, with its state and location; 202 as long as it is under way.
pub(super) fn accepted(app: &Arc<App>, job: &JobKey, waited: Option<u64>) -> Result<Response, Problem> {
    let standing = app.desk.standing(job).ok_or_else(unknown)?;
    let status = if standing.phase.is_settled() { StatusCode::OK } else { StatusCode::ACCEPTED };
    Ok(with_location(state_response(status, &standing), &format!("/v1/jobs/{}", job.id), waited))
}

/// Returns the answer 202 with the location of a job that is under way.
pub(super) fn later(app: &Arc<App>, job: &JobKey, waited: Option<u64>) -> Result<Response, Problem> {
    let standing = app.desk.standing(job).ok_or_else(unknown)?;
    let mut response =
        with_location(state_response(StatusCode::ACCEPTED, &standing), &format!("/v1/jobs/{}", job.id), waited);
    response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    Ok(response)
}

/// Adds the location of a posted job or batch, and the wait that was granted, to an answer.
pub(super) fn with_location(mut response: Response, place: &str, waited: Option<u64>) -> Response {
    let headers = response.headers_mut();
    if let Ok(location) = HeaderValue::try_from(place) {
        headers.insert(header::LOCATION, location);
    }
    if let Some(Ok(waited)) = waited.map(|seconds| HeaderValue::try_from(format!("wait={seconds}"))) {
        headers.insert(HeaderName::from_static("preference-applied"), waited);
    }
    response
}

/// Parses the query of a page: the number before which the page begins, and the number of jobs.
pub(super) fn page(query: &str) -> Result<(u64, usize), Problem> {
    let (mut before, mut limit) = (u64::MAX, JOBS_PER_PAGE);
    if let Some(fault) = repeated(query).into_iter().next() {
        return Err(Problem::invalid(vec![fault]));
    }
    for (name, value) in form_urlencoded::parse(query.as_bytes()) {
        let place = format!("?{}", shortened(&name));
        let wrong = |detail: String| Problem::invalid(vec![Fault::new(place, detail)]);
        let number = value.parse().ok().filter(|_| value.bytes().all(|byte| byte.is_ascii_digit()));
        match (&*name, number) {
            ("cursor", Some(number)) => before = number,
            ("cursor", None) => return Err(wrong("it is no cursor; take \"next\" of the page before".to_owned())),
            ("limit", Some(number @ 1..=LARGEST_PAGE)) => limit = usize::try_from(number).unwrap_or(JOBS_PER_PAGE),
            ("limit", _) => return Err(wrong(format!("give a number from 1 to {LARGEST_PAGE}"))),
            _ => return Err(wrong("it is unknown; known are limit and cursor".to_owned())),
        }
    }
    Ok((before, limit))
}
