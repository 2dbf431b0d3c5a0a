//! POST /v1/validate: the checks of a job without refining anything.

use axum::Json;
use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;

use super::app::SharedApp;
use super::blobs::attached;
use super::client::Client;
use super::content::AcceptedBodies;
use super::problem::Problem;
use super::reading::too_much;
use super::{body, negotiate};
use crate::fault::Fault;
use crate::job::{Draft, Input};
use crate::scheme::plan::{Plan, PlanInput};
use crate::wire::JobRequest;
use crate::wire::answer::{FaultAnswer, MeshReport, ValidateAnswer};
use crate::wire::examined::Examined;
use crate::wire::query::refuse_parameters;
use crate::wire::read::reading_memory;

/// What is wrong with a job, and what its mesh is like: boundary loops, valences, degenerate faces, latitude lines.
///
/// The whole job is looked at, as `/v1/render` would, and all its faults are told together; an input alone is looked at
/// as one that is to be refined. Nothing is refined. A job that would be too large here is not valid here; only where
/// the level of a tolerance is still to be searched for, which `/v1/estimate` does, that is left open.
#[utoipa::path(
    post, path = "/v1/validate", tag = "questions", request_body = JobRequest,
    responses(
        (status = 200, description = "What was found; `valid` tells whether the job can be done",
            body = ValidateAnswer),
    )
)]
pub(super) async fn validate(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    RawQuery(query): RawQuery,
    body: Body,
) -> Result<Json<ValidateAnswer>, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    refuse_parameters(query.as_deref().unwrap_or_default(), &[]).map_err(Problem::invalid)?;
    let sent = match attached(&app, client.peer(), sent).await.map_err(Problem::faults) {
        Ok(sent) => sent,
        // an unknown upload is a fault of the job like others
        Err(Ok(faults)) => return Ok(Json(report(Examined { faults, ..Examined::default() }))),
        Err(Err(problem)) => return Err(problem),
    };
    let (limits, bytes) = (app.desk.limits.reading(), reading_memory(sent.length()));
    let examined = app.desk.read(client.peer(), bytes, move |_| {
        let mut request = sent.request()?;
        let purpose = request.stated_purpose();
        negotiate::settle(&HeaderMap::new(), &mut request)?;
        Ok::<_, Problem>(request.examine(purpose, &limits))
    });
    let mut examined = examined.await??;
    let bytes = examined.draft.as_ref().map_or(0, Draft::bytes);
    let most = app.desk.account.inputs.capacity / 2;
    if bytes > most {
        examined.faults.push(Fault::new("/input", too_much("the input takes", bytes, most)));
        return Ok(Json(report(examined)));
    }
    let forecast = if let Some(Draft::Job(job)) = &examined.draft { job.forecast_bytes() } else { 0 };
    let limits = app.desk.limits;
    let bounded = app.desk.read(client.peer(), forecast, move |watch| report(examined.bounded(&limits, watch)));
    Ok(Json(bounded.await?))
}

/// Returns the answer with the findings about a job.
pub(crate) fn report(Examined { faults, input, plan, .. }: Examined) -> ValidateAnswer {
    let mut answer = ValidateAnswer {
        valid: faults.is_empty(),
        errors: faults.into_iter().map(FaultAnswer::from).collect(),
        warnings: Vec::new(),
        report: None,
    };
    if let Some(input @ Input::Mesh(mesh)) = &input {
        answer.warnings = mesh.warnings();
        answer.report = Some(MeshReport::new(mesh, judge(input, plan).as_ref().map_err(String::as_str)));
    }
    answer
}

/// Returns the plan for which latitude lines are checked (the usual one for them if the job has none), or why it does
/// not fit the input.
fn judge(input: &Input, plan: Option<PlanInput>) -> Result<Plan, String> {
    let plan = plan.unwrap_or_else(PlanInput::usual_for_latitude_lines);
    input.plan(&plan).map_err(|faults| faults.into_iter().next().map_or_else(String::new, |fault| fault.detail))
}
