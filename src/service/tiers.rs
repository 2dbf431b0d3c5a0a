//! The stores in use: a quick one in memory, and behind it, where there is one, a large one on disk.

use std::sync::Arc;

use bytes::Bytes;

use super::store::{Description, Embedded, Manifest, Memory, Spool, Store, StoreError, Usage};
use crate::job::key::Key;

/// Artifacts up to this size are brought from disk into memory when they are asked for.
const PROMOTED_BYTES: u64 = 4 << 20;

/// Memory before disk.
#[derive(Debug)]
pub struct Tiers {
    memory: Memory,
    memory_bytes: u64,
    disk: Option<Embedded>,
}

impl Tiers {
    /// The stores of a service.
    pub fn new(memory_bytes: u64, disk: Option<Embedded>) -> Self {
        Self { memory: Memory::new(memory_bytes), memory_bytes, disk }
    }

    /// The manifest of an artifact that is in memory: never blocks.
    pub fn at_hand(&self, key: &Key) -> Option<Arc<Manifest>> {
        self.memory.manifest(key).ok().flatten()
    }

    /// The manifest of an artifact wherever it is; small ones are brought into memory. Blocks.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn find(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        if let Some(manifest) = self.at_hand(key) {
            return Ok(Some(manifest));
        }
        let Some(disk) = &self.disk else { return Ok(None) };
        let Some(manifest) = disk.manifest(key)? else { return Ok(None) };
        if manifest.length <= PROMOTED_BYTES.min(self.memory_bytes / 8) {
            return Ok(self.promote(disk, &manifest)?.then_some(manifest));
        }
        Ok(Some(manifest))
    }

    /// Copies an artifact into memory; false when its bytes turned out to be damaged.
    fn promote(&self, disk: &Embedded, manifest: &Manifest) -> Result<bool, StoreError> {
        let mut spool = self.memory.spool(manifest.key)?;
        for index in 0..manifest.parts.len() {
            let Some(part) = disk.part(manifest, index)? else { return Ok(false) };
            spool.write_all(&part)?;
        }
        spool.commit(description(manifest))?;
        Ok(true)
    }

    /// A verified part of an artifact that is in memory: never blocks.
    pub fn part_at_hand(&self, manifest: &Manifest, index: usize) -> Option<Bytes> {
        self.memory.part(manifest, index).ok().flatten()
    }

    /// A verified part of an artifact; `None` when it is gone or was damaged. Blocks.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        match (self.part_at_hand(manifest, index), &self.disk) {
            (Some(part), _) => Ok(Some(part)),
            (None, Some(disk)) => disk.part(manifest, index),
            (None, None) => Ok(None),
        }
    }

    /// A place for a new artifact of about this size: memory when it fits there well, else the disk.
    ///
    /// # Errors
    /// When there is no room or the disk fails.
    pub fn spool(&self, key: Key, about_bytes: u128) -> Result<Box<dyn Spool>, StoreError> {
        match &self.disk {
            Some(disk) if about_bytes > u128::from(self.memory_bytes / 8) => disk.spool(key),
            _ => self.memory.spool(key),
        }
    }

    /// Copies an artifact from memory to disk, where there is one, so that it outlasts the process. Blocks.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn persist(&self, manifest: &Manifest) -> Result<(), StoreError> {
        let Some(disk) = &self.disk else { return Ok(()) };
        if self.at_hand(&manifest.key).is_none() {
            return Ok(());
        }
        let mut spool = disk.spool(manifest.key)?;
        for index in 0..manifest.parts.len() {
            let Some(part) = self.part_at_hand(manifest, index) else { return Ok(()) };
            spool.write_all(&part)?;
        }
        spool.commit(description(manifest)).map(drop)
    }

    /// Removes an artifact everywhere.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.memory.remove(key)?;
        self.disk.as_ref().map_or(Ok(()), |disk| disk.remove(key))
    }

    /// What each store holds: its name and usage.
    pub fn usage(&self) -> Vec<(&'static str, Usage)> {
        let disk = self.disk.as_ref().map(|disk| ("disk", disk.usage()));
        [Some(("memory", self.memory.usage())), disk].into_iter().flatten().collect()
    }
}

fn description(manifest: &Manifest) -> Description {
    Description { media_type: manifest.media_type.clone(), warnings: manifest.warnings.clone() }
}
