//! The writer of an artifact to disk: up to one part is buffered in memory, the rest is in a temporary file.

use std::io::{self, Write};
use std::sync::Arc;

use super::disk_state::DiskState;
use super::error::StoreError;
use super::files::{Tmp, cost};
use super::interface::{LargeSpool, Sealed, Spool};
use super::manifest::{ArtifactDescription, Manifest, PART_BYTES};
use super::parts::PartHashes;
use super::sealed::SealedFile;
use super::shelf;
use crate::job::key::{Key, content};

/// The [`Spool`] and [`LargeSpool`] of the embedded store.
#[derive(Debug)]
pub(super) struct DiskSpool {
    store: Arc<DiskState>,
    key: Key,
    /// The bytes of the current, incomplete part.
    part: Vec<u8>,
    parts: PartHashes,
    tmp: Option<Tmp>,
    /// The error after which the spool accepts no more bytes: a write failed, so the bytes have a gap.
    failed: Option<StoreError>,
}

impl DiskSpool {
    pub(super) fn new(store: Arc<DiskState>, key: Key) -> Self {
        Self { store, key, part: Vec::new(), parts: PartHashes::default(), tmp: None, failed: None }
    }

    /// Writes the buffered part to the temporary file and hashes it; if the disk is full, evicts artifacts to make
    /// room.
    fn spill(&mut self) -> Result<(), StoreError> {
        if self.part.is_empty() {
            return Ok(());
        }
        let (store, key, part) = (&self.store, &self.key, &self.part);
        let need = part.len() as u64;
        let mut tmp =
            self.tmp.take().map_or_else(|| store.with_room(need, || Ok(store.folder.create_tmp(key)?)), Ok)?;
        let offset = self.parts.length();
        let written = store.with_room(need, || Ok(tmp.write(offset, part)?));
        self.tmp = Some(tmp);
        written?;
        self.parts.push(&self.part);
        self.part.clear();
        Ok(())
    }
}

impl LargeSpool for DiskSpool {
    fn take(&mut self, bytes: &[u8]) -> Result<usize, StoreError> {
        let before = self.part.len();
        let taken = bytes.len().min(PART_BYTES - before);
        shelf::admit(self.parts.length() + (before + taken) as u64, self.store.capacity)?;
        self.part.extend_from_slice(&bytes[..taken]);
        if self.part.len() == PART_BYTES {
            self.spill().inspect_err(|_| self.part.truncate(before))?;
        }
        Ok(taken)
    }

    fn seal(&mut self, mut description: ArtifactDescription) -> Result<Arc<dyn Sealed>, StoreError> {
        self.spill()?;
        if let Some(present) = self.store.held(&self.key, &self.parts.content())
            && let Some(owners) = present.owners.with(&description.owners)
        {
            description.owners = owners;
        }
        let manifest = self.parts.clone().manifest(self.key, description);
        shelf::admit(cost(manifest.length, manifest.encode().len()), self.store.capacity)?;
        let tmp = self.tmp.take().map_or_else(|| self.store.folder.create_tmp(&self.key), Ok)?;
        Ok(Arc::new(SealedFile::new(Arc::clone(&self.store), Arc::new(manifest), tmp)))
    }

    fn reclaim(mut self: Box<Self>) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for hash in self.parts.hashes() {
            let tmp = self.tmp.as_ref().ok_or(io::ErrorKind::NotFound)?;
            let part = tmp.read(bytes.len() as u64, PART_BYTES.min(usize_of(self.parts.length()) - bytes.len()))?;
            if content(&part) != *hash {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "bytes that were just written are damaged"));
            }
            bytes.extend_from_slice(&part);
        }
        bytes.append(&mut self.part);
        Ok(bytes)
    }
}

impl Write for DiskSpool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(failed) = &self.failed {
            return Err(failed.again().into());
        }
        self.take(bytes).map_err(|error| {
            self.failed = Some(error.again());
            self.tmp = None;
            self.part = Vec::new();
            error.into()
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Spool for DiskSpool {
    fn commit(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        if let Some(failed) = self.failed.take() {
            return Err(failed);
        }
        self.seal(description)?.settle()
    }

    fn commit_by_content(mut self: Box<Self>, description: ArtifactDescription) -> Result<Arc<Manifest>, StoreError> {
        if self.failed.is_none() {
            self.spill()?;
            self.key = self.parts.content();
        }
        self.commit(description)
    }
}

/// Converts a length to `usize`. It fits, because its bytes were in memory part by part.
fn usize_of(length: u64) -> usize {
    usize::try_from(length).unwrap_or(usize::MAX)
}
