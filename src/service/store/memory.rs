//! A store in memory: nothing survives the process, and no call waits for a disk or a network.

use std::io::{self, Write};
use std::mem;
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::error::StoreError;
use super::interface::{Spool, Store, Usage};
use super::manifest::{ArtifactDescription, Manifest};
use super::parts::{self, PartHashes};
use super::shelf::{self, Shelf};
use crate::job::key::{Key, content};
use crate::service::lock::lock;

/// Estimated bytes of an entry besides its contents and encoded manifest: structures, strings, map entries. Half of it
/// would let many tiny artifacts take more memory than the cache may; twice of it would hold fewer of them.
const STORED_ENTRY_BYTES: u64 = 512;

/// Artifacts in memory, each one contiguous slice of bytes; reads share the slice without copying. Clones share the
/// store.
#[derive(Debug, Clone)]
pub struct MemoryStore {
    shelf: Arc<Mutex<Shelf<StoredArtifact>>>,
    capacity: u64,
}

/// A stored artifact. Its bytes were hashed before it was stored and are not verified again.
#[derive(Debug)]
struct StoredArtifact {
    manifest: Arc<Manifest>,
    bytes: Bytes,
}

impl MemoryStore {
    /// Creates an empty store for `capacity_bytes`, including manifests; no artifact may take more than half of it.
    pub fn new(capacity_bytes: u64) -> Self {
        Self { shelf: Arc::new(Mutex::new(Shelf::new(capacity_bytes))), capacity: capacity_bytes }
    }

    /// Returns all bytes of an artifact, if it is stored with the same content; does not count as a use.
    pub(in crate::service) fn whole(&self, manifest: &Manifest) -> Option<Bytes> {
        let shelf = lock(&self.shelf);
        let held = shelf.peek(&manifest.key).filter(|held| held.manifest.content == manifest.content);
        held.map(|held| held.bytes.clone())
    }

    /// Returns all bytes of an artifact, if it is stored with this same manifest object; counts as a use.
    pub(in crate::service) fn take(&self, manifest: &Arc<Manifest>) -> Option<Bytes> {
        let mut shelf = lock(&self.shelf);
        let held = shelf.touch(&manifest.key).filter(|held| Arc::ptr_eq(&held.manifest, manifest));
        held.map(|held| held.bytes.clone())
    }

    /// Stores an artifact whose bytes are complete. If the same bytes are stored under the key already, they are kept
    /// and the new owners are added.
    ///
    /// # Errors
    /// [`StoreError::TooLarge`], [`StoreError::InUse`].
    pub(in crate::service) fn keep(&self, manifest: Arc<Manifest>, bytes: Bytes) -> Result<Arc<Manifest>, StoreError> {
        let key = manifest.key;
        let cost = cost(&manifest);
        shelf::admit(cost, self.capacity)?;
        let held = StoredArtifact { manifest: Arc::clone(&manifest), bytes };

        let mut left = Vec::new(); // freed after the lock is released
        let mut shelf = lock(&self.shelf);
        if let Some(present) = shelf.touch_mut(&key).filter(|present| present.manifest.content == manifest.content) {
            if let Some(owners) = present.manifest.owners.with(&manifest.owners) {
                present.manifest = Arc::new(Manifest { owners, ..(*present.manifest).clone() });
            }
            let manifest = Arc::clone(&present.manifest);
            shelf.set_cost(&key, self::cost(&manifest));
            return Ok(manifest);
        }
        let replaced = shelf.remove(&key);
        while let Some((_, evicted)) = shelf.evict_for(cost) {
            left.push(evicted);
        }
        if !shelf.has_room(cost) {
            return Err(StoreError::InUse);
        }
        shelf.insert(key, cost, held);
        drop(shelf);
        if replaced.is_some() {
            tracing::warn!(%key, "an artifact was made again with other bytes; the new ones replace the old");
        }
        Ok(manifest)
    }
}

/// Returns the number of bytes of an artifact in memory, with its manifest and its entry.
fn cost(manifest: &Manifest) -> u64 {
    manifest.length + manifest.encode().len() as u64 + STORED_ENTRY_BYTES
}

impl Store for MemoryStore {
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(lock(&self.shelf).touch(key).map(|held| Arc::clone(&held.manifest)))
    }

    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        Ok(self.whole(manifest).and_then(|bytes| parts::part_of(manifest, &bytes, index)))
    }

    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError> {
        Ok(Box::new(MemorySpool { store: self.clone(), key, bytes: Vec::new(), refused: false }))
    }

    fn remove(&self, key: &Key) -> Result<(), StoreError> {
        let removed = lock(&self.shelf).remove(key);
        drop(removed); // The bytes are freed after the lock is released.
        Ok(())
    }

    fn pin(&self, key: &Key) -> bool {
        lock(&self.shelf).pin(key)
    }

    fn unpin(&self, key: &Key) {
        lock(&self.shelf).unpin(key);
    }

    fn usage(&self) -> Usage {
        lock(&self.shelf).usage()
    }
}

#[derive(Debug)]
struct MemorySpool {
    store: MemoryStore,
    key: Key,
    bytes: Vec<u8>,
    /// Whether a write was refused, so that the bytes have a gap.
    refused: bool,
}

impl Write for MemorySpool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let length = if self.refused { u64::MAX } else { (self.bytes.len() + bytes.len()) as u64 };
        if let Err(error) = shelf::admit(length, self.store.capacity) {
            self.refused = true;
            self.bytes = Vec::new();
            return Err(error.into());
        }
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Spool for MemorySpool {
    fn commit(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        if self.refused {
            shelf::admit(u64::MAX, self.store.capacity)?;
        }
        let bytes = mem::take(&mut self.bytes);
        let manifest = Arc::new(PartHashes::of(&bytes).manifest(self.key, description));
        self.store.keep(manifest, Bytes::from(bytes.into_boxed_slice()))
    }

    fn commit_by_content(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        self.key = content(&self.bytes);
        self.commit(description)
    }
}
