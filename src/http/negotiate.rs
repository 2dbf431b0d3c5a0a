//! Content negotiation by request headers: format, coding, waiting time, byte range, and conditional requests.

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

/// Maximum wait that is granted, which is a promise of the interface. Half of it makes more clients ask again; twice of
/// it holds connections for ten minutes.
pub(super) const MAX_GRANTED_WAIT: Duration = Duration::from_mins(5);
/// Default wait, which is a promise of the interface. Half of it answers 202 to more clients that would have had their
/// result; twice of it is longer than many clients wait.
const DEFAULT_WAIT: Duration = Duration::from_secs(30);

/// Adds an output in the format that `Accept` prefers if the job names none; else checks the format of the only output.
///
/// # Errors
/// 406 if `Accept` allows no format for the input, or not the format of the only output.
pub(super) fn settle(headers: &HeaderMap, request: &mut JobRequest) -> Result<(), Problem> {
    let accepted = accepted(headers);
    let format = match request.outputs.as_slice() {
        [] => {
            let format = format(&accepted, request)?;
            request.outputs = vec![OutputRequest::of_format(format.name())];
            return Ok(());
        }
        [output] => output.format().and_then(output::named),
        _ => None,
    };
    // an unknown format and several outputs are refused elsewhere, with their own faults
    let Some(format) = format.filter(|format| allowed(&accepted, format.media_type()) == 0) else { return Ok(()) };
    let (name, media_type) = (format.name(), format.media_type());
    let detail = format!(
        "the output is {name}, {media_type}, which Accept does not allow; accept {media_type}, or leave outputs out \
         and let Accept choose"
    );
    Err(Problem::new(problem::NOT_ACCEPTABLE, detail))
}

/// Returns the values of `Accept`, joined; without such a header, everything is allowed.
fn accepted(headers: &HeaderMap) -> String {
    let values = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    let accepted = values.collect::<Vec<_>>().join(",");
    if accepted.trim().is_empty() { "*/*".to_owned() } else { accepted }
}

/// Returns the quality, in thousandths, that `Accept` gives to a media type: that of the most precise matching entry.
fn allowed(accepted: &str, media_type: &str) -> u32 {
    let matching = accepted.split(',').filter_map(|entry| accepts(entry, media_type));
    matching.max_by_key(|(precision, _)| *precision).map_or(0, |(_, quality)| quality)
}

/// Returns the format that `Accept` prefers: of the highest quality, and among equals the default (glb for meshes, json
/// for polygons) or the first in the catalogue.
fn format(accepted: &str, request: &JobRequest) -> Result<&'static dyn Format, Problem> {
    let kind = request.shape_kind();
    let holds = |format: &&dyn Format| match &request.figure {
        Some(_) => format.paper().is_some(),
        None => format.holds(kind).is_ok(),
    };
    let default = output::named(request.usual_format()).expect("the default formats are in the registry");
    let quality = |format: &&dyn Format| allowed(accepted, format.media_type());
    let holding = FORMATS.iter().copied().filter(holds);
    let best = holding.clone().map(|format| quality(&format)).max().unwrap_or(0);
    if best == 0 {
        let mut types: Vec<&str> = holding.map(<dyn Format>::media_type).collect();
        types.dedup();
        let what = match kind {
            _ if request.figure.is_some() => "a figure",
            ShapeKind::Mesh => "a mesh",
            ShapeKind::Curves { .. } => "a polygon",
        };
        let detail = format!("{what} can be answered as {}; change Accept or name an output", types.join(", "));
        return Err(Problem::new(problem::NOT_ACCEPTABLE, detail));
    }
    if quality(&default) == best {
        return Ok(default);
    }
    let mut candidates = holding.filter(|format| quality(format) == best);
    Ok(candidates.next().expect("some format has the best quality"))
}

/// Returns the form of an analysis that `Accept` prefers: of the highest quality, and among equals the first.
///
/// # Errors
/// 406 if `Accept` allows none.
pub(super) fn form(headers: &HeaderMap) -> Result<Form, Problem> {
    let accepted = accepted(headers);
    let quality = |form: &Form| allowed(&accepted, form.media_type());
    let best = Form::ALL.iter().map(quality).max().filter(|best| *best > 0);
    best.and_then(|best| Form::ALL.into_iter().find(|form| quality(form) == best)).ok_or_else(|| {
        let types = Form::ALL.map(Form::media_type).join(", ");
        Problem::new(problem::NOT_ACCEPTABLE, format!("an analysis can be answered as {types}; change Accept"))
    })
}

/// Returns how precisely an entry of `Accept` matches a media type (2 exactly, 1 by its type, 0 as `*/*`), with its
/// quality in thousandths; `None` if it does not match.
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

/// Parses a number of digits and a point only.
fn weight(text: &str) -> Option<f64> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    is_plain.then(|| text.parse().ok()).flatten()
}

