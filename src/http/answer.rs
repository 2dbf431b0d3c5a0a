//! Answers that carry an artifact: their headers, and their bytes part by part.

use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::header::InvalidHeaderValue;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;

use super::address::etag;
use super::app::App;
use super::negotiate::ByteRange;
use super::problem::{self, Problem};
use super::short::Plain;
use crate::job::key::Key;
use crate::service::computation::{Outcome, Timings};
use crate::service::lent::{Lent, is_free};
use crate::service::peer::{Paid, Peer, QuotaKind};
use crate::service::pool::{Busy, Lack};
use crate::service::store::{Manifest, PART_BYTES, Pin};
use crate::service::under_way::Provenance;
use crate::service::variant::Coding;

/// An artifact to be sent.
#[derive(Debug)]
pub(super) struct Artifact {
    pub(super) manifest: Arc<Manifest>,
    /// The bytes, if no store has them.
    pub(super) loose: Option<Bytes>,
    pub(super) provenance: Provenance,
    pub(super) timings: Timings,
    /// The client of the answer.
    pub(super) peer: Peer,
    /// The form in which it is sent.
    pub(super) form: ArtifactForm,
}

/// The form in which an artifact is sent.
#[derive(Debug, Clone)]
pub(super) enum ArtifactForm {
    /// Uncompressed.
    Plain,
    /// Uncompressed for now, as the variant that the client prefers is not available yet.
    PlainForNow,
    /// A variant in a content coding.
    Coded(Coding, Arc<Manifest>),
}

impl Artifact {
    /// Creates the answer with an artifact from the cache.
    pub(super) fn kept(manifest: Arc<Manifest>, peer: Peer) -> Self {
        let (loose, provenance, timings) = (None, Provenance::Hit, Timings::default());
        Self { manifest, loose, provenance, timings, peer, form: ArtifactForm::Plain }
    }

    /// Creates the answer with an artifact that was computed, for this client or for another.
    pub(super) fn made(outcome: &Outcome, provenance: Provenance, peer: Peer) -> Self {
        let (manifest, loose) = (outcome.manifest.clone(), outcome.loose.clone());
        Self { manifest, loose, provenance, timings: outcome.timings, peer, form: ArtifactForm::Plain }
    }

    /// Returns the content coding of the answer.
    pub(super) fn coding(&self) -> Option<Coding> {
        if let ArtifactForm::Coded(coding, _) = self.form { Some(coding) } else { None }
    }

    /// Returns the manifest of the bytes that are sent.
    pub(super) fn sent(&self) -> &Arc<Manifest> {
        if let ArtifactForm::Coded(_, variant) = &self.form { variant } else { &self.manifest }
    }
}

/// The reason why the bytes of an artifact cannot be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lost {
    /// The bytes were damaged, or have just left the cache.
    Gone,
    /// Other answers have taken the memory.
    Crowded,
}

impl From<Lost> for Problem {
    fn from(lost: Lost) -> Self {
        match lost {
            Lost::Gone => {
                let detail = "the stored result was damaged or has just left the cache; send the job again";
                Self::new(problem::GONE, detail)
            }
            Lost::Crowded => Busy { lack: Lack::Answers, retry_after: Duration::from_secs(1) }.into(),
        }
    }
}

/// The request headers by which answers about artifacts differ.
const VARY: &str = "accept, accept-encoding";

/// Returns the headers that every answer about an artifact has.
pub(super) fn headers(found: &Artifact, address: &str) -> HeaderMap {
    let cache = match (found.provenance, &found.loose) {
        (Provenance::Hit, _) => "planish; hit",
        (Provenance::Made, None) => "planish; fwd=miss; stored",
        (Provenance::Made, Some(_)) => "planish; fwd=miss",
        (Provenance::Joined, _) => "planish; fwd=miss; collapsed",
    };
    let manifest = &found.manifest;
    let head = ResultHeaders {
        key: manifest.key,
        coding: found.coding(),
        media_type: &manifest.media_type,
        warnings: &manifest.warnings,
        cache,
        timings: &found.timings,
    };
    let mut headers = head.headers();
    headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    if let Ok(address) = address.try_into() {
        headers.insert(header::CONTENT_LOCATION, address);
    }
    headers
}

/// Returns the answer that the client has the artifact at this address already, with these headers and its tag.
pub(super) fn not_modified(mut headers: HeaderMap, tag: String, address: &str) -> Response {
    headers.insert(header::VARY, HeaderValue::from_static(VARY));
    if let (Ok(tag), Ok(address)) = (HeaderValue::try_from(tag), HeaderValue::try_from(address)) {
        headers.insert(header::ETAG, tag);
        headers.insert(header::CONTENT_LOCATION, address);
    }
    (StatusCode::NOT_MODIFIED, headers).into_response()
}

