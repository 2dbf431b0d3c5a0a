//! Request bodies: bounded in length, in silence and in slowness, with their memory taken from the account as they
//! arrive and as they are inflated.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use http_body::Body;
use http_body_util::BodyExt;
use tokio::time::Instant;

use super::app::App;
use super::charge::Charge;
use super::client::Client;
use super::content::{self, Coding, Kind, Notation, Takes};
use super::inflate::{inflated, too_long};
use super::pace::Pace;
use super::problem::{self, Problem};
use crate::input::Alone;
use crate::math::amounts::in_bytes;
use crate::output::Format;
use crate::wire::JobRequest;
use crate::wire::query::{job_of_file, job_text, read_as, text_as};
use crate::wire::read::{ReadError, read};
use crate::wire::text::MeshFile;

/// Of a body that is refused, so much is read and forgotten at most.
/// A client that is still sending reads no answer before it has sent all. Half of it cuts off more such clients; twice
/// of it reads twice as much for nothing.
const DRAINED_BYTES: u64 = 64 << 20;

/// The body of a request, with the memory it takes.
#[derive(Debug, Clone)]
pub(super) struct Sent {
    /// The body.
    pub(super) bytes: Bytes,
    /// How the request says what is asked for.
    pub(super) notation: Notation,
    _charge: Option<Arc<Charge>>,
}

impl Sent {
    /// A job that was sent before, or stands in an address; whoever kept it has its memory.
    pub(super) fn job(bytes: Bytes) -> Self {
        Self { bytes, notation: Notation::Job, _charge: None }
    }

    /// The same job, with an output of this format.
    pub(super) fn drawn(self, format: &'static dyn Format) -> Self {
        Self { notation: Notation::JobAs(format), ..self }
    }

    /// The request that the body, or the body and the query, say.
    ///
    /// # Errors
    /// [`ReadError`].
    pub(super) fn request(&self) -> Result<JobRequest, ReadError> {
        match &self.notation {
            Notation::Job => read(&self.bytes),
            Notation::JobAs(format) => read_as(format.name(), &self.bytes),
            Notation::File(reader, query) => job_of_file(query, file(reader.name, &self.bytes)),
        }
    }

    /// The text of the job, in a place of its own: a short request does not keep the buffer that it arrived in.
    pub(super) fn text(&self) -> Bytes {
        match &self.notation {
            Notation::Job => Bytes::copy_from_slice(&self.bytes),
            Notation::JobAs(format) => text_as(format.name(), &self.bytes).into(),
            Notation::File(reader, query) => job_text(query, reader.name, &self.bytes).into(),
        }
    }
}

fn file(format: &str, bytes: &[u8]) -> MeshFile {
    MeshFile { format: format.to_owned(), bytes: bytes.to_vec(), beside: Arc::new(Alone) }
}

/// The bytes of a body that says it is JSON, or a mesh file where these are read.
pub(super) async fn collect<B>(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    takes: Takes<'_>,
    mut body: B,
) -> Result<Sent, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    let collected = collected(app, client, headers, takes, &mut body).await;
    let is_coming =
        collected.as_ref().is_err_and(|problem| !problem.is(problem::SLOW) && !problem.is(problem::NOT_JSON));
    if is_coming && !headers.contains_key(header::EXPECT) && announced(headers).unwrap_or(0) <= DRAINED_BYTES {
        drain(body, Duration::from_secs(app.settings.body_timeout_s)).await;
    }
    client.has_sent();
    let Collected { bytes, charge, kind, coding } = collected?;
    let (bytes, charge) = inflated(app, client, coding, bytes, charge).await?;
    let notation = kind.notation(headers, takes, &bytes)?;
    Ok(Sent { bytes: bytes.into(), notation, _charge: Some(Arc::new(charge)) })
}

/// A body as it arrived.
struct Collected {
    bytes: Vec<u8>,
    charge: Charge,
    kind: Kind,
    coding: Coding,
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

async fn collected<B>(
    app: &App,
    client: &Client,
    headers: &HeaderMap,
    takes: Takes<'_>,
    body: &mut B,
) -> Result<Collected, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    let (kind, coding) = content::of(headers, takes)?;
    let limit = app.settings.max_body_bytes;
    if let Some(length) = announced(headers).filter(|length| *length > limit) {
        return Err(too_long(length, limit));
    }
    let pace =
        Pace { grace: Duration::from_secs(app.settings.body_timeout_s), least_rate: app.settings.least_rate_bytes_s };
    let (start, mut charge, mut bytes) = (Instant::now(), Charge::default(), Vec::new());
    loop {
        let late = Instant::now() + pace.grace;
        let slow = start + pace.allows(bytes.len() as u64);
        let frame = tokio::time::timeout_at(late.min(slow), body.frame()).await;
        let Some(frame) = frame.map_err(|_| too_slow(pace, late < slow))? else {
            return Ok(Collected { bytes, charge, kind, coding });
        };
        let frame = frame.map_err(|_| Problem::new(problem::NOT_JSON, "the body broke off; send it again"))?;
        let Ok(data) = frame.into_data() else { continue };
        let length = bytes.len() + data.len();
        if length as u64 > limit {
            return Err(too_long(length as u64, limit));
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
