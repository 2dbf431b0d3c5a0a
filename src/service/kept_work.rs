//! Intermediate work of earlier computations in memory, refinement programs and refined meshes; the least recently used
//! is evicted first.

use std::sync::Mutex;

use super::lock::lock;
use super::store::{Owners, Shelf, Usage, admit};
use crate::job::key::{Key, content};
use crate::job::{KeepWork, Work};

/// Bytes charged for an entry besides its own: its places in the maps and what the allocator rounds up. Half of it
/// would let many tiny meshes exceed the capacity; twice of it would hold fewer of them.
const KEPT_ENTRY_BYTES: u64 = 512;

/// Intermediate work of computations, bounded in bytes.
#[derive(Debug)]
pub struct KeptWork {
    shelf: Mutex<Shelf<Work>>,
    capacity: u64,
}

impl KeptWork {
    /// Creates an empty store of `capacity` bytes, which refuses entries of more than half of that.
    pub fn new(capacity: u64) -> Self {
        Self { shelf: Mutex::new(Shelf::new(capacity)), capacity }
    }

    /// Returns the usage.
    pub fn usage(&self) -> Usage {
        lock(&self.shelf).usage()
    }

    /// Returns the work of these tenants.
    pub fn of(&self, owners: &Owners) -> WorkOf<'_> {
        let scope = (*owners != Owners::default()).then(|| content(format!("{owners:?}").as_bytes()));
        WorkOf { kept: self, scope }
    }
}

/// The work kept for one set of tenants. Work of other tenants is not reused, since the time saved would reveal what
/// they have computed.
#[derive(Debug)]
pub struct WorkOf<'a> {
    kept: &'a KeptWork,
    /// Prefix hashed into the keys; `None` for the public tenant.
    scope: Option<Key>,
}

impl WorkOf<'_> {
    fn key(&self, key: &Key) -> Key {
        self.scope.map_or(*key, |scope| content(&[*scope.as_bytes(), *key.as_bytes()].concat()))
    }
}

impl KeepWork for WorkOf<'_> {
    fn find(&self, key: &Key) -> Option<Work> {
        self.kept.find(&self.key(key))
    }

    fn keep(&self, key: Key, work: Work) {
        self.kept.keep(self.key(&key), work);
    }
}

impl KeepWork for KeptWork {
    fn find(&self, key: &Key) -> Option<Work> {
        lock(&self.shelf).touch(key).cloned()
    }

    fn keep(&self, key: Key, work: Work) {
        let cost = work.bytes() + KEPT_ENTRY_BYTES;
        if admit(cost, self.capacity).is_err() {
            return;
        }
        let mut left = Vec::new(); // dropped after the lock is released
        let mut shelf = lock(&self.shelf);
        left.extend(shelf.remove(&key));
        while let Some((_, evicted)) = shelf.evict_for(cost) {
            left.push(evicted);
        }
        shelf.insert(key, cost, work);
        drop(shelf);
        drop(left);
    }
}
