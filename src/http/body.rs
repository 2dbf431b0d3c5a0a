//! Request bodies: bounded in length, in silence and in slowness; their memory is charged as they arrive and as they
//! are inflated.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use futures_util::FutureExt;
use http_body::{Body, Frame};
use http_body_util::BodyExt;
use tokio::time::Instant;

use super::app::App;
use super::charge::Charge;
use super::client::Client;
use super::content::{self, AcceptedBodies, BodyCoding, BodyKind, Notation};
use super::inflate::{inflated, too_long};
use super::pace::Pace;
use super::problem::{self, Problem};
use crate::input::Alone;
use crate::job::key::Key;
use crate::math::amounts::in_bytes;
use crate::output::Format;
use crate::service::peer::Paid;
use crate::wire::JobRequest;
use crate::wire::place::InputPlace;
use crate::wire::query::{job_of_file, job_text, read_as, text_as};
use crate::wire::read::{ReadError, read};
use crate::wire::text::MeshFile;

/// Maximum number of bytes of a refused body that are read and discarded, as a client that is still sending reads no
/// answer before it has sent everything. Half of it cuts off more such clients; twice of it reads twice as much for
/// nothing.
const DRAINED_BYTES: u64 = 64 << 20;

/// The body of a request, with its memory.
#[derive(Debug, Clone)]
pub(super) struct Sent {
    /// The inflated bytes.
    pub(super) bytes: Bytes,
    /// The form in which the request describes its job.
    pub(super) notation: Notation,
    /// The uploads that the job names, each with the input that names it.
    pub(super) uploads: Vec<(InputPlace, Arc<Attached>)>,
    _charge: Option<Arc<Charge>>,
}

/// An upload in memory, with its charge.
#[derive(Debug)]
pub(super) struct Attached {
    pub(super) id: Key,
    pub(super) file: MeshFile,
    _paid: Paid,
}

impl Attached {
    /// Combines a file with its id and the charge for its memory.
    pub(super) fn new(id: Key, file: MeshFile, paid: Paid) -> Self {
        Self { id, file, _paid: paid }
    }
}

impl Sent {
    /// Creates the body of a job that was sent before, or that an address contains; its memory is charged elsewhere.
    pub(super) fn job(bytes: Bytes) -> Self {
        Self { bytes, notation: Notation::Job, uploads: Vec::new(), _charge: None }
    }

    /// Returns the same job, with an output of this format.
    pub(super) fn drawn(self, format: &'static dyn Format) -> Self {
        Self { notation: Notation::JobAs(format), ..self }
    }

    /// Parses the request in the body, or in the body and the query.
    ///
    /// # Errors
    /// [`ReadError`].
    pub(super) fn request(&self) -> Result<JobRequest, ReadError> {
        let mut request = match &self.notation {
            Notation::Job => read(&self.bytes),
            Notation::JobAs(format) => read_as(format.name(), &self.bytes),
            Notation::File(reader, query) => job_of_file(query, file(reader.name, &self.bytes)),
        }?;
        if request.describes() {
            request.source = String::from_utf8(self.text().into()).ok().map(Arc::from);
        }
        for (place, upload) in &self.uploads {
            request.attach(*place, upload.file.clone());
        }
        Ok(request)
    }

    /// Returns the same job with the uploads that it names.
    pub(super) fn with_uploads(self, uploads: Vec<(InputPlace, Arc<Attached>)>) -> Self {
        Self { uploads, ..self }
    }

    /// Returns the number of bytes to be parsed; an upload counts as often as it is named.
    pub(super) fn length(&self) -> u64 {
        let files: u64 = self.uploads.iter().map(|(_, upload)| upload.file.bytes.len() as u64).sum();
        self.bytes.len() as u64 + files
    }

    /// Returns the ids of the uploads that the job names.
    pub(super) fn upload_ids(&self) -> Vec<Key> {
        self.uploads.iter().map(|(_, upload)| upload.id).collect()
    }

    /// Returns a copy of the job's text as JSON, so that a short request does not keep the buffer in which it arrived.
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

/// Reads a body that is JSON, or a mesh file if `takes` allows it.
pub(super) async fn collect<B>(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    takes: AcceptedBodies<'_>,
    mut body: B,
) -> Result<Sent, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    let collected = collected(app, client, headers, takes, &mut body).await;
    let is_coming =
        collected.as_ref().is_err_and(|problem| !problem.is(problem::SLOW) && !problem.is(problem::BROKEN_OFF));
    if is_coming && !headers.contains_key(header::EXPECT) && announced(headers).unwrap_or(0) <= DRAINED_BYTES {
        // in a box, so that requests that are not refused are not moved with room for it
        Box::pin(drain(body, Duration::from_secs(app.settings.body_timeout_s))).await;
    }
    client.has_sent();
    let RawBody { bytes, charge, kind, coding } = collected?;
    let (bytes, charge) = inflated(app, client, coding, bytes, charge).await?;
    let notation = kind.notation(headers, takes, &bytes)?;
    Ok(Sent { bytes: bytes.into(), notation, uploads: Vec::new(), _charge: Some(Arc::new(charge)) })
}

