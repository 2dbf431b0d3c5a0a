//! A store in a folder of the local disk, for one process; what was committed survives it.
//!
//! An artifact exists if and only if its manifest does: bytes and manifest are written aside, synced, then renamed into
//! place, bytes first. All else can be rebuilt from the manifests.

use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;

use super::disk::{Disk, Local};
use super::disk_spool::DiskSpool;
use super::disk_state::DiskState;
use super::error::StoreError;
use super::interface::{LargeSpool, Room, Spool, Store, StoreKind, Usage};
use super::manifest::Manifest;
use super::records::{RECORDS_FILE, RecordFile};
use crate::job::key::Key;

/// The store as the settings name it.
pub(super) const KIND: StoreKind = StoreKind {
    name: "folder",
    in_folder: true,
    open: |place| {
        let dir = match place.room {
            Room::Results => place.dir.clone(),
            Room::Uploads => place.dir.join("uploads"),
        };
        Ok(Arc::new(Embedded::open(&dir, place.capacity_bytes)?))
    },
    records: |dir| Ok(Arc::new(RecordFile::open(&dir.join(RECORDS_FILE))?)),
};

/// Artifacts in a folder; every byte served was verified on the way. Clones share it.
#[derive(Debug, Clone)]
pub struct Embedded {
    state: Arc<DiskState>,
}

impl Embedded {
    /// Opens the store in `dir`, making the folder if need be: sweeps what a crash left, and removes the least recently
    /// used artifacts until the rest fits into `capacity_bytes` (blocks and records included). No artifact may take
    /// more than half of that.
    ///
    /// # Errors
    /// When another process uses the folder, or the disk fails.
    pub fn open(dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        Self::open_on(Arc::new(Local), dir, capacity_bytes)
    }

    /// Opens the store on a disk of its own kind.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_on(disk: Arc<dyn Disk>, dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        Ok(Self { state: Arc::new(DiskState::open(disk, dir, capacity_bytes)?) })
    }
}

impl Store for Embedded {
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(self.state.touch(key))
    }

    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        self.state.part(manifest, index)
    }

    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError> {
        self.admit(&key, 0)?;
        Ok(Box::new(DiskSpool::new(Arc::clone(&self.state), key)))
    }

    fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.state.remove(key)
    }

    fn pin(&self, key: &Key) -> bool {
        self.state.pin(key)
    }

    fn unpin(&self, key: &Key) {
        self.state.unpin(key);
    }

    fn usage(&self) -> Usage {
        self.state.usage()
    }

    fn admit(&self, key: &Key, length: u64) -> Result<(), StoreError> {
        self.state.admit(key, length)
    }

    fn large_spool(&self, key: Key) -> Option<Box<dyn LargeSpool>> {
        Some(Box::new(DiskSpool::new(Arc::clone(&self.state), key)))
    }

    /// Writes the order of use and lets go of the folder.
    fn close(&self) {
        self.state.close();
    }
}
