//! The settings file: a regular file of bounded length, in TOML.

use std::fs::{File, metadata};
use std::io::{self, Read};
use std::path::Path;

use toml::{Table, Value};

use super::error::ConfigError;

/// Longest settings file, bytes: every setting with a page of comment stays far below.
const MOST_BYTES: u64 = 1 << 20;

/// The keys of the settings file, each with its value as a flag would have it.
pub(super) fn read(path: &Path) -> Result<Vec<(String, String)>, ConfigError> {
    let text = text(path).map_err(|error| ConfigError::Unreadable { path: path.to_owned(), error })?;
    let table: Table =
        toml::from_str(&text).map_err(|error| ConfigError::Unfit { path: path.to_owned(), error: Box::new(error) })?;
    Ok(table.into_iter().map(|(key, value)| (key, flat(value))).collect())
}

/// A value as a flag would have it: a list with commas.
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
    // asked before it is opened: the opening of a pipe waits for a writer
    if !metadata(path)?.is_file() {
        return Err(refused("it is no regular file; name one that holds the settings"));
    }
    let mut text = String::new();
    // a length is only a promise, so the reading itself is bounded
    File::open(path)?.take(MOST_BYTES + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MOST_BYTES {
        return Err(refused("it is longer than 1 MiB, the longest that is read; leave out what is no setting"));
    }
    Ok(text)
}
