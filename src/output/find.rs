//! Finds formats in the registry.

use super::format::Format;
use super::registry::FORMATS;

/// Returns the format with this name.
pub fn named(name: &str) -> Option<&'static dyn Format> {
    FORMATS.iter().copied().find(|format| format.name() == name)
}

/// Returns the names of the formats whose files can hold the description of a job.
pub fn described() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().filter(|format| format.facts().description.is_some()).map(|format| format.name())
}
