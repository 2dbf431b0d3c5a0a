//! Entries of results that are ignored when a result is read as an input, because they do not describe the mesh itself.

use serde::de::{Deserialize, Deserializer, IgnoredAny};

/// An optional entry whose value is ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PassedOver {
    /// Whether the entry is present.
    pub is_given: bool,
}

impl<'de> Deserialize<'de> for PassedOver {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Self { is_given: true })
    }
}
