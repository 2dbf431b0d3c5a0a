//! POST /v1/analyses: the analysis of a plan.

use std::io::Write;
use std::sync::Arc;

use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;

use super::answer::{self, Artifact, Lost};
use super::app::{App, SharedApp};
use super::client::Client;
use super::content::AcceptedBodies;
use super::negotiate::{self, ByteRange};
use super::problem::Problem;
use super::variants::coded;
use super::{address, body};
use crate::job::key::Key;
use crate::job::{Form, Inquiry, KeepWork, Report, RunError};
use crate::service::task::{Cost, Task};
use crate::watch::Watch;
use crate::wire::analysis::{AnalysisAnswer, AnalysisRequest};
use crate::wire::read::{read, reading_memory};

/// Upper bound of an answer in bytes: masks of 512 entries with the longest fractions, and the values of a fine grid.
/// It bounds only the memory that is booked beforehand. Masks of many digits may exceed half of it; twice of it lets
/// half as many analyses run.
const ANALYSIS_ANSWER_BYTES: u128 = 4 << 20;

/// Says what can be said of a plan for curves: mask, sum rules, support, certified smoothness, limit and tangent masks.
///
/// Everything is read off the operators' weights, without rounding where they are fractions. `proved_c` and
/// `disproved_c` are proofs; the intervals are as narrow as `nodes` lets them be, and never wrong. A plan and its word,
/// and parameters of the same value, have the same answer and `ETag`.
#[utoipa::path(
    post, path = "/v1/analyses", tag = "questions", request_body = AnalysisRequest,
    params(
        ("If-None-Match" = Option<String>, Header, description = "ETags of answers that the client has"),
        ("Accept" = Option<String>, Header, description = "The form of the answer: `application/json` with every \
            number by its name, `text/markdown` for a report to read, `image/svg+xml` or `image/png` for a figure of \
            one page"),
    ),
    responses(
        (status = 200, description = "What can be said", content(
            (AnalysisAnswer = "application/json"), (String = "text/markdown"), (String = "image/svg+xml"),
            (Vec<u8> = "image/png"),
        )),
        (status = 304, description = "The client has the answer already (`If-None-Match`)"),
    )
)]
pub(super) async fn analyse(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    let bytes = reading_memory(sent.bytes.len() as u64);
    let form = negotiate::form(&headers)?;
    let analysis = app.desk.read(client.peer(), bytes, move |watch| {
        let request: AnalysisRequest = read(&sent.bytes)?;
        request.resolve(form, watch).map_err(Problem::invalid)
    });
    let task = Arc::new(AnalysisTask(analysis.await??, form));
    made(&app, &client, &headers, task, form.extension()).await
}

/// Answers with the result of a task, found in the cache or computed now; `extension` completes the address of the
/// artifact.
///
/// # Errors
/// The reason why there is no result.
pub(super) async fn made(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    task: Arc<dyn Task>,
    extension: &str,
) -> Result<Response, Problem> {
    let key = task.key();
    if let Some(tag) = negotiate::has_already(headers, &key) {
        return Ok(answer::not_modified(HeaderMap::new(), tag, &address::of_extension(key, extension)));
    }
    if let Some(manifest) = app.desk.find_artifact(key, client.peer()).await {
        // a damaged artifact has been dropped from the store, and is computed again
        match whole(app, headers, Artifact::kept(manifest, client.peer()), (&key, extension)).await {
            Err(Lost::Gone) => {}
            answered => return Ok(answered?),
        }
    }
    let interest = app.desk.compute(task, client.peer())?;
    let outcome = interest.computation.outcome().await;
    let outcome = outcome.map_err(|failure| Problem::of_failure(failure, |refused| refused.fault))?;
    let found = Artifact::made(&outcome, interest.provenance, client.peer());
    Ok(whole(app, headers, found, (&key, extension)).await?)
}

async fn whole(
    app: &Arc<App>,
    headers: &HeaderMap,
    found: Artifact,
    (key, extension): (&Key, &str),
) -> Result<Response, Lost> {
    let found = coded(app, headers, found).await;
    let head = answer::headers(&found, &address::of_extension(key, extension));
    answer::bytes(app, found, head, ByteRange::Whole).await
}

/// The task that computes an analysis in one form.
#[derive(Debug)]
pub(super) struct AnalysisTask(pub(super) Inquiry, pub(super) Form);

impl Task for AnalysisTask {
    fn key(&self) -> Key {
        self.0.key(self.1)
    }

    fn cost(&self) -> Cost {
        let [memory_bytes, work, time_ms] = self.0.cost().map(u128::from);
        Cost { memory_bytes, time_ms, work, result_bytes: ANALYSIS_ANSWER_BYTES }
    }

    fn media_type(&self) -> &'static str {
        self.1.media_type()
    }

    fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        let answer = AnalysisAnswer::of(&self.0, watch).map_err(RunError::Stopped)?;
        answer.write(self.1, out, watch)?;
        Ok(Report::default())
    }
}
