//! What every store can do.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytes::Bytes;

use super::error::StoreError;
use super::manifest::{Description, Manifest};
use super::records::Records;
use crate::job::key::Key;
use crate::service::clock::Clock;

/// A place where artifacts are kept. Bounded: the least recently used ones leave when there is no room.
///
/// Calls may block, and the service makes them off the event loop, except those that say that they never wait.
pub trait Store: std::fmt::Debug + Send + Sync {
    /// The manifest of an artifact, if it is here. Counts as a use. Never waits for a disk or a network: a store keeps
    /// its manifests in memory.
    ///
    /// # Errors
    /// When the store itself fails. A damaged record is not an error: it is dropped and counted. A record of another
    /// results version is dropped.
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError>;

    /// Whether other processes put artifacts here, too, so that [`Store::look_up`] finds more than [`Store::manifest`].
    fn is_shared(&self) -> bool {
        false
    }

    /// The manifest of an artifact as it stands in the store now, whoever put it there. Counts as a use.
    ///
    /// # Errors
    /// When the store itself fails.
    fn look_up(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError> {
        self.manifest(key)
    }

    /// Part number `index` of an artifact, verified against its hash; `None` when the artifact is gone, was replaced by
    /// other bytes, has no such part (an empty artifact has none at all), or was found damaged (then it is dropped and
    /// counted, so that it will be computed again).
    ///
    /// # Errors
    /// When the store itself fails.
    fn part(&self, manifest: &Manifest, index: usize) -> Result<Option<Bytes>, StoreError>;

    /// A place to write a new artifact to. Nothing is visible before [`Spool::commit`]; a dropped spool leaves nothing.
    ///
    /// The bytes in open spools do not count towards the capacity.
    ///
    /// # Errors
    /// When the store itself fails.
    fn spool(&self, key: Key) -> Result<Box<dyn Spool>, StoreError>;

    /// Removes an artifact, if it is here.
    ///
    /// # Errors
    /// When the store itself fails.
    fn remove(&self, key: &Key) -> Result<(), StoreError>;

    /// What the store holds and has seen.
    fn usage(&self) -> Usage;

    /// Keeps an artifact from leaving for others, once more each time; false when it is not here. Never waits.
    fn pin(&self, key: &Key) -> bool;

    /// Takes one [`Store::pin`] back. Never waits.
    fn unpin(&self, key: &Key);

    /// Refuses what cannot be kept, before anything is written. Never waits for a disk or a network.
    ///
    /// # Errors
    /// [`StoreError::TooLarge`] or [`StoreError::Occupied`].
    fn admit(&self, _key: &Key, _length: u64) -> Result<(), StoreError> {
        Ok(())
    }

    /// A place for an artifact that does not fit into memory well, whose bytes can be had back when the store fails.
    /// Without one the artifact is made in memory all the same, and kept only while it fits there.
    fn large_spool(&self, _key: Key) -> Option<Box<dyn LargeSpool>> {
        None
    }

    /// Writes what has to outlast the process and lets go of the place; nothing is written afterwards.
    fn close(&self) {}
}

/// An artifact being written.
///
/// A write that would make it [too large](StoreError::TooLarge) fails at once, with that error inside the
/// [`std::io::Error`]; `StoreError::from` takes it out again. After a failed write the spool accepts nothing more.
pub trait Spool: Write + Send + std::fmt::Debug {
    /// Makes the bytes written so far the artifact, durably, and returns its manifest.
    ///
    /// When the same bytes are here already, those are kept and their manifest is returned; other bytes under the same
    /// key are replaced, with a warning in the log.
    ///
    /// # Errors
    /// When the bytes cannot be kept (disk full, too large, an earlier write failed).
    fn commit(self: Box<Self>, description: Description) -> Result<Arc<Manifest>, StoreError>;

