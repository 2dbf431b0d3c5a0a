//! Stores: keys and bytes only, content addressed, verified part by part when read.

mod disk;
mod disk_spool;
mod embedded;
mod files;
mod index;
mod manifest;
mod memory;
mod parts;
mod sealed;
mod shelf;
mod sweep;

pub use disk::{Disk, Local};
pub(super) use disk_spool::DiskSpool;
pub use embedded::Embedded;
pub use memory::Memory;
pub(super) use parts::part_of;
pub(super) use sealed::Sealed;

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

use crate::job::key::Key;

/// Bytes of one part; the last part of an artifact may be shorter.
pub const PART_BYTES: usize = 1 << 20;

/// Most entries one store holds, whatever its capacity: their records stay in memory, at about 500 bytes each.
pub const MAX_ARTIFACTS: usize = 1 << 19;

/// Recorded in every manifest.
const BUILD: &str = concat!("planish ", env!("CARGO_PKG_VERSION"));

/// What is known of a stored artifact; its own record, from which the index can be rebuilt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Manifest {
    /// Key of the artifact.
    pub key: Key,
    /// Media type of the bytes.
    pub media_type: String,
    /// Length in bytes.
    pub length: u64,
    /// BLAKE3 of all bytes.
    pub content: Key,
    /// BLAKE3 of each part of [`PART_BYTES`].
    pub parts: Vec<Key>,
    /// Warnings of the computation, repeated with every answer.
    pub warnings: Vec<String>,
    /// Build that made the bytes; recorded, never hashed.
    pub build: String,
    /// Results version under which they were made.
    pub results_version: u32,
}

/// What the maker of an artifact says of it when it commits the bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// Media type of the bytes.
    pub media_type: String,
    /// Warnings of the computation.
    pub warnings: Vec<String>,
}

impl Description {
    /// What was said of an artifact.
    pub fn of(manifest: &Manifest) -> Self {
        Self { media_type: manifest.media_type.clone(), warnings: manifest.warnings.clone() }
    }
}

impl Manifest {
    /// What is known of bytes that are all there.
    pub fn of(key: Key, bytes: &[u8], description: Description) -> Self {
        parts::Parts::of(bytes).manifest(key, description)
    }
}

/// A place where artifacts are kept. Bounded: the least recently used ones leave when there is no room.
///
/// All calls block; the service makes them off the event loop, except on stores that say they are [quick](Self::is_quick).
pub trait Store: std::fmt::Debug + Send + Sync {
    /// Whether every call returns within microseconds, without touching a disk or a network.
    fn is_quick(&self) -> bool {
        false
    }

    /// The manifest of an artifact, if it is here. Counts as a use.
    ///
    /// # Errors
    /// When the store itself fails. A damaged record is not an error: it is dropped and counted. A record of another
    /// results version is dropped.
    fn manifest(&self, key: &Key) -> Result<Option<Arc<Manifest>>, StoreError>;

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
}

/// An artifact being written.
///
/// A write that would make it [too large](StoreError::TooLarge) fails at once, with that error inside the
/// [`io::Error`]; `StoreError::from` takes it out again. After a failed write the spool accepts nothing more.
pub trait Spool: Write + Send + std::fmt::Debug {
    /// Makes the bytes written so far the artifact, durably, and returns its manifest.
    ///
    /// When the same bytes are here already, those are kept and their manifest is returned; other bytes under the same
    /// key are replaced, with a warning in the log.
    ///
    /// # Errors
    /// When the bytes cannot be kept (disk full, too large, an earlier write failed).
    fn commit(self: Box<Self>, description: Description) -> Result<Arc<Manifest>, StoreError>;
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
}

/// The store itself failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// More bytes than the store keeps of any one artifact.
    #[error("the artifact is too large for the store: more than {capacity} bytes; raise --cache-bytes")]
    TooLarge {
        /// Most bytes one artifact may have: half of what may be held.
        capacity: u64,
    },
    /// Something that is no file has the name of the artifact.
    #[error("a folder stands where the artifact would: {path}; remove it")]
    Occupied {
        /// Where.
        path: String,
    },
    /// The disk or the index failed.
    #[error("the store failed: {0}")]
    Io(#[source] io::Error),
}

impl StoreError {
    /// Whether there was no room on the disk: removing something may help.
    pub fn is_full(&self) -> bool {
        matches!(self, Self::Io(error) if disk::is_full(error))
    }
}

impl From<io::Error> for StoreError {
    fn from(error: io::Error) -> Self {
        error.downcast().unwrap_or_else(Self::Io)
    }
}

impl From<StoreError> for io::Error {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Io(error) => error,
            StoreError::TooLarge { .. } => Self::new(io::ErrorKind::FileTooLarge, error),
            StoreError::Occupied { .. } => Self::new(io::ErrorKind::IsADirectory, error),
        }
    }
}

/// Every change under these locks is complete before anything can panic, so a poisoned lock guards sound values.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