/// The facts in the headers of a result, whether it is stored or not.
pub(super) struct ResultHeaders<'a> {
    pub(super) key: Key,
    pub(super) coding: Option<Coding>,
    pub(super) media_type: &'a str,
    pub(super) warnings: &'a [String],
    /// The value of `Cache-Status`.
    pub(super) cache: &'static str,
    pub(super) timings: &'a Timings,
}

impl ResultHeaders<'_> {
    /// Returns the headers.
    pub(super) fn headers(&self) -> HeaderMap {
        let mut headers = HeaderMap::with_capacity(16);
        let mut put = |name: HeaderName, value: Result<HeaderValue, InvalidHeaderValue>| {
            if let Ok(value) = value {
                headers.insert(name, value);
            }
        };
        let fixed = |text| Ok(HeaderValue::from_static(text));
        put(header::ETAG, etag(&self.key, self.coding).try_into());
        if let Some(coding) = self.coding {
            put(header::CONTENT_ENCODING, fixed(coding.name()));
        }
        put(HeaderName::from_static("cache-status"), fixed(self.cache));
        put(HeaderName::from_static("server-timing"), server_timing(self.timings).try_into());
        put(header::CONTENT_TYPE, self.media_type.try_into());
        put(header::VARY, fixed(VARY));
        put(header::CONTENT_SECURITY_POLICY, fixed("default-src 'none'; style-src 'unsafe-inline'; sandbox"));
        put(HeaderName::from_static("cross-origin-resource-policy"), fixed("cross-origin"));
        put(HeaderName::from_static("timing-allow-origin"), fixed("*"));
        if !self.warnings.is_empty() {
            put(HeaderName::from_static("planish-warnings"), warnings(self.warnings).try_into());
        }
        headers
    }
}

fn server_timing(timings: &Timings) -> String {
    let ms = |duration: Duration| duration.as_secs_f64() * 1000.0;
    let path = if timings.swept { ";desc=\"sweep\"" } else { "" };
    format!(
        "queue;dur={:.3}, refine;dur={:.3}{path}, render;dur={:.3}, encode;dur={:.3}",
        ms(timings.queue),
        ms(timings.refine),
        ms(timings.render),
        ms(timings.encode)
    )
}

/// Formats warnings as a list of quoted strings (RFC 8941), with about 4 KiB at most.
fn warnings(warnings: &[String]) -> String {
    let plain = |c: char| if matches!(c, ' '..='~') && c != '"' && c != '\\' { c } else { '\'' };
    let quoted = |text: &str| format!("\"{}\"", text.chars().map(plain).collect::<String>());
    let mut room: usize = 4096;
    let mut listed: Vec<String> = Vec::new();
    for warning in warnings {
        let text = quoted(warning);
        let Some(rest) = room.checked_sub(text.len()) else { break };
        room = rest;
        listed.push(text);
    }
    if listed.len() < warnings.len() {
        listed.push(format!("\"and {} more\"", warnings.len() - listed.len()));
    }
    listed.join(", ")
}

/// Returns the answer with the artifact's bytes, or with a range of them.
///
/// # Errors
/// [`Lost`], if the bytes are found missing before the answer begins.
pub(super) async fn bytes(
    app: &Arc<App>,
    found: Artifact,
    mut headers: HeaderMap,
    range: ByteRange,
) -> Result<Response, Lost> {
    let length = found.sent().length;
    let (status, first, last) = match range {
        ByteRange::Whole => (StatusCode::OK, 0, length.saturating_sub(1)),
        ByteRange::Bytes { first, last } => (StatusCode::PARTIAL_CONTENT, first, last),
        ByteRange::Beyond => {
            let mut response = Problem::new(problem::RANGE, format!("the artifact has {length} bytes")).into_response();
            if let Ok(range) = HeaderValue::try_from(format!("bytes */{length}")) {
                response.headers_mut().insert(header::CONTENT_RANGE, range);
            }
            return Ok(response);
        }
    };
    let content = if length == 0 { 0 } else { last - first + 1 };
    headers.insert(header::CONTENT_LENGTH, content.into());
    if status == StatusCode::PARTIAL_CONTENT
        && let Ok(range) = HeaderValue::try_from(format!("bytes {first}-{last}/{length}"))
    {
        headers.insert(header::CONTENT_RANGE, range);
    }
    let plain = Plain(found.sent().clone());
    let is_settled = found.provenance == Provenance::Hit && !matches!(found.form, ArtifactForm::PlainForNow);
    let is_plain = range == ByteRange::Whole && is_settled && is_free(&plain.0);
    let body = if content == 0 { Body::empty() } else { body(app, found, first, last).await? };
    let mut response = (status, headers, body).into_response();
    if is_plain {
        response.extensions_mut().insert(plain);
    }
    Ok(response)
}

