//! Conversion of bytes to typed requests, with JSON pointers to faults.

use serde::de::{DeserializeOwned, IgnoredAny};
use serde_path_to_error::{Path, Segment};

use super::object::JsonObject;
use crate::fault::{Fault, cut, did_you_mean, shortened, token};

/// Maximum number of characters of the sentence about a fault; the longest of our own takes half as many.
const MAX_READ_DETAIL: usize = 1000;

/// The byte order mark with which some programs begin UTF-8. RFC 8259, section 8.1, forbids it.
const UTF_8_MARK: &[u8] = b"\xef\xbb\xbf";
/// Those of UTF-16, in which some shells write files.
const UTF_16_MARKS: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];

/// The reason why bytes are not a request.
#[derive(Debug, Clone, PartialEq)]
pub enum ReadError {
    /// The text is not JSON.
    NotJson(String),
    /// The text is JSON, but not the expected request.
    Unfit(Vec<Fault>),
}

/// Reads a request, which is a JSON object.
///
/// # Errors
/// [`ReadError`] if the bytes are not such a request.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ReadError> {
    // tracking the path costs time at every number, so that only a second pass after a failure tracks it
    if let Ok(JsonObject(value)) = serde_json::from_slice(bytes) {
        return Ok(value);
    }
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let JsonObject(value) = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let pointer = pointer(error.path());
        refusal(error.inner(), pointer, bytes)
    })?;
    deserializer.end().map_err(|error| refusal(&error, String::new(), bytes))?;
    Ok(value)
}

fn refusal(error: &serde_json::Error, pointer: String, bytes: &[u8]) -> ReadError {
    let mut text = briefly(&error.to_string());
    // a number beyond the range of f64 is valid JSON
    let beyond = text.starts_with("number out of range");
    let fits_json = error.is_data() || beyond;
    // the text may be broken after the first fault, and is then not JSON at all
    let broken = if fits_json { serde_json::from_slice::<IgnoredAny>(bytes).err() } else { None };
    if let Some(broken) = &broken {
        text = briefly(&broken.to_string());
    }
    if fits_json && broken.is_none() {
        let detail = text.split(" at line ").next().unwrap_or(&text).to_owned();
        let detail = if beyond { "the number is too large; the largest is about 1.8e308".to_owned() } else { detail };
        ReadError::Unfit(vec![placed(pointer, &detail)])
    } else {
        let deep = text.starts_with("recursion limit");
        let remedy = match broken.as_ref().unwrap_or(error) {
            _ if deep => Some("lists and objects are nested too deep"),
            _ if let Some(mark) = mark_remedy(bytes) => Some(mark),
            error if is_no_number(bytes, error) => Some("JSON has neither NaN nor Infinity, all numbers are finite"),
            _ => None,
        };
        let remedy = remedy.map(|remedy| format!("; {remedy}")).unwrap_or_default();
        ReadError::NotJson(format!("the body is not JSON: {text}{remedy}"))
    }
}

/// Returns what is to be done about bytes that begin with a byte order mark, which no JSON may; `None` without one.
pub fn mark_remedy(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(UTF_8_MARK) {
        return Some("it begins with a byte order mark, JSON is UTF-8 without one");
    }
    UTF_16_MARKS.iter().any(|mark| bytes.starts_with(mark)).then_some("it is UTF-16, JSON is UTF-8")
}

/// Whether the text at an error is NaN or an infinity as other languages write them.
fn is_no_number(bytes: &[u8], error: &serde_json::Error) -> bool {
    let line = bytes.split(|&byte| byte == b'\n').nth(error.line().saturating_sub(1)).unwrap_or_default();
    let word = |start: usize| line.get(start..).unwrap_or_default().trim_ascii_start();
    // the column is that of the character at which reading stopped, up to three after the first of the word
    let at = [3, 2, 1, 0].map(|before| word(error.column().saturating_sub(before)));
    let is_name =
        |word: &[u8], name: &str| word.get(..name.len()).is_some_and(|w| w.eq_ignore_ascii_case(name.as_bytes()));
    at.iter().any(|word| ["nan", "-nan", "inf", "-inf"].iter().any(|name| is_name(word, name)))
}

/// Creates the fault: the pointer to a missing or repeated field includes its name, and an unknown field comes with the
/// known name that it resembles.
fn placed(pointer: String, detail: &str) -> Fault {
    if let Some(name) = detail.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
        return Fault::new(format!("{pointer}/{}", token(name)), format!("\"{name}\" is missing, and has to be given"));
    }
    let sentence = plain(detail);
    if let Some(name) = sentence.strip_prefix("duplicate field \"").and_then(|rest| rest.strip_suffix('"')) {
        return Fault::new(format!("{pointer}/{}", token(name)), format!("{sentence}; write it once"));
    }
    let unknown = detail.strip_prefix("unknown field `").and_then(|rest| rest.rsplit_once("`, expected "));
    let Some((name, known)) = unknown else { return Fault::new(pointer, sentence) };
    let meant = did_you_mean(name, known.split('`').skip(1).step_by(2));
    Fault::new(pointer, sentence.replacen("\", expected", &format!("\"; {meant}expected"), 1))
}

/// Shortens the parts of a message that repeat the request: an unknown name or a misplaced text may be as long as the
/// request.
fn briefly(text: &str) -> String {
    let repeated = [
        ("unknown field `", "`, expected "),
        ("unknown field `", "`, there are no fields"),
        ("invalid type: string \"", "\", expected "),
        ("invalid value: string \"", "\", expected "),
    ];
    let shorter = repeated.iter().find_map(|(before, after)| {
        let (word, rest) = text.strip_prefix(before)?.rsplit_once(after)?;
        Some(format!("{before}{}{after}{}", shortened(word), cut(rest, MAX_READ_DETAIL)))
    });
    shorter.unwrap_or_else(|| cut(text, MAX_READ_DETAIL).into_owned())
}

/// Replaces Rust type names by the terms of JSON.
fn plain(detail: &str) -> String {
    // clients do not know the type names of requests
    let detail = match detail.split_once("expected struct ") {
        Some((before, name)) if !name.starts_with("JobRequest") => &format!("{before}expected an object"),
        _ => detail,
    };
    detail
        .replace("expected f64", "expected a number")
        .replace("expected u64", "expected a whole number of at least 0")
        .replace("expected u32", "expected a whole number of at least 0")
        .replace("expected a sequence", "expected a list")
        .replace("floating point", "number")
        .replace(
            "expected struct JobRequest",
            "expected a job: an object with \"input\", \"plan\", \"levels\" and \"outputs\"",
        )
        .replace("a boolean", "true or false")
        .replace('`', "\"")
}

fn pointer(path: &Path) -> String {
    let segment = |segment: &Segment| match segment {
        Segment::Seq { index } => format!("/{index}"),
        Segment::Map { key } => format!("/{}", token(key)),
        Segment::Enum { .. } | Segment::Unknown => String::new(),
    };
    path.iter().map(segment).collect()
}

/// Upper bound of the memory of the texts of a body, as a multiple of its length: the text of a mesh file, the growing
/// buffer that unescapes it, and the file decoded from base64.
const TEXT_COPIES_READ: u64 = 4;

/// Returns an upper bound of the memory in bytes that a request of `length` bytes takes until it is a checked job,
/// without the body itself. A mesh file within the request takes what its reader may; lists in the body take less (27
/// bytes per byte at worst, for polygons of one point).
pub const fn reading_memory(length: u64) -> u64 {
    crate::input::reading_memory(length).saturating_add(TEXT_COPIES_READ.saturating_mul(length))
}
