//! An artifact on its way to the disk: up to one part waits in memory, the rest in a temporary file.

use std::io::{self, Write};
use std::sync::Arc;

use super::embedded::Inner;
use super::files::Tmp;
use super::parts::Parts;
use super::{Description, Manifest, PART_BYTES, Spool, StoreError, shelf};
use crate::job::key::Key;

/// Bytes of a block; each file costs whole blocks.
const BLOCK_BYTES: u64 = 4096;

/// Spool of the embedded store.
#[derive(Debug)]
pub(super) struct DiskSpool {
    store: Arc<Inner>,
    key: Key,
    /// The part being filled.
    part: Vec<u8>,
    parts: Parts,
    tmp: Option<Tmp>,
    /// Why nothing more is accepted: a write failed, so the bytes have a gap.
    failed: Option<StoreError>,
}

impl DiskSpool {
    pub(super) fn new(store: Arc<Inner>, key: Key) -> Self {
        Self { store, key, part: Vec::new(), parts: Parts::default(), tmp: None, failed: None }
    }

    fn take(&mut self, bytes: &[u8]) -> Result<usize, StoreError> {
        let taken = bytes.len().min(PART_BYTES - self.part.len());
        shelf::admit(self.parts.length() + (self.part.len() + taken) as u64, self.store.capacity)?;
        self.part.extend_from_slice(&bytes[..taken]);
        if self.part.len() == PART_BYTES {
            self.spill()?;
        }
        Ok(taken)
    }

    /// Hashes the waiting part and writes it to the file.
    fn spill(&mut self) -> Result<(), StoreError> {
        if !self.part.is_empty() {
            self.parts.push(&self.part);
            let tmp = self.tmp.take().map_or_else(|| self.store.folder.create_tmp(&self.key), Ok)?;
            self.tmp.insert(tmp).write(&self.part)?;
            self.part.clear();
        }
        Ok(())
    }
}

impl Write for DiskSpool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(failed) = &self.failed {
            return Err(again(failed).into());
        }
        self.take(bytes).map_err(|error| {
            self.failed = Some(again(&error));
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
    fn commit(mut self: Box<Self>, description: Description) -> Result<Arc<Manifest>, StoreError> {
        if let Some(failed) = self.failed.take() {
            return Err(failed);
        }
        self.spill()?;
        let Self { store, key, parts, tmp, .. } = *self;
        if let Some(present) = store.held(&key, &parts.content()) {
            return Ok(present);
        }
        let manifest = Arc::new(parts.manifest(key, description));
        let record = manifest.encode();
        let cost = cost(manifest.length, record.len());
        shelf::admit(cost, store.capacity)?;
        let mut bytes = tmp.map_or_else(|| store.folder.create_tmp(&key), Ok)?;
        bytes.sync()?;
        let mut written = store.folder.create_tmp(&key)?;
        written.write(&record)?;
        written.sync()?;
        store.keep(manifest, cost, &mut bytes, &mut written)
    }
}

/// Bytes that an artifact of this length takes on the disk, with a record of this length.
pub(super) fn cost(length: u64, record: usize) -> u64 {
    let blocks = |bytes: u64| bytes.max(1).div_ceil(BLOCK_BYTES).saturating_mul(BLOCK_BYTES);
    blocks(length).saturating_add(blocks(record as u64))
}

/// The same failure, told once more.
fn again(error: &StoreError) -> StoreError {
    match error {
        StoreError::TooLarge { capacity } => StoreError::TooLarge { capacity: *capacity },
        StoreError::Io(error) => StoreError::Io(io::Error::new(error.kind(), error.to_string())),
    }
}
