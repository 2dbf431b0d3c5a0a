//! What the client's headers ask for: a format, patience, a range, what it has already.

use std::time::Duration;

use axum::http::{HeaderMap, HeaderName, header};

use super::address::etag;
use super::problem::{self, Problem};
use crate::job::Form;
use crate::job::key::Key;
use crate::output::{self, FORMATS, Format, ShapeKind};
use crate::service::variant::Coding;
use crate::wire::JobRequest;
use crate::wire::output::OutputRequest;

/// Longest wait that is granted.
/// It is a promise of the interface. Half of it sends more clients to ask again; twice of it holds connections for ten
/// minutes.
pub(super) const MAX_WAIT: Duration = Duration::from_mins(5);
/// Wait when none is named.
/// It is a promise of the interface. Half of it answers 202 to more clients that would have had their result; twice of
/// it is longer than many clients wait.
const DEFAULT_WAIT: Duration = Duration::from_secs(30);

/// Settles what a job is answered with: the format that `Accept` asks for, where the job names no output.
///
/// # Errors
/// 406 where `Accept` allows nothing that the input can be answered with, or not what the only output is.
pub(super) fn settle(headers: &HeaderMap, request: &mut JobRequest) -> Result<(), Problem> {
    let accepted = accepted(headers);
    let format = match request.outputs.as_slice() {
        [] => {
            let format = format(&accepted, request.shape_kind())?;
            request.outputs = vec![OutputRequest::of_format(format.name())];
            return Ok(());
        }
        [output] => output.format().and_then(output::named),
        _ => None,
    };
    // what names no format, and several outputs, are refused for that
    let Some(format) = format.filter(|format| allowed(&accepted, format.media_type()) == 0) else { return Ok(()) };
    let (name, media_type) = (format.name(), format.media_type());
    let detail = format!(
        "the output is {name}, {media_type}, which Accept does not allow; accept {media_type}, or leave outputs out \
         and let Accept choose"
    );
    Err(Problem::new(problem::NOT_ACCEPTABLE, detail))
}

/// What `Accept` says; without such a header, everything is allowed.
fn accepted(headers: &HeaderMap) -> String {
    let values = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    let accepted = values.collect::<Vec<_>>().join(",");
    if accepted.trim().is_empty() { "*/*".to_owned() } else { accepted }
}

/// The quality, in thousandths, that `Accept` gives to a media type: that of the entry that names it most precisely.
fn allowed(accepted: &str, media_type: &str) -> u32 {
    let matching = accepted.split(',').filter_map(|entry| accepts(entry, media_type));
    matching.max_by_key(|(precision, _)| *precision).map_or(0, |(_, quality)| quality)
}

/// The format that `Accept` asks for: of the highest quality, and among equals the usual one (glb for meshes, json for
/// polygons) or the first in the catalogue.
fn format(accepted: &str, kind: ShapeKind) -> Result<&'static dyn Format, Problem> {
    let default = if kind == ShapeKind::Mesh { "glb" } else { "json" };
    let default = output::named(default).expect("the default formats are in the registry");
    let quality = |format: &&dyn Format| allowed(accepted, format.media_type());
    let holding = FORMATS.iter().copied().filter(|format| format.holds(kind).is_ok());
    let best = holding.clone().map(|format| quality(&format)).max().unwrap_or(0);
    if best == 0 {
        let mut types: Vec<&str> = holding.map(<dyn Format>::media_type).collect();
        types.dedup();
        let what = if kind == ShapeKind::Mesh { "a mesh" } else { "a polygon" };
        let detail = format!("{what} can be answered as {}; change Accept or name an output", types.join(", "));
        return Err(Problem::new(problem::NOT_ACCEPTABLE, detail));
    }
    if quality(&default) == best {
        return Ok(default);
    }
    let mut candidates = holding.filter(|format| quality(format) == best);
    Ok(candidates.next().expect("some format has the best quality"))
}

/// The form of an analysis that `Accept` asks for: of the highest quality, and among equals the first.
///
/// # Errors
/// 406 where `Accept` allows none.
pub(super) fn form(headers: &HeaderMap) -> Result<Form, Problem> {
    let accepted = accepted(headers);
    let quality = |form: &Form| allowed(&accepted, form.media_type());
    let best = Form::ALL.iter().map(quality).max().filter(|best| *best > 0);
    best.and_then(|best| Form::ALL.into_iter().find(|form| quality(form) == best)).ok_or_else(|| {
        let types = Form::ALL.map(Form::media_type).join(", ");
        Problem::new(problem::NOT_ACCEPTABLE, format!("an analysis can be answered as {types}; change Accept"))
    })
}

/// How precisely one entry of `Accept` names a media type (2 exactly, 1 its family, 0 anything), and its quality in
/// thousandths.
fn accepts(entry: &str, media_type: &str) -> Option<(u8, u32)> {
    let entry = entry.to_ascii_lowercase();
    let mut parts = entry.split(';').map(str::trim);
    let range = parts.next()?;
    let precision = if range == media_type {
        2
    } else if range.strip_suffix("/*").is_some_and(|family| media_type.split('/').next() == Some(family)) {
        1
    } else if range == "*/*" {
        0
    } else {
        return None;
    };
    Some((precision, said_quality(parts)?))
}

/// A weight of digits and a point.
fn weight(text: &str) -> Option<f64> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    is_plain.then(|| text.parse().ok()).flatten()
}

