//! POST /v1/blobs, GET and HEAD /v1/blobs/{id}: mesh files that are uploaded once and named by their content.

use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;

use super::app::{App, SharedApp};
use super::body::{Arriving, Attached, Sent, announced, drain};
use super::client::Client;
use super::content::{self, AcceptedBodies, BodyCoding, BodyKind, JSON, Notation};
use super::inflate::too_long;
use super::negotiate::has_tag;
use super::problem::{self, Problem};
use super::segment::PathSegment;
use crate::fault::{Fault, shortened};
use crate::input::{self, Alone, READERS};
use crate::job::key::Key;
use crate::service::computation::Failure;
use crate::service::peer::{Paid, Peer};
use crate::service::pool::Busy;
use crate::service::read_lane::ReadRefusal;
use crate::service::store::{Manifest, PART_BYTES, StoreError};
use crate::service::uploads::{Unknown, Upload};
use crate::wire::answer::BlobAnswer;
use crate::wire::place::InputPlace;
use crate::wire::posted::{NamedUpload, uploads_of};
use crate::wire::text::MeshFile;

/// Number of bytes per write. Half of it goes to the disk twice as often; twice of it takes twice the memory of each
/// upload.
const WRITE_BYTES: usize = 1 << 20;
pub(super) const PICTURE: &str = "image/png";
/// The signature of a PNG.
const PICTURE_STARTS: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Keeps a mesh file, under the hash of its bytes; jobs name it as `input.blob`.
///
/// The body is the file, of a type that /v1/readers lists, a mesh as JSON, or a PNG for /v1/compare; a type that is not
/// said is told by the first bytes, and one that these contradict is refused. The same file sent again is the same
/// upload. Uploads that no job needs may leave for others: a job that names one that is gone is refused, and the file
/// can be sent again.
#[utoipa::path(
    post, path = "/v1/blobs", tag = "jobs",
    request_body(content = String, content_type = "application/octet-stream", description = "The file",
        example = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    responses(
        (status = 201, description = "It is kept, now or since it was sent before; `Location` is where",
            body = BlobAnswer),
    )
)]
pub(super) async fn upload(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    mut body: Body,
) -> Response {
    let kept = kept(&app, &client, &headers, &mut body).await;
    if kept.is_err() && !headers.contains_key(header::EXPECT) {
        drain(body, std::time::Duration::from_secs(app.settings.body_timeout_s)).await;
    }
    client.has_sent();
    kept.into_response()
}

