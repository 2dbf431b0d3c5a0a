//! GET /v1/jobs/{id}/events: what happens to a job, as server-sent events.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use serde::Serialize;
use tokio::sync::watch;

use super::app::{App, Shared};
use super::client::Client;
use super::jobs;
use super::problem::Problem;
use super::segment::Segment;
use crate::service::job_key::JobKey;
use crate::service::jobs::{Phase, Standing};
use crate::service::peer::{Kind, Paid, Ticket};
use crate::service::pool::Lane;
use crate::wire::standing::{JobAnswer, ProgressAnswer};

/// How long a stream is silent at most: half of what proxies usually allow. Half of it wakes idle connections twice as
/// often; twice of it is cut by some proxies.
const HEARTBEAT: Duration = Duration::from_secs(15);
/// How often a job is looked at for progress. Half of it tells more than eyes follow; twice of it makes bars jump.
const LOOK: Duration = Duration::from_millis(200);
/// Booked for a stream: an event with 64 outputs, and the one before it that is still being sent.
/// Half of it is less than that; twice of it lets half as many listen.
const STREAM_BYTES: u64 = 64 << 10;

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
            state, progress and level", body = Object, content_type = "text/event-stream",
            example = "id: 4294968297\nevent: progress\ndata: {\"state\":\"running\",\"progress\":0.0}\n\n"),
        (status = 204, description = "The client has seen the end"),
    )
)]
pub(super) async fn events(
    State(app): State<Shared>,
    client: Client,
    Segment(id): Segment,
    headers: HeaderMap,
) -> Response {
    let found = jobs::parse(&client, &id).and_then(|job| Some((job, app.desk.standing(&job)?)));
    let Some((job, standing)) = found else { return jobs::unknown().into_response() };
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok()).and_then(|id| id.trim().parse().ok());
    let feed = Feed::new(seen, app.desk.now());
    if feed.has_seen_the_end(&standing) {
        return StatusCode::NO_CONTENT.into_response();
    }
    let ended = standing.record.ended.subscribe();
    drop(standing); // an interest in the computation would stay with it
    match Listener::new(&app, &client, job, (feed, ended)) {
        Some(listener) => {
            let body = Body::from_stream(stream::unfold(listener, Listener::next));
            let kind = [(header::CONTENT_TYPE, HeaderValue::from_static("text/event-stream"))];
            let kept = [(header::CACHE_CONTROL, HeaderValue::from_static("no-store"))];
            // proxies that hold answers back would hold events back
            let unbuffered = [(HeaderName::from_static("x-accel-buffering"), HeaderValue::from_static("no"))];
            (kind, kept, unbuffered, body).into_response()
        }
        None => Problem::from(app.desk.pool.busy(Lane::Long)).into_response(),
    }
}

/// One client that listens to one job.
struct Listener {
    app: Arc<App>,
    job: JobKey,
    feed: Feed,
    ended: watch::Receiver<bool>,
    _held: (Ticket, Paid),
}

impl Listener {
    /// A listener, where there is room for it: all of them have a quarter of the connections, one peer half of that.
    fn new(app: &Arc<App>, client: &Client, job: JobKey, of: (Feed, watch::Receiver<bool>)) -> Option<Self> {
        let (desk, peer) = (&app.desk, client.peer());
        let most = (app.settings.max_connections as u64 / 4).max(2);
        let ticket = desk.peers.take(peer, Kind::Listening, 1, most / 2, most)?;
        let paid = desk.peers.charge(&desk.account.answers, Kind::AnswerBytes, peer, STREAM_BYTES).ok()?;
        Some(Self { app: app.clone(), job, feed: of.0, ended: of.1, _held: (ticket, paid) })
    }

    /// The next event, when there is one.
    async fn next(mut self) -> Option<(Result<String, std::convert::Infallible>, Self)> {
        loop {
            if self.feed.is_done || self.app.desk.is_ending() {
                return None;
            }
            let standing = self.app.desk.standing(&self.job);
            if let Some(event) = self.feed.next(standing.as_ref(), self.app.desk.now()) {
                return Some((Ok(event), self));
            }
            drop(standing);
            let has_ended = *self.ended.borrow();
            tokio::select! {
                () = tokio::time::sleep(LOOK) => {}
                () = self.app.desk.ended() => {}
                _ = self.ended.wait_for(|ended| *ended), if !has_ended => {}
            }
        }
    }
}

/// What a client has been told of a job.
#[derive(Debug)]
struct Feed {
    /// The number of the last event that it saw.
    seen: Option<u64>,
    /// The last whole that it was told, and where the job stood.
    told: Option<(JobAnswer, Phase)>,
    last_sent: Duration,
    is_done: bool,
}

impl Feed {
    fn new(seen: Option<u64>, now: Duration) -> Self {
        Self { seen, told: None, last_sent: now, is_done: false }
    }

    fn has_seen_the_end(&self, standing: &Standing) -> bool {
        standing.is_settled() && self.seen.is_some_and(|seen| seen > standing.sequence())
    }

    /// What is to be told at this time, of a job that stands so, or is forgotten.
    fn next(&mut self, standing: Option<&Standing>, now: Duration) -> Option<String> {
        let event = match standing {
            Some(standing) => self.changed(standing),
            None => Some(self.forgotten()),
        };
        let event = event.or_else(|| {
            let is_silent = now.saturating_sub(self.last_sent) >= HEARTBEAT;
            is_silent.then(|| ": the job goes on\n\n".to_owned())
        })?;
        self.last_sent = now;
        Some(event)
    }

    fn changed(&mut self, standing: &Standing) -> Option<String> {
        let number = standing.sequence();
        let is_new = self.seen.is_none_or(|seen| number > seen);
        let is_known = self.told.as_ref().is_some_and(|(_, phase)| *phase == standing.phase);
        if !is_new && !standing.is_settled() {
            return None;
        }
        if is_known && standing.is_settled() {
            self.is_done = true;
            return Some(event(number + 1, "done", &jobs::answer(standing)));
        }
        self.seen = Some(number);
        if is_known {
            return Some(event(number, "progress", &ProgressAnswer::new(standing)));
        }
        let answer = jobs::answer(standing);
        let told = event(number, "state", &answer);
        self.told = Some((answer, standing.phase.clone()));
        Some(told)
    }

    /// The end of a job that somebody has forgotten.
    fn forgotten(&mut self) -> String {
        self.is_done = true;
        let number = self.seen.map_or(0, |seen| seen + 1);
        match &self.told {
            Some((answer, _)) => event(number, "done", &JobAnswer { state: "cancelled", ..answer.clone() }),
            None => event(number, "done", &serde_json::json!({ "state": "cancelled" })),
        }
    }
}

/// An event as it is sent; JSON has no line breaks.
fn event(number: u64, name: &str, data: &impl Serialize) -> String {
    let data = serde_json::to_string(data).expect("numbers and text");
    format!("id: {number}\nevent: {name}\ndata: {data}\n\n")
}
