//! The hashes of an artifact, taken while its bytes pass by.

use blake3::Hasher;
use bytes::Bytes;
use rayon::prelude::*;

use super::manifest::{Description, Manifest, PART_BYTES};
use crate::job::key::{Key, RESULTS_VERSION, content};

/// Recorded in every manifest.
const BUILD: &str = concat!("planish ", env!("CARGO_PKG_VERSION"));

/// The hashes and the length of the parts seen so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    whole: Hasher,
    hashes: Vec<Key>,
    length: u64,
}

impl Parts {
    /// The parts of bytes that are all there.
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut parts = Self::default();
        bytes.chunks(PART_BYTES).for_each(|part| parts.push(part));
        parts
    }

    /// Takes the next part: exactly [`PART_BYTES`], except for the last one.
    pub(super) fn push(&mut self, part: &[u8]) {
        // a part after a short one would be looked for at another place: a fault of the caller, before anything is kept
        assert!(self.length.is_multiple_of(PART_BYTES as u64), "only the last part may be short");
        self.whole.update(part);
        self.hashes.push(content(part));
        self.length += part.len() as u64;
    }

    /// Bytes seen so far.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The hash of each part seen so far.
    pub(super) fn hashes(&self) -> &[Key] {
        &self.hashes
    }

    /// BLAKE3 of all bytes seen so far.
    pub(super) fn content(&self) -> Key {
        Key::from_bytes(*self.whole.finalize().as_bytes())
    }

    /// The record of these bytes under `key`.
    pub(super) fn manifest(self, key: Key, description: Description) -> Manifest {
        let content = self.content();
        record(key, self.length, content, self.hashes, description)
    }

    /// The record of these bytes under the hash of them.
    pub(super) fn manifest_by_content(self, description: Description) -> Manifest {
        let key = self.content();
        self.manifest(key, description)
    }
}

impl Manifest {
    /// What is known of bytes that are all there; called on a compute thread, whose neighbours hash as well.
    pub fn of(key: Key, bytes: &[u8], description: Description) -> Self {
        let whole = || content(bytes);
        let (content, hashes) = if bytes.len() <= PART_BYTES {
            // the only part is the whole
            let only = whole();
            (only, vec![only; bytes.len().min(1)])
        } else {
            rayon::join(whole, || bytes.par_chunks(PART_BYTES).map(content).collect())
        };
        record(key, bytes.len() as u64, content, hashes, description)
    }
}

fn record(key: Key, length: u64, content: Key, parts: Vec<Key>, description: Description) -> Manifest {
    let Description { media_type, warnings, owners } = description;
    let (build, results_version) = (BUILD.to_owned(), RESULTS_VERSION);
    Manifest { key, media_type, length, content, parts, warnings, build, results_version, owners }
}

/// Where part `index` starts and how many bytes it has; `None` when there is no such part.
pub(super) fn span(manifest: &Manifest, index: usize) -> Option<(u64, usize)> {
    let start = u64::try_from(index).ok()?.checked_mul(PART_BYTES as u64)?;
    let left = manifest.length.checked_sub(start).filter(|&left| left > 0)?;
    Some((start, usize::try_from(left).map_or(PART_BYTES, |left| left.min(PART_BYTES))))
}

/// Part `index` of an artifact whose bytes are all there; `None` when there is no such part.
pub(in crate::service) fn part_of(manifest: &Manifest, bytes: &Bytes, index: usize) -> Option<Bytes> {
    let (start, length) = span(manifest, index)?;
    let start = usize::try_from(start).ok()?;
    let end = start.checked_add(length).filter(|&end| end <= bytes.len())?;
    Some(bytes.slice(start..end))
}
