//! The state of the shared store in one server: remembered manifests, and reading and writing in the bucket.

use std::io;
use std::sync::{Arc, Mutex};

use bytes::Bytes;
use object_store::ObjectStore;
use object_store::path::Path;

use super::calls::{CALL_TIMEOUT, Calls, Fetched, MANIFEST_TIMEOUT};
use super::error::StoreError;
use super::interface::{StoreLocation, StorePurpose, Usage};
use super::manifest::{Manifest, PART_BYTES};
use super::parts;
use super::shelf::{self, Shelf};
use crate::job::key::{Key, RESULTS_VERSION, content};
use crate::service::lock::lock;

/// Maximum size of a manifest in bytes: with 32 bytes for each part of a mebibyte, enough for artifacts of nearly
/// 32 GiB. A longer object was not written by this service. Half of it would limit artifacts to 16 GiB; twice of it
/// would let a foreign object take 2 MiB of memory.
const MAX_SHARED_MANIFEST_BYTES: u64 = 1 << 20;
/// Memory for remembered manifests in bytes, some ten thousand of them. With half of it twice as many lookups go to the
/// object store; twice of it would take 16 MiB more beside the memory account.
const REMEMBERED_BYTES: u64 = 16 << 20;
/// Estimated bytes of a remembered manifest besides its encoded form: map entries. Half or twice of it would let twice
/// or half as many small ones be remembered.
const MANIFEST_ENTRY_BYTES: u64 = 512;

/// The state of a store, shared with its open spools.
#[derive(Debug)]
pub(super) struct SharedState {
    calls: Calls,
    /// Prefix of the names of all objects.
    root: String,
    capacity: u64,
    /// Manifests that were read or written; the bucket may have others, and may have lost some of these.
    pub(super) shelf: Mutex<Shelf<Arc<Manifest>>>,
    checked: Mutex<ConditionalWrites>,
}

/// Whether the object store supports conditional writes.
#[derive(Debug, Clone)]
enum ConditionalWrites {
    /// Whether conditional writes are supported is unknown: the object store has not answered yet.
    NotYet,
    /// Conditional writes are supported: a write that must not replace an object is refused if one exists.
    Sound,
    /// Conditional writes are not supported, or the object store is unusable for the given reason.
    Unfit(String),
}

impl SharedState {
    /// Opens the store in a bucket. If the object store does not answer, this succeeds, and later calls try again.
    pub(super) fn open(objects: Arc<dyn ObjectStore>, place: &StoreLocation) -> Result<Self, StoreError> {
        let room = match place.room {
            StorePurpose::Results => "results",
            StorePurpose::Uploads => "uploads",
        };
        let prefix = place.bucket.prefix.trim_matches('/');
        let root = if prefix.is_empty() { room.to_owned() } else { format!("{prefix}/{room}") };
        let calls = Calls::new(objects, Arc::clone(&place.clock))?;
        let (shelf, checked) = (Mutex::new(Shelf::new(REMEMBERED_BYTES)), Mutex::new(ConditionalWrites::NotYet));
        let state = SharedState { calls, root, capacity: place.capacity_bytes, shelf, checked };
        match state.check() {
            Err(StoreError::Away { reason, refuses: true }) => {
                let needs = "it has to allow GetObject, PutObject, DeleteObject and ListBucket to these credentials";
                Err(io::Error::new(io::ErrorKind::PermissionDenied, format!("{reason}; {needs}")).into())
            }
            Err(StoreError::Away { .. }) | Ok(()) => Ok(state),
            Err(unfit) => Err(unfit),
        }
    }

    /// Reads the manifest of an artifact from the bucket and remembers it.
    pub(super) fn look_up(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        Ok(self.fetch(key)?.map(|manifest| self.remember(manifest)))
    }

    /// Returns the counts of the remembered manifests, the capacity, and whether the object store is in an outage.
    pub(super) fn usage(&self) -> Usage {
        let usage = lock(&self.shelf).usage();
        Usage { capacity: self.capacity, away: self.calls.is_away(&self.manifest_path(&content(b"probe"))), ..usage }
    }

    fn path(&self, kind: &str, key: &Key) -> Path {
        Path::from(format!("{}/{kind}/{:02x}/{key}", self.root, key.as_bytes()[0]))
    }

    fn manifest_path(&self, key: &Key) -> Path {
        self.path("manifests", key)
    }

    fn part_path(&self, hash: &Key) -> Path {
        self.path("parts", hash)
    }

    /// Refuses an artifact of `length` bytes if it is too large.
    pub(super) fn admit(&self, length: u64) -> Result<(), StoreError> {
        shelf::admit(length, self.capacity)
    }

    /// Checks once whether the object store supports conditional writes; nothing is written before it has passed.
    pub(super) fn check(&self) -> Result<(), StoreError> {
        let checked = lock(&self.checked).clone();
        let checked = match checked {
            ConditionalWrites::NotYet => {
                let found = self.probed()?;
                *lock(&self.checked) = found.clone();
                found
            }
            known => known,
        };
        match checked {
            ConditionalWrites::Unfit(why) => Err(io::Error::other(why).into()),
            ConditionalWrites::Sound | ConditionalWrites::NotYet => Ok(()),
        }
    }