/// A file that was sent, as it was.
#[utoipa::path(
    get, path = "/v1/blobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the upload: `b3-` and 64 hexadecimal digits",
        example = "b3-7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2")),
    responses(
        (status = 200, description = "The file, of the type that it was sent as", content(
            (String = "application/octet-stream"), (String = "model/obj"), (String = "model/ply"),
            (String = "model/stl"), (String = "model/off"), (String = "model/gltf+json"),
            (String = "model/gltf-binary"), (Vec<u8> = "model/3mf"), (String = "model/vnd.usda"),
            (String = "application/json"), (Vec<u8> = "image/png"),
        )),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn blob(
    State(app): State<SharedApp>,
    client: Client,
    PathSegment(id): PathSegment,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let unknown = || Problem::new(problem::NOT_FOUND, "there is no upload of this id; send the file to /v1/blobs");
    let key = parse(&id).ok_or_else(unknown)?;
    let found = app.desk.uploads.find(&key, client.tenant()).await.map_err(|Unknown| Problem::away())?;
    let manifest = found.ok_or_else(unknown)?;
    let mut head = HeaderMap::new();
    let etag = format!("\"{id}\"");
    for (name, value) in [
        (header::ETAG, etag.as_str()),
        (header::CACHE_CONTROL, "private, max-age=31536000, immutable"),
        (header::CONTENT_SECURITY_POLICY, "default-src 'none'; sandbox"),
        (header::CONTENT_DISPOSITION, "attachment"),
    ] {
        head.extend(HeaderValue::try_from(value).map(|value| (name, value)));
    }
    if has_tag(&headers, &etag) {
        return Ok((StatusCode::NOT_MODIFIED, head).into_response());
    }
    head.extend(HeaderValue::try_from(&manifest.media_type).map(|value| (header::CONTENT_TYPE, value)));
    head.insert(header::CONTENT_LENGTH, manifest.length.into());
    if method == Method::HEAD {
        return Ok((head, Body::empty()).into_response());
    }
    Ok((head, parts(&app, client.peer(), manifest)?).into_response())
}

/// Streams the parts of an upload; two parts are charged for the whole answer.
fn parts(app: &Arc<App>, peer: Peer, manifest: Arc<Manifest>) -> Result<Body, Busy> {
    let desk = &app.desk;
    let part = manifest.length.min(PART_BYTES as u64);
    let paid = desk.charge_answer(peer, 2 * part)?;
    let pin = desk.uploads.pin(&manifest.key);
    let next = (app.clone(), manifest, 0, (paid, pin));
    let parts = stream::unfold(next, |(app, manifest, at, held)| async move {
        if at >= manifest.parts.len() {
            return None;
        }
        // an error breaks the connection: the answer may be cut, but no byte is wrong
        let part = app.desk.uploads.part(&manifest, at).await.ok_or(std::io::ErrorKind::InvalidData);
        Some((part.map_err(std::io::Error::from), (app, manifest, at + 1, held)))
    });
    Ok(Body::from_stream(parts))
}

/// Stores the file in a body.
async fn kept(app: &Arc<App>, client: &Client, headers: &HeaderMap, body: &mut Body) -> Result<Response, Problem> {
    let mut of_reader = headers.clone();
    if headers.get(header::CONTENT_TYPE).is_some_and(|named| named == PICTURE) {
        // the first bytes show that it is a PNG
        of_reader.remove(header::CONTENT_TYPE);
    }
    let (kind, coding) = content::of(&of_reader, AcceptedBodies::Uploads)?;
    if coding != BodyCoding::Identity {
        return Err(Problem::new(problem::MEDIA_TYPE, "files are kept as they are; send it without Content-Encoding"));
    }
    let limit = app.settings.max_body_bytes;
    if let Some(length) = announced(headers).filter(|length| *length > limit) {
        return Err(too_long(length, limit));
    }
    let (desk, peer) = (&app.desk, client.peer());
    // one piece that arrives, and one that is being written
    let _paid = desk.charge_body(peer, 2 * WRITE_BYTES as u64)?;
    let mut arriving = Arriving::new(app, body, limit);
    let (mut piece, mut upload, mut media_type) = (Vec::with_capacity(WRITE_BYTES), None, None);
    loop {
        let data = arriving.next().await?;
        piece.extend_from_slice(data.as_deref().unwrap_or_default());
        if piece.len() >= WRITE_BYTES || data.is_none() {
            if media_type.is_none() {
                media_type = Some(media_type_of(kind, headers, &piece)?);
            }
            let before = match upload.take() {
                Some(upload) => upload,
                None => desk.uploads.begin().map_err(not_kept)?,
            };
            upload = Some(written(before, std::mem::replace(&mut piece, Vec::with_capacity(WRITE_BYTES))).await?);
        }
        if data.is_none() {
            break;
        }
    }
    let (Some(upload), Some(media_type)) = (upload, media_type) else { return Err(internal()) };
    let finished = tokio::task::spawn_blocking(move || upload.finish(media_type, peer.tenant())).await;
    let manifest = finished.map_err(|_| internal())?.map_err(not_kept)?;
    Ok(upload_response(&manifest))
}

/// Appends a piece to an upload.
async fn written(mut upload: Upload, piece: Vec<u8>) -> Result<Upload, Problem> {
    let written = tokio::task::spawn_blocking(move || upload.take(&piece).map(|()| upload));
    written.await.map_err(|_| internal())?.map_err(|error| not_kept(error.into()))
}

fn internal() -> Problem {
    let failure = Failure::Internal("an upload was lost".to_owned());
    Problem::from(ReadRefusal::Failed(failure))
}

/// Returns the refusal of a file that the store does not take.
fn not_kept(error: StoreError) -> Problem {
    match error {
        StoreError::TooLarge { capacity } => {
            let detail = format!("uploads may have {capacity} bytes here; send a smaller file, or raise uploads-bytes");
            Problem::new(problem::BODY_TOO_LONG, detail)
        }
        // the log names the store
        StoreError::Away { .. } => Problem::away(),
        other => Problem::new(problem::UNWRITTEN, other.to_string()),
    }
}

/// Returns the media type under which a file is stored: as declared by the client, or recognized by the first bytes.
fn media_type_of(kind: BodyKind, headers: &HeaderMap, first: &[u8]) -> Result<&'static str, Problem> {
    if matches!(kind, BodyKind::Untold) && first.starts_with(PICTURE_STARTS) {
        return Ok(PICTURE);
    }
    let (declared, media_type) = match kind.notation(headers, AcceptedBodies::Uploads, first)? {
        Notation::Job | Notation::JobAs(_) => (None, JSON),
        Notation::File(reader, _) => (Some(reader), reader.media_type),
    };
    // jobs read the file by its type, which stays that of its first upload
    if let Some(own) = input::mistaken(first, declared) {
        let declared = declared.map_or("json", |reader| reader.name);
        let detail = format!(
            "Content-Type is {media_type}, but the file begins like {}, not like {declared}; send it as {}",
            own.name, own.media_type
        );
        return Err(Problem::new(problem::MEDIA_TYPE, detail));
    }
    Ok(media_type)
}

