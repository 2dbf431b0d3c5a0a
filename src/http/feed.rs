//! Server-sent events about a job or a batch.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use serde_json::{Value, json};
use tokio::sync::watch;

use super::app::App;
use super::client::Client;
use super::problem::Problem;
use crate::service::jobs::JobPhase;
use crate::service::peer::{Paid, QuotaKind, Ticket};
use crate::service::pool::{Lack, Lane};

/// Maximum silence of a stream: half of what proxies usually allow. Half of it wakes idle connections twice as often;
/// twice of it is cut by some proxies.
const HEARTBEAT_INTERVAL: Duration = Duration::from_secs(15);
/// Interval of looking for progress. Half of it reports more than eyes follow; twice of it makes progress bars jump.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(200);
/// Minimum memory booked for a stream, in bytes: an event with 64 outputs, and the one before it that is still being
/// sent. Half of it is less than that; twice of it lets half as many clients listen.
const LEAST_FEED_BYTES: u64 = 64 << 10;

/// The state of a job or batch that a client follows.
pub(super) trait Followed {
    /// Returns a number that grows with every change.
    fn sequence(&self) -> u64;
    /// Returns the phase.
    fn phase(&self) -> &JobPhase;
    /// Returns the complete state as JSON, for the events `state` and `done`.
    fn whole(&self) -> Value;
    /// Returns the progress as JSON, for the event `progress`.
    fn progress(&self) -> Value;
}

/// Returns the current state, or `None` if the job or batch has been forgotten.
pub(super) type StateLookup = Box<dyn Fn(&App) -> Option<Box<dyn Followed>> + Send + Sync>;

/// Returns the event stream of a job or batch with the state `now`. `ended` becomes true when nothing more will happen
/// to it, and `look` returns its state at any time.
pub(super) fn stream(
    app: &Arc<App>,
    (client, headers): (&Client, &HeaderMap),
    now: Box<dyn Followed>,
    ended: watch::Receiver<bool>,
    look: StateLookup,
) -> Result<Response, Problem> {
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok()).and_then(|id| id.trim().parse().ok());
    let feed = Feed::new(seen, app.desk.clock().now());
    if feed.has_seen_the_end(&*now) {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let bytes = LEAST_FEED_BYTES.max(2 * now.whole().to_string().len() as u64);
    drop(now); // an interest in a computation would stay with it
    let listener = Listener::new(app, client, bytes, (look, feed, ended));
    let listener = listener.ok_or_else(|| app.desk.pool.busy(Lane::Long, Lack::Streams))?;
    let body = Body::from_stream(stream::unfold(listener, Listener::next));
    let head = [
        (header::CONTENT_TYPE, "text/event-stream"),
        (header::CACHE_CONTROL, "no-store"),
        // some proxies would buffer the events
        (HeaderName::from_static("x-accel-buffering"), "no"),
    ];
    Ok((head, body).into_response())
}

/// One client that listens.
struct Listener {
    app: Arc<App>,
    look: StateLookup,
    feed: Feed,
    ended: watch::Receiver<bool>,
    _held: (Ticket, Paid),
}

impl Listener {
    /// Creates a listener if there is room: all listeners may have a quarter of the connections, one peer half of that.
    fn new(
        app: &Arc<App>,
        client: &Client,
        bytes: u64,
        (look, feed, ended): (StateLookup, Feed, watch::Receiver<bool>),
    ) -> Option<Self> {
        let (desk, peer) = (&app.desk, client.peer());
        let most = (app.settings.max_connections as u64 / 4).max(2);
        let ticket = desk.peers.take(peer, QuotaKind::Listening, 1, most / 2, most)?;
        let paid = desk.peers.charge(&desk.account.answers, QuotaKind::AnswerBytes, peer, bytes).ok()?;
        Some(Self { app: app.clone(), look, feed, ended, _held: (ticket, paid) })
    }

    /// Waits for the next event; `None` when the stream ends.
    async fn next(mut self) -> Option<(Result<String, Infallible>, Self)> {
        loop {
            if self.feed.is_done || self.app.desk.is_ending() {
                return None;
            }
            // only for this statement, as the state holds an interest in a computation
            let event = self.feed.next((self.look)(&self.app).as_deref(), self.app.desk.clock().now());
            if let Some(event) = event {
                return Some((Ok(event), self));
            }
            let has_ended = *self.ended.borrow();
            tokio::select! {
                () = tokio::time::sleep(PROGRESS_INTERVAL) => {}
                () = self.app.desk.ended() => {}
                _ = self.ended.wait_for(|ended| *ended), if !has_ended => {}
            }
        }
    }
}

/// The events that a client has been sent.
#[derive(Debug)]
struct Feed {
    /// The number of the last event that the client saw.
    seen: Option<u64>,
    /// The last complete state that was sent, and its phase.
    last_state: Option<(Value, JobPhase)>,
    last_sent: Duration,
    is_done: bool,
}

impl Feed {
    fn new(seen: Option<u64>, now: Duration) -> Self {
        Self { seen, last_state: None, last_sent: now, is_done: false }
    }

    fn has_seen_the_end(&self, standing: &dyn Followed) -> bool {
        standing.phase().is_settled() && self.seen.is_some_and(|seen| seen > standing.sequence())
    }

    /// Returns the event to be sent at time `now`; `standing` is the current state, or `None` if it has been forgotten.
    fn next(&mut self, standing: Option<&dyn Followed>, now: Duration) -> Option<String> {
        let event = match standing {
            Some(standing) => self.changed(standing),
            None => Some(self.forgotten()),
        };
        let event = event.or_else(|| {
            let is_silent = now.saturating_sub(self.last_sent) >= HEARTBEAT_INTERVAL;
            is_silent.then(|| ": it goes on\n\n".to_owned())
        })?;
        self.last_sent = now;
        Some(event)
    }

    fn changed(&mut self, standing: &dyn Followed) -> Option<String> {
        let number = standing.sequence();
        let is_new = self.seen.is_none_or(|seen| number > seen);
        let is_known = self.last_state.as_ref().is_some_and(|(_, phase)| phase == standing.phase());
        if !is_new && !standing.phase().is_settled() {
            return None;
        }
        if is_known && standing.phase().is_settled() {
            self.is_done = true;
            return Some(event(number + 1, "done", &standing.whole()));
        }
        self.seen = Some(number);
        if is_known {
            return Some(event(number, "progress", &standing.progress()));
        }
        let whole = standing.whole();
        let sent = event(number, "state", &whole);
        self.last_state = Some((whole, standing.phase().clone()));
        Some(sent)
    }

    /// Returns the last event of a job or batch that has been forgotten.
    fn forgotten(&mut self) -> String {
        self.is_done = true;
        let number = self.seen.map_or(0, |seen| seen + 1);
        let mut whole = self.last_state.take().map_or_else(|| json!({}), |(whole, _)| whole);
        whole["state"] = "cancelled".into();
        event(number, "done", &whole)
    }
}

/// Formats an event; serialized JSON has no line breaks.
fn event(number: u64, name: &str, data: &Value) -> String {
    format!("id: {number}\nevent: {name}\ndata: {data}\n\n")
}
