//! The settings file: a regular file of bounded length, in TOML.

use std::fs::{File, metadata};
use std::io::{self, Read};
use std::path::Path;

use toml::{Table, Value};

use super::error::ConfigError;

/// Maximum length of the settings file in bytes: every setting with a page of comment stays far below.
const MAX_SETTINGS_FILE_BYTES: u64 = 1 << 20;

/// Reads the keys of the settings file, each with its value in the form of a flag.
pub(super) fn read(path: &Path) -> Result<Vec<(String, String)>, ConfigError> {
    let text = text(path).map_err(|error| ConfigError::Unreadable { path: path.to_owned(), error })?;
    let table: Table =
        toml::from_str(&text).map_err(|error| ConfigError::Unfit { path: path.to_owned(), error: Box::new(error) })?;
    Ok(table.into_iter().map(|(key, value)| (key, flat(value))).collect())
}

/// Converts a value to the form of a flag; the entries of a list are separated by commas.
fn flat(value: Value) -> String {
    match value {
        Value::String(text) => text,
        Value::Array(entries) => entries.into_iter().map(flat).collect::<Vec<_>>().join(","),
        Value::Integer(n) => n.to_string(),
        Value::Float(x) => x.to_string(),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(time) => time.to_string(),
        Value::Table(table) => table.into_iter().map(|(key, _)| key).collect::<Vec<_>>().join(","),
    }
}

fn text(path: &Path) -> io::Result<String> {
    let refused = |detail| io::Error::new(io::ErrorKind::InvalidInput, detail);
    // checked before opening, since opening a pipe waits for a writer
    if !metadata(path)?.is_file() {
        return Err(refused("it is no regular file; name one that holds the settings"));
    }
    let mut text = String::new();
    // the reading is bounded, since the length in the metadata may be wrong
    File::open(path)?.take(MAX_SETTINGS_FILE_BYTES + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MAX_SETTINGS_FILE_BYTES {
        return Err(refused("it is longer than 1 MiB, the longest that is read; leave out what is no setting"));
    }
    Ok(text)
}
