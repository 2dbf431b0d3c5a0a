//! Request bodies: bounded in length, in silence and in slowness, with their memory taken from the account as they
//! arrive.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, header};
use http_body::Body;
use http_body_util::BodyExt;
use tokio::time::Instant;

use super::app::App;
use super::client::Client;
use super::pace::Pace;
use super::problem::{self, Problem};
use crate::fault::shortened;
use crate::job::amounts::in_bytes;
use crate::service::account::Held;
use crate::service::peer::{Kind, Ticket};
use crate::service::pool::Lane;

/// Bodies up to this length take nothing from the account: with one a connection they are bounded by the connections,
/// and a small request gets in though large ones have taken all there is.
/// Twice of it may hold twice as much beside the account for each connection; half of it lets more small requests wait
/// for the account.
const SHORT_BYTES: usize = 16 << 10;

/// Of a body that is refused, so much is read and forgotten at most.
/// A client that is still sending reads no answer before it has sent all. Half of it cuts off more such clients; twice
/// of it reads twice as much for nothing.
const DRAINED_BYTES: u64 = 64 << 20;

/// The body of a request, with the memory it takes.
#[derive(Debug, Clone)]
pub(super) struct Sent {
    /// The body.
    pub(super) bytes: Bytes,
    _charge: Option<Arc<Charge>>,
}

impl Sent {
    /// A request that was sent before; whoever kept it has its memory.
    pub(super) fn again(bytes: Bytes) -> Self {
        Self { bytes, _charge: None }
    }
}

/// The bytes of a body that says it is JSON.
pub(super) async fn collect<B>(app: &App, client: &Client, headers: &HeaderMap, mut body: B) -> Result<Sent, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    let collected = collected(app, client, headers, &mut body).await;
    let is_coming =
        collected.as_ref().is_err_and(|problem| !problem.is(problem::SLOW) && !problem.is(problem::NOT_JSON));
    if is_coming && !headers.contains_key(header::EXPECT) && announced(headers).unwrap_or(0) <= DRAINED_BYTES {
        drain(body, Duration::from_secs(app.settings.body_timeout_s)).await;
    }
    client.has_sent();
    collected
}

/// What a body takes from the account, and from its peer's part of it.
#[derive(Debug, Default)]
struct Charge {
    memory: Option<Held>,
    ticket: Option<Ticket>,
}

impl Charge {
    /// Takes what a buffer of so many bytes needs in all, before it is allocated; short bodies are free, as there can
    /// only be one a connection.
    fn cover(&mut self, app: &App, client: &Client, bytes: usize) -> Result<(), Problem> {
        let more = (bytes as u64).saturating_sub(self.memory.as_ref().map_or(0, Held::bytes));
        if bytes <= SHORT_BYTES || more == 0 {
            return Ok(());
        }
        let bodies = &app.desk.account.bodies;
        let most_a_peer = bodies.capacity / 2;
        let peers = &app.desk.peers;
        let is_fair = if let Some(ticket) = &mut self.ticket {
            ticket.grow(more, most_a_peer, bodies.capacity)
        } else {
            self.ticket = peers.take(client.peer(), Kind::BodyBytes, more, most_a_peer, bodies.capacity);
            self.ticket.is_some()
        };
        let is_there = is_fair
            && if let Some(memory) = &mut self.memory {
                memory.grow(more).is_ok()
            } else {
                self.memory = bodies.try_take(more).ok();
                self.memory.is_some()
            };
        if is_there { Ok(()) } else { Err(app.desk.pool.busy(Lane::Reading).into()) }
    }
}

/// Reads the rest of a refused body and forgets it: most clients read no answer before they have sent everything.
async fn drain(mut body: impl Body<Data = Bytes> + Unpin, most: Duration) {
    let mut left = DRAINED_BYTES;
    let reading = async {
        while let Some(Ok(frame)) = body.frame().await {
            let length = frame.data_ref().map_or(0, Bytes::len) as u64;
            let Some(rest) = left.checked_sub(length) else { return };
            left = rest;
        }
    };
    // a client that takes longer than `most` has to do without the answer
    let _ = tokio::time::timeout(most, reading).await;
}

/// The length that the client says the body has.
fn announced(headers: &HeaderMap) -> Option<u64> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

