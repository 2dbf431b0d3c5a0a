//! The order of use on disk: a hint that is read once, when the store opens, and written now and then.
//!
//! Only the order of eviction depends on the index. If it is missing or unreadable, a new one is started; artifacts
//! that it does not list count as more recently used than all others, ordered by the times at which their manifests
//! were written.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use redb::{Database, ReadableDatabase, ReadableTable, TableDefinition, TableError};

use super::database::{builder, close, guarded};
use super::shelf::Shelf;
use crate::job::key::Key;

/// Maps the key of an artifact to the number of its last use.
const USES_TABLE: TableDefinition<'_, &[u8; 32], u64> = TableDefinition::new("last-use-1");

/// Number of additions and removals after which the order is written again. Half of it would write twice as often;
/// twice of it would lose the order of twice as many uses in a crash.
const CHANGES_A_WRITE: u32 = 256;

/// The index file, and the changes that are not written to it yet.
#[derive(Debug)]
pub(super) struct StoreIndex {
    path: PathBuf,
    /// The open database; `None` after a failure, and the next write starts a new file.
    database: Option<Database>,
    /// All uses with numbers below this one are in the file; 0 if the file has no valid contents.
    written: u64,
    removed: Vec<Key>,
    changes: u32,
    /// Whether the index is closed for good, so that nothing is written any more.
    closed: bool,
}

impl StoreIndex {
    /// Opens the index, or an empty one in its place, and reads the numbers of last use.
    pub(super) fn open(path: PathBuf) -> (Self, HashMap<Key, u64>) {
        let mut index = Self { path, database: None, written: 0, removed: Vec::new(), changes: 0, closed: false };
        let uses = index.read().unwrap_or_else(|error| {
            tracing::warn!(path = %index.path.display(), error, "the index cannot be read and is made anew");
            index.close();
            HashMap::new()
        });
        (index, uses)
    }

    /// Notes that an artifact was added.
    pub(super) fn note_added(&mut self) {
        self.changes += 1;
    }

    /// Notes that an artifact was removed.
    pub(super) fn note_removed(&mut self, key: Key) {
        self.changes += 1;
        if self.written > 0 {
            self.removed.push(key);
        }
    }

    /// Returns whether there are enough changes for a write.
    pub(super) fn is_due(&self) -> bool {
        self.changes >= CHANGES_A_WRITE
    }

    /// Collects from the shelf what [`write`](Self::write) needs.
    pub(super) fn pending<V>(&self, shelf: &Shelf<V>) -> PendingUses {
        PendingUses { uses: shelf.used_since(self.written).collect(), next_use: shelf.next_use() }
    }

    /// Writes the order. A failure loses no artifact: it is logged, and the next write starts a new file.
    pub(super) fn write(&mut self, pending: &PendingUses) {
        self.changes = 0;
        let removed = std::mem::take(&mut self.removed);
        match self.try_write(&removed, &pending.uses) {
            Ok(()) => self.written = pending.next_use,
            Err(error) => {
                tracing::warn!(path = %self.path.display(), error, "the index cannot be written");
                self.written = 0;
                self.close();
            }
        }
    }

    fn read(&mut self) -> Result<HashMap<Key, u64>, String> {
        let database = self.database.insert(guarded(|| Ok(builder().create(&self.path)?))?);
        guarded(|| read(database))
    }

    fn try_write(&mut self, removed: &[Key], uses: &[(Key, u64)]) -> Result<(), String> {
        let database = match self.database.take() {
            Some(database) => database,
            None => guarded(|| create(&self.path))?,
        };
        let database = self.database.insert(database);
        guarded(|| write(database, self.written == 0, removed, uses))
    }

    /// Closes the file for good.
    pub(super) fn shut(&mut self) {
        self.close();
        self.closed = true;
    }

    /// Returns whether the index is closed for good.
    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Closes the database. Closing writes, so it can fail like a write.
    fn close(&mut self) {
        if let Some(database) = self.database.take()
            && let Err(error) = close(database)
        {
            tracing::warn!(path = %self.path.display(), error, "the index cannot be closed");
        }
    }
}

impl Drop for StoreIndex {
    fn drop(&mut self) {
        self.close();
    }
}

/// The uses that are not in the file yet.
#[derive(Debug)]
pub(super) struct PendingUses {
    uses: Vec<(Key, u64)>,
    next_use: u64,
}

fn read(database: &Database) -> Result<HashMap<Key, u64>, redb::Error> {
    let transaction = database.begin_read()?;
    let table = match transaction.open_table(USES_TABLE) {
        Err(TableError::TableDoesNotExist(_)) => return Ok(HashMap::new()),
        table => table?,
    };
    let mut uses = HashMap::new();
    for row in table.iter()? {
        let (key, last_use) = row?;
        uses.insert(Key::from_bytes(*key.value()), last_use.value());
    }
    Ok(uses)
}

/// Creates an empty database, replacing the file at `path`, if any.
fn create(path: &Path) -> Result<Database, redb::Error> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(builder().create(path)?),
    }
}

fn write(database: &Database, anew: bool, removed: &[Key], uses: &[(Key, u64)]) -> Result<(), redb::Error> {
    let transaction = database.begin_write()?;
    if anew {
        transaction.delete_table(USES_TABLE)?;
    }
    {
        let mut table = transaction.open_table(USES_TABLE)?;
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
