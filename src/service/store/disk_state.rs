//! What the embedded store has in its folder, and who may change it.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;
use std::{io, thread};

use bytes::Bytes;

use super::disk::Disk;
use super::error::StoreError;
use super::files::{Folder, Tmp, cost};
use super::index::Index;
use super::interface::Usage;
use super::lock::lock;
use super::manifest::Manifest;
use super::shelf::{self, Shelf};
use super::sweep::{self, Swept};
use crate::job::key::Key;

/// How often a computation asks whether it may evict for its bytes, and the pause between: a second at most, about as
/// long as a disk takes for one durable write under load. After it the bytes stay in memory, and no turn is held up.
/// Half of the time leaves more bytes in memory while evictions are written; twice of it holds turns for longer.
const TRIES: u32 = 100;
const PAUSE: Duration = Duration::from_millis(10);

/// Shared with the open spools.
#[derive(Debug)]
pub(super) struct DiskState {
    pub(super) folder: Folder,
    pub(super) capacity: u64,
    /// What is there, with its records. Held for moments only, never while the disk works.
    shelf: Mutex<Shelf<Arc<Manifest>>>,
    /// Held by whoever changes the files of artifacts; taken before the shelf.
    index: Mutex<Index>,
    /// Keys that cannot be written, as a folder has the name of their artifact.
    occupied: Mutex<HashSet<Key>>,
}

/// Puts what was found on a shelf, in order of use; artifacts that the index does not know are the newest.
fn fill(
    folder: &Folder,
    swept: Swept,
    uses: &HashMap<Key, u64>,
    capacity: u64,
) -> Result<Shelf<Arc<Manifest>>, StoreError> {
    let mut shelf = Shelf::new(capacity);
    shelf.count_damaged(swept.damaged);
    let mut found = swept.found;
    found.sort_by_cached_key(|found| {
        let key = found.manifest.key;
        (uses.get(&key).copied().unwrap_or(u64::MAX), found.written, key)
    });
    for manifest in found.into_iter().map(|found| found.manifest) {
        let cost = cost(manifest.length, manifest.encode().len());
        if shelf::admit(cost, capacity).is_err() {
            folder.remove(&manifest.key)?; // the capacity was larger when it was committed
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
    /// Opens the folder, sweeps what a crash left and evicts what is beyond the capacity.
    pub(super) fn open(disk: Arc<dyn Disk>, dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        let folder = Folder::open(dir, disk)?;
        let mut swept = sweep::sweep(&folder)?;
        if swept.damaged + swept.removed > 0 {
            tracing::warn!(dir = %dir.display(), damaged = swept.damaged, left_over = swept.removed, "swept the store");
        }
        let (index, uses) = Index::open(folder.index());
        let occupied = Mutex::new(std::mem::take(&mut swept.occupied));
        let shelf = Mutex::new(fill(&folder, swept, &uses, capacity_bytes)?);
        let state = Self { folder, capacity: capacity_bytes, shelf, index: Mutex::new(index), occupied };
        state.write_index(&mut lock(&state.index));
        Ok(state)
    }

    /// The manifest of `key` if it is here; counts as a use.
    pub(super) fn touch(&self, key: &Key) -> Option<Arc<Manifest>> {
        lock(&self.shelf).touch(key).cloned()
    }

    /// Refuses what cannot be kept, before anything is written.
    pub(super) fn admit(&self, key: &Key, length: u64) -> Result<(), StoreError> {
        shelf::admit(length, self.capacity)?;
        if lock(&self.occupied).contains(key) { Err(self.occupied(key)) } else { Ok(()) }
    }

    /// A part, verified; `None` when the artifact has no such part, is gone, or was found damaged.
    pub(super) fn part(&self, manifest: &Manifest, number: usize) -> Result<Option<Bytes>, StoreError> {
        if number >= manifest.parts.len() {
            return Ok(None);
        }
        match self.folder.read_part(manifest, number)? {
            Some(bytes) => Ok(Some(bytes)),
            None => self.part_again(manifest, number),
        }
    }

    /// Removes an artifact, if it is here.
    pub(super) fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.discard(&mut lock(&self.index), key)?;
        Ok(())
    }

    /// Keeps an artifact from leaving, if it is here.
    pub(super) fn pin(&self, key: &Key) -> bool {
        lock(&self.shelf).pin(key)
    }

    /// Takes one pin back.
    pub(super) fn unpin(&self, key: &Key) {
        lock(&self.shelf).unpin(key);
    }

    /// What is held and was seen.
    pub(super) fn usage(&self) -> Usage {
        lock(&self.shelf).usage()
    }

    /// The manifest of `key` if it is here with this content; counts as a use.
    pub(super) fn held(&self, key: &Key, content: &Key) -> Option<Arc<Manifest>> {
        lock(&self.shelf).touch(key).filter(|held| held.content == *content).cloned()
    }

    /// Makes two written and synced files an artifact: makes room, then gives them their names.
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
            // the same bytes for further tenants: only what is known of them changes
            self.folder.describe(&key, record)?;
            if let Some(held) = lock(&self.shelf).touch_mut(&key) {
                *held = Arc::clone(&manifest);
            }
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

    /// Writes something; where the disk is full, evicts the least recently used artifacts until it fits. Gives up when
    /// none is left, or when others change files for longer than a computation should wait.
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

    /// The right to change files, if it can be had soon.
    fn index_soon(&self) -> Option<MutexGuard<'_, Index>> {
        for _ in 0..TRIES {
            match self.index.try_lock() {
                Ok(index) => return Some(index),
                Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => thread::sleep(PAUSE),
            }
        }
        None
    }

    /// Evicts the least recently used artifacts, as the disk has no room for `need` bytes; false when none is left.
    pub(super) fn make_room(&self, need: u64) -> Result<bool, StoreError> {
        self.evict(&mut lock(&self.index), need)
    }

    fn evict(&self, index: &mut Index, need: u64) -> Result<bool, StoreError> {
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

    /// Removes an artifact; says whether it was here.
    fn discard(&self, index: &mut Index, key: &Key) -> Result<bool, StoreError> {
        let was_here = { lock(&self.shelf).remove(key) }.is_some();
        if was_here {
            index.note_removed(*key);
            self.folder.remove(key)?;
            self.folder.sync(key)?;
        }
        Ok(was_here)
    }

    /// Judges a part that could not be read, while no file changes: either it can be read after all, or the artifact
    /// was evicted or replaced meanwhile, or it is damaged and goes.
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

    fn write_index(&self, index: &mut Index) {
        let pending = index.pending(&lock(&self.shelf));
        index.write(&pending);
    }
}

impl DiskState {
    /// Writes the order of use and lets go of the folder; nothing is written afterwards. Blocks.
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
