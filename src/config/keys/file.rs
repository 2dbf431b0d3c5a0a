//! The file of keys in the data directory: read by a running service again and again, changed by `planish key`.

use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::entry::KeyEntry;

/// Its name in the data directory.
pub const KEYS_FILE: &str = "keys.toml";
/// Most keys of a service. Twice of it is read in twice the time each second, half a millisecond; half of it is few for
/// a service whose users have a key each.
pub const MOST_KEYS: usize = 1024;
/// Longest file that is read, bytes: every key with half a page of comment.
const MOST_BYTES: u64 = 2 << 20;

/// Why the keys cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum KeyFileError {
    /// It cannot be read or written.
    #[error("the keys in {path}: {error}; choose another folder with --data-dir")]
    Files {
        /// The file.
        path: String,
        /// Why.
        error: io::Error,
    },
    /// It is not what it should be.
    #[error("the keys in {path}: {detail}; mend the file, or take it from a backup")]
    Unfit {
        /// The file.
        path: String,
        /// Where and why.
        detail: String,
    },
    /// The key that is to be added does not fit.
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
struct Written {
    #[serde(default)]
    key: Vec<KeyEntry>,
}

impl KeyFile {
    /// That of a data directory.
    pub fn of(data_dir: &Path) -> Self {
        Self { path: data_dir.join(KEYS_FILE) }
    }

    /// Its keys; `None` where there is no file. A file without keys lets nobody in.
    ///
    /// # Errors
    /// [`KeyFileError`].
    pub fn read(&self) -> Result<Option<Vec<KeyEntry>>, KeyFileError> {
        let mut text = String::new();
        let read = File::open(&self.path).and_then(|file| file.take(MOST_BYTES + 1).read_to_string(&mut text));
        match read {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(self.files(error)),
            Ok(_) if text.len() as u64 > MOST_BYTES => {
                return Err(self.unfit(format!("the file is longer than {MOST_BYTES} bytes")));
            }
            Ok(_) => {}
        }
        let written: Written = toml::from_str(&text).map_err(|error| self.unfit(error.to_string()))?;
        if let Some(fault) = written.key.iter().find_map(KeyEntry::fault) {
            return Err(self.unfit(fault));
        }
        if written.key.len() > MOST_KEYS {
            return Err(self.unfit(format!("there are {} keys, at most {MOST_KEYS} are read", written.key.len())));
        }
        Ok(Some(written.key))
    }

    /// Changes the keys while nobody else does, and tells what `change` does; for good when it returns.
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
        if keys.len() > MOST_KEYS {
            let detail = format!("there are {MOST_KEYS} keys already, the most there can be; revoke some first");
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

    /// Where it is.
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

/// How files are opened that only their owner, and the group of the service, may read.
fn private() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.create(true).write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o640);
    options
}

/// The file as it is written: every text is of plain letters, which [`KeyEntry::fault`] checks.
fn text_of(keys: &[KeyEntry]) -> String {
    let mut text = "# Keys of planish, changed by `planish key`: hashes, no secrets. `link` signs links.\n".to_owned();
    for key in keys {
        let KeyEntry { id, tenant, role, hash, link, created, expires, requests_per_minute, in_flight } = key;
        // writing to a text does not fail
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
