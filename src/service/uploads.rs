//! Files that clients sent once, to be named by their content: kept apart from results, so that these do not push them
//! out.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use bytes::Bytes;

use super::disk_counts::DiskCounts;
use super::job_key::Tenant;
use super::reads::Reads;
use super::store::{Description, Manifest, Owners, Pin, Spool, Store, StoreError, Usage};
use crate::job::key::{Key, content};

/// How long reading a part may wait for the disk: as long as answers wait for theirs.
/// Half of it fails more jobs under load; twice of it is longer than some clients wait.
const PATIENCE: Duration = Duration::from_secs(10);

/// The files that clients sent.
#[derive(Debug)]
pub struct Uploads {
    store: Arc<dyn Store>,
    reads: Reads,
    begun: AtomicU64,
}

/// Nobody can tell at the moment whether an upload is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unknown;

/// A file on its way.
#[derive(Debug)]
pub struct Upload(Box<dyn Spool>);

impl Upload {
    /// Takes the next bytes. Blocks.
    ///
    /// # Errors
    /// When the store does not take them; then it takes nothing more.
    pub fn take(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }

    /// Keeps the file, for good when it returns, under the hash of its bytes, for a tenant; beside others who have sent
    /// the same bytes. Blocks.
    ///
    /// # Errors
    /// When the store does not take it.
    pub fn finish(self, media_type: &str, tenant: Tenant) -> Result<Arc<Manifest>, StoreError> {
        let owners = Owners::from_iter([tenant]);
        self.0.commit_by_content(Description { media_type: media_type.to_owned(), warnings: Vec::new(), owners })
    }
}

impl Uploads {
    /// Uploads in a store of their own.
    pub fn new(store: Arc<dyn Store>) -> Self {
        Self { store, reads: Reads::new(Arc::<DiskCounts>::default()), begun: AtomicU64::new(0) }
    }

    /// Begins an upload.
    ///
    /// # Errors
    /// When the store fails.
    pub fn begin(&self) -> Result<Upload, StoreError> {
        // a name for the time until the content is known
        let number = self.begun.fetch_add(1, Ordering::Relaxed);
        self.store.spool(content(&number.to_le_bytes())).map(Upload)
    }

    /// What is known of an upload, if it is here and this tenant has sent it; counts as a use. Waits only for a store
    /// that servers share, where this one does not know of it.
    ///
    /// # Errors
    /// [`Unknown`]: the shared store does not tell whether it is there.
    pub async fn find(&self, id: &Key, tenant: Tenant) -> Result<Option<Arc<Manifest>>, Unknown> {
        let is_his = |manifest: &Arc<Manifest>| manifest.content == *id && manifest.owners.contain(tenant);
        let here = self.store.manifest(id).ok().flatten().filter(is_his);
        if here.is_some() || !self.store.is_shared() {
            return Ok(here);
        }
        let (store, id) = (self.store.clone(), *id);
        let found = self.reads.read(PATIENCE, move || store.look_up(&id)).await.ok_or(Unknown)?;
        Ok(found.filter(is_his))
    }

    /// Keeps an upload here for as long as somebody needs it.
    pub fn pin(&self, id: &Key) -> Option<Pin> {
        Pin::new(&self.store, *id)
    }

    /// A verified part of an upload; `None` when it is gone or was damaged, or the disk does not answer in time.
    pub async fn part(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        let (store, of) = (self.store.clone(), manifest.clone());
        self.reads.read(PATIENCE, move || store.part(&of, index)).await.flatten()
    }

    /// All bytes of an upload, for which the caller has the memory.
    pub async fn whole(&self, manifest: &Arc<Manifest>) -> Option<Vec<u8>> {
        let mut bytes = Vec::with_capacity(usize::try_from(manifest.length).ok()?);
        for index in 0..manifest.parts.len() {
            bytes.extend_from_slice(&self.part(manifest, index).await?);
        }
        Some(bytes)
    }

    /// What is held.
    pub fn usage(&self) -> Usage {
        self.store.usage()
    }

    /// Writes what has to outlast the process and lets go of the place. Blocks.
    pub fn close(&self) {
        self.store.close();
    }
}
