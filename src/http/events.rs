//! GET /v1/jobs/{id}/events: the changes of a job, as server-sent events.

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use serde_json::{Value, json};

use super::app::SharedApp;
use super::client::Client;
use super::feed::{self, Followed};
use super::jobs;
use super::problem::Problem;
use super::segment::PathSegment;
use crate::service::jobs::{JobPhase, Standing};
use crate::wire::standing::ProgressAnswer;

/// What happens to a job, as it happens: `state` with the whole of it, at first and when it changes, `progress` with
/// how far it is, and `done` with the whole of it when nothing more will happen, which ends the stream.
///
/// Each event has a number that grows (`id`). A client that comes back with the last number that it saw
/// (`Last-Event-ID`, which browsers send by themselves) gets what has changed since; after `done` that is 204, which
/// tells browsers to stay away. A comment every 15 seconds keeps the connection alive.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "jobs",
    params(
        ("id" = String, Path, description = "Id of the job, 64 hexadecimal digits",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2"),
        ("Last-Event-ID" = Option<String>, Header, description = "The number of the last event that the client saw"),
    ),
    responses(
        (status = 200, description = "The events; the data of `state` and `done` is a `JobAnswer`, that of `progress` \
            state, progress and level", body = serde_json::Value, content_type = "text/event-stream",
            example = "id: 4294968297\nevent: progress\ndata: {\"state\":\"running\",\"progress\":0.0}\n\n"),
        (status = 204, description = "The client has seen the end"),
    )
)]
pub(super) async fn events(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let job = client.named(&id).ok_or_else(jobs::unknown)?;
    let standing = app.desk.standing(&job).ok_or_else(jobs::unknown)?;
    let ended = standing.record.ended.subscribe();
    let look: feed::StateLookup = Box::new(move |app| Some(Box::new(app.desk.standing(&job)?)));
    feed::stream(&app, (&client, &headers), Box::new(standing), ended, look)
}

impl Followed for Standing {
    fn sequence(&self) -> u64 {
        Self::sequence(self)
    }

    fn phase(&self) -> &JobPhase {
        &self.phase
    }

    fn whole(&self) -> Value {
        json!(jobs::answer(self))
    }

    fn progress(&self) -> Value {
        json!(ProgressAnswer::new(self))
    }
}
