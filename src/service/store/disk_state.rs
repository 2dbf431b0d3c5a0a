//! The state of the embedded store: the artifacts in its folder, and the locks for changing them.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;
use std::{io, thread};

use bytes::Bytes;

use super::clean_up::{CleanUp, clean_up};
use super::disk::Disk;
use super::error::StoreError;
use super::files::{StoreFolder, Tmp, cost};
use super::index::StoreIndex;
use super::manifest::Manifest;
use super::shelf::{self, Shelf};
use crate::job::key::Key;
use crate::service::lock::lock;

/// Number of attempts of a computation to get the lock for evicting artifacts, with [`LOCK_PAUSE`] between two of them:
/// one second at most, about as long as one durable write takes on a disk under load. After that the bytes stay in
/// memory, so that the compute thread is not held up. Half of the time would leave more bytes in memory while evictions
/// are written; twice of it would hold compute threads for longer.
const LOCK_TRIES: u32 = 100;
const LOCK_PAUSE: Duration = Duration::from_millis(10);

/// The state of a store, shared with its open spools.
#[derive(Debug)]
pub(super) struct DiskState {
    pub(super) folder: StoreFolder,
    pub(super) capacity: u64,
    /// The artifacts with their manifests, in order of use. Locked only for moments, never during disk operations.
    pub(super) shelf: Mutex<Shelf<Arc<Manifest>>>,
    /// The index on disk. Its lock is held by whoever changes files of artifacts, and is taken before the lock of the
    /// shelf.
    index: Mutex<StoreIndex>,
    /// Keys whose artifact cannot be written, because a directory has the name of one of its files.
    occupied: Mutex<HashSet<Key>>,
}

/// Puts the artifacts found in the folder on a shelf, in order of use; artifacts missing from the index count as the
/// most recently used.
fn fill(
    folder: &StoreFolder,
    cleaned: CleanUp,
    uses: &HashMap<Key, u64>,
    capacity: u64,
) -> Result<Shelf<Arc<Manifest>>, StoreError> {
    let mut shelf = Shelf::new(capacity);
    shelf.count_damaged(cleaned.damaged);
    let mut found = cleaned.found;
    found.sort_by_cached_key(|found| {
        let key = found.manifest.key;
        (uses.get(&key).copied().unwrap_or(u64::MAX), found.written, key)
    });
    for manifest in found.into_iter().map(|found| found.manifest) {
        let cost = cost(manifest.length, manifest.encode().len());
        if shelf::admit(cost, capacity).is_err() {
            folder.remove(&manifest.key)?; // the capacity was larger when the artifact was committed
            continue;
        }
        while let Some((key, _)) = shelf.evict_for(cost) {
            folder.remove(&key)?;
        }
        shelf.insert(manifest.key, cost, Arc::new(manifest));
    }
    Ok(shelf)
}

impl DiskState {
    /// Opens the folder, removes what a crash left behind, and evicts artifacts beyond the capacity.
    pub(super) fn open(disk: Arc<dyn Disk>, dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        let folder = StoreFolder::open(dir, disk)?;
        let mut cleaned = clean_up(&folder)?;
        if cleaned.damaged + cleaned.removed > 0 {
            let CleanUp { damaged, removed: left_over, .. } = cleaned;
            tracing::warn!(dir = %dir.display(), damaged, left_over, "swept the store");
        }
        let (index, uses) = StoreIndex::open(folder.index());
        let occupied = Mutex::new(std::mem::take(&mut cleaned.occupied));
        let shelf = Mutex::new(fill(&folder, cleaned, &uses, capacity_bytes)?);
        let state = Self { folder, capacity: capacity_bytes, shelf, index: Mutex::new(index), occupied };
        state.write_index(&mut lock(&state.index));
        Ok(state)
    }

    /// Refuses an artifact that cannot be stored, before any byte is written.
    pub(super) fn admit(&self, key: &Key, length: u64) -> Result<(), StoreError> {
        shelf::admit(length, self.capacity)?;
        if lock(&self.occupied).contains(key) { Err(self.occupied(key)) } else { Ok(()) }
    }

    /// Returns a part after verifying its hash; `None` if the artifact has no such part, is gone, or was found damaged.
    pub(super) fn part(&self, manifest: &Manifest, number: usize) -> Result<Option<Bytes>, StoreError> {
        if number >= manifest.parts.len() {
            return Ok(None);
        }
        match self.folder.read_part(manifest, number)? {
            Some(bytes) => Ok(Some(bytes)),
            None => self.part_again(manifest, number),
        }
    }

