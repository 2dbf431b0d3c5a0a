//! Reads what the headers of a request declare about its body: the form of the job, and the coding of the bytes.

use std::sync::Arc;

use axum::http::{HeaderMap, HeaderName, HeaderValue, header};

use super::problem::{self, Problem};
use crate::fault::shortened;
use crate::input::{self, READERS, Reader};
use crate::output::Format;
use crate::wire::query::{BESIDE_THE_JOB, refuse_parameters};

/// The media type of jobs and answers.
pub(super) const JSON: &str = "application/json";
/// Media types that clients send by default: `curl --data-binary`, and browsers for files of an unknown type.
const UNTOLD: [&str; 2] = ["application/x-www-form-urlencoded", "application/octet-stream"];

/// The form in which a request describes its job.
#[derive(Debug, Clone)]
pub(super) enum Notation {
    /// The body, or the address, contains the job.
    Job,
    /// The body, or the address, contains a job without outputs: the only output has this format, which is named
    /// outside the job.
    JobAs(&'static dyn Format),
    /// The body is a mesh file, and the query contains the rest of the job.
    File(&'static Reader, Arc<str>),
}

/// The content coding of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyCoding {
    /// No coding.
    Identity,
    /// gzip.
    Gzip,
    /// Zstandard.
    Zstd,
}

/// The declared kind of a body.
#[derive(Debug, Clone, Copy)]
pub(super) enum BodyKind {
    /// A job as JSON.
    Job,
    /// A mesh file of this reader's format.
    File(&'static Reader),
    /// Undeclared: a mesh file, if its first bytes show its format.
    Untold,
}

/// The kinds of bodies that a resource accepts.
#[derive(Debug, Clone, Copy)]
pub(super) enum AcceptedBodies<'a> {
    /// Jobs only.
    Jobs,
    /// Jobs and mesh files; this is the query, which contains the rest of the job for a mesh file.
    Files(&'a str),
    /// Files to be kept: mesh files, meshes as JSON, and pictures.
    Uploads,
}

impl<'a> AcceptedBodies<'a> {
    /// Returns the query; it is empty if it contains no part of a job.
    fn query(self) -> &'a str {
        if let Self::Files(query) = self { query } else { "" }
    }
}

/// Reads kind and coding of the body from the headers.
///
/// # Errors
/// A media type, content coding or transfer coding that is not supported.
pub(super) fn of(headers: &HeaderMap, takes: AcceptedBodies<'_>) -> Result<(BodyKind, BodyCoding), Problem> {
    check_transfer_coding(headers)?;
    Ok((kind(headers, takes)?, coding(headers)?))
}

impl BodyKind {
    /// Returns the form in which the request describes its job, given the bytes of its body.
    ///
    /// # Errors
    /// Parameters in the query that are not known beside a job, and bytes of an unknown format.
    pub(super) fn notation(
        self,
        headers: &HeaderMap,
        takes: AcceptedBodies<'_>,
        body: &[u8],
    ) -> Result<Notation, Problem> {
        let reader = match self {
            Self::Job => {
                refuse_parameters(takes.query(), BESIDE_THE_JOB).map_err(Problem::invalid)?;
                return Ok(Notation::Job);
            }
            Self::File(reader) => reader,
            Self::Untold => input::of_bytes(body).ok_or_else(|| unknown(headers, takes, body))?,
        };
        Ok(Notation::File(reader, takes.query().into()))
    }
}

/// Refuses transfer codings other than a single `chunked`.
fn check_transfer_coding(headers: &HeaderMap) -> Result<(), Problem> {
    let is_chunked = |value: &HeaderValue| value.as_bytes().trim_ascii().eq_ignore_ascii_case(b"chunked");
    let mut codings = headers.get_all(header::TRANSFER_ENCODING).iter();
    match (codings.next(), codings.next()) {
        (None, _) => Ok(()),
        (Some(coding), None) if is_chunked(coding) => Ok(()),
        (Some(coding), _) => {
            let coding = shortened(coding.to_str().unwrap_or("?"));
            let detail =
                format!("Transfer-Encoding \"{coding}\" is not read; send the body as it is, or chunked alone");
            Err(Problem::new(problem::TRANSFER_CODING, detail))
        }
    }
}

/// Returns the coding that `Content-Encoding` names; several codings in sequence are not supported.
fn coding(headers: &HeaderMap) -> Result<BodyCoding, Problem> {
    let named = text(headers, &header::CONTENT_ENCODING).unwrap_or_default();
    match named.as_str() {
        "" | "identity" => Ok(BodyCoding::Identity),
        "gzip" | "x-gzip" => Ok(BodyCoding::Gzip),
        "zstd" => Ok(BodyCoding::Zstd),
        other => {
            let other = shortened(other);
            let detail = format!("Content-Encoding \"{other}\" is not read; send the body as it is, or gzip or zstd");
            Err(Problem::new(problem::CODING, detail))
        }
    }
}

fn kind(headers: &HeaderMap, takes: AcceptedBodies<'_>) -> Result<BodyKind, Problem> {
    let takes_files = !matches!(takes, AcceptedBodies::Jobs);
    let named = text(headers, &header::CONTENT_TYPE);
    let essence = named.as_deref().map(|value| value.split(';').next().unwrap_or("").trim());
    let reader = READERS.iter().find(|reader| essence == Some(reader.media_type));
    match (essence, reader) {
        (Some(JSON), _) => Ok(BodyKind::Job),
        (_, Some(reader)) if takes_files => Ok(BodyKind::File(reader)),
        (None, _) if takes_files => Ok(BodyKind::Untold),
        (Some(essence), _) if takes_files && UNTOLD.contains(&essence) => Ok(BodyKind::Untold),
        _ => Err(unknown(headers, takes, &[])),
    }
}

/// Returns the refusal of a body whose media type is neither declared nor recognized; `body` is empty if it is not read
/// yet.
fn unknown(headers: &HeaderMap, takes: AcceptedBodies<'_>, body: &[u8]) -> Problem {
    let said = match text(headers, &header::CONTENT_TYPE) {
        Some(named) => format!("Content-Type is {}", shortened(&named)),
        None => "Content-Type is missing".to_owned(),
    };
    let shown = match input::foreign(body) {
        Some(what) => format!(", and the body is {what}"),
        None if matches!(takes, AcceptedBodies::Uploads) && !body.is_empty() => {
            ", and the first bytes are those of no format that is read".to_owned()
        }
        None => String::new(),
    };
    let types: Vec<&str> = READERS.iter().map(|reader| reader.media_type).collect();
    let has = |word: &[u8; 7]| body.windows(7).any(|found| found == word);
    let meant = match takes {
        AcceptedBodies::Files(_) if has(b"\"input\"") => JSON,
        AcceptedBodies::Uploads if has(b"\"asset\"") => "model/gltf+json",
        AcceptedBodies::Uploads if body.trim_ascii_start().starts_with(b"{") => JSON,
        _ => types.first().unwrap_or(&"model/obj"),
    };
    let (types, curl) = (types.join(", "), format!("curl says so with -H 'Content-Type: {meant}'"));
    let job = "send the job as Content-Type: application/json";
    let remedy = match takes {
        AcceptedBodies::Jobs => job.to_owned(),
        AcceptedBodies::Files(_) => format!("{job}, or a mesh file as {types}; {curl}"),
        AcceptedBodies::Uploads => {
            format!("send a mesh file as {types}, a mesh as application/json, or a picture as image/png; {curl}")
        }
    };
    Problem::new(problem::MEDIA_TYPE, format!("{said}{shown}; {remedy}"))
}

/// Returns all values of a header, joined by commas, in lower case.
fn text(headers: &HeaderMap, name: &HeaderName) -> Option<String> {
    let values: Vec<&str> = headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("?").trim()).collect();
    (!values.is_empty()).then(|| values.join(", ").to_ascii_lowercase())
}
