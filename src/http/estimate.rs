//! POST /v1/estimate: exact counts and bytes, predicted cost, the key; runs nothing.

use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};

use super::problem::Problem;
use super::resolve::resolve;
use super::{Shared, body, render};
use crate::wire::JobRequest;
use crate::wire::answer::EstimateAnswer;
use crate::wire::output::OutputRequest;

/// What a job would come to: exact counts a level, bytes and key of each output, predicted time and memory.
///
/// Refused as the job would be, but for what only its coordinates show, such as numbers beyond the range of f32 in glTF or STL.
#[utoipa::path(
    post, path = "/v1/estimate", tag = "questions", request_body = JobRequest,
    responses(
        (status = 200, description = "What it would come to", body = EstimateAnswer),
    )
)]
pub(super) async fn estimate(State(app): State<Shared>, headers: HeaderMap, body: Body) -> Response {
    let answer = async {
        let mut request: JobRequest = body::json(&app, &headers, body).await?;
        if request.outputs.is_empty() {
            let format = super::negotiate::format(&HeaderMap::new(), request.shape_kind())?;
            request.outputs = vec![OutputRequest::of_format(format.name())];
        }
        let job = resolve(&app, request, usize::MAX).await?;
        let admitted = render::admit(&app, job).await?;
        Ok::<_, Problem>(axum::Json(EstimateAnswer::new(admitted.job(), admitted.estimate())))
    };
    answer.await.into_response()
}