    /// Makes the bytes written so far the artifact whose key is the hash of them (BLAKE3), as [`Spool::commit`] does.
    ///
    /// # Errors
    /// As [`Spool::commit`].
    fn commit_by_content(self: Box<Self>, description: Description) -> Result<Arc<Manifest>, StoreError>;
}

/// A large artifact being written, whose bytes are not lost when the store takes no more.
pub trait LargeSpool: Send + std::fmt::Debug {
    /// Takes some of these bytes; says how many. On failure it has taken none of them, and still has all before.
    ///
    /// # Errors
    /// When the bytes cannot be kept.
    fn take(&mut self, bytes: &[u8]) -> Result<usize, StoreError>;

    /// Ends the writing: the bytes can be read from now on, but are not durable yet.
    ///
    /// # Errors
    /// When the bytes cannot be kept; the spool still has all that it took.
    fn seal(&mut self, description: Description) -> Result<Arc<dyn Sealed>, StoreError>;

    /// Gives back all bytes that it took, verified, and leaves nothing in the store.
    ///
    /// # Errors
    /// When bytes are lost.
    fn reclaim(self: Box<Self>) -> io::Result<Vec<u8>>;
}

/// A finished large artifact; dropped before it [settles](Self::settle), it leaves nothing.
pub trait Sealed: Send + Sync + std::fmt::Debug {
    /// What is known of the bytes. Never waits.
    fn manifest(&self) -> &Arc<Manifest>;

    /// A verified part, as long as the artifact has not settled: then the store has it.
    ///
    /// # Errors
    /// When the store fails.
    fn part(&self, index: usize) -> Result<Option<Bytes>, StoreError>;

    /// All bytes, verified.
    ///
    /// # Errors
    /// When the store fails or the bytes are damaged.
    fn whole(&self) -> Result<Vec<u8>, StoreError>;

    /// Makes the bytes the artifact, durably. Where the store is full, the least recently used artifacts leave until
    /// the bytes fit or none is left.
    ///
    /// When the same bytes are here already, those are kept; other bytes under the same key are replaced.
    ///
    /// # Errors
    /// When the bytes cannot be kept.
    fn settle(&self) -> Result<Arc<Manifest>, StoreError>;
}

/// What a store holds and has seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Usage {
    /// Artifacts held.
    pub artifacts: u64,
    /// What they cost: their bytes, their manifests, and the rounding to whole blocks where there are blocks.
    pub bytes: u64,
    /// Most bytes that may be held.
    pub capacity: u64,
    /// Artifacts dropped to make room.
    pub evicted: u64,
    /// Artifacts found damaged and dropped.
    pub damaged: u64,
    /// Whether the store does not answer at the moment.
    pub away: bool,
}

/// What a store is for: each has a place of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// Results of computations.
    Results,
    /// Files that clients sent.
    Uploads,
}

/// The bucket of a store that servers share.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Bucket {
    /// Its name.
    pub name: String,
    /// What the names of all objects begin with; may be empty.
    pub prefix: String,
    /// Where the store answers; empty for that of the region.
    pub endpoint: String,
    /// The region; empty for the usual one.
    pub region: String,
}

/// Where a store is opened.
#[derive(Debug, Clone)]
pub struct Place {
    /// The folder of the service.
    pub dir: PathBuf,
    /// The bucket of the service.
    pub bucket: Bucket,
    /// What the store is for.
    pub room: Room,
    /// Bytes of room.
    pub capacity_bytes: u64,
    /// Reaches the bucket.
    pub connect: Connect,
    /// Tells the time.
    pub clock: Arc<dyn Clock>,
}

/// Makes a client that speaks HTTP: how is the affair of those who know HTTP.
pub type Connect = fn() -> object_store::Result<object_store::client::HttpClient>;

/// Opens a store.
pub(super) type Open = fn(&Place) -> Result<Arc<dyn Store>, StoreError>;

/// A kind of store.
#[derive(Debug)]
pub struct StoreKind {
    /// Its name in the settings.
    pub name: &'static str,
    /// Whether it keeps bytes in the folder of the service, and nothing without one.
    pub in_folder: bool,
    /// Opens it.
    pub open: Open,
    /// Opens what it keeps of small records, in a folder that is open already.
    pub records: fn(&Path) -> Result<Arc<dyn Records>, StoreError>,
}
