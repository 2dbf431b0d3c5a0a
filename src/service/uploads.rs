//! Uploads: files that clients send once and then name by the hash of their content. They have a store of their own, so
//! that results do not evict them.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bytes::Bytes;

use super::disk_counts::DiskCounts;
use super::job_key::Tenant;
use super::reads::{PART_PATIENCE, Reads};
use super::store::{ArtifactDescription, Manifest, Owners, Pin, Spool, Store, StoreError, Usage};
use crate::job::key::{Key, content};

/// The files that clients sent.
#[derive(Debug)]
pub struct Uploads {
    store: Arc<dyn Store>,
    reads: Reads,
    begun: AtomicU64,
}

/// The shared store did not answer whether it has an upload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unknown;

/// A file being received.
#[derive(Debug)]
pub struct Upload(Box<dyn Spool>);

impl Upload {
    /// Appends bytes. Blocks.
    ///
    /// # Errors
    /// When the store does not take the bytes; then it takes nothing more.
    pub fn take(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }

    /// Stores the file durably under the hash of its bytes, for a tenant, in addition to other tenants that have sent
    /// the same bytes. Blocks.
    ///
    /// # Errors
    /// When the store does not take it.
    pub fn finish(self, media_type: &str, tenant: Tenant) -> Result<Arc<Manifest>, StoreError> {
        let owners = Owners::from_iter([tenant]);
        self.0.commit_by_content(ArtifactDescription {
            media_type: media_type.to_owned(),
            warnings: Vec::new(),
            owners,
        })
    }
}

impl Uploads {
    /// Creates the uploads of a service, in a store of their own.
    pub fn new(store: Arc<dyn Store>) -> Self {
        Self { store, reads: Reads::new(Arc::<DiskCounts>::default()), begun: AtomicU64::new(0) }
    }

    /// Begins an upload.
    ///
    /// # Errors
    /// When the store fails.
    pub fn begin(&self) -> Result<Upload, StoreError> {
        // a temporary key until the content is known
        let number = self.begun.fetch_add(1, Ordering::Relaxed);
        self.store.spool(content(&number.to_le_bytes())).map(Upload)
    }

    /// Returns the manifest of an upload, if it is here and this tenant has sent it; counts as a use. Waits only if a
    /// store that servers share has to be queried.
    ///
    /// # Errors
    /// [`Unknown`] when the shared store does not answer.
    pub async fn find(&self, id: &Key, tenant: Tenant) -> Result<Option<Arc<Manifest>>, Unknown> {
        let is_his = |manifest: &Arc<Manifest>| manifest.content == *id && manifest.owners.contain(tenant);
        let here = self.store.manifest(id).ok().flatten().filter(is_his);
        if here.is_some() || !self.store.is_shared() {
            return Ok(here);
        }
        let (store, id) = (self.store.clone(), *id);
        let found = self.reads.read(PART_PATIENCE, move || store.look_up(&id)).await.ok_or(Unknown)?;
        Ok(found.filter(is_his))
    }

    /// Keeps an upload here until the pin is dropped.
    pub fn pin(&self, id: &Key) -> Option<Pin> {
        Pin::new(&self.store, *id)
    }

    /// Returns a verified part of an upload; `None` if it is gone or damaged, or if the disk does not answer in time.
    pub async fn part(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        let (store, of) = (self.store.clone(), manifest.clone());
        self.reads.read(PART_PATIENCE, move || store.part(&of, index)).await.flatten()
    }

    /// Returns all bytes of an upload; the caller has taken the memory for them.
    pub async fn whole(&self, manifest: &Arc<Manifest>) -> Option<Vec<u8>> {
        let mut bytes = Vec::with_capacity(usize::try_from(manifest.length).ok()?);
        for index in 0..manifest.parts.len() {
            bytes.extend_from_slice(&self.part(manifest, index).await?);
        }
        Some(bytes)
    }

    /// Returns the usage of the store.
    pub fn usage(&self) -> Usage {
        self.store.usage()
    }

    /// Writes what has to outlast the process, and closes the store. Blocks.
    pub fn close(&self) {
        self.store.close();
    }
}
