//! From bytes to typed requests, with a pointer to whatever does not fit.

use serde::de::{DeserializeOwned, IgnoredAny};
use serde_path_to_error::{Path, Segment};

use super::object::Object;
use crate::fault::{Fault, cut, did_you_mean, shortened, token};

/// Most characters of a sentence about what does not fit: the longest of our own has half of them.
const MOST_DETAIL: usize = 1000;

/// Why bytes are no request.
#[derive(Debug, Clone, PartialEq)]
pub enum ReadError {
    /// The text is not JSON.
    NotJson(String),
    /// JSON, but not what was asked for.
    Unfit(Vec<Fault>),
}

/// Reads a request, which is an object.
///
/// # Errors
/// [`ReadError`].
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ReadError> {
    // the place of what does not fit is only looked for where something does not: it costs time at every number
    if let Ok(Object(value)) = serde_json::from_slice(bytes) {
        return Ok(value);
    }
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let Object(value) = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let pointer = pointer(error.path());
        refusal(error.inner(), pointer, bytes)
    })?;
    deserializer.end().map_err(|error| refusal(&error, String::new(), bytes))?;
    Ok(value)
}

fn refusal(error: &serde_json::Error, pointer: String, bytes: &[u8]) -> ReadError {
    let mut text = briefly(&error.to_string());
    // a number beyond f64 is JSON all the same
    let beyond = text.starts_with("number out of range");
    let fits_json = error.is_data() || beyond;
    // what does not fit may stand in a text that breaks off later, and then it is no JSON in the first place
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
            _ if deep => "; lists and objects are nested too deep",
            error if is_no_number(bytes, error) => "; JSON has neither NaN nor Infinity, all numbers are finite",
            _ => "",
        };
        ReadError::NotJson(format!("the body is not JSON: {text}{remedy}"))
    }
}

/// Whether at the place of an error stands what other languages write for a number that is none.
fn is_no_number(bytes: &[u8], error: &serde_json::Error) -> bool {
    let line = bytes.split(|&byte| byte == b'\n').nth(error.line().saturating_sub(1)).unwrap_or_default();
    let word = |start: usize| line.get(start..).unwrap_or_default().trim_ascii_start();
    // the column is that of the letter at which reading stopped, up to three behind the first one
    let at = [3, 2, 1, 0].map(|before| word(error.column().saturating_sub(before)));
    let is_name =
        |word: &[u8], name: &str| word.get(..name.len()).is_some_and(|w| w.eq_ignore_ascii_case(name.as_bytes()));
    at.iter().any(|word| ["nan", "-nan", "inf", "-inf"].iter().any(|name| is_name(word, name)))
}

/// The fault at its place: a field that is missing or written twice has one of its own, and a field that is unknown may
/// be spelled like one that is known.
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

/// The sentence with what it repeats of the request shortened: an unknown name or a text in the wrong place may be as
/// long as the request.
fn briefly(text: &str) -> String {
    let repeated = [
        ("unknown field `", "`, expected "),
        ("unknown field `", "`, there are no fields"),
        ("invalid type: string \"", "\", expected "),
        ("invalid value: string \"", "\", expected "),
    ];
    let shorter = repeated.iter().find_map(|(before, after)| {
        let (word, rest) = text.strip_prefix(before)?.rsplit_once(after)?;
        Some(format!("{before}{}{after}{}", shortened(word), cut(rest, MOST_DETAIL)))
    });
    shorter.unwrap_or_else(|| cut(text, MOST_DETAIL).into_owned())
}

/// Type names of this implementation in the words of JSON.
fn plain(detail: &str) -> String {
    // the name of a request's type means nothing to a client
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

/// Copies of the text of a body at worst: the text of a mesh file, what takes the escapes out of it as it grows, and
/// the file that base64 holds.
const TEXT: u64 = 4;

/// Bytes that a request of so many bytes takes at most until it is a checked job, the body itself left out: a mesh file
/// within it takes what its reader may; lists that the body itself holds take less (27 bytes a byte at worst, polygons
/// of one point).
pub const fn weight(length: u64) -> u64 {
    crate::input::weight(length).saturating_add(TEXT.saturating_mul(length))
}
