//! The hashes of an artifact and of its parts, computed while the bytes are written.

use blake3::Hasher;
use bytes::Bytes;
use rayon::prelude::*;

use super::manifest::{ArtifactDescription, Manifest, PART_BYTES};
use crate::job::key::{Key, RESULTS_VERSION, content};

/// Name and version of this build, recorded in every manifest.
const BUILD: &str = concat!("planish ", env!("CARGO_PKG_VERSION"));

/// The hashes and the total length of the parts added so far.
#[derive(Debug, Clone, Default)]
pub(super) struct PartHashes {
    whole: Hasher,
    hashes: Vec<Key>,
    length: u64,
}

impl PartHashes {
    /// Hashes all parts of complete bytes.
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut parts = Self::default();
        bytes.chunks(PART_BYTES).for_each(|part| parts.push(part));
        parts
    }

    /// Adds the next part: exactly [`PART_BYTES`] long, except for the last one.
    pub(super) fn push(&mut self, part: &[u8]) {
        // Readers would look for a part after a short one at a wrong offset, so a caller's error must stop here.
        assert!(self.length.is_multiple_of(PART_BYTES as u64), "only the last part may be short");
        self.whole.update(part);
        self.hashes.push(content(part));
        self.length += part.len() as u64;
    }

    /// Returns the number of bytes added so far.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Returns the hash of each part added so far.
    pub(super) fn hashes(&self) -> &[Key] {
        &self.hashes
    }

    /// Returns the BLAKE3 hash of all bytes added so far.
    pub(super) fn content(&self) -> Key {
        Key::from_bytes(*self.whole.finalize().as_bytes())
    }

    /// Makes the manifest of these bytes under `key`.
    pub(super) fn manifest(self, key: Key, description: ArtifactDescription) -> Manifest {
        let content = self.content();
        record(key, self.length, content, self.hashes, description)
    }
}

impl Manifest {
    /// Makes the manifest of complete bytes. It hashes in parallel on the thread pool of the compute thread that calls
    /// it.
    pub fn of(key: Key, bytes: &[u8], description: ArtifactDescription) -> Self {
        let whole = || content(bytes);
        let (content, hashes) = if bytes.len() <= PART_BYTES {
            // The only part equals the whole.
            let only = whole();
            (only, vec![only; bytes.len().min(1)])
        } else {
            rayon::join(whole, || bytes.par_chunks(PART_BYTES).map(content).collect())
        };
        record(key, bytes.len() as u64, content, hashes, description)
    }
}

fn record(key: Key, length: u64, content: Key, parts: Vec<Key>, description: ArtifactDescription) -> Manifest {
    let ArtifactDescription { media_type, warnings, owners } = description;
    let (build, results_version) = (BUILD.to_owned(), RESULTS_VERSION);
    Manifest { key, media_type, length, content, parts, warnings, build, results_version, owners }
}

/// Returns the offset of part `index` and its length in bytes; `None` if there is no such part.
pub(super) fn span(manifest: &Manifest, index: usize) -> Option<(u64, usize)> {
    let start = u64::try_from(index).ok()?.checked_mul(PART_BYTES as u64)?;
    let left = manifest.length.checked_sub(start).filter(|&left| left > 0)?;
    Some((start, usize::try_from(left).map_or(PART_BYTES, |left| left.min(PART_BYTES))))
}

/// Returns part `index` of an artifact whose bytes are complete; `None` if there is no such part.
pub(in crate::service) fn part_of(manifest: &Manifest, bytes: &Bytes, index: usize) -> Option<Bytes> {
    let (start, length) = span(manifest, index)?;
    let start = usize::try_from(start).ok()?;
    let end = start.checked_add(length).filter(|&end| end <= bytes.len())?;
    Some(bytes.slice(start..end))
}
