//! The interface of stores.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytes::Bytes;

use super::error::StoreError;
use super::manifest::{ArtifactDescription, Manifest};
use super::records::Records;
use crate::job::key::Key;
use crate::service::clock::Clock;

/// A bounded store of artifacts: the least recently used ones are evicted when there is no room.
///
/// Calls may block, and the service makes them outside the event loop, except calls that are documented never to block.
pub trait Store: std::fmt::Debug + Send + Sync {
    /// Returns the manifest of an artifact, if the store knows it, and counts this as a use. Never blocks on a disk or
    /// a network: a store keeps its manifests in memory.
    ///
    /// # Errors
    /// When the store itself fails. A damaged manifest is not an error: the artifact is removed and counted. An
    /// artifact of another results version is treated as missing, unless its key is the hash of its bytes.
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError>;

    /// Returns whether other processes write to the store, too, so that [`Store::look_up`] may find more than
    /// [`Store::manifest`].
    fn is_shared(&self) -> bool {
        false
    }

    /// Returns the current manifest of an artifact in the store, whichever process wrote it, and counts this as a use.
    ///
    /// # Errors
    /// When the store itself fails.
    fn look_up(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        self.manifest(key)
    }

    /// Returns part number `index` of an artifact after verifying its hash. Returns `None` if the artifact is gone, was
    /// replaced by other bytes, has no such part (an empty artifact has no parts), or was found damaged; a damaged
    /// artifact is removed and counted, so that it will be computed again.
    ///
    /// # Errors
    /// When the store itself fails.
    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError>;

    /// Returns a writer for a new artifact. Nothing is visible before [`Spool::commit`]; a spool that is dropped leaves
    /// nothing that can be read.
    ///
    /// The bytes in open spools do not count towards the capacity.
    ///
    /// # Errors
    /// When the store itself fails.
    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError>;

    /// Removes an artifact, if it is stored.
    ///
    /// # Errors
    /// When the store itself fails.
    fn remove(&self, key: &Key) -> Result<(), StoreError>;

    /// Returns the counts and sizes of the store.
    fn usage(&self) -> Usage;

    /// Protects an artifact from eviction until a matching [`Store::unpin`]; pins are counted. Returns false if the
    /// artifact is not stored. Never blocks.
    fn pin(&self, key: &Key) -> bool;

    /// Undoes one [`Store::pin`]. Never blocks.
    fn unpin(&self, key: &Key);

    /// Refuses an artifact that cannot be stored, before any byte is written. Never blocks on a disk or a network.
    ///
    /// # Errors
    /// [`StoreError::TooLarge`] or [`StoreError::Occupied`].
    fn admit(&self, _key: &Key, _length: u64) -> Result<(), StoreError> {
        Ok(())
    }

    /// Returns a writer for an artifact that is large for the memory, from which the bytes can be taken back if the
    /// store fails. Without such a writer the artifact is made in memory, and kept only as long as it fits there.
    fn large_spool(&self, _key: Key) -> Option<Box<dyn LargeSpool>> {
        None
    }

    /// Writes everything that has to outlast the process and releases the folder; nothing is written afterwards.
    fn close(&self) {}
}

