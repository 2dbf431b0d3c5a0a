//! The file operations of the embedded store that may block or fail, as a trait, so that tests can replace the real
//! disk.

use std::fmt::Debug;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A disk. The default implementations use the file system of the machine.
pub trait Disk: Debug + Send + Sync {
    /// Writes `bytes` to `file` at `offset` bytes from its start.
    ///
    /// # Errors
    /// When the disk fails; the same write may be tried again.
    fn write(&self, file: &mut File, offset: u64, bytes: &[u8]) -> io::Result<()> {
        file.seek(SeekFrom::Start(offset))?;
        file.write_all(bytes)
    }

    /// Flushes the contents of a file, or the entries of a directory, to durable storage.
    ///
    /// # Errors
    /// When the disk fails.
    fn sync(&self, file: &File) -> io::Result<()> {
        file.sync_all()
    }

    /// Renames a file, replacing any file of the new name.
    ///
    /// # Errors
    /// When the disk fails.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    /// Reads up to `length` bytes of a file at `offset` bytes from its start.
    ///
    /// # Errors
    /// When the disk fails.
    fn read(&self, path: &Path, offset: u64, length: usize) -> io::Result<Vec<u8>> {
        let mut file = File::open(path)?;
        let mut bytes = Vec::with_capacity(length);
        file.seek(SeekFrom::Start(offset))?;
        file.take(length as u64).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

/// The local disk of the machine.
#[derive(Debug, Clone, Copy, Default)]
pub struct LocalDisk;

impl Disk for LocalDisk {}

/// Returns whether an operation failed for lack of space, so that removing files may help.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)
}
