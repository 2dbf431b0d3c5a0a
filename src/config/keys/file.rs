//! The file of keys in the data directory: a running service reads it again and again, and `planish key` changes it.

use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::entry::KeyEntry;

/// Name of the file in the data directory.
pub const KEYS_FILE: &str = "keys.toml";
/// Maximum number of keys of a service. Twice as many would take twice the time to read each second, half a
/// millisecond; half as many are few for a service whose users have a key each.
pub const MAX_KEYS: usize = 1024;
/// Maximum length of the file in bytes: every key with half a page of comment.
const MAX_KEYS_FILE_BYTES: u64 = 2 << 20;

/// The reason why the keys cannot be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum KeyFileError {
    /// The file cannot be read or written.
    #[error("the keys in {path}: {error}; choose another folder with --data-dir")]
    Files {
        /// The file.
        path: String,
        /// The I/O error.
        error: io::Error,
    },
    /// The content of the file is invalid.
    #[error("the keys in {path}: {detail}; mend the file, or take it from a backup")]
    Unfit {
        /// The file.
        path: String,
        /// The position and the reason.
        detail: String,
    },
    /// The change would exceed the maximum number of keys, or is refused for another reason.
    #[error("{0}")]
    Refused(String),
}

/// The file of keys of a data directory.
#[derive(Debug, Clone)]
pub struct KeyFile {
    path: PathBuf,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyEntries {
    #[serde(default)]
    key: Vec<KeyEntry>,
}

impl KeyFile {
    /// Returns the file of keys of a data directory, without opening it.
    pub fn of(data_dir: &Path) -> Self {
        Self { path: data_dir.join(KEYS_FILE) }
    }

    /// Reads the keys; `None` if there is no file. A file without keys lets nobody in.
    ///
    /// # Errors
    /// [`KeyFileError`].
    pub fn read(&self) -> Result<Option<Vec<KeyEntry>>, KeyFileError> {
        let mut text = String::new();
        let read = File::open(&self.path).and_then(|file| file.take(MAX_KEYS_FILE_BYTES + 1).read_to_string(&mut text));
        match read {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(self.files(error)),
            Ok(_) if text.len() as u64 > MAX_KEYS_FILE_BYTES => {
                return Err(self.unfit(format!("the file is longer than {MAX_KEYS_FILE_BYTES} bytes")));
            }
            Ok(_) => {}
        }
        let written: KeyEntries = toml::from_str(&text).map_err(|error| self.unfit(error.to_string()))?;
        if let Some(fault) = written.key.iter().find_map(KeyEntry::fault) {
            return Err(self.unfit(fault));
        }
        if written.key.len() > MAX_KEYS {
            return Err(self.unfit(format!("there are {} keys, at most {MAX_KEYS} are read", written.key.len())));
        }
        Ok(Some(written.key))
    }

    /// Changes the keys under a lock that excludes other changes, and returns the result of `change`; the new keys are
    /// durable then.
    ///
    /// # Errors
    /// [`KeyFileError`]; then nothing is changed.
    pub fn change<T>(
        &self,
        change: impl FnOnce(&mut Vec<KeyEntry>) -> Result<T, KeyFileError>,
    ) -> Result<T, KeyFileError> {
        let failed = |error| self.files(error);
        let folder = self.path.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(failed)?;
        let lock = self.path.with_extension("lock");
        let lock = private().truncate(false).open(lock).map_err(failed)?;
        lock.lock().map_err(failed)?;
        let mut keys = self.read()?.unwrap_or_default();
        let changed = change(&mut keys)?;
        if keys.len() > MAX_KEYS {
            let detail = format!("there are {MAX_KEYS} keys already, the most there can be; revoke some first");
            return Err(KeyFileError::Refused(detail));
        }
        let aside = self.path.with_extension("new");
        let mut file = private().truncate(true).open(&aside).map_err(failed)?;
        let written = file.write_all(text_of(&keys).as_bytes()).and_then(|()| file.sync_all());
        written.and_then(|()| fs::rename(&aside, &self.path)).map_err(failed)?;
        if cfg!(unix) {
            File::open(folder).and_then(|folder| folder.sync_all()).map_err(failed)?;
        }
        Ok(changed)
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn files(&self, error: io::Error) -> KeyFileError {
        KeyFileError::Files { path: self.path.display().to_string(), error }
    }

    fn unfit(&self, detail: String) -> KeyFileError {
        KeyFileError::Unfit { path: self.path.display().to_string(), detail }
    }
}

/// Returns the options to open files that only their owner may write, and only their owner and group may read.
fn private() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.create(true).write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o640);
    options
}

/// Returns the text of the file. The values need no escapes, since [`KeyEntry::fault`] allows only plain characters.
fn text_of(keys: &[KeyEntry]) -> String {
    let mut text = "# Keys of planish, changed by `planish key`: hashes, no secrets. `link` signs links.\n".to_owned();
    for key in keys {
        let KeyEntry { id, tenant, role, hash, link, created, expires, requests_per_minute, in_flight } = key;
        // writing to a string does not fail
        let _ = write!(
            text,
            "\n[[key]]\nid = \"{id}\"\ntenant = \"{tenant}\"\nrole = \"{}\"\nhash = \"{hash}\"\nlink = \"{link}\"\n\
             created = {created}\n",
            role.name()
        );
        let numbers = [("expires", expires), ("requests_per_minute", requests_per_minute), ("in_flight", in_flight)];
        for (name, number) in numbers {
            if let Some(number) = number {
                let _ = writeln!(text, "{name} = {number}");
            }
        }
    }
    text
}
