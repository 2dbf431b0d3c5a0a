//! Entries of results that say nothing of the mesh itself, and are passed over where a result is read as an input.

use serde::de::{Deserialize, Deserializer, IgnoredAny};

/// An entry that is there or not, whatever it holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PassedOver {
    /// Whether it is there.
    pub is_given: bool,
}

impl<'de> Deserialize<'de> for PassedOver {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Self { is_given: true })
    }
}