/// Returns how long the client is willing to wait (`Prefer: wait=N`, or not at all: `respond-async` alone), and whether
/// it said so. Together they ask to wait and only then to be told later (RFC 7240, 4.3).
pub(super) fn patience(headers: &HeaderMap) -> (Duration, bool) {
    let preferences = headers.get_all(HeaderName::from_static("prefer"));
    let preferences = preferences.iter().filter_map(|value| value.to_str().ok()).flat_map(|value| value.split(','));
    let mut is_async = false;
    for preference in preferences {
        // none of these has parameters
        let preference = preference.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
        is_async |= preference == "respond-async";
        let seconds = preference.strip_prefix("wait=").and_then(|n| position(n.trim_matches('"')));
        if let Some(seconds) = seconds {
            return (Duration::from_secs(seconds).min(MAX_GRANTED_WAIT), true);
        }
    }
    if is_async { (Duration::ZERO, true) } else { (DEFAULT_WAIT, false) }
}

/// Returns the ETag by which `If-None-Match` names the artifact or one of its variants, compared weakly (RFC 9110).
pub(super) fn has_already(headers: &HeaderMap, key: &Key) -> Option<String> {
    let mut named = unwanted(headers).map(|tag| tag.strip_prefix("W/").unwrap_or(tag)).peekable();
    named.peek()?;
    let tags = [None].into_iter().chain(Coding::ALL.map(Some)).map(|coding| etag(key, coding)).collect::<Vec<_>>();
    named.find_map(|tag| tags.iter().find(|known| *known == tag).cloned())
}

/// Returns what [`has_already`] returns, for an artifact that is stored here, which `If-None-Match: *` matches as well.
pub(super) fn has_kept(headers: &HeaderMap, key: &Key) -> Option<String> {
    has_already(headers, key).or_else(|| unwanted(headers).any(|tag| tag == "*").then(|| etag(key, None)))
}

/// Returns whether `If-None-Match` matches something that is stored here and has this ETag, compared weakly.
pub(super) fn has_tag(headers: &HeaderMap, etag: &str) -> bool {
    unwanted(headers).any(|tag| tag == "*" || tag.strip_prefix("W/").unwrap_or(tag) == etag)
}

/// Returns the coding that `Accept-Encoding` prefers, or `None` if it prefers uncompressed bytes (RFC 9110, 12.5.3).
pub(super) fn coding(headers: &HeaderMap) -> Option<Coding> {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    let entries: Vec<(&str, u32)> = values.flat_map(|value| value.split(',')).filter_map(liked).collect();
    let named = |name: &str| entries.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|entry| entry.1);
    let quality = |coding: Coding| named(coding.name()).or_else(|| named("*")).unwrap_or(0);
    let best = Coding::ALL.into_iter().map(quality).max()?;
    // `identity` needs no entry, and quality 0 forbids a coding
    let least = named("identity").unwrap_or(0).max(1);
    Coding::ALL.into_iter().find(|coding| quality(*coding) == best && best >= least)
}

/// Parses an entry of `Accept-Encoding`: its name, and its quality in thousandths.
fn liked(entry: &str) -> Option<(&str, u32)> {
    let mut parts = entry.split(';').map(str::trim);
    let name = parts.next().filter(|name| !name.is_empty())?;
    Some((name, said_quality(parts)?))
}

/// Returns the quality among the parameters, in thousandths; 1000 if there is none.
fn said_quality<'a>(mut parts: impl Iterator<Item = &'a str>) -> Option<u32> {
    let said = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
    let quality = said.map_or(Some(1.0), weight)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..1000")]
    Some((quality.clamp(0.0, 1.0) * 1000.0) as u32)
}

/// Returns the entries of `If-None-Match`.
fn unwanted(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let values = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).map(str::trim)
}

/// The bytes of an artifact that a request asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteRange {
    /// All bytes.
    Whole,
    /// The bytes `first ..= last`.
    Bytes {
        /// First byte.
        first: u64,
        /// Last byte.
        last: u64,
    },
    /// A range beyond the end, or an empty one.
    Beyond,
}

/// Returns the range that `Range` requests of an artifact with this ETag and length. Several ranges, other units and a
/// different `If-Range` select the whole artifact.
pub(super) fn range(headers: &HeaderMap, etag: &str, length: u64) -> ByteRange {
    let Some(range) = headers.get(header::RANGE).and_then(|value| value.to_str().ok()) else { return ByteRange::Whole };
    if headers.get(header::IF_RANGE).is_some_and(|value| value != etag) {
        return ByteRange::Whole;
    }
    // range units are case-insensitive
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

/// Parses a number of digits only; a number beyond 64 bits becomes `u64::MAX`, which is beyond every artifact.
fn position(text: &str) -> Option<u64> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u64::MAX))
}
