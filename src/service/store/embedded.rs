//! A store in a folder of the local disk, used by one process; committed artifacts survive the process.
//!
//! An artifact exists if and only if its manifest does: the bytes and the manifest are written to temporary files,
//! synced, then renamed into place, the bytes first. Everything else can be rebuilt from the manifests.

use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;

use super::disk::{Disk, LocalDisk};
use super::disk_spool::DiskSpool;
use super::disk_state::DiskState;
use super::error::StoreError;
use super::interface::{LargeSpool, Spool, Store, StoreKind, StorePurpose, Usage};
use super::manifest::Manifest;
use super::records::{RECORDS_FILE, RecordFile};
use crate::job::key::Key;
use crate::service::lock::lock;

/// The entry of this store in the list of stores.
pub(super) const FOLDER_STORE: StoreKind = StoreKind {
    name: "folder",
    in_folder: true,
    open: |place| {
        let dir = match place.room {
            StorePurpose::Results => place.dir.clone(),
            StorePurpose::Uploads => place.dir.join("uploads"),
        };
        Ok(Arc::new(Embedded::open(&dir, place.capacity_bytes)?))
    },
    records: |dir| Ok(Arc::new(RecordFile::open(&dir.join(RECORDS_FILE))?)),
};

/// Artifacts in a folder. All bytes are verified when they are read. Clones share the store.
#[derive(Debug, Clone)]
pub struct Embedded {
    state: Arc<DiskState>,
}

impl Embedded {
    /// Opens the store in `dir`, creating the folder if necessary: removes what a crash left behind, then evicts the
    /// least recently used artifacts until the rest fits into `capacity_bytes` (whole disk blocks, including
    /// manifests). No artifact may take more than half of the capacity.
    ///
    /// # Errors
    /// When another process uses the folder, or the disk fails.
    pub fn open(dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        Self::open_on(Arc::new(LocalDisk), dir, capacity_bytes)
    }

    /// Opens the store with another implementation of the disk operations.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_on(disk: Arc<dyn Disk>, dir: &Path, capacity_bytes: u64) -> Result<Self, StoreError> {
        Ok(Self { state: Arc::new(DiskState::open(disk, dir, capacity_bytes)?) })
    }
}

impl Store for Embedded {
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(lock(&self.state.shelf).touch(key).cloned())
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
        lock(&self.state.shelf).pin(key)
    }

    fn unpin(&self, key: &Key) {
        lock(&self.state.shelf).unpin(key);
    }

    fn usage(&self) -> Usage {
        lock(&self.state.shelf).usage()
    }

    fn admit(&self, key: &Key, length: u64) -> Result<(), StoreError> {
        self.state.admit(key, length)
    }

    fn large_spool(&self, key: Key) -> Option<Box<dyn LargeSpool>> {
        Some(Box::new(DiskSpool::new(Arc::clone(&self.state), key)))
    }

    /// Writes the order of use and releases the folder.
    fn close(&self) {
        self.state.close();
    }
}