    /// Removes an artifact, if it is stored.
    pub(super) fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.discard(&mut lock(&self.index), key)?;
        Ok(())
    }

    /// Returns the manifest of `key`, if the artifact is stored with this content, and counts this as a use.
    pub(super) fn held(&self, key: &Key, content: &Key) -> Option<Arc<Manifest>> {
        lock(&self.shelf).touch(key).filter(|held| held.content == *content).cloned()
    }

    /// Turns two written and synced files into an artifact: evicts others to make room, then renames the files into
    /// place.
    pub(super) fn keep(
        &self,
        manifest: Arc<Manifest>,
        cost: u64,
        bytes: &Tmp,
        record: &Tmp,
    ) -> Result<Arc<Manifest>, StoreError> {
        let key = manifest.key;
        let mut index = lock(&self.index);
        if index.is_closed() {
            return Err(io::Error::other("the store is closed").into());
        }
        if let Some(present) = self.held(&key, &manifest.content) {
            if present.owners.with(&manifest.owners).is_none() {
                return Ok(present);
            }
            // The bytes are the same and only the owners are new, so only the manifest is replaced.
            self.folder.describe(&key, record)?;
            let mut shelf = lock(&self.shelf);
            if let Some(held) = shelf.touch_mut(&key) {
                *held = Arc::clone(&manifest);
            }
            shelf.set_cost(&key, cost);
            drop(shelf);
            return Ok(manifest);
        }
        if self.discard(&mut index, &key)? {
            tracing::warn!(%key, "an artifact was made again with other bytes; the new ones replace the old");
        }
        while let Some((evicted, _)) = { lock(&self.shelf).evict_for(cost) } {
            index.note_removed(evicted);
            self.folder.remove(&evicted)?;
        }
        if !lock(&self.shelf).has_room(cost) {
            return Err(StoreError::InUse);
        }
        if let Err(error) = self.folder.place(&key, bytes, record) {
            if !self.folder.is_occupied(&key) {
                return Err(error.into());
            }
            lock(&self.occupied).insert(key);
            return Err(self.occupied(&key));
        }
        lock(&self.shelf).insert(key, cost, Arc::clone(&manifest));
        index.note_added();
        if index.is_due() {
            self.write_index(&mut index);
        }
        Ok(manifest)
    }

    fn occupied(&self, key: &Key) -> StoreError {
        StoreError::Occupied { path: self.folder.bytes(key).display().to_string() }
    }

    /// Runs a write; while the disk is full, evicts the least recently used artifacts and tries again. Gives up if
    /// nothing can be evicted, or if other threads hold the index for longer than a computation should wait.
    pub(super) fn with_room<T>(
        &self,
        need: u64,
        mut write: impl FnMut() -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        loop {
            match write() {
                Err(error) if error.is_full() => {
                    let Some(mut index) = self.index_soon() else { return Err(error) };
                    if !self.evict(&mut index, need)? {
                        return Err(error);
                    }
                }
                done => return done,
            }
        }
    }

    /// Locks the index, if that is possible within [`LOCK_TRIES`] times [`LOCK_PAUSE`].
    fn index_soon(&self) -> Option<MutexGuard<'_, StoreIndex>> {
        for _ in 0..LOCK_TRIES {
            match self.index.try_lock() {
                Ok(index) => return Some(index),
                Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => thread::sleep(LOCK_PAUSE),
            }
        }
        None
    }

    /// Evicts the least recently used artifacts until `need` bytes are freed; returns false if nothing could be
    /// evicted.
    pub(super) fn make_room(&self, need: u64) -> Result<bool, StoreError> {
        self.evict(&mut lock(&self.index), need)
    }

    fn evict(&self, index: &mut StoreIndex, need: u64) -> Result<bool, StoreError> {
        let mut freed = 0;
        while freed < need {
            let Some((key, cost, _)) = ({ lock(&self.shelf).evict_oldest() }) else { break };
            index.note_removed(key);
            self.folder.remove(&key)?;
            freed += cost;
        }
        tracing::warn!(need, freed, "the disk is full; the least recently used artifacts leave");
        Ok(freed > 0)
    }

    /// Removes an artifact; returns whether it was stored.
    fn discard(&self, index: &mut StoreIndex, key: &Key) -> Result<bool, StoreError> {
        let was_here = { lock(&self.shelf).remove(key) }.is_some();
        if was_here {
            index.note_removed(*key);
            self.folder.remove(key)?;
            self.folder.sync(key)?;
        }
        Ok(was_here)
    }

    /// Decides about a part that failed verification, while the lock of the index keeps all files unchanged: returns
    /// the part if it can be read after all, `None` if the artifact was evicted or replaced in the meantime; otherwise
    /// the artifact is damaged and is removed.
    fn part_again(&self, manifest: &Manifest, number: usize) -> Result<Option<Bytes>, StoreError> {
        let mut index = lock(&self.index);
        if lock(&self.shelf).peek(&manifest.key).is_none_or(|held| *held.parts != *manifest.parts) {
            return Ok(None);
        }
        if let Some(bytes) = self.folder.read_part(manifest, number)? {
            return Ok(Some(bytes));
        }
        tracing::warn!(key = %manifest.key, part = number, "an artifact is damaged; it is dropped");
        lock(&self.shelf).count_damaged(1);
        self.discard(&mut index, &manifest.key)?;
        Ok(None)
    }

    fn write_index(&self, index: &mut StoreIndex) {
        let pending = index.pending(&lock(&self.shelf));
        index.write(&pending);
    }

    /// Writes the order of use and releases the folder; nothing is written afterwards. Blocks.
    pub(super) fn close(&self) {
        let mut index = lock(&self.index);
        if !index.is_closed() {
            self.write_index(&mut index);
            index.shut();
            self.folder.release();
        }
    }
}

impl Drop for DiskState {
    fn drop(&mut self) {
        self.close();
    }
}
