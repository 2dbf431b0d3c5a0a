//! POST /v1/compare: the differences between two pictures, or between two shapes.

use std::io::Write;
use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, header};
use axum::response::{IntoResponse, Response};

use super::address::of_extension;
use super::app::{App, SharedApp};
use super::client::Client;
use super::compared::{self, Booked};
use super::content::AcceptedBodies;
use super::problem::Problem;
use super::{body, reading};
use crate::fault::Fault;
use crate::job::key::Key;
use crate::job::{Comparison, KeepWork, Report, RunError};
use crate::service::peer::Peer;
use crate::service::task::{Cost, Task};
use crate::watch::Watch;
use crate::wire::comparison::{ComparisonAnswer, ComparisonRequest, DifferenceAnswer};
use crate::wire::read::{read, reading_memory};

/// Upper bound of an answer in bytes. It bounds only the memory that is booked beforehand: half of it is still more
/// than two boxes, four places and two hashes take.
const COMPARISON_ANSWER_BYTES: u128 = 4 << 10;
/// Upper bounds of the bytes per pixel of a difference picture, and of the bytes around the pixels.
const PICTURE_BYTES: [u128; 2] = [4, 64 << 10];

/// Compares two pictures, or two shapes.
///
/// Each is an artifact, an upload (a mesh file, or a PNG) or a job. Pictures that this service drew are compared pixel
/// by pixel by equality, others, and all where a `threshold` is given, as they are seen: by the distance of colours in
/// YIQ, without pixels that smooth an edge, as pixelmatch does. Shapes are compared by the Hausdorff distance both
/// ways, and by what changes of box, area, volume and shape hash; meshes are taken as their faces cut into triangles.
///
/// The same comparison asked again is not made again.
#[utoipa::path(
    post, path = "/v1/compare", tag = "questions", request_body = ComparisonRequest,
    responses(
        (status = 200, description = "What differs", body = ComparisonAnswer),
    )
)]
pub(super) async fn compare(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let sent = body::collect(&app, &client, &headers, AcceptedBodies::Jobs, body).await?;
    let (bytes, peer) = (reading_memory(sent.bytes.len() as u64), client.peer());
    let (request, tolerances) = app
        .desk
        .read(peer, bytes, move |_| {
            let request: ComparisonRequest = read(&sent.bytes)?;
            let tolerances = request.tolerances().map_err(Problem::invalid)?;
            Ok::<_, Problem>((request, tolerances))
        })
        .await??;
    let a = compared::side(&app, peer, "/a", &request.a).await?;
    let b = compared::side(&app, peer, "/b", &request.b).await?;
    let (sides, paid) = ([a.side, b.side], [a.paid, b.paid]);
    let comparison = Arc::new(Comparison::new(sides, tolerances).map_err(Problem::invalid)?);
    if !request.outputs.is_empty() && !comparison.has_picture() {
        let detail = "only two pictures of one size have a picture of what differs; leave the outputs out";
        return Err(Problem::invalid(vec![Fault::new("/outputs", detail)]));
    }
    let paid = Arc::new(paid);
    let task = |what| ComparisonTask { comparison: comparison.clone(), what, _paid: paid.clone() };
    let (answer, is_hit) = made(&app, peer, task(ComparisonProduct::Answer)).await?;
    let mut answer: serde_json::Map<_, _> = serde_json::from_slice(&answer).map_err(|_| compared::lost())?;
    if !request.outputs.is_empty() {
        let picture = task(ComparisonProduct::Picture);
        let id = picture.key().to_string();
        made(&app, peer, picture).await?;
        let href = of_extension(&id, "png");
        let outputs = vec![DifferenceAnswer { format: "png", id, href }];
        answer.insert("outputs".to_owned(), serde_json::to_value(outputs).map_err(|_| compared::lost())?);
    }
    let status = if is_hit { "planish; hit" } else { "planish; fwd=miss; stored" };
    let kept = [(HeaderName::from_static("cache-status"), status), (header::CACHE_CONTROL, "no-cache")];
    Ok((kept, axum::Json(answer)).into_response())
}

/// Returns the first part of a task's result, and whether it was in the cache.
async fn made(app: &Arc<App>, peer: Peer, task: ComparisonTask) -> Result<(Bytes, bool), Problem> {
    reading::first_part(app, peer, Arc::new(task), "the comparison takes").await?.ok_or_else(compared::lost)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ComparisonProduct {
    Answer,
    Picture,
}

/// The task of a comparison.
#[derive(Debug)]
struct ComparisonTask {
    comparison: Arc<Comparison>,
    what: ComparisonProduct,
    /// The memory of both sides.
    _paid: Arc<[Booked; 2]>,
}

impl Task for ComparisonTask {
    fn key(&self) -> Key {
        match self.what {
            ComparisonProduct::Answer => self.comparison.key(),
            ComparisonProduct::Picture => self.comparison.picture_key(),
        }
    }

    fn cost(&self) -> Cost {
        let [of_pixel, around] = PICTURE_BYTES;
        let result_bytes = match self.what {
            ComparisonProduct::Answer => COMPARISON_ANSWER_BYTES,
            ComparisonProduct::Picture => u128::from(self.comparison.pixels()) * of_pixel + around,
        };
        Cost {
            memory_bytes: self.comparison.bytes(),
            time_ms: self.comparison.milliseconds(),
            work: self.comparison.work(),
            result_bytes,
        }
    }

    fn media_type(&self) -> &'static str {
        match self.what {
            ComparisonProduct::Answer => "application/json",
            ComparisonProduct::Picture => "image/png",
        }
    }

    fn run(&self, out: &mut dyn Write, kept: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        let found = self.comparison.run(kept, watch)?;
        match self.what {
            ComparisonProduct::Answer => {
                let bytes = serde_json::to_vec(&ComparisonAnswer::new(&found)).expect("numbers and text");
                out.write_all(&bytes).map_err(RunError::Io)?;
            }
            ComparisonProduct::Picture => found.write_picture(out)?,
        }
        Ok(Report::default())
    }
}
