//! The order of use on disk: a hint that is read once, when the store opens, and written now and then.
//!
//! Nothing depends on it but the order of eviction. An index that is missing or cannot be read is made anew; an
//! artifact it does not know counts as used when its manifest was written.

use std::collections::HashMap;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::{fs, io};

use redb::{Database, ReadableDatabase, ReadableTable, TableDefinition, TableError};

use super::shelf::Shelf;
use crate::job::key::Key;

/// Key of an artifact -> number of its last use.
const USES: TableDefinition<'_, &[u8; 32], u64> = TableDefinition::new("last-use-1");

/// Changes after which the order is written again.
const CHANGES_A_WRITE: u32 = 256;

/// Page cache of the database; its default would be a gigabyte.
const CACHE_BYTES: usize = 4 << 20;

/// The file and what of it is out of date.
#[derive(Debug)]
pub(super) struct Index {
    path: PathBuf,
    /// `None` after a failure: the next write starts a new file.
    database: Option<Database>,
    /// Uses before this one are in the file; 0 when the file holds nothing of worth.
    written: u64,
    removed: Vec<Key>,
    changes: u32,
}

impl Index {
    /// Opens the index, or an empty one in its place, and reads the numbers of last use.
    pub(super) fn open(path: PathBuf) -> (Self, HashMap<Key, u64>) {
        let (database, uses) = match guarded(|| read(&path)) {
            Ok((database, uses)) => (Some(database), uses),
            Err(error) => {
                tracing::warn!(path = %path.display(), error, "the index cannot be read and is made anew");
                (None, HashMap::new())
            }
        };
        (Self { path, database, written: 0, removed: Vec::new(), changes: 0 }, uses)
    }

    /// Notes a new artifact.
    pub(super) fn note_added(&mut self) {
        self.changes += 1;
    }

    /// Notes that an artifact is gone.
    pub(super) fn note_removed(&mut self, key: Key) {
        self.changes += 1;
        if self.written > 0 {
            self.removed.push(key);
        }
    }

    /// Whether enough has changed for a write.
    pub(super) fn is_due(&self) -> bool {
        self.changes >= CHANGES_A_WRITE
    }

    /// What [`write`](Self::write) must be told, taken from the shelf.
    pub(super) fn pending<V>(&self, shelf: &Shelf<V>) -> Pending {
        Pending { uses: shelf.used_since(self.written).collect(), next_use: shelf.next_use() }
    }

    /// Writes the order. A failure costs no artifact: it is logged, and the next write starts a new file.
    pub(super) fn write(&mut self, pending: &Pending) {
        self.changes = 0;
        let removed = std::mem::take(&mut self.removed);
        let database = self.database.take();
        let anew = self.written == 0;
        let written = guarded(|| {
            let database = database.map_or_else(|| create(&self.path), Ok)?;
            write(&database, anew, &removed, &pending.uses)?;
            Ok(database)
        });
        match written {
            Ok(database) => (self.database, self.written) = (Some(database), pending.next_use),
            Err(error) => {
                self.written = 0;
                tracing::warn!(path = %self.path.display(), error, "the index cannot be written");
            }
        }
    }
}

/// Uses that are not in the file yet.
#[derive(Debug)]
pub(super) struct Pending {
    uses: Vec<(Key, u64)>,
    next_use: u64,
}

/// A damaged file must not stop the service, so a panic of the database counts as a failure of the index.
fn guarded<T>(work: impl FnOnce() -> Result<T, redb::Error>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => done.map_err(|error| error.to_string()),
        Err(_) => Err("the database panicked".to_owned()),
    }
}

fn read(path: &Path) -> Result<(Database, HashMap<Key, u64>), redb::Error> {
    let database = Database::builder().set_cache_size(CACHE_BYTES).create(path)?;
    let transaction = database.begin_read()?;
    let mut uses = HashMap::new();
    match transaction.open_table(USES) {
        Ok(table) => {
            for row in table.iter()? {
                let (key, last_use) = row?;
                uses.insert(Key::from_bytes(*key.value()), last_use.value());
            }
        }
        Err(TableError::TableDoesNotExist(_)) => {}
        Err(error) => return Err(error.into()),
    }
    drop(transaction);
    Ok((database, uses))
}

/// An empty database in place of whatever was there.
fn create(path: &Path) -> Result<Database, redb::Error> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(Database::builder().set_cache_size(CACHE_BYTES).create(path)?),
    }
}

fn write(database: &Database, anew: bool, removed: &[Key], uses: &[(Key, u64)]) -> Result<(), redb::Error> {
    let transaction = database.begin_write()?;
    if anew {
        transaction.delete_table(USES)?;
    }
    {
        let mut table = transaction.open_table(USES)?;
        for key in removed {
            table.remove(key.as_bytes())?;
        }
        for (key, last_use) in uses {
            table.insert(key.as_bytes(), last_use)?;
        }
    }
    transaction.commit()?;
    Ok(())
}
