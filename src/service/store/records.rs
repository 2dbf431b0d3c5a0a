//! A durable map of small records, such as those of jobs and batches; it knows their keys and bytes only.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use redb::{Database, ReadableDatabase, ReadableTable, TableDefinition, TableError};

use super::database::{builder, close, guarded};
use super::disk_files::{at, remove_file};
use super::error::StoreError;
use crate::service::lock::lock;

/// Name of the file of records in a folder.
pub(super) const RECORDS_FILE: &str = "jobs.redb";

/// Maps a key to a record.
const RECORDS: TableDefinition<'_, &[u8], &[u8]> = TableDefinition::new("records-1");

/// Records by key. Calls may block.
pub trait Records: std::fmt::Debug + Send + Sync {
    /// Calls `tell` with the key and the bytes of every record.
    ///
    /// # Errors
    /// When the store fails.
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError>;

    /// Writes records, and removes the keys without a record, in one transaction that is durable when this returns.
    ///
    /// # Errors
    /// When the store fails.
    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError>;

    /// Returns an error if records that are written now would be lost when the process ends.
    ///
    /// # Errors
    /// When the store fails.
    fn check(&self) -> Result<(), StoreError>;
}

/// Records in one file of a local disk.
#[derive(Debug)]
pub(super) struct RecordFile {
    path: PathBuf,
    /// The open database; `None` after a failure, until the next operation opens it again: a database that has failed
    /// once, for instance on a full disk, accepts nothing more.
    open: Mutex<Option<OpenFile>>,
}

/// An open database, and the file that it was opened from.
#[derive(Debug)]
struct OpenFile {
    database: Database,
    file: FileId,
}

impl OpenFile {
    /// Opens the database at a path. If the file is replaced in between, the next operation fails, and the one
    /// after it opens the file again.
    fn open(path: &Path) -> Result<Self, String> {
        let file = file_at(path)?;
        let database = guarded(|| Ok(builder().open(path)?))?;
        Ok(Self { database, file })
    }
}

/// The numbers of a file's device and inode, which tell it from every other file whatever their names. Both are 0 on
/// systems without inodes, which let nobody remove an open file.
type FileId = (u64, u64);

/// The message when the path of the records leads to no file, or to another one than the open one: records that are
/// written into a removed file do not outlast the process.
const REMOVED: &str = "it was removed or replaced while the service ran; put it back, or start the service again";

/// Returns the identity of the file that has this path now.
fn file_at(path: &Path) -> Result<FileId, String> {
    match fs::metadata(path) {
        Ok(file) => Ok(identity(&file)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Err(REMOVED.to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(unix)]
fn identity(file: &Metadata) -> FileId {
    use std::os::unix::fs::MetadataExt;
    (file.dev(), file.ino())
}

#[cfg(not(unix))]
fn identity(_: &Metadata) -> FileId {
    (0, 0)
}

impl RecordFile {
    /// Opens the file, or creates it; a file that is damaged or not a database is left unchanged.
    pub(super) fn open(path: &Path) -> Result<Self, StoreError> {
        let damaged = |error: String| StoreError::Io(damaged(path, &error));
        if !path.exists() {
            // The file is created under another name first, so that a crash leaves no incomplete file under its final
            // name.
            let aside = path.with_extension("new");
            remove_file(&aside)?;
            guarded(|| Ok(builder().create(&aside).map(drop)?)).map_err(damaged)?;
            fs::rename(&aside, path).map_err(at("make", path))?;
        }
        let open = OpenFile::open(path).map_err(damaged)?;
        let file = Self { open: Mutex::new(Some(open)), path: path.to_owned() };
        // All records are read now, so that damage is found here and not at a later request.
        file.each(&mut |_, _| {}).map_err(|error| damaged(error.to_string()))?;
        Ok(file)
    }

    /// Runs an operation on the database, which is opened again first if an earlier operation failed. Fails as well if
    /// the file is no longer at its path afterwards.
    fn with<T>(&self, work: impl FnOnce(&Database) -> Result<T, redb::Error>) -> Result<T, StoreError> {
        let mut held = lock(&self.open);
        let opened = held.take().map_or_else(|| OpenFile::open(&self.path), Ok);
        let done = opened.and_then(|opened| {
            let OpenFile { database, file } = held.insert(opened);
            let done = guarded(|| work(database))?;
            if file_at(&self.path)? == *file { Ok(done) } else { Err(REMOVED.to_owned()) }
        });
        done.map_err(|error| {
            if let Some(failed) = held.take() {
                // Closing writes, so it may fail as well; only what the next open finds in the file counts.
                let _ = close(failed);
            }
            StoreError::Io(io::Error::other(format!("{}: {error}", self.path.display())))
        })
    }
}

/// The first bytes of every redb file.
const REDB_MAGIC: &[u8; 9] = b"redb\x1A\x0A\xA9\x0D\x0A";

/// Refuses an existing file that does not begin with [`REDB_MAGIC`], without changing it; a missing file is accepted.
pub(super) fn refuse_damaged(path: &Path) -> io::Result<()> {
    let mut head = Vec::with_capacity(REDB_MAGIC.len());
    match File::open(path).and_then(|file| file.take(REDB_MAGIC.len() as u64).read_to_end(&mut head)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Ok(_) if head == REDB_MAGIC => Ok(()),
        Ok(_) => Err(damaged(path, "it does not begin as such a file does")),
        Err(error) => Err(at("read", path)(error)),
    }
}

/// Reads all records of a locked folder, if there are any, so that damage is found before anything else is changed.
pub(super) fn read_through(path: &Path) -> io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    RecordFile::open(path).map(drop).map_err(|error| match error {
        StoreError::Io(error) => error,
        error => io::Error::other(error),
    })
}

fn damaged(path: &Path, error: &str) -> io::Error {
    let detail = format!(
        "the records of jobs in {} cannot be read: {error}; restore the file from a backup, or move it away to start \
         without its jobs",
        path.display()
    );
    io::Error::new(io::ErrorKind::InvalidData, detail)
}

impl Records for RecordFile {
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError> {
        self.with(|database| {
            let transaction = database.begin_read()?;
            let table = match transaction.open_table(RECORDS) {
                Err(TableError::TableDoesNotExist(_)) => return Ok(()),
                table => table?,
            };
            for row in table.iter()? {
                let (key, record) = row?;
                tell(key.value(), record.value());
            }
            Ok(())
        })
    }

    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError> {
        self.with(|database| {
            let transaction = database.begin_write()?;
            {
                let mut table = transaction.open_table(RECORDS)?;
                for (key, record) in changes {
                    match record {
                        Some(record) => table.insert(key.as_slice(), record.as_slice())?,
                        None => table.remove(key.as_slice())?,
                    };
                }
            }
            transaction.commit()?;
            Ok(())
        })
    }

    fn check(&self) -> Result<(), StoreError> {
        self.with(|_| Ok(()))
    }
}