/// A body as it arrived, not inflated.
struct RawBody {
    bytes: Vec<u8>,
    charge: Charge,
    kind: BodyKind,
    coding: BodyCoding,
}

/// Reads and discards the rest of a refused body, as most clients read no answer before they have sent everything.
pub(super) async fn drain(mut body: impl Body<Data = Bytes> + Unpin, most: Duration) {
    let mut left = DRAINED_BYTES;
    let reading = async {
        while let Some(Ok(frame)) = body.frame().await {
            let length = frame.data_ref().map_or(0, Bytes::len) as u64;
            let Some(rest) = left.checked_sub(length) else { return };
            left = rest;
        }
    };
    // a client that takes longer than `most` does not get the answer
    let _ = tokio::time::timeout(most, reading).await;
}

/// Returns the length in the header `Content-Length`.
pub(super) fn announced(headers: &HeaderMap) -> Option<u64> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

async fn collected<B>(
    app: &App,
    client: &Client,
    headers: &HeaderMap,
    takes: AcceptedBodies<'_>,
    body: &mut B,
) -> Result<RawBody, Problem>
where
    B: Body<Data = Bytes> + Unpin,
{
    let (kind, coding) = content::of(headers, takes)?;
    let limit = app.settings.max_body_bytes;
    if let Some(length) = announced(headers).filter(|length| *length > limit) {
        return Err(too_long(length, limit));
    }
    let (mut arriving, mut charge, mut bytes) = (Arriving::new(app, body, limit), Charge::default(), Vec::new());
    while let Some(data) = arriving.next().await? {
        let length = bytes.len() + data.len();
        if length > bytes.capacity() {
            // the capacity doubles, but not beyond the announced length
            let most = announced(headers).and_then(|length| usize::try_from(length).ok()).unwrap_or(usize::MAX);
            let capacity = (2 * bytes.capacity()).min(most).max(length);
            charge.cover(app, client, capacity)?;
            bytes.reserve_exact(capacity - bytes.len());
        }
        bytes.extend_from_slice(&data);
    }
    Ok(RawBody { bytes, charge, kind, coding })
}

/// A body that arrives: bounded in length, in silence and in slowness.
pub(super) struct Arriving<'a, B> {
    body: &'a mut B,
    pace: Pace,
    start: Instant,
    length: u64,
    limit: u64,
}

impl<'a, B: Body<Data = Bytes> + Unpin> Arriving<'a, B> {
    /// Wraps a body of at most `limit` bytes.
    pub(super) fn new(app: &App, body: &'a mut B, limit: u64) -> Self {
        let grace = Duration::from_secs(app.settings.body_timeout_s);
        let pace = Pace { grace, least_rate: app.settings.least_rate_bytes_s };
        Self { body, pace, start: Instant::now(), length: 0, limit }
    }

    /// Returns the next bytes, or `None` at the end.
    ///
    /// # Errors
    /// A body that breaks off, is too long, or too slow.
    pub(super) async fn next(&mut self) -> Result<Option<Bytes>, Problem> {
        loop {
            // what has arrived needs no clock
            let frame = match self.body.frame().now_or_never() {
                Some(frame) => frame,
                None => self.waited().await?,
            };
            let Some(frame) = frame else { return Ok(None) };
            let frame = frame.map_err(|_| broken_off(self.length))?;
            let Ok(data) = frame.into_data() else { continue };
            self.length += data.len() as u64;
            if self.length > self.limit {
                return Err(too_long(self.length, self.limit));
            }
            return Ok(Some(data));
        }
    }

    /// Waits for the next frame, for as long as the pace allows.
    async fn waited(&mut self) -> Result<Option<Result<Frame<Bytes>, B::Error>>, Problem> {
        let late = Instant::now() + self.pace.grace;
        let slow = self.start + self.pace.allows(self.length);
        let frame = tokio::time::timeout_at(late.min(slow), self.body.frame()).await;
        frame.map_err(|_| too_slow(self.pace, late < slow))
    }
}

/// Returns the refusal of a body that ended early, after `length` bytes.
fn broken_off(length: u64) -> Problem {
    Problem::new(problem::BROKEN_OFF, format!("the body broke off after {length} bytes; send it again"))
}

/// Returns the refusal of a body that stopped arriving, or arrives too slowly.
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
