//! What every file of the embedded store has in common: how its failures are told, and how it is removed.

use std::fs;
use std::io;
use std::path::Path;

/// Removes a file, if it is there. A folder of that name is not of this store and is left alone.
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

/// Says what was being done and where when `error` came.
pub(super) fn at(doing: &str, path: &Path) -> impl FnOnce(io::Error) -> io::Error {
    move |error| io::Error::new(error.kind(), format!("cannot {doing} {}: {error}", path.display()))
}
