//! A store in a folder of the local disk, for one process; what was committed survives it.
//!
//! An artifact exists if and only if its manifest does: bytes and manifest are written aside, synced, then renamed into
//! place, bytes first. All else can be rebuilt from the manifests.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::disk_spool::{self, DiskSpool};
use super::files::{Folder, Tmp};
use super::index::Index;
use super::shelf::{self, Shelf};
use super::sweep::{self, Swept};
use super::{Manifest, Spool, Store, StoreError, Usage, lock};
use crate::job::key::Key;

/// Artifacts in a folder; every byte served was verified on the way.
#[derive(Debug)]
pub struct Embedded {
    inner: Arc<Inner>,
}

/// Shared with the open spools.
#[derive(Debug)]
pub(super) struct Inner {
    pub(super) folder: Folder,
    pub(super) capacity: u64,
    /// What is there, with its records. Held for moments only, never while the disk works.
    shelf: Mutex<Shelf<Arc<Manifest>>>,
    /// Held by whoever changes the files of artifacts; taken before the shelf.
    index: Mutex<Index>,
}

impl Embedded {
    /// Opens the store in `dir`, making the folder if need be: sweeps what a crash left, and removes the least recently
    /// used artifacts until the rest fits into `capacity_bytes` (blocks and records included). No artifact may take
    /// more than half of that.
    ///
    /// # Errors
    /// When another process uses the folder, or the disk fails.
    pub fn open(dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        let folder = Folder::open(dir)?;
        let swept = sweep::sweep(&folder)?;
        if swept.damaged + swept.removed > 0 {
            tracing::warn!(dir = %dir.display(), damaged = swept.damaged, left_over = swept.removed, "swept the store");
        }
        let (index, uses) = Index::open(folder.index());
        let shelf = fill(&folder, swept, &uses, capacity_bytes)?;
        let inner = Inner { folder, capacity: capacity_bytes, shelf: Mutex::new(shelf), index: Mutex::new(index) };
        inner.write_index(&mut lock(&inner.index));
        Ok(Self { inner: Arc::new(inner) })
    }
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
        let cost = disk_spool::cost(manifest.length, manifest.encode().len());
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

impl Inner {
    /// The manifest of `key` if it is here with this content; counts as a use.
    pub(super) fn held(&self, key: &Key, content: &Key) -> Option<Arc<Manifest>> {
        lock(&self.shelf).touch(key).filter(|held| held.content == *content).cloned()
    }

    /// Makes two written and synced files an artifact: makes room, then gives them their names.
    pub(super) fn keep(
        &self,
        manifest: Arc<Manifest>,
        cost: u64,
        bytes: &mut Tmp,
        record: &mut Tmp,
    ) -> Result<Arc<Manifest>, StoreError> {
        let key = manifest.key;
        let mut index = lock(&self.index);
        if let Some(present) = self.held(&key, &manifest.content) {
            return Ok(present);
        }
        if self.discard(&mut index, &key)? {
            tracing::warn!(%key, "an artifact was made again with other bytes; the new ones replace the old");
        }
        while let Some((evicted, _)) = { lock(&self.shelf).evict_for(cost) } {
            index.note_removed(evicted);
            self.folder.remove(&evicted)?;
        }
        self.folder.place(&key, bytes, record)?;
        lock(&self.shelf).insert(key, cost, Arc::clone(&manifest));
        index.note_added();
        if index.is_due() {
            self.write_index(&mut index);
        }
        Ok(manifest)
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

impl Drop for Inner {
    fn drop(&mut self) {
        self.write_index(&mut lock(&self.index));
    }
}

impl Store for Embedded {
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(lock(&self.inner.shelf).touch(key).cloned())
    }

    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        if index >= manifest.parts.len() {
            return Ok(None);
        }
        match self.inner.folder.read_part(manifest, index)? {
            Some(bytes) => Ok(Some(bytes)),
            None => self.inner.part_again(manifest, index),
        }
    }

    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError> {
        Ok(Box::new(DiskSpool::new(Arc::clone(&self.inner), key)))
    }

    fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.inner.discard(&mut lock(&self.inner.index), key)?;
        Ok(())
    }

    fn usage(&self) -> Usage {
        lock(&self.inner.shelf).usage()
    }
}
