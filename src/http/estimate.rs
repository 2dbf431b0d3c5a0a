//! POST /v1/estimate: exact counts, bytes (exact or an upper bound), predicted cost, and the key; computes nothing but
//! the search for the level of a tolerance.

use axum::Json;
use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;

use super::app::SharedApp;
use super::client::Client;
use super::content::AcceptedBodies;
use super::problem::Problem;
use super::{body, negotiate, reading};
use crate::wire::JobRequest;
use crate::wire::answer::EstimateAnswer;
use crate::wire::query::refuse_parameters;

/// What a job would come to: exact counts a level, bytes and key of each output, predicted time and memory.
///
/// Refused as the job would be, but for what only its coordinates show, such as numbers beyond the range of f32 in glTF
/// or STL.
#[utoipa::path(
    post, path = "/v1/estimate", tag = "questions", request_body = JobRequest,
    responses(
        (status = 200, description = "What it would come to", body = EstimateAnswer),
    )
)]
pub(super) async fn estimate(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    RawQuery(query): RawQuery,
    body: Body,
) -> Result<Json<EstimateAnswer>, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    refuse_parameters(query.as_deref().unwrap_or_default(), &[]).map_err(Problem::invalid)?;
    let read =
        reading::job(&app, client.peer(), sent, usize::MAX, |request| negotiate::settle(&HeaderMap::new(), request));
    let admitted = reading::admit(&app, client.peer(), read.await?.job).await?;
    Ok(Json(EstimateAnswer::new(admitted.job(), admitted.estimate())))
}
