//! Manifests of artifacts, and their binary form: fields in a fixed order.

use crate::job::key::Key;
use crate::service::fields::{Fields, RecordWriter};
use crate::service::job_key::Tenant;

/// Number of bytes of one part; the last part of an artifact may be shorter. Half of it would double the hashes in a
/// manifest; twice of it would double the bytes read and verified for a byte of a range. It is fixed in all manifests
/// on disk: a change needs a new format of the store.
pub const PART_BYTES: usize = 1 << 20;

/// The description of a stored artifact, written beside its bytes; the index can be rebuilt from the manifests.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Manifest {
    /// Key of the artifact.
    pub key: Key,
    /// Media type of the bytes.
    pub media_type: String,
    /// Length in bytes.
    pub length: u64,
    /// BLAKE3 hash of all bytes.
    pub content: Key,
    /// BLAKE3 hash of each part of [`PART_BYTES`].
    pub parts: Vec<Key>,
    /// Warnings of the computation, repeated in every response.
    pub warnings: Vec<String>,
    /// Build that made the bytes; for information, not part of any hash.
    pub build: String,
    /// Results version under which the bytes were made.
    pub results_version: u32,
    /// Tenants for whom the bytes were made, or who uploaded them.
    pub owners: Owners,
}

/// The part of a manifest that the maker of an artifact provides when it commits the bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArtifactDescription {
    /// Media type of the bytes.
    pub media_type: String,
    /// Warnings of the computation.
    pub warnings: Vec<String>,
    /// Tenants for whom the bytes were made, or who uploaded them.
    pub owners: Owners,
}

impl ArtifactDescription {
    /// Copies the description out of a manifest.
    pub fn of(manifest: &Manifest) -> Self {
        Self {
            media_type: manifest.media_type.clone(),
            warnings: manifest.warnings.clone(),
            owners: manifest.owners.clone(),
        }
    }
}

/// Maximum number of tenants that a manifest lists. One more replaces the first, for whom the artifact would be made
/// again. Twice of it would make manifests of popular artifacts twice as long, 4 KiB; half of it would make such
/// artifacts again if more than 128 tenants share a service.
const MAX_OWNERS: usize = 256;

/// The tenants that may see an artifact: those for whom it was made, or who uploaded it. Only they find it under its
/// key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Owners(Vec<Tenant>);

impl Default for Owners {
    /// Returns the tenant of all clients that do not identify themselves.
    fn default() -> Self {
        Self(vec![Tenant::ANYONE])
    }
}

impl FromIterator<Tenant> for Owners {
    fn from_iter<I: IntoIterator<Item = Tenant>>(tenants: I) -> Self {
        let mut owners = Self(Vec::new());
        tenants.into_iter().for_each(|tenant| owners.add(tenant));
        owners
    }
}

impl Owners {
    /// Returns whether a tenant is one of the owners.
    pub fn contain(&self, tenant: Tenant) -> bool {
        self.0.contains(&tenant)
    }

    fn add(&mut self, tenant: Tenant) {
        if !self.contain(tenant) {
            if self.0.len() >= MAX_OWNERS {
                self.0.remove(0);
            }
            self.0.push(tenant);
        }
    }

    /// Returns the union of both lists of owners; `None` if `self` contains all of `others` already.
    pub(super) fn with(&self, others: &Self) -> Option<Self> {
        let mut all = self.clone();
        others.0.iter().for_each(|tenant| all.add(*tenant));
        (all != *self).then_some(all)
    }
}

const MANIFEST_MAGIC: [u8; 8] = *b"plnshman";
const MANIFEST_VERSION: u32 = 1;

/// Tags of the fields in their order; the warnings follow, each as a field of its own.
mod tag {
    pub(super) const KEY_FIELD: u8 = 1;
    pub(super) const MEDIA_TYPE_FIELD: u8 = 2;
    pub(super) const LENGTH_FIELD: u8 = 3;
    pub(super) const CONTENT_FIELD: u8 = 4;
    pub(super) const PARTS_FIELD: u8 = 5;
    pub(super) const BUILD_FIELD: u8 = 6;
    pub(super) const RESULTS_VERSION_FIELD: u8 = 7;
    pub(super) const WARNING_FIELD: u8 = 8;
    /// Omitted if the owners are the default, the tenant of all clients that do not identify themselves.
    pub(super) const OWNERS_FIELD: u8 = 9;
}

impl Manifest {
    /// Encodes the manifest in its binary form.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = RecordWriter::new(MANIFEST_MAGIC, MANIFEST_VERSION, 512 + self.parts.len() * 32);
        out.field(tag::KEY_FIELD, self.key.as_bytes());
        out.field(tag::MEDIA_TYPE_FIELD, self.media_type.as_bytes());
        out.numbers(tag::LENGTH_FIELD, &[self.length]);
        out.field(tag::CONTENT_FIELD, self.content.as_bytes());
        out.hashes(tag::PARTS_FIELD, &self.parts);
        out.field(tag::BUILD_FIELD, self.build.as_bytes());
        out.field(tag::RESULTS_VERSION_FIELD, &self.results_version.to_le_bytes());
        if self.owners != Owners::default() {
            let numbers: Vec<u64> = self.owners.0.iter().map(|tenant| tenant.0).collect();
            out.numbers(tag::OWNERS_FIELD, &numbers);
        }
        for warning in &self.warnings {
            out.field(tag::WARNING_FIELD, warning.as_bytes());
        }
        out.closed()
    }

    /// Decodes the binary form; returns `None` if it is damaged, of another version, or inconsistent.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let mut fields = Fields::of(bytes, MANIFEST_MAGIC, MANIFEST_VERSION)?;
        let key = fields.hash(tag::KEY_FIELD)?;
        let media_type = fields.text(tag::MEDIA_TYPE_FIELD)?;
        let length = u64::from_le_bytes(fields.fixed(tag::LENGTH_FIELD)?);
        let content = fields.hash(tag::CONTENT_FIELD)?;
        let parts = fields.hashes(tag::PARTS_FIELD)?;
        if parts.len() as u64 != length.div_ceil(PART_BYTES as u64) {
            return None;
        }
        let build = fields.text(tag::BUILD_FIELD)?;
        let results_version = u32::from_le_bytes(fields.fixed(tag::RESULTS_VERSION_FIELD)?);
        let owners = if fields.is_next(tag::OWNERS_FIELD) {
            fields.numbers(tag::OWNERS_FIELD)?.into_iter().map(Tenant).collect()
        } else {
            Owners::default()
        };
        let mut warnings = Vec::new();
        while !fields.is_empty() {
            warnings.push(fields.text(tag::WARNING_FIELD)?);
        }
        Some(Self { key, media_type, length, content, parts, warnings, build, results_version, owners })
    }
}
