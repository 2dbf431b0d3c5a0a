//! The writer of an artifact to the shared store: the current part is buffered in memory, earlier parts are objects
//! already.

use std::io::{self, Write};
use std::sync::Arc;

use bytes::Bytes;

use super::error::StoreError;
use super::interface::Spool;
use super::manifest::{ArtifactDescription, Manifest, PART_BYTES};
use super::parts::PartHashes;
use super::shared_state::SharedState;
use crate::job::key::{Key, content};

/// The [`Spool`] of the shared store. If dropped, it leaves parts that no manifest names; the lifecycle rules of the
/// bucket remove them.
#[derive(Debug)]
pub(super) struct SharedSpool {
    store: Arc<SharedState>,
    key: Key,
    /// The bytes of the current, incomplete part.
    part: Vec<u8>,
    parts: PartHashes,
    /// The error after which the spool accepts no more bytes: a part was not written, so the bytes have a gap.
    failed: Option<StoreError>,
}

impl SharedSpool {
    pub(super) fn new(store: Arc<SharedState>, key: Key) -> Self {
        Self { store, key, part: Vec::new(), parts: PartHashes::default(), failed: None }
    }

    /// Writes the buffered part to the bucket.
    fn spill(&mut self) -> Result<(), StoreError> {
        if self.part.is_empty() {
            return Ok(());
        }
        self.store.check()?;
        let part = Bytes::from(std::mem::take(&mut self.part));
        self.store.put_part(&content(&part), part.clone())?;
        self.parts.push(&part);
        Ok(())
    }

    fn take(&mut self, bytes: &[u8]) -> Result<usize, StoreError> {
        let taken = bytes.len().min(PART_BYTES - self.part.len());
        self.store.admit(self.parts.length() + (self.part.len() + taken) as u64)?;
        self.part.extend_from_slice(&bytes[..taken]);
        if self.part.len() == PART_BYTES {
            self.spill()?;
        }
        Ok(taken)
    }

    /// Writes the last part and returns the hashes of all parts.
    fn end(&mut self) -> Result<PartHashes, StoreError> {
        if let Some(failed) = self.failed.take() {
            return Err(failed);
        }
        self.spill()?;
        self.store.check()?;
        Ok(std::mem::take(&mut self.parts))
    }
}

impl Write for SharedSpool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(failed) = &self.failed {
            return Err(failed.again().into());
        }
        self.take(bytes).map_err(|error| {
            self.failed = Some(error.again());
            self.part = Vec::new();
            error.into()
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Spool for SharedSpool {
    fn commit(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        let parts = self.end()?;
        self.store.enter(parts.manifest(self.key, description))
    }

    fn commit_by_content(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        let parts = self.end()?;
        let key = parts.content();
        self.store.enter(parts.manifest(key, description))
    }
}
