//! Helpers for all files of the embedded store: error messages with the path, and removal.

use std::fs;
use std::io;
use std::path::Path;

/// Removes a file if it exists. A directory of that name does not belong to the store and is left alone.
pub(super) fn remove_file(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(_) if path.is_dir() => {
            tracing::warn!(path = %path.display(), "a folder stands where a file of the store would; left alone");
            Ok(())
        }
        removed => removed.map_err(at("remove", path)),
    }
}

/// Returns a function that adds the attempted operation and the path to an I/O error.
pub(super) fn at(doing: &str, path: &Path) -> impl FnOnce(io::Error) -> io::Error {
    move |error| io::Error::new(error.kind(), format!("cannot {doing} {}: {error}", path.display()))
}
