//! A store in a bucket that several servers share.
//!
//! ```text
//! PREFIX/results/manifests/ab/<64 hex>   the manifest of the artifact of this key
//! PREFIX/results/parts/ab/<64 hex>       a part of 1 MiB at most, named by the hash of its bytes
//! PREFIX/uploads/...                     the same for files that clients sent
//! ```
//!
//! An artifact exists if and only if its manifest does, which is written last. Parts are named by the hashes of their
//! bytes, so two servers cannot write different bytes under one name, and a part is verified against its name when it
//! is read. Objects are removed by the lifecycle rules of the bucket: an artifact that has lost a part counts as
//! missing.

use std::sync::Arc;

use bytes::Bytes;
use object_store::ObjectStore;

use super::error::StoreError;
use super::interface::{Spool, Store, StoreLocation, Usage};
use super::manifest::Manifest;
use super::shared_spool::SharedSpool;
use super::shared_state::SharedState;
use crate::job::key::Key;
use crate::service::lock::lock;

/// Artifacts in a bucket. Clones share the store.
#[derive(Debug, Clone)]
pub struct BucketStore {
    state: Arc<SharedState>,
}

impl BucketStore {
    /// Opens the store in a bucket. If the object store does not answer, this succeeds, and later calls try again.
    ///
    /// # Errors
    /// When the bucket does not exist, access is refused, or the object store ignores conditional writes.
    pub fn open(objects: Arc<dyn ObjectStore>, place: &StoreLocation) -> Result<Self, StoreError> {
        Ok(Self { state: Arc::new(SharedState::open(objects, place)?) })
    }
}

impl Store for BucketStore {
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(lock(&self.state.shelf).touch(key).cloned())
    }

    fn is_shared(&self) -> bool {
        true
    }

    fn look_up(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        self.state.look_up(key)
    }

    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        self.state.part(manifest, index)
    }

    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError> {
        Ok(Box::new(SharedSpool::new(Arc::clone(&self.state), key)))
    }

    fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.state.forget(key);
        Ok(())
    }

    fn usage(&self) -> Usage {
        self.state.usage()
    }

    /// Keeps the manifest in the memory of this server. Objects in the bucket are never evicted, so they need no
    /// protection.
    fn pin(&self, key: &Key) -> bool {
        lock(&self.state.shelf).pin(key)
    }

    fn unpin(&self, key: &Key) {
        lock(&self.state.shelf).unpin(key);
    }

    fn admit(&self, _key: &Key, length: u64) -> Result<(), StoreError> {
        self.state.admit(length)
    }
}