/// How long the client wants to wait (`Prefer: wait=N`, `respond-async`), and whether it said so.
pub(super) fn patience(headers: &HeaderMap) -> (Duration, bool) {
    let preferences = headers.get_all(HeaderName::from_static("prefer"));
    let preferences =
        preferences.iter().filter_map(|value| value.to_str().ok()).flat_map(|value| value.split([',', ';']));
    for preference in preferences.map(|preference| preference.trim().to_ascii_lowercase()) {
        if preference == "respond-async" {
            return (Duration::ZERO, true);
        }
        let seconds = preference.strip_prefix("wait=").and_then(|n| position(n.trim_matches('"')));
        if let Some(seconds) = seconds {
            return (Duration::from_secs(seconds).min(MAX_WAIT), true);
        }
    }
    (DEFAULT_WAIT, false)
}

/// The ETag by which the client names the artifact, or a variant of it, as one that it has (`If-None-Match`, compared
/// weakly as RFC 9110 says).
pub(super) fn has_already(headers: &HeaderMap, key: &Key) -> Option<String> {
    let mut named = unwanted(headers).map(|tag| tag.strip_prefix("W/").unwrap_or(tag)).peekable();
    named.peek()?;
    let tags = [None].into_iter().chain(Coding::ALL.map(Some)).map(|coding| etag(key, coding)).collect::<Vec<_>>();
    named.find_map(|tag| tags.iter().find(|known| *known == tag).cloned())
}

/// As [`has_already`], of an artifact that is kept here: the client may also want nothing of that (`If-None-Match: *`).
pub(super) fn has_kept(headers: &HeaderMap, key: &Key) -> Option<String> {
    has_already(headers, key).or_else(|| unwanted(headers).any(|tag| tag == "*").then(|| etag(key, None)))
}

/// The coding that the client likes best, unless it likes bytes as they are better (`Accept-Encoding`, RFC 9110,
/// 12.5.3).
pub(super) fn coding(headers: &HeaderMap) -> Option<Coding> {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    let entries: Vec<(&str, u32)> = values.flat_map(|value| value.split(',')).filter_map(liked).collect();
    let named = |name: &str| entries.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|entry| entry.1);
    let quality = |coding: Coding| named(coding.name()).or_else(|| named("*")).unwrap_or(0);
    let best = Coding::ALL.into_iter().map(quality).max()?;
    // bytes as they are need no permission, and what has quality 0 is not wanted
    let least = named("identity").unwrap_or(0).max(1);
    Coding::ALL.into_iter().find(|coding| quality(*coding) == best && best >= least)
}

/// One entry of `Accept-Encoding`: its name, and its quality in thousandths.
fn liked(entry: &str) -> Option<(&str, u32)> {
    let mut parts = entry.split(';').map(str::trim);
    let name = parts.next().filter(|name| !name.is_empty())?;
    Some((name, said_quality(parts)?))
}

/// The quality that parameters say, in thousandths; all of it where they say none.
fn said_quality<'a>(mut parts: impl Iterator<Item = &'a str>) -> Option<u32> {
    let said = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
    let quality = said.map_or(Some(1.0), weight)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..1000")]
    Some((quality.clamp(0.0, 1.0) * 1000.0) as u32)
}

/// The entries of `If-None-Match`.
fn unwanted(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let values = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).map(str::trim)
}

/// The bytes of an artifact that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteRange {
    /// All of it.
    Whole,
    /// The bytes `first ..= last`.
    Bytes {
        /// First byte.
        first: u64,
        /// Last byte.
        last: u64,
    },
    /// Nothing that exists.
    Beyond,
}

/// The part that `Range` asks for of so many bytes with this ETag; several ranges, other units and a foreign `If-Range`
/// are answered with the whole.
pub(super) fn range(headers: &HeaderMap, etag: &str, length: u64) -> ByteRange {
    let Some(range) = headers.get(header::RANGE).and_then(|value| value.to_str().ok()) else { return ByteRange::Whole };
    if headers.get(header::IF_RANGE).is_some_and(|value| value != etag) {
        return ByteRange::Whole;
    }
    // the names of units know no small and large letters
    let ranges = range.split_once('=').filter(|(unit, _)| unit.eq_ignore_ascii_case("bytes"));
    let Some((first, last)) = ranges.and_then(|(_, range)| range.split_once('-')) else { return ByteRange::Whole };
    match (position(first), position(last)) {
        (Some(first), Some(last)) if last < first => ByteRange::Whole,
        (Some(first), Some(_)) if first >= length => ByteRange::Beyond,
        (Some(first), Some(last)) => ByteRange::Bytes { first, last: last.min(length - 1) },
        (Some(_), None) if !last.is_empty() => ByteRange::Whole,
        (Some(first), None) if first >= length => ByteRange::Beyond,
        (Some(first), None) => ByteRange::Bytes { first, last: length - 1 },
        (None, Some(suffix)) if first.is_empty() && (suffix == 0 || length == 0) => ByteRange::Beyond,
        (None, Some(suffix)) if first.is_empty() => {
            ByteRange::Bytes { first: length - suffix.min(length), last: length - 1 }
        }
        _ => ByteRange::Whole,
    }
}

/// A number of digits alone; what is beyond 64 bits is beyond every artifact.
fn position(text: &str) -> Option<u64> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u64::MAX))
}