async fn collected<B>(app: &App, client: &Client, headers: &HeaderMap, body: &mut B) -> Result<Sent, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    check_media_type(headers)?;
    let limit = app.settings.max_body_bytes;
    let too_long = |length: u64| {
        let detail = format!(
            "the body has {} bytes or more; this server reads {}: send a smaller input",
            length,
            in_bytes(limit.into())
        );
        Problem::new(problem::BODY_TOO_LONG, detail)
    };
    if let Some(length) = announced(headers).filter(|length| *length > limit) {
        return Err(too_long(length));
    }
    let pace =
        Pace { grace: Duration::from_secs(app.settings.body_timeout_s), least_rate: app.settings.least_rate_bytes_s };
    let (start, mut charge, mut bytes) = (Instant::now(), Charge::default(), Vec::new());
    loop {
        let late = Instant::now() + pace.grace;
        let slow = start + pace.allows(bytes.len() as u64);
        let frame = tokio::time::timeout_at(late.min(slow), body.frame()).await;
        let Some(frame) = frame.map_err(|_| too_slow(pace, late < slow))? else {
            return Ok(Sent { bytes: bytes.into(), _charge: Some(Arc::new(charge)) });
        };
        let frame = frame.map_err(|_| Problem::new(problem::NOT_JSON, "the body broke off; send it again"))?;
        let Ok(data) = frame.into_data() else { continue };
        let length = bytes.len() + data.len();
        if length as u64 > limit {
            return Err(too_long(length as u64));
        }
        if length > bytes.capacity() {
            // twice as much each time, but no more than was announced
            let most = announced(headers).and_then(|length| usize::try_from(length).ok()).unwrap_or(usize::MAX);
            let capacity = (2 * bytes.capacity()).min(most).max(length);
            charge.cover(app, client, capacity)?;
            bytes.reserve_exact(capacity - bytes.len());
        }
        bytes.extend_from_slice(&data);
    }
}

/// The refusal of a body that stopped arriving, or arrives too slowly.
fn too_slow(pace: Pace, is_silent: bool) -> Problem {
    let seconds = pace.grace.as_secs();
    let detail = if is_silent {
        format!("no byte of the body arrived for {seconds} s; send it again")
    } else {
        let rate = in_bytes(pace.least_rate.into());
        format!(
            "after {seconds} s the body arrives more slowly than at {rate} a second; send it again, or a smaller one"
        )
    };
    Problem::new(problem::SLOW, detail)
}

/// Of the codings that a body may come in, only `chunked` is read, and only alone.
fn check_transfer_coding(headers: &HeaderMap) -> Result<(), Problem> {
    let is_chunked = |value: &HeaderValue| value.as_bytes().trim_ascii().eq_ignore_ascii_case(b"chunked");
    let mut codings = headers.get_all(header::TRANSFER_ENCODING).iter();
    match (codings.next(), codings.next()) {
        (None, _) => Ok(()),
        (Some(coding), None) if is_chunked(coding) => Ok(()),
        (Some(coding), _) => {
            let coding = shortened(coding.to_str().unwrap_or("?"));
            let detail =
                format!("Transfer-Encoding \"{coding}\" is not read; send the JSON as it is, or chunked alone");
            Err(Problem::new(problem::TRANSFER_CODING, detail))
        }
    }
}

fn check_media_type(headers: &HeaderMap) -> Result<(), Problem> {
    check_transfer_coding(headers)?;
    if let Some(encoding) =
        headers.get(header::CONTENT_ENCODING).filter(|value| !value.as_bytes().eq_ignore_ascii_case(b"identity"))
    {
        let encoding = shortened(encoding.to_str().unwrap_or("?"));
        let detail = format!("Content-Encoding \"{encoding}\" is not read; send the JSON as it is");
        return Err(Problem::new(problem::MEDIA_TYPE, detail));
    }
    let given = headers.get(header::CONTENT_TYPE).map(|value| value.to_str().unwrap_or("?"));
    let essence = given.map(|value| value.split(';').next().unwrap_or("").trim().to_ascii_lowercase());
    match essence.as_deref() {
        Some("application/json") => Ok(()),
        Some(other) => {
            let other = shortened(other);
            let detail = format!("Content-Type is {other}; send the job as Content-Type: application/json");
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
        None => {
            let detail = "Content-Type is missing; send the job as Content-Type: application/json";
            Err(Problem::new(problem::MEDIA_TYPE, detail))
        }
    }
}
