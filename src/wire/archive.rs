//! The contents of the archive of a batch: the manifest, and the names of the files.

use std::collections::BTreeSet;

use serde::Serialize;
use serde_json::value::RawValue;

use super::batch_standing::ended;
use crate::job::key::Key;
use crate::service::batches::{Batch, BatchLayout, GridAxis};
use crate::service::jobs::{JobState, OutputResult};

/// Maximum number of characters that a file name takes over from the name of an output. Half as many would cut names
/// that people choose; twice as many would make paths too long for some systems.
const MAX_FILE_NAME_CHARS: usize = 80;
/// File names that some systems reserve for devices, with any extension.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// The contents of an archive.
#[derive(Debug)]
pub struct ArchiveContents {
    /// The manifest, the first file of the archive.
    pub manifest: Vec<u8>,
    /// The results, in the order of jobs and outputs.
    pub files: Vec<ArchiveFile>,
}

/// One result in an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArchiveFile {
    /// The path of the file within the archive.
    pub name: String,
    /// The key of the artifact.
    pub key: Key,
    /// The length of the file in bytes.
    pub bytes: u64,
}

#[derive(Serialize)]
struct ArchiveManifest<'a> {
    batch: String,
    state: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    grid: Vec<AxisEntry<'a>>,
    items: Vec<ItemEntry<'a>>,
}

#[derive(Serialize)]
struct AxisEntry<'a> {
    pointer: &'a str,
    values: Vec<Box<RawValue>>,
}

#[derive(Serialize)]
struct ItemEntry<'a> {
    index: usize,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    at: Vec<usize>,
    state: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    job: Option<String>,
    outputs: Vec<OutputEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

#[derive(Serialize)]
struct OutputEntry<'a> {
    name: &'a str,
    format: &'static str,
    key: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// Returns the contents of the archive of a settled batch.
///
/// # Panics
/// Never: the manifest is plain text and numbers.
pub fn contents(batch: &Batch) -> ArchiveContents {
    let mut files = Vec::new();
    let items = (0..batch.items.len()).map(|at| item(batch, at, &mut files)).collect();
    let grid = match &batch.request.layout {
        BatchLayout::List(_) => Vec::new(),
        BatchLayout::Grid { axes, .. } => {
            let raw = |range: &std::ops::Range<usize>| {
                let text = batch.request.text.get(range.clone()).unwrap_or_default();
                serde_json::from_slice(text).ok()
            };
            let axes = axes.iter();
            axes.map(|GridAxis { pointer, values }| AxisEntry {
                pointer,
                values: values.iter().filter_map(raw).collect(),
            })
            .collect()
        }
    };
    let manifest = ArchiveManifest { batch: batch.batch.id.to_string(), state: ended(&batch.state), grid, items };
    let mut manifest = serde_json::to_vec_pretty(&manifest).expect("plain text and numbers");
    manifest.push(b'\n');
    ArchiveContents { manifest, files }
}

/// Returns the manifest entry of one job, and appends its results to `files`.
fn item<'a>(batch: &'a Batch, at: usize, files: &mut Vec<ArchiveFile>) -> ItemEntry<'a> {
    let item = &batch.items[at];
    let (mut taken, mut outputs) = (BTreeSet::new(), Vec::new());
    for (product, made) in item.ending.iter().flat_map(|ending| &ending.outputs) {
        let (bytes, error) = match made {
            Some(OutputResult::Done { bytes, .. }) => (Some(*bytes), None),
            Some(OutputResult::Failed(reason)) => (None, Some(reason.as_str())),
            None => (None, None),
        };
        let file = bytes.map(|bytes| {
            let name = format!("{at:04}/{}", unique(&product.name, product.format.extension(), &mut taken));
            files.push(ArchiveFile { name: name.clone(), key: product.key, bytes });
            name
        });
        let (name, format, key) = (product.name.as_str(), product.format.name(), product.key.to_string());
        outputs.push(OutputEntry { name, format, key, file, bytes, error });
    }
    let state = item.ending.as_ref().map_or(&JobState::Active, |ending| &ending.state);
    let error = if let JobState::Failed(reason) = state { Some(reason.as_str()) } else { None };
    let coordinates = batch.request.layout.coordinates(at);
    ItemEntry {
        index: at,
        at: coordinates,
        state: ended(state),
        job: item.job.map(|job| job.to_string()),
        outputs,
        error,
    }
}

/// Returns a file name for an output that is valid on every system and unique within its job.
fn unique(name: &str, extension: &str, taken: &mut BTreeSet<String>) -> String {
    let stem = name.strip_suffix(extension).and_then(|name| name.strip_suffix('.')).unwrap_or(name);
    let safe = |letter: char| if letter.is_ascii_alphanumeric() || "-_.".contains(letter) { letter } else { '_' };
    let stem: String = stem.chars().take(MAX_FILE_NAME_CHARS).map(safe).collect();
    let stem = stem.trim_matches('.');
    let small = stem.to_ascii_lowercase();
    let first = small.split('.').next().unwrap_or_default();
    let is_port = ["com", "lpt"].iter().any(|port| first.strip_prefix(port).is_some_and(|rest| rest.len() == 1));
    let stem = match stem {
        "" => "output".to_owned(),
        stem if is_port || DEVICES.contains(&first) => format!("_{stem}"),
        stem => stem.to_owned(),
    };
    let candidates = std::iter::once(stem.clone()).chain((2..).map(|n| format!("{stem}-{n}")));
    let mut names = candidates.map(|stem| format!("{stem}.{extension}"));
    // some systems do not distinguish lower and upper case
    let free = names.find(|name| taken.insert(name.to_ascii_lowercase()));
    free.expect("there is always a further number")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_safe_and_unique() {
        let mut taken = BTreeSet::new();
        for (name, file) in [
            ("figure", "figure.png"),
            ("Figure", "Figure-2.png"),
            ("figure.png", "figure-3.png"),
            ("../../etc/passwd", "_.._etc_passwd.png"),
            ("..", "output.png"),
            ("nul", "_nul.png"),
            ("COM1", "_COM1.png"),
            ("a\u{0}b/ß", "a_b__.png"),
            (&"x".repeat(500), &format!("{}.png", "x".repeat(80))),
        ] {
            assert_eq!(unique(name, "png", &mut taken), file, "{name}");
        }
    }
}
