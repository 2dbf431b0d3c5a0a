//! Binary records: typed, length-prefixed fields, followed by a checksum of everything before it.
//!
//! `magic, version` then for each field `tag: u8, length: u64, bytes`, then `BLAKE3: 32 bytes`. Numbers are
//! little-endian.

use crate::job::key::{Key, content};

/// Bytes of a hash.
pub(super) const HASH_BYTES: usize = 32;

/// A record being written.
#[derive(Debug)]
pub(super) struct RecordWriter(Vec<u8>);

impl RecordWriter {
    /// Begins a record of a kind and a version, with a capacity of `room` bytes.
    pub(super) fn new(magic: [u8; 8], version: u32, room: usize) -> Self {
        let mut out = Vec::with_capacity(room);
        out.extend_from_slice(&magic);
        out.extend_from_slice(&version.to_le_bytes());
        Self(out)
    }

    /// Appends a field.
    pub(super) fn field(&mut self, tag: u8, bytes: &[u8]) {
        self.0.push(tag);
        self.0.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.extend_from_slice(bytes);
    }

    /// Appends a field of whole numbers.
    pub(super) fn numbers(&mut self, tag: u8, numbers: &[u64]) {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.field(tag, &bytes);
    }

    /// Appends a field of hashes.
    pub(super) fn hashes<'a>(&mut self, tag: u8, hashes: impl IntoIterator<Item = &'a Key>) {
        let bytes: Vec<u8> = hashes.into_iter().flat_map(|hash| *hash.as_bytes()).collect();
        self.field(tag, &bytes);
    }

    /// Returns the record with its checksum appended.
    pub(super) fn closed(mut self) -> Vec<u8> {
        let checksum = content(&self.0);
        self.0.extend_from_slice(checksum.as_bytes());
        self.0
    }
}

/// The fields of a record that are still to be read.
#[derive(Debug)]
pub(super) struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    /// Opens a record; `None` if it is damaged, or of another kind or version.
    pub(super) fn of(bytes: &'a [u8], magic: [u8; 8], version: u32) -> Option<Self> {
        let (record, checksum) = bytes.split_last_chunk::<HASH_BYTES>()?;
        if content(record).as_bytes() != checksum {
            return None;
        }
        record.strip_prefix(&magic)?.strip_prefix(&version.to_le_bytes()).map(Self)
    }

    /// Returns whether all fields were read.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns whether the next field has this tag.
    pub(super) fn is_next(&self, tag: u8) -> bool {
        self.0.first() == Some(&tag)
    }

    /// Reads the bytes of the next field; `None` if it has another tag or is longer than the rest of the record.
    pub(super) fn take(&mut self, tag: u8) -> Option<&'a [u8]> {
        let (&found, rest) = self.0.split_first()?;
        let (length, rest) = rest.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let (bytes, rest) = rest.split_at_checked(length)?;
        self.0 = rest;
        (found == tag).then_some(bytes)
    }

    /// Reads the next field, of exactly `N` bytes.
    pub(super) fn fixed<const N: usize>(&mut self, tag: u8) -> Option<[u8; N]> {
        self.take(tag)?.try_into().ok()
    }

    /// Reads the next field as a hash.
    pub(super) fn hash(&mut self, tag: u8) -> Option<Key> {
        self.fixed(tag).map(Key::from_bytes)
    }

    /// Reads the next field as a list of hashes.
    pub(super) fn hashes(&mut self, tag: u8) -> Option<Vec<Key>> {
        let (hashes, []) = self.take(tag)?.as_chunks::<HASH_BYTES>() else { return None };
        Some(hashes.iter().map(|hash| Key::from_bytes(*hash)).collect())
    }

    /// Reads the next field as a list of whole numbers.
    pub(super) fn numbers(&mut self, tag: u8) -> Option<Vec<u64>> {
        let (numbers, []) = self.take(tag)?.as_chunks::<8>() else { return None };
        Some(numbers.iter().map(|number| u64::from_le_bytes(*number)).collect())
    }

    /// Reads the next field as UTF-8 text.
    pub(super) fn text(&mut self, tag: u8) -> Option<String> {
        std::str::from_utf8(self.take(tag)?).ok().map(str::to_owned)
    }
}