    /// Creates the same object twice and expects a refusal the second time. The first read, of an object that cannot
    /// exist yet, shows whether the object store distinguishes a missing object from a forbidden one.
    fn probed(&self) -> Result<ConditionalWrites, StoreError> {
        let mut name = [0; 16];
        getrandom::fill(&mut name).map_err(io::Error::from)?;
        let path = Path::from(format!("{}/checks/{}", self.root, hex::encode(name)));
        let bytes = || Bytes::from_static(b"planish");
        self.calls.get(&path, MAX_SHARED_MANIFEST_BYTES, MANIFEST_TIMEOUT)?;
        self.calls.create(&path, bytes())?;
        let again = self.calls.create(&path, bytes())?;
        let back = self.calls.get(&path, MAX_SHARED_MANIFEST_BYTES, MANIFEST_TIMEOUT)?;
        self.calls.delete(&path);
        let unfit = if again {
            "the store replaces objects though it is asked not to (If-None-Match: *); use one with conditional puts"
        } else if !matches!(back, Fetched::Bytes(back) if back == bytes()) {
            "the store does not give back what was just put there"
        } else {
            return Ok(ConditionalWrites::Sound);
        };
        tracing::error!(unfit, "nothing is put into the shared store");
        Ok(ConditionalWrites::Unfit(unfit.to_owned()))
    }

    /// Reads the manifest of an artifact from the bucket. A damaged manifest is deleted and counted; an artifact of
    /// another results version is treated as missing.
    fn fetch(&self, key: &Key) -> Result<Option<Manifest>, StoreError> {
        let bytes = match self.calls.get(&self.manifest_path(key), MAX_SHARED_MANIFEST_BYTES, MANIFEST_TIMEOUT)? {
            Fetched::Missing => return Ok(None),
            Fetched::TooLong => None,
            Fetched::Bytes(bytes) => Some(bytes),
        };
        let manifest = bytes.and_then(|bytes| Manifest::decode(&bytes)).filter(|manifest| manifest.key == *key);
        let Some(manifest) = manifest else {
            self.drop_damaged(key, "its manifest is damaged");
            return Ok(None);
        };
        // An artifact whose key is the hash of its bytes is the same in every results version.
        Ok(Some(manifest).filter(|found| found.results_version == RESULTS_VERSION || found.content == *key))
    }

    /// Remembers a manifest that is in the bucket.
    fn remember(&self, manifest: Manifest) -> Arc<Manifest> {
        let (key, cost) = (manifest.key, manifest.encode().len() as u64 + MANIFEST_ENTRY_BYTES);
        let manifest = Arc::new(manifest);
        let mut shelf = lock(&self.shelf);
        while shelf.evict_for(cost).is_some() {}
        if shelf.has_room(cost) {
            shelf.insert(key, cost, Arc::clone(&manifest));
        }
        manifest
    }

    /// Reads a part and verifies its hash; deletes the manifest if the part is missing or damaged.
    pub(super) fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError> {
        let (Some((_, length)), Some(hash)) = (parts::span(manifest, index), manifest.parts.get(index)) else {
            return Ok(None);
        };
        match self.calls.get(&self.part_path(hash), length as u64, CALL_TIMEOUT)? {
            Fetched::Bytes(bytes) if content(&bytes) == *hash => return Ok(Some(bytes)),
            Fetched::Missing => {
                tracing::debug!(key = %manifest.key, part = index, "a part has left the shared store");
                self.forget(&manifest.key);
            }
            Fetched::Bytes(_) | Fetched::TooLong => {
                self.calls.delete(&self.part_path(hash));
                self.drop_damaged(&manifest.key, "one of its parts is damaged");
            }
        }
        Ok(None)
    }

    fn drop_damaged(&self, key: &Key, why: &str) {
        tracing::warn!(%key, why, "an artifact of the shared store is damaged; it is dropped");
        lock(&self.shelf).count_damaged(1);
        self.forget(key);
    }

    /// Removes an artifact by deleting its manifest. The parts stay, because other artifacts may share them.
    pub(super) fn forget(&self, key: &Key) {
        lock(&self.shelf).remove(key);
        self.calls.delete(&self.manifest_path(key));
    }

    /// Writes a part. An existing object has the same bytes or is damaged; writing it again also restarts its age for
    /// the lifecycle rules of the bucket.
    pub(super) fn put_part(&self, hash: &Key, bytes: Bytes) -> Result<(), StoreError> {
        self.calls.replace(&self.part_path(hash), bytes)
    }

    /// Writes the manifest of an artifact whose parts are all written. If another server has written the same artifact
    /// first, its manifest is kept with the owners of both; if two servers add owners at once, one addition may be
    /// lost, and the artifact is made again for that tenant.
    pub(super) fn enter(&self, manifest: Manifest) -> Result<Arc<Manifest>, StoreError> {
        let path = self.manifest_path(&manifest.key);
        let encoded = manifest.encode();
        if encoded.len() as u64 > MAX_SHARED_MANIFEST_BYTES {
            return Err(StoreError::TooLarge { capacity: MAX_SHARED_MANIFEST_BYTES / 32 * PART_BYTES as u64 });
        }
        if self.calls.create(&path, encoded.into())? {
            return Ok(self.remember(manifest));
        }
        let present = self.fetch(&manifest.key)?;
        if let Some(present) = present.filter(|present| present.content == manifest.content) {
            // The manifest is written even without new owners, so that its age for the lifecycle rules restarts like
            // that of its parts.
            let owners = present.owners.with(&manifest.owners).unwrap_or_else(|| present.owners.clone());
            return self.replace(&path, Manifest { owners, ..present });
        }
        tracing::warn!(key = %manifest.key, "what is in the shared store has other bytes; the new ones replace it");
        self.replace(&path, manifest)
    }

    fn replace(&self, path: &Path, manifest: Manifest) -> Result<Arc<Manifest>, StoreError> {
        self.calls.replace(path, manifest.encode().into())?;
        Ok(self.remember(manifest))
    }
}
