//! A completely written artifact in a temporary file: it can be read, and can be renamed to its final name.

use std::sync::Arc;

use bytes::Bytes;

use super::disk_state::DiskState;
use super::error::StoreError;
use super::files::{Tmp, cost};
use super::interface::Sealed;
use super::manifest::{Manifest, PART_BYTES};

/// The [`Sealed`] of the embedded store.
#[derive(Debug)]
pub(super) struct SealedFile {
    store: Arc<DiskState>,
    manifest: Arc<Manifest>,
    bytes: Tmp,
}

impl SealedFile {
    pub(super) fn new(store: Arc<DiskState>, manifest: Arc<Manifest>, bytes: Tmp) -> Self {
        Self { store, manifest, bytes }
    }

    fn sound_part(&self, index: usize) -> Result<Bytes, StoreError> {
        let damaged =
            || std::io::Error::new(std::io::ErrorKind::InvalidData, "bytes that were just written are damaged");
        Ok(self.part(index)?.ok_or_else(damaged)?)
    }

    fn cost(&self) -> u64 {
        cost(self.manifest.length, self.manifest.encode().len())
    }

    fn copied(&self) -> Result<Self, StoreError> {
        let (store, key) = (&self.store, &self.manifest.key);
        let mut copy = store.with_room(PART_BYTES as u64, || Ok(store.folder.create_tmp(key)?))?;
        let mut offset = 0;
        for index in 0..self.manifest.parts.len() {
            let part = self.sound_part(index)?;
            store.with_room(part.len() as u64, || Ok(copy.write(offset, &part)?))?;
            offset += part.len() as u64;
        }
        Ok(Self::new(Arc::clone(store), Arc::clone(&self.manifest), copy))
    }

    fn place(&self) -> Result<Arc<Manifest>, StoreError> {
        let (store, key) = (&self.store, &self.manifest.key);
        let present = store.held(key, &self.manifest.content);
        if let Some(present) = present.filter(|present| present.owners.with(&self.manifest.owners).is_none()) {
            return Ok(present);
        }
        self.bytes.sync()?;
        let mut record = store.folder.create_tmp(key)?;
        record.write(0, &self.manifest.encode())?;
        record.sync()?;
        store.keep(Arc::clone(&self.manifest), self.cost(), &self.bytes, &record)
    }
}

impl Sealed for SealedFile {
    fn manifest(&self) -> &Arc<Manifest> {
        &self.manifest
    }

    fn part(&self, index: usize) -> Result<Option<Bytes>, StoreError> {
        Ok(self.bytes.read_part(&self.manifest, index)?)
    }

    fn whole(&self) -> Result<Vec<u8>, StoreError> {
        let mut bytes = Vec::new();
        for index in 0..self.manifest.parts.len() {
            bytes.extend_from_slice(&self.sound_part(index)?);
        }
        Ok(bytes)
    }

    fn settle(&self) -> Result<Arc<Manifest>, StoreError> {
        let mut copy: Option<Self> = None;
        loop {
            match copy.as_ref().unwrap_or(self).place() {
                // After a failed sync the system may report lost bytes as written, so only a copy in a new file is
                // safe.
                Err(error) if error.is_full() && self.store.make_room(self.cost())? => copy = Some(self.copied()?),
                placed => return placed,
            }
        }
    }
}
