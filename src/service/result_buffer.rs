//! The buffer of a result being made: its bytes go to the store that will keep them, and remain available if that store
//! fails, so that they need not be computed again.

use std::io::{self, Write};
use std::sync::Arc;

use bytes::Bytes;

use super::disk_counts::count;
use super::store::{ArtifactDescription, LargeSpool, Manifest, StoreError};
use super::tiers::{Stored, Tiers};
use super::writer::UnwrittenArtifact;
use crate::job::key::Key;

/// Memory of a result beyond its estimate, in bytes. Half of it would abort results whose estimate is short by more;
/// twice of it would let each exceed its promise by 2 MiB.
const SLACK_BYTES: u128 = 1 << 20;

/// A result being made.
#[derive(Debug)]
pub struct ResultBuffer<'a> {
    tiers: &'a Tiers,
    key: Key,
    /// The store's spool for the bytes, as long as it takes them.
    spool: Option<Box<dyn LargeSpool>>,
    /// All bytes, if there is no spool.
    bytes: Vec<u8>,
    about_bytes: u128,
    max_bytes: usize,
    lost: bool,
}

impl<'a> ResultBuffer<'a> {
    /// Creates a buffer for about `about_bytes` bytes: in memory if that many are small for the memory cache, otherwise
    /// on the disk.
    pub fn new(tiers: &'a Tiers, key: Key, about_bytes: u128) -> Self {
        Self { spool: tiers.spool(key, about_bytes), ..Self::in_memory(tiers, key, about_bytes) }
    }

    /// Creates a buffer in memory. It holds up to five quarters of the estimate, which is an upper bound already and
    /// part of the job's memory, plus `SLACK_BYTES`.
    pub fn in_memory(tiers: &'a Tiers, key: Key, about_bytes: u128) -> Self {
        let max_bytes = about_bytes.saturating_add(about_bytes / 4).saturating_add(SLACK_BYTES);
        let max_bytes = usize::try_from(max_bytes).unwrap_or(usize::MAX);
        Self { tiers, key, spool: None, bytes: Vec::new(), about_bytes, max_bytes, lost: false }
    }

    /// Returns whether the disk lost bytes that it had taken, so that they have to be computed again.
    pub fn has_lost_bytes(&self) -> bool {
        self.lost
    }

    /// Stores the result where there is room for it.
    ///
    /// # Errors
    /// When the disk [lost](Self::has_lost_bytes) bytes.
    pub fn commit(&mut self, description: ArtifactDescription) -> Result<Stored, StoreError> {
        if let Some(mut spool) = self.spool.take() {
            match spool.seal(description.clone()) {
                Ok(sealed) => {
                    if self.tiers.offer(&UnwrittenArtifact::Sealed(Arc::clone(&sealed))) {
                        return Ok(Stored { manifest: Arc::clone(sealed.manifest()), loose: None });
                    }
                    self.bytes = self.taken_back(sealed.whole())?;
                }
                Err(error) => self.take_back(spool, &error)?,
            }
        }
        let bytes = Bytes::from(std::mem::take(&mut self.bytes).into_boxed_slice());
        Ok(self.tiers.keep(Arc::new(Manifest::of(self.key, &bytes, description)), bytes))
    }

    /// Moves the bytes from the disk into memory, since the disk takes no more.
    fn take_back(&mut self, spool: Box<dyn LargeSpool>, error: &StoreError) -> Result<(), StoreError> {
        tracing::warn!(key = %self.key, %error, "the disk does not take the result; it stays in memory");
        self.tiers.failed(error);
        self.bytes = self.taken_back(spool.reclaim().map_err(StoreError::from))?;
        Ok(())
    }

    fn taken_back(&mut self, bytes: Result<Vec<u8>, StoreError>) -> Result<Vec<u8>, StoreError> {
        self.lost = bytes.is_err();
        let counts = self.tiers.disk_counts();
        count(if self.lost { &counts.lost } else { &counts.taken_back });
        bytes
    }
}

impl Write for ResultBuffer<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(mut spool) = self.spool.take() {
            match spool.take(bytes) {
                Ok(taken) => {
                    self.spool = Some(spool);
                    return Ok(taken);
                }
                Err(error) => self.take_back(spool, &error)?,
            }
        }
        if self.lost || self.bytes.len().saturating_add(bytes.len()) > self.max_bytes {
            let detail = format!("the result has more than the {} bytes that its estimate allows", self.max_bytes);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, detail));
        }
        if self.bytes.capacity() == 0 {
            // a growing buffer would be copied, and its pages touched, again and again
            let room = usize::try_from(self.about_bytes).unwrap_or(0).clamp(bytes.len(), self.max_bytes);
            let _ = self.bytes.try_reserve_exact(room); // without this memory the buffer grows instead
        }
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
