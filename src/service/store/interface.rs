//! What every store can do.

use std::io::Write;
use std::sync::Arc;

use bytes::Bytes;

use super::error::StoreError;
use super::manifest::{Description, Manifest};
use crate::job::key::Key;

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