/// Returns the name of the format of meshes with a media type.
pub(super) fn format_of(media_type: &str) -> Option<&'static str> {
    let reader = READERS.iter().find(|reader| reader.media_type == media_type).map(|reader| reader.name);
    reader.or((media_type == JSON).then_some("json"))
}

fn upload_response(manifest: &Manifest) -> Response {
    let id = written_id(&manifest.key);
    let href = format!("/v1/blobs/{id}");
    let is_picture = manifest.media_type == PICTURE;
    let format = if is_picture { "png" } else { format_of(&manifest.media_type).unwrap_or("json") }.to_owned();
    let answer = BlobAnswer { id, bytes: manifest.length, format, href: href.clone() };
    let mut response = (StatusCode::CREATED, axum::Json(answer)).into_response();
    response.headers_mut().extend(HeaderValue::try_from(href).map(|href| (header::LOCATION, href)));
    response.headers_mut().insert(HeaderName::from_static("cache-control"), HeaderValue::from_static("no-store"));
    response
}

fn written_id(key: &Key) -> String {
    format!("b3-{key}")
}

/// Parses the id of an upload to its key.
fn parse(id: &str) -> Option<Key> {
    Key::parse(id.strip_prefix("b3-")?)
}

/// Adds the uploads that a job names, each read into memory once.
///
/// # Errors
/// An unknown upload; 503 if there is no memory for it.
pub(super) async fn attached(app: &Arc<App>, peer: Peer, sent: Sent) -> Result<Sent, Problem> {
    if !sent.uploads.is_empty() || !matches!(sent.notation, Notation::Job | Notation::JobAs(_)) {
        return Ok(sent);
    }
    let bytes: Bytes = sent.bytes.clone();
    let named = app.desk.read(peer, bytes.len() as u64, move |_| uploads_of(&bytes)).await?;
    let limit = app.settings.max_body_bytes;
    let (mut all, mut length): (Vec<(InputPlace, Arc<Attached>)>, _) = (Vec::new(), 0);
    for named in named {
        let known = all.iter().find(|(_, upload)| written_id(&upload.id) == named.id).map(|(_, upload)| upload.clone());
        let upload = match known {
            Some(known) => known,
            None => Arc::new(read(app, peer, &named).await?),
        };
        // every input parses its file separately
        length += upload.file.bytes.len() as u64;
        if length > limit {
            return Err(too_long(length, limit));
        }
        all.push((named.place, upload));
    }
    Ok(sent.with_uploads(all))
}

/// Reads a mesh file that a job names into memory.
async fn read(app: &Arc<App>, peer: Peer, named: &NamedUpload) -> Result<Attached, Problem> {
    let (id, manifest, bytes, paid) = loaded(app, peer, &named.id, &named.pointer()).await?;
    if manifest.media_type == PICTURE {
        let detail = format!("the upload {} is a picture; only /v1/compare takes it", written_id(&id));
        return Err(Problem::invalid(vec![Fault::new(named.pointer(), detail)]));
    }
    let format = format_of(&manifest.media_type).unwrap_or("json").to_owned();
    let file = MeshFile { format, bytes, beside: Arc::new(Alone) };
    Ok(Attached::new(id, file, paid))
}

/// Reads an upload that is named at `place` of a request, and charges its memory.
///
/// # Errors
/// An unknown upload; 503 if there is no memory for it, or the store that has it does not answer.
pub(super) async fn loaded(
    app: &Arc<App>,
    peer: Peer,
    named: &str,
    place: &str,
) -> Result<(Key, Arc<Manifest>, Vec<u8>, Paid), Problem> {
    let fault = |detail: String| Problem::invalid(vec![Fault::new(place, detail)]);
    let id = parse(named).ok_or_else(|| {
        fault(format!("\"{}\" is no id of an upload, which is b3- and 64 hexadecimal digits", shortened(named)))
    })?;
    let missing = || fault(format!("there is no upload {}; send the file to /v1/blobs (again)", written_id(&id)));
    let found = app.desk.uploads.find(&id, peer.tenant()).await.map_err(|Unknown| Problem::away())?;
    let manifest = found.ok_or_else(missing)?;
    let _pin = app.desk.uploads.pin(&id).ok_or_else(missing)?;
    let limit = app.settings.max_body_bytes;
    if manifest.length > limit {
        return Err(too_long(manifest.length, limit));
    }
    let paid = app.desk.charge_body(peer, manifest.length)?;
    let bytes = app.desk.uploads.whole(&manifest).await.ok_or_else(missing)?;
    Ok((id, manifest, bytes, paid))
}
