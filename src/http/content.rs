//! What the headers of a request say of its body: how it says what is asked for, and how it is coded on its way.

use std::sync::Arc;

use axum::http::{HeaderMap, HeaderName, HeaderValue, header};

use super::problem::{self, Problem};
use crate::fault::shortened;
use crate::input::{self, READERS, Reader};
use crate::output::Format;
use crate::wire::query::{BESIDE_THE_JOB, says_nothing};

/// Types that programs send when nobody told them one: `curl --data-binary`, and pages that send a file of a kind that
/// the browser does not know.
const UNTOLD: [&str; 2] = ["application/x-www-form-urlencoded", "application/octet-stream"];

/// How a request says what is asked for.
#[derive(Debug, Clone)]
pub(super) enum Notation {
    /// Its body, or its address, holds the job.
    Job,
    /// As [`Self::Job`], without outputs: the format of the one is named beside it.
    JobAs(&'static dyn Format),
    /// Its body is a mesh file, and the query of its address the rest of the job.
    File(&'static Reader, Arc<str>),
}

/// How the bytes of a body are coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// As they are.
    Identity,
    /// By gzip.
    Gzip,
    /// By Zstandard.
    Zstd,
}

/// What a body is said to be.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A job.
    Job,
    /// A mesh file of a reader.
    File(&'static Reader),
    /// A mesh file, if it shows by its first bytes of which kind.
    Untold,
}

/// What a page reads.
#[derive(Debug, Clone, Copy)]
pub(super) enum Takes<'a> {
    /// Jobs alone.
    Jobs,
    /// Jobs and mesh files; the query of the address says the rest of the job.
    Files(&'a str),
}

impl<'a> Takes<'a> {
    /// What the query of the address says of the job.
    fn query(self) -> &'a str {
        if let Self::Files(query) = self { query } else { "" }
    }
}

/// What the headers say.
///
/// # Errors
/// What is not read.
pub(super) fn of(headers: &HeaderMap, takes: Takes<'_>) -> Result<(Kind, Coding), Problem> {
    check_transfer_coding(headers)?;
    Ok((kind(headers, matches!(takes, Takes::Files(_)))?, coding(headers)?))
}

impl Kind {
    /// The notation of a request with this body.
    ///
    /// # Errors
    /// Bytes that do not show what they are.
    pub(super) fn notation(self, headers: &HeaderMap, takes: Takes<'_>, body: &[u8]) -> Result<Notation, Problem> {
        let reader = match self {
            Self::Job => {
                says_nothing(takes.query(), BESIDE_THE_JOB).map_err(Problem::invalid)?;
                return Ok(Notation::Job);
            }
            Self::File(reader) => reader,
            Self::Untold => input::of_bytes(body).ok_or_else(|| unknown(headers, true, body))?,
        };
        Ok(Notation::File(reader, takes.query().into()))
    }
}

/// Of the codings that a body may travel in, only `chunked` is read, and only alone.
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

/// The coding that `Content-Encoding` names; one alone, as nobody compresses twice.
fn coding(headers: &HeaderMap) -> Result<Coding, Problem> {
    let named = text(headers, &header::CONTENT_ENCODING).unwrap_or_default();
    match named.as_str() {
        "" | "identity" => Ok(Coding::Identity),
        "gzip" | "x-gzip" => Ok(Coding::Gzip),
        "zstd" => Ok(Coding::Zstd),
        other => {
            let other = shortened(other);
            let detail = format!("Content-Encoding \"{other}\" is not read; send the body as it is, or gzip or zstd");
            Err(Problem::new(problem::CODING, detail))
        }
    }
}

fn kind(headers: &HeaderMap, takes_files: bool) -> Result<Kind, Problem> {
    let named = text(headers, &header::CONTENT_TYPE);
    let essence = named.as_deref().map(|value| value.split(';').next().unwrap_or("").trim());
    let reader = READERS.iter().find(|reader| essence == Some(reader.media_type));
    match (essence, reader) {
        (Some("application/json"), _) => Ok(Kind::Job),
        (_, Some(reader)) if takes_files => Ok(Kind::File(reader)),
        (None, _) if takes_files => Ok(Kind::Untold),
        (Some(essence), _) if takes_files && UNTOLD.contains(&essence) => Ok(Kind::Untold),
        _ => Err(unknown(headers, takes_files, &[])),
    }
}

/// The refusal of a body that says or shows no type that is read here; `body` is empty where it is not read yet.
fn unknown(headers: &HeaderMap, takes_files: bool, body: &[u8]) -> Problem {
    let said = match text(headers, &header::CONTENT_TYPE) {
        Some(named) => format!("Content-Type is {}", shortened(&named)),
        None => "Content-Type is missing".to_owned(),
    };
    let shown = input::foreign(body).map(|what| format!(", and the body is {what}")).unwrap_or_default();
    let mut detail = format!("{said}{shown}; send the job as Content-Type: application/json");
    if takes_files {
        let types: Vec<&str> = READERS.iter().map(|reader| reader.media_type).collect();
        let is_job = body.windows(7).any(|word| word == b"\"input\"");
        let meant = if is_job { "application/json" } else { types.first().unwrap_or(&"model/obj") };
        detail =
            format!("{detail}, or a mesh file as {}; curl says so with -H 'Content-Type: {meant}'", types.join(", "));
    }
    Problem::new(problem::MEDIA_TYPE, detail)
}

/// The values of a header in small letters, as one.
fn text(headers: &HeaderMap, name: &HeaderName) -> Option<String> {
    let values: Vec<&str> = headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("?").trim()).collect();
    (!values.is_empty()).then(|| values.join(", ").to_ascii_lowercase())
}
