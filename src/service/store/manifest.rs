//! The binary form of a manifest: typed, length-prefixed fields, closed by a checksum of all that stands before it.
//!
//! `magic, version` then for each field, in fixed order, `tag: u8, length: u64, bytes`, then `BLAKE3: 32 bytes`.
//! Numbers are little-endian.

use crate::job::key::{Key, content};

/// Bytes of one part; the last part of an artifact may be shorter.
/// Half of it doubles the hashes of a manifest; twice of it doubles what is read and verified for a byte of a range.
/// All manifests on disk have it: a change is a new format of the store.
pub const PART_BYTES: usize = 1 << 20;

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

const MAGIC: &[u8; 8] = b"plnshman";
const VERSION: u32 = 1;
const HASH_BYTES: usize = 32;

/// The fields, in the order in which they stand; the warnings follow, each under its own tag.
mod tag {
    pub(super) const KEY: u8 = 1;
    pub(super) const MEDIA_TYPE: u8 = 2;
    pub(super) const LENGTH: u8 = 3;
    pub(super) const CONTENT: u8 = 4;
    pub(super) const PARTS: u8 = 5;
    pub(super) const BUILD: u8 = 6;
    pub(super) const RESULTS_VERSION: u8 = 7;
    pub(super) const WARNING: u8 = 8;
}

impl Manifest {
    /// Its binary form.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(512 + self.parts.len() * HASH_BYTES);
        out.extend_from_slice(MAGIC);
        out.extend_from_slice(&VERSION.to_le_bytes());
        field(&mut out, tag::KEY, self.key.as_bytes());
        field(&mut out, tag::MEDIA_TYPE, self.media_type.as_bytes());
        field(&mut out, tag::LENGTH, &self.length.to_le_bytes());
        field(&mut out, tag::CONTENT, self.content.as_bytes());
        let hashes: Vec<u8> = self.parts.iter().flat_map(|part| *part.as_bytes()).collect();
        field(&mut out, tag::PARTS, &hashes);
        field(&mut out, tag::BUILD, self.build.as_bytes());
        field(&mut out, tag::RESULTS_VERSION, &self.results_version.to_le_bytes());
        for warning in &self.warnings {
            field(&mut out, tag::WARNING, warning.as_bytes());
        }
        let checksum = content(&out);
        out.extend_from_slice(checksum.as_bytes());
        out
    }

    /// Reads the binary form back; `None` when it is damaged, of another version, or contradicts itself.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let (record, checksum) = bytes.split_last_chunk::<HASH_BYTES>()?;
        if content(record).as_bytes() != checksum {
            return None;
        }
        let mut fields = Fields(record.strip_prefix(MAGIC)?.strip_prefix(&VERSION.to_le_bytes())?);
        let key = fields.hash(tag::KEY)?;
        let media_type = fields.text(tag::MEDIA_TYPE)?;
        let length = u64::from_le_bytes(fields.fixed(tag::LENGTH)?);
        let content = fields.hash(tag::CONTENT)?;
        let (hashes, []) = fields.take(tag::PARTS)?.as_chunks::<HASH_BYTES>() else { return None };
        if hashes.len() as u64 != length.div_ceil(PART_BYTES as u64) {
            return None;
        }
        let parts = hashes.iter().map(|hash| Key::from_bytes(*hash)).collect();
        let build = fields.text(tag::BUILD)?;
        let results_version = u32::from_le_bytes(fields.fixed(tag::RESULTS_VERSION)?);
        let mut warnings = Vec::new();
        while !fields.0.is_empty() {
            warnings.push(fields.text(tag::WARNING)?);
        }
        Some(Self { key, media_type, length, content, parts, warnings, build, results_version })
    }
}

fn field(out: &mut Vec<u8>, tag: u8, bytes: &[u8]) {
    out.push(tag);
    out.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
    out.extend_from_slice(bytes);
}

/// What is left to read.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    /// The bytes of the next field, which must have this tag and fit into what is left.
    fn take(&mut self, tag: u8) -> Option<&'a [u8]> {
        let (&found, rest) = self.0.split_first()?;
        let (length, rest) = rest.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let (bytes, rest) = rest.split_at_checked(length)?;
        self.0 = rest;
        (found == tag).then_some(bytes)
    }

    fn fixed<const N: usize>(&mut self, tag: u8) -> Option<[u8; N]> {
        self.take(tag)?.try_into().ok()
    }

    fn hash(&mut self, tag: u8) -> Option<Key> {
        self.fixed(tag).map(Key::from_bytes)
    }

    fn text(&mut self, tag: u8) -> Option<String> {
        std::str::from_utf8(self.take(tag)?).ok().map(str::to_owned)
    }
}
