//! The manifest of rendered figures: one JSON file beside them, with entries sorted by name.

use std::collections::BTreeMap;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::cli::error::CliError;
use crate::cli::files::Files;
use crate::job::key::{Key, RESULTS_VERSION, content};

/// Name of the manifest file.
const MANIFEST_NAME: &str = "manifest.json";
/// Maximum number of measured numbers per figure: those of some six panels. Half of it would omit panels of common
/// figures; twice of it would fill reports with numbers that nobody reads.
const MAX_FIGURE_NUMBERS: usize = 128;

/// All figures of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureManifest {
    /// Results version.
    pub(super) results_version: u32,
    /// The figures, by the names of their files.
    pub(super) figures: BTreeMap<String, Entry>,
}

/// One figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    /// Name of the job file.
    pub(super) job: String,
    /// Key of the result.
    pub(super) key: String,
    /// BLAKE3 hash of the bytes.
    pub(super) hash: String,
    /// Number of bytes.
    pub(super) bytes: usize,
    /// Measured numbers of the shapes shown.
    pub(super) numbers: BTreeMap<String, Value>,
}

impl Default for FigureManifest {
    fn default() -> Self {
        Self { results_version: RESULTS_VERSION, figures: BTreeMap::new() }
    }
}

impl FigureManifest {
    fn path(folder: &Path) -> PathBuf {
        folder.join(MANIFEST_NAME)
    }

    /// Reads the manifest of a folder; `None` if there is none.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>, CliError> {
        let path = Self::path(folder);
        let cannot =
            |error: &dyn std::fmt::Display| CliError::files(format!("cannot read {}: {error}", path.display()));
        match fs::read(&path) {
            Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|error| cannot(&error)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(cannot(&error)),
        }
    }

    /// Writes the manifest into a folder.
    pub(super) fn write(&self, folder: &Path) -> Result<(), CliError> {
        let text = serde_json::to_string_pretty(self).map_err(CliError::other)?;
        put(&Self::path(folder), format!("{text}\n").as_bytes())
    }
}

impl Entry {
    /// Returns whether a folder has a file of this name with the bytes of the figure.
    pub(super) fn is_in(&self, folder: &Path, name: &str) -> bool {
        fs::read(folder.join(name)).is_ok_and(|bytes| hash(&bytes) == self.hash)
    }
}

/// Returns the hash of bytes in the form used in manifests.
pub(super) fn hash(bytes: &[u8]) -> String {
    let key: Key = content(bytes);
    key.to_string()
}

/// Writes a file; creates missing folders.
pub(super) fn put(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    let write = || {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        let mut files = Files::default();
        files.create(path)?.write_all(bytes)?;
        files.finish()
    };
    write().map_err(|error| CliError::files(format!("cannot write {}: {error}", path.display())))
}

/// Collects the numbers, texts and flags of a JSON value by their paths; skips matrices and lists of more than four
/// items.
pub(super) fn numbers(of: &str, value: &Value, found: &mut BTreeMap<String, Value>) {
    let place = |name: &str| if of.is_empty() { name.to_owned() } else { format!("{of} {name}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| numbers(&place(name), value, found)),
        Value::Array(items) if items.len() <= 4 && !items.iter().any(Value::is_array) => {
            items.iter().enumerate().for_each(|(i, value)| numbers(&place(&i.to_string()), value, found));
        }
        Value::Array(_) | Value::Null => {}
        other if found.len() < MAX_FIGURE_NUMBERS => {
            found.insert(of.to_owned(), other.clone());
        }
        _ => {}
    }
}
