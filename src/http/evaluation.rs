//! POST /v1/evaluate: values of the limit surface of a mesh at places on its faces, and the places closest to points.

use std::io::Write;
use std::sync::Arc;

use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;

use super::analyses::made;
use super::app::SharedApp;
use super::body::Sent;
use super::client::Client;
use super::content::AcceptedBodies;
use super::problem::Problem;
use super::reading::ReadJob;
use super::{body, reading};
use crate::job::key::Key;
use crate::job::{Evaluation, KeepWork, Report, RunError};
use crate::service::peer::Paid;
use crate::service::task::{Cost, Task};
use crate::watch::{Stage, Watch};
use crate::wire::evaluation::{EvaluationAnswer, EvaluationRequest, places};
use crate::wire::read::{read, reading_memory};

/// Evaluates the Catmull-Clark limit surface of a mesh at places on its faces: positions, normals, derivatives and
/// curvatures; and finds the places of the surface that are closest to points.
///
/// Values are exact but for rounding, at boundaries, creases, corners and holes and next to extraordinary vertices,
/// too; no level of refinement has any influence. At vertices around which the surface is not bicubic, derivatives and
/// curvatures are null. Of places that are equally close one is told; of faces that share it, the lowest. Other schemes
/// are refused.
#[utoipa::path(
    post, path = "/v1/evaluate", tag = "questions", request_body = EvaluationRequest,
    params(
        ("If-None-Match" = Option<String>, Header, description = "ETags of answers that the client has"),
    ),
    responses(
        (status = 200, description = "The values, in the order of the places", body = EvaluationAnswer),
        (status = 304, description = "The client has the answer already (`If-None-Match`)"),
    )
)]
pub(super) async fn evaluate(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    let (bytes, peer) = (reading_memory(sent.bytes.len() as u64), client.peer());
    // the body stays charged while its places are in memory
    let text = sent.bytes.clone();
    let request = app.desk.read(peer, bytes, move |_| {
        let request: EvaluationRequest = read(&text)?;
        let at = places(&request.at).map_err(Problem::invalid)?;
        let (values, job) = (request.values().map_err(Problem::invalid)?, request.job());
        Ok::<_, Problem>((at, request.closest, values, job))
    });
    let (at, closest, values, job) = request.await??;
    let ReadJob { job, input, .. } = reading::job(&app, peer, Sent::job(job.into()), 1, |_| Ok(())).await?;
    let admitted = reading::admit(&app, peer, job).await?;
    let made_of = move |_: &Watch| Evaluation::new(admitted, at, closest, values).map_err(Problem::invalid);
    let evaluation = app.desk.read(peer, bytes, made_of).await??;
    let (needs, has) = (evaluation.bytes(), app.desk.account.long.capacity);
    if needs > u128::from(has) {
        let needs = u64::try_from(needs).unwrap_or(u64::MAX);
        return Err(reading::too_large("the evaluation takes", needs, has));
    }
    let answer = made(&app, &client, &headers, Arc::new(EvaluationTask { evaluation, _input: input }), "json").await;
    drop(sent);
    answer
}

/// The task of an evaluation.
#[derive(Debug)]
struct EvaluationTask {
    evaluation: Evaluation,
    /// The memory of its mesh.
    _input: Arc<Paid>,
}

impl Task for EvaluationTask {
    fn key(&self) -> Key {
        self.evaluation.key()
    }

    fn cost(&self) -> Cost {
        Cost {
            memory_bytes: self.evaluation.bytes(),
            time_ms: self.evaluation.milliseconds(),
            work: self.evaluation.work(),
            result_bytes: self.evaluation.result_bytes(),
        }
    }

    fn media_type(&self) -> &'static str {
        "application/json"
    }

    fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        let found = self.evaluation.run(watch)?;
        watch.enter(Stage::Encode);
        let answer = EvaluationAnswer::new(&found, self.evaluation.values());
        serde_json::to_writer(out, &answer).map_err(|error| RunError::Io(error.into()))?;
        Ok(Report::default())
    }
}
