//! The addresses of artifacts.

use crate::output::Format;

/// Where an artifact has its address.
pub(super) fn address(key: impl std::fmt::Display, format: &dyn Format) -> String {
    format!("/v1/artifacts/{key}.{}", format.extension())
}