/// Returns the bytes `first ..= last` as a body. The first part is read at once, so that damage is found before the
/// answer begins.
async fn body(app: &Arc<App>, found: Artifact, first: u64, last: u64) -> Result<Body, Lost> {
    let slice = |bytes: &Bytes, start: u64| {
        let from = usize::try_from(first.saturating_sub(start)).unwrap_or(0);
        let to = usize::try_from(last + 1 - start).unwrap_or(usize::MAX).min(bytes.len());
        bytes.slice(from.min(to)..to)
    };
    if let Some(bytes) = &found.loose {
        return Ok(Body::from(slice(bytes, 0)));
    }
    let part_bytes = PART_BYTES as u64;
    let index = |byte: u64| usize::try_from(byte / part_bytes).unwrap_or(usize::MAX);
    let (from, to) = (index(first), index(last));
    let parts = PartReader::of(app, found.peer, found.sent().clone())?;
    let head = parts.part(from).await?;
    let head = slice(&head, from as u64 * part_bytes);
    if from == to {
        return Ok(Body::from(head));
    }
    let tail = stream::unfold((parts, from + 1), move |(parts, at)| async move {
        if at > to {
            return None;
        }
        let start = at as u64 * part_bytes;
        let part = parts.part(at).await;
        let end = usize::try_from(last + 1 - start).unwrap_or(usize::MAX);
        // an error breaks the connection: the answer may be cut, but no byte is wrong
        let part = part.map(|part| part.slice(..end.min(part.len())));
        Some((part.map_err(|_| std::io::Error::from(std::io::ErrorKind::InvalidData)), (parts, at + 1)))
    });
    let head = stream::once(async move { Ok::<_, std::io::Error>(head) });
    Ok(Body::from_stream(futures_util::StreamExt::chain(head, tail)))
}

/// Maximum time that an answer waits for the memory of its next part. Half of it cuts more answers under load; twice of
/// it lets a client wait twice as long for an answer that is cut after all.
const MEMORY_PATIENCE: Duration = Duration::from_secs(10);

/// Reads the parts of an artifact; each is charged until the client has read it.
pub(super) struct PartReader {
    app: Arc<App>,
    peer: Peer,
    manifest: Arc<Manifest>,
    from: PartSource,
    /// Keeps the artifact from being evicted from disk while it is read.
    _pin: Option<Pin>,
}

/// The source of the parts.
enum PartSource {
    /// An artifact in memory, which is charged as a whole, or so small that it is free.
    Memory(Option<Arc<Paid>>),
    /// The disk.
    Disk,
}

impl PartReader {
    /// Creates the reader of an artifact for a client.
    ///
    /// # Errors
    /// [`Lost::Crowded`].
    pub(super) fn of(app: &Arc<App>, peer: Peer, manifest: Arc<Manifest>) -> Result<Self, Lost> {
        let desk = &app.desk;
        let mut from = PartSource::Disk;
        if desk.tiers.part_at_hand(&manifest, 0).is_some() {
            let pay = |bytes| desk.peers.charge(&desk.account.answers, QuotaKind::AnswerBytes, peer, bytes);
            match desk.in_flight.hold(&manifest, pay) {
                Ok(paid) => from = PartSource::Memory(paid),
                Err(_) if desk.tiers.is_on_disk(&manifest.key) => {}
                Err(_) => return Err(Lost::Crowded),
            }
        }
        let pin = if matches!(from, PartSource::Disk) { desk.tiers.pin(&manifest.key) } else { None };
        Ok(Self { app: app.clone(), peer, manifest, from, _pin: pin })
    }

    /// Reads all parts.
    ///
    /// # Errors
    /// [`Lost`].
    pub(super) async fn all(&self) -> Result<Vec<Bytes>, Lost> {
        let mut parts = Vec::with_capacity(self.manifest.parts.len());
        for index in 0..self.manifest.parts.len() {
            parts.push(self.part(index).await?);
        }
        Ok(parts)
    }

    /// Reads a part: from memory if the artifact is charged as a whole, else from disk, charged by itself.
    ///
    /// # Errors
    /// [`Lost`].
    pub(super) async fn part(&self, index: usize) -> Result<Bytes, Lost> {
        let tiers = &self.app.desk.tiers;
        if let PartSource::Memory(paid) = &self.from {
            let part = tiers.part(&self.manifest, index).await.ok_or(Lost::Gone)?;
            return Ok(match paid {
                Some(paid) => Lent::new(part, paid.clone()),
                None => part,
            });
        }
        let (answers, length) = (&self.app.desk.account.answers, self.manifest.length.min(PART_BYTES as u64));
        let (most, peers) = (answers.capacity / 2, &self.app.desk.peers);
        let ticket = peers.take(self.peer, QuotaKind::AnswerBytes, length, most, u64::MAX).ok_or(Lost::Crowded)?;
        let paid = tokio::time::timeout(MEMORY_PATIENCE, answers.take(length)).await.map_err(|_| Lost::Crowded)?;
        let part = tiers.part_on_disk(&self.manifest, index).await.ok_or(Lost::Gone)?;
        Ok(Lent::new(part, (paid, ticket)))
    }
}
