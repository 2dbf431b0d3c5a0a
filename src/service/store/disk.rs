//! The operations on files that may wait or fail: one narrow place, so that another disk can stand in for the real one.

use std::fmt::Debug;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A disk. The operations that are not replaced are those of the machine.
pub trait Disk: Debug + Send + Sync {
    /// Writes `bytes` into `file`, `offset` bytes after its start.
    ///
    /// # Errors
    /// When the disk fails; the same write may be tried again.
    fn write(&self, file: &mut File, offset: u64, bytes: &[u8]) -> io::Result<()> {
        file.seek(SeekFrom::Start(offset))?;
        file.write_all(bytes)
    }

    /// Makes what was written into a file, or the names in a folder, last.
    ///
    /// # Errors
    /// When the disk fails.
    fn sync(&self, file: &File) -> io::Result<()> {
        file.sync_all()
    }

    /// Gives a file another name, in place of whatever file has it.
    ///
    /// # Errors
    /// When the disk fails.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    /// Reads up to `length` bytes of a file, from `offset` bytes after its start.
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

/// The disk of the machine.
#[derive(Debug, Clone, Copy, Default)]
pub struct Local;

impl Disk for Local {}

/// Whether an operation failed because there is no room: removing something may help.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)
}
