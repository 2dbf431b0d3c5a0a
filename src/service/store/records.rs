//! Small records by key that outlast the process: the store of bytes for what is known of jobs.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use redb::{Database, ReadableDatabase, ReadableTable, TableDefinition, TableError};

use super::database::{builder, guarded};
use super::disk_files::{at, remove_file};
use super::error::StoreError;
use super::lock::lock;

/// Where a folder has its records.
pub(super) const RECORDS_FILE: &str = "jobs.redb";

/// Key -> record.
const RECORDS: TableDefinition<'_, &[u8], &[u8]> = TableDefinition::new("records-1");

/// Records by key. Calls may block.
pub trait Records: std::fmt::Debug + Send + Sync {
    /// Tells every record with its key.
    ///
    /// # Errors
    /// When the store fails.
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError>;

    /// Writes records, and removes those of keys without one: all of it or nothing, and for good when it returns.
    ///
    /// # Errors
    /// When the store fails.
    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError>;
}

/// Records in one file of a local disk.
#[derive(Debug)]
pub(super) struct RecordFile {
    path: PathBuf,
    /// None after a failure, until it is opened again: a database that failed once, of a full disk for instance, takes
    /// nothing more.
    database: Mutex<Option<Database>>,
}

impl RecordFile {
    /// Opens the file, or makes it; one that is no such file, or is damaged, is left as it is.
    pub(super) fn open(path: &Path) -> Result<Self, StoreError> {
        let damaged = |error: String| StoreError::Io(damaged(path, &error));
        if !path.exists() {
            // made aside, so that no crash leaves half a file under its name
            let aside = path.with_extension("new");
            remove_file(&aside)?;
            guarded(|| Ok(builder().create(&aside).map(drop)?)).map_err(damaged)?;
            fs::rename(&aside, path).map_err(at("make", path))?;
        }
        let database = guarded(|| Ok(builder().open(path)?)).map_err(damaged)?;
        let file = Self { database: Mutex::new(Some(database)), path: path.to_owned() };
        // what is damaged shows now, and not when a record is asked for
        file.each(&mut |_, _| {}).map_err(|error| damaged(error.to_string()))?;
        Ok(file)
    }

    /// Does something with the database, which is opened for it where it failed before.
    fn with<T>(&self, work: impl FnOnce(&Database) -> Result<T, redb::Error>) -> Result<T, StoreError> {
        let mut held = lock(&self.database);
        let opened = match held.take() {
            Some(database) => Ok(database),
            None => guarded(|| Ok(builder().open(&self.path)?)),
        };
        let done = opened.and_then(|database| {
            let database = held.insert(database);
            guarded(|| work(database))
        });
        done.map_err(|error| {
            if let Some(failed) = held.take() {
                // closing writes too, so it may fail as well; what the next one opens is what lasts
                let _ = guarded(|| {
                    drop(failed);
                    Ok(())
                });
            }
            StoreError::Io(io::Error::other(format!("{}: {error}", self.path.display())))
        })
    }
}

/// What every file of records begins with.
const MAGIC: &[u8; 9] = b"redb\x1A\x0A\xA9\x0D\x0A";

/// Refuses a file that does not begin as records do, without touching it; none is as good as one.
pub(super) fn refuse_damaged(path: &Path) -> io::Result<()> {
    let mut head = Vec::with_capacity(MAGIC.len());
    match File::open(path).and_then(|file| file.take(MAGIC.len() as u64).read_to_end(&mut head)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Ok(_) if head == MAGIC => Ok(()),
        Ok(_) => Err(damaged(path, "it does not begin as such a file does")),
        Err(error) => Err(at("read", path)(error)),
    }
}

/// Reads the records of a folder that is held, if there are any, so that damage shows before anything else is touched.
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
}