/// A writer of an artifact.
///
/// A write that would make the artifact [too large](StoreError::TooLarge) fails at once, with that error inside the
/// [`std::io::Error`]; `StoreError::from` extracts it. After a failed write the spool accepts no more bytes.
pub trait Spool: Write + Send + std::fmt::Debug {
    /// Makes the bytes written so far the artifact, durably, and returns its manifest.
    ///
    /// If the same bytes are stored under the key already, they are kept and their manifest is returned, with the new
    /// owners added; different bytes under the same key are replaced, with a warning in the log.
    ///
    /// # Errors
    /// When the bytes cannot be stored (disk full, too large, an earlier write failed).
    fn commit(self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError>;

    /// Commits the bytes written so far, like [`Spool::commit`], under their BLAKE3 hash as the key.
    ///
    /// # Errors
    /// As [`Spool::commit`].
    fn commit_by_content(self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError>;
}

/// A writer of a large artifact that gives the bytes back if the store accepts no more.
pub trait LargeSpool: Send + std::fmt::Debug {
    /// Takes some of `bytes` and returns how many. On failure none of them are taken, and all earlier bytes are kept.
    ///
    /// # Errors
    /// When the bytes cannot be stored.
    fn take(&mut self, bytes: &[u8]) -> Result<usize, StoreError>;

    /// Ends the writing: the bytes can be read from now on, but are not durable yet.
    ///
    /// # Errors
    /// When the bytes cannot be stored; the spool keeps all bytes that it has taken.
    fn seal(&mut self, description: ArtifactDescription) -> Result<Arc<dyn Sealed>, StoreError>;

    /// Gives back all bytes that the spool has taken, verified, and leaves nothing in the store.
    ///
    /// # Errors
    /// When bytes are lost.
    fn reclaim(self: Box<Self>) -> io::Result<Vec<u8>>;
}

/// A completely written large artifact; if it is dropped before [`settle`](Self::settle), it leaves nothing in the
/// store.
pub trait Sealed: Send + Sync + std::fmt::Debug {
    /// Returns the manifest of the bytes. Never blocks.
    fn manifest(&self) -> &Arc<Manifest>;

    /// Returns a verified part of an artifact that has not settled; after that the store serves the parts.
    ///
    /// # Errors
    /// When the store fails.
    fn part(&self, index: usize) -> Result<Option<Bytes>, StoreError>;

    /// Returns all bytes, verified.
    ///
    /// # Errors
    /// When the store fails or the bytes are damaged.
    fn whole(&self) -> Result<Vec<u8>, StoreError>;

    /// Makes the bytes the artifact, durably. If the disk is full, evicts the least recently used artifacts until the
    /// bytes fit or nothing is left to evict.
    ///
    /// If the same bytes are stored under the key already, they are kept; different bytes under the same key are
    /// replaced.
    ///
    /// # Errors
    /// When the bytes cannot be stored.
    fn settle(&self) -> Result<Arc<Manifest>, StoreError>;
}

/// The counts and sizes of a store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Usage {
    /// Number of artifacts stored.
    pub artifacts: u64,
    /// Bytes used: contents and manifests, rounded up to whole blocks on a disk.
    pub bytes: u64,
    /// Maximum number of bytes stored.
    pub capacity: u64,
    /// Number of artifacts evicted to make room.
    pub evicted: u64,
    /// Number of artifacts found damaged and removed.
    pub damaged: u64,
    /// Whether the store does not answer at the moment.
    pub away: bool,
}

/// The purpose of a store; each purpose has a place of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StorePurpose {
    /// Results of computations.
    Results,
    /// Files uploaded by clients.
    Uploads,
}

/// The bucket of a store that several servers share.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Bucket {
    /// Name of the bucket.
    pub name: String,
    /// Prefix of the names of all objects; may be empty.
    pub prefix: String,
    /// Endpoint URL of the object store; empty for the default of the region.
    pub endpoint: String,
    /// Region; empty for the default.
    pub region: String,
}

/// The location and the parameters of a store to be opened.
#[derive(Debug, Clone)]
pub struct StoreLocation {
    /// Folder of the service.
    pub dir: PathBuf,
    /// Bucket of the service.
    pub bucket: Bucket,
    /// Purpose of the store.
    pub room: StorePurpose,
    /// Capacity in bytes.
    pub capacity_bytes: u64,
    /// Makes the HTTP client for the bucket.
    pub connect: Connect,
    /// The clock of the service.
    pub clock: Arc<dyn Clock>,
}

/// Makes the HTTP client of an object store. The `http` module implements it, so that stores do not depend on it.
pub type Connect = fn() -> object_store::Result<object_store::client::HttpClient>;

/// Opens a store.
pub(super) type StoreOpener = fn(&StoreLocation) -> Result<Arc<dyn Store>, StoreError>;

/// An implementation of [`Store`] that the settings can name.
#[derive(Debug)]
pub struct StoreKind {
    /// Name in the settings.
    pub name: &'static str,
    /// Whether the store keeps its bytes in the folder of the service, so that it needs such a folder.
    pub in_folder: bool,
    /// Opens a store of this kind.
    pub open: StoreOpener,
    /// Opens the small records (of jobs and batches) in a folder whose store is already open.
    pub records: fn(&Path) -> Result<Arc<dyn Records>, StoreError>,
}
