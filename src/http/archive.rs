//! GET and HEAD /v1/batches/{id}/archive.zip: all results of a batch in one file, written while the client reads it.

use std::io;
use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use flate2::Crc;
use futures_util::stream;

use super::answer::PartReader;
use super::app::{App, SharedApp};
use super::artifacts::made_again;
use super::batches::unknown;
use super::client::Client;
use super::negotiate;
use super::problem::Problem;
use super::segment::PathSegment;
use super::zip::Zip;
use crate::job::key::{Key, content};
use crate::service::job_key::Tenant;
use crate::service::peer::{Paid, Peer};
use crate::service::store::Manifest;
use crate::wire::archive::{ArchiveContents, contents};

/// Memory booked for each file of an archive, in bytes: its name, its position, and its entry in the central directory.
/// Half of it is less than a long name takes; twice of it lets half as many archives be read at once.
const FILE_BYTES: u64 = 512;

/// All results of a batch that has come to its end, as a ZIP archive.
///
/// It begins with `manifest.json`, which tells for each job its state, its outputs with keys and lengths, and why it
/// failed; each result that was made is `0007/name.ext`, by the number of its job and the name of its output. The same
/// results are the same bytes. What has left the cache is made again when it is its turn.
#[utoipa::path(
    get, path = "/v1/batches/{id}/archive.zip", tag = "jobs",
    params(
        ("id" = String, Path, description = "Id of the batch, 64 hexadecimal digits",
            example = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of archives that the client has"),
    ),
    responses(
        (status = 200, description = "The archive", content_type = "application/zip", body = String),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn archive(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let peer = client.peer();
    let standing = client.named(&id).and_then(|batch| app.desk.batch_standing(&batch)).ok_or_else(unknown)?;
    if !standing.phase.is_settled() {
        return Err(Problem::unfinished());
    }
    let request = &standing.batch.request;
    let bytes = request.text.len() as u64 + FILE_BYTES * (request.n() as u64 + 2 * request.n_outputs);
    let paid = app.desk.charge_answer(peer, bytes)?;
    let ArchiveContents { manifest, files } = contents(&standing.batch);
    let key = content(&manifest);
    let mut head = HeaderMap::new();
    for (name, value) in [
        (header::CONTENT_TYPE, "application/zip"),
        (header::CACHE_CONTROL, "no-cache"),
        (header::CONTENT_DISPOSITION, &format!("attachment; filename=\"batch-{}.zip\"", &id[..12])),
        (header::CONTENT_SECURITY_POLICY, "default-src 'none'; sandbox"),
        (header::ETAG, &format!("\"{key}\"")),
    ] {
        head.extend(HeaderValue::try_from(value).map(|value| (name, value)));
    }
    if negotiate::has_kept(&headers, &key).is_some() {
        head.remove(header::CONTENT_TYPE);
        return Ok((StatusCode::NOT_MODIFIED, head).into_response());
    }
    let names = files.iter().map(|file| (file.name.clone(), file.bytes));
    let zip = Zip::new(std::iter::once(("manifest.json".to_owned(), manifest.len() as u64)).chain(names));
    head.insert(header::CONTENT_LENGTH, zip.length().into());
    let files = files.into_iter().map(|file| (file.key, file.bytes)).collect();
    let tenant = standing.batch.batch.tenant;
    let writing = ArchiveWriter {
        app: app.clone(),
        peer,
        tenant,
        zip,
        manifest: Some(Bytes::from(manifest)),
        files,
        crcs: Vec::new(),
        open: None,
        has_ended: false,
        _paid: paid,
    };
    let parts = stream::unfold(writing, |mut writing| async move {
        // an error breaks the connection, so that a cut archive never looks complete
        let part = writing.next().await.transpose()?;
        Some((part, writing))
    });
    Ok((head, Body::from_stream(parts)).into_response())
}

/// An archive that is written as fast as its client reads it; each result is looked up or computed only at its turn.
struct ArchiveWriter {
    app: Arc<App>,
    peer: Peer,
    tenant: Tenant,
    zip: Zip,
    /// The bytes of `manifest.json`, until they are written.
    manifest: Option<Bytes>,
    /// The keys and lengths of the other files.
    files: Vec<(Key, u64)>,
    /// The checksums of the files that were begun.
    crcs: Vec<u32>,
    open: Option<UnsentFile>,
    has_ended: bool,
    _paid: Paid,
}

/// A file with parts still to be sent.
enum UnsentFile {
    /// Bytes in memory that are sent as one part.
    Loose(Bytes),
    /// A stored result, the index of its next part, and the number of its parts.
    Kept(PartReader, usize, usize),
}

impl ArchiveWriter {
    /// Returns the next bytes, or `None` at the end.
    async fn next(&mut self) -> io::Result<Option<Bytes>> {
        match self.open.take() {
            Some(UnsentFile::Loose(bytes)) => return Ok(Some(bytes)),
            Some(UnsentFile::Kept(parts, at, n)) if at < n => {
                let part = parts.part(at).await.map_err(|_| broken("a part of it was lost"))?;
                self.open = Some(UnsentFile::Kept(parts, at + 1, n));
                return Ok(Some(part));
            }
            Some(UnsentFile::Kept(..)) | None => {}
        }
        if let Some(manifest) = self.manifest.take() {
            let crc = checksum([&manifest]);
            self.crcs.push(crc);
            let head = self.zip.head(0, crc);
            self.open = Some(UnsentFile::Loose(manifest));
            return Ok(Some(head.into()));
        }
        let at = self.crcs.len() - 1;
        if let Some((key, length)) = self.files.get(at).copied() {
            let (open, crc) = self.opened(key, length).await?;
            self.crcs.push(crc);
            self.open = Some(open);
            return Ok(Some(self.zip.head(at + 1, crc).into()));
        }
        let is_end = !std::mem::replace(&mut self.has_ended, true);
        Ok(is_end.then(|| self.zip.list(&self.crcs).into()))
    }

    /// Opens a result and reads it once for its checksum, which precedes it in the archive.
    async fn opened(&self, key: Key, length: u64) -> io::Result<(UnsentFile, u32)> {
        if let Some(manifest) = self.app.desk.find_artifact(key, self.peer).await
            && let Some(open) = self.kept(&manifest, length).await?
        {
            return Ok(open);
        }
        let made = made_again(&self.app, self.peer, self.tenant, &key).await;
        let made = made.map_err(|_| broken("a result of it has left the cache and cannot be made again"))?;
        if let Some(bytes) = made.loose.filter(|bytes| bytes.len() as u64 == length) {
            let crc = checksum([&bytes]);
            return Ok((UnsentFile::Loose(bytes), crc));
        }
        self.kept(&made.manifest, length).await?.ok_or_else(|| broken("a result of it was lost"))
    }

    /// Opens a stored result; `None` if its bytes turn out to be lost.
    async fn kept(&self, manifest: &Arc<Manifest>, length: u64) -> io::Result<Option<(UnsentFile, u32)>> {
        if manifest.length != length {
            return Err(broken("a result of it has become another one"));
        }
        let parts = PartReader::of(&self.app, self.peer, manifest.clone());
        let parts = parts.map_err(|_| broken("there is no memory for it"))?;
        let mut crc = Crc::new();
        for at in 0..manifest.parts.len() {
            let Ok(part) = parts.part(at).await else { return Ok(None) };
            crc.update(&part);
        }
        Ok(Some((UnsentFile::Kept(parts, 0, manifest.parts.len()), crc.sum())))
    }
}

fn checksum<'a>(parts: impl IntoIterator<Item = &'a Bytes>) -> u32 {
    let mut crc = Crc::new();
    parts.into_iter().for_each(|part| crc.update(part));
    crc.sum()
}

fn broken(why: &'static str) -> io::Error {
    tracing::warn!(why, "an archive was cut");
    io::Error::new(io::ErrorKind::InvalidData, why)
}
