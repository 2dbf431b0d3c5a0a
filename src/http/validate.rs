//! POST /v1/validate: what can be said of a mesh before it is refined.

use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde::de::IgnoredAny;
use utoipa::ToSchema;

use super::app::Shared;
use super::body;
use super::client::Client;
use super::content::Takes;
use super::problem::Problem;
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::Input;
use crate::scheme::plan::{Plan, PlanInput};
use crate::wire::answer::{FaultAnswer, MeshReport, ValidateAnswer};
use crate::wire::input::InputRequest;
use crate::wire::object;
use crate::wire::plan::PlanRequest;
use crate::wire::read::{read, weight};

/// The question: an input, as in a job.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ValidateRequest {
    /// The mesh (or polygons) to be checked.
    #[serde(deserialize_with = "object::one")]
    input: InputRequest,
    /// The rest of a job, which is not looked at: a job may be sent as it is.
    #[serde(rename = "spec")]
    #[schema(value_type = Option<serde_json::Value>)]
    _spec: Option<IgnoredAny>,
    /// The plan that latitude lines are judged by, push-back with delta 1 when left out; one that does not fit the mesh is
    /// the reason why no line is exact.
    #[serde(default, deserialize_with = "object::optional")]
    plan: Option<PlanRequest>,
    /// Not looked at.
    #[serde(rename = "levels")]
    #[schema(value_type = Option<serde_json::Value>)]
    _levels: Option<IgnoredAny>,
    /// Not looked at.
    #[serde(rename = "outputs")]
    #[schema(value_type = Option<serde_json::Value>)]
    _outputs: Option<IgnoredAny>,
}

/// Reports what a mesh is like: manifold, boundary loops, valences, degenerate faces, each fault with its index.
#[utoipa::path(
    post, path = "/v1/validate", tag = "questions", request_body = ValidateRequest,
    responses(
        (status = 200, description = "The report; `valid` tells whether a job would take the input",
            body = ValidateAnswer),
    )
)]
pub(super) async fn validate(State(app): State<Shared>, client: Client, headers: HeaderMap, body: Body) -> Response {
    let answer = async {
        let sent = body::collect(&app, &client, &headers, Takes::Jobs, body).await?;
        let (limits, bytes) = (app.desk.limits.reading(), weight(sent.bytes.len() as u64));
        let report = app.desk.read(client.peer(), bytes, move |_| {
            let request: ValidateRequest = read(&sent.bytes)?;
            Ok::<_, Problem>(axum::Json(report(request.input, request.plan, &limits)))
        });
        report.await?
    };
    answer.await.into_response()
}

fn report(input: InputRequest, plan: Option<PlanRequest>, limits: &ReadLimits) -> ValidateAnswer {
    match input.resolve(limits).map(|resolved| resolved.input) {
        Ok(Input::Mesh(mesh)) => {
            let input = Input::Mesh(mesh.clone());
            let plan = judge(&input, plan);
            let report = Some(MeshReport::new(&mesh, plan.as_ref().map_err(String::as_str)));
            ValidateAnswer { valid: true, errors: Vec::new(), warnings: mesh.warnings(), report }
        }
        Ok(Input::Polygons(_)) => {
            ValidateAnswer { valid: true, errors: Vec::new(), warnings: Vec::new(), report: None }
        }
        Err(faults) => {
            let errors: Vec<Fault> = under("/input", faults);
            let errors = errors.into_iter().map(FaultAnswer::from).collect();
            ValidateAnswer { valid: false, errors, warnings: Vec::new(), report: None }
        }
    }
}

/// The plan that latitude lines are judged by, or why it does not fit the input.
fn judge(input: &Input, plan: Option<PlanRequest>) -> Result<Plan, String> {
    let usual = || PlanInput { preset: Some("push-back".into()), ..PlanInput::default() };
    let plan = plan.map_or_else(usual, PlanRequest::resolve);
    input.plan(&plan).map_err(|faults| faults.into_iter().next().map_or_else(String::new, |fault| fault.detail))
}
