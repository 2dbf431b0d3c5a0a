//! Work of earlier computations in memory: programs of refinement and refined meshes, the least recently used leave
//! first.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::store::{Owners, Shelf, Usage, admit};
use crate::job::key::{Key, content};
use crate::job::{KeepWork, Work};

/// Charged for an entry besides its bytes: its places in the maps and what the allocator rounds up.
/// Half of it lets many tiny meshes take more than they may; twice of it holds fewer of them.
const ENTRY_BYTES: u64 = 512;

/// Work that is kept, bounded in bytes.
#[derive(Debug)]
pub struct KeptWork {
    shelf: Mutex<Shelf<Work>>,
    capacity: u64,
}

impl KeptWork {
    /// Keeps so many bytes of work at most; nothing that takes more than half of them.
    pub fn new(capacity: u64) -> Self {
        Self { shelf: Mutex::new(Shelf::new(capacity)), capacity }
    }

    /// Every change under this lock is complete before anything can panic.
    fn shelf(&self) -> MutexGuard<'_, Shelf<Work>> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is held.
    pub fn usage(&self) -> Usage {
        self.shelf().usage()
    }
}

/// The work that was kept for the same tenants: what others have refined before makes nothing quicker, so that time
/// does not tell of it.
#[derive(Debug)]
pub struct WorkOf<'a> {
    kept: &'a KeptWork,
    /// Goes into the keys, but where the tenants are everybody.
    scope: Option<Key>,
}

impl KeptWork {
    /// The work of these tenants.
    pub fn of(&self, owners: &Owners) -> WorkOf<'_> {
        let scope = (*owners != Owners::default()).then(|| content(format!("{owners:?}").as_bytes()));
        WorkOf { kept: self, scope }
    }
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
        self.shelf().touch(key).cloned()
    }

    fn keep(&self, key: Key, work: Work) {
        let cost = work.bytes() + ENTRY_BYTES;
        if admit(cost, self.capacity).is_err() {
            return;
        }
        let mut left = Vec::new(); // freed after the lock
        let mut shelf = self.shelf();
        left.extend(shelf.remove(&key));
        while let Some((_, evicted)) = shelf.evict_for(cost) {
            left.push(evicted);
        }
        shelf.insert(key, cost, work);
        drop(shelf);
        drop(left);
    }
}
