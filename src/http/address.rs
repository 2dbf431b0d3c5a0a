//! The addresses of artifacts, and their entity tags.

use axum::http::Uri;

use crate::job::key::Key;
use crate::output::Format;
use crate::service::variant::Coding;

/// Returns the address of an artifact.
pub(super) fn address(key: impl std::fmt::Display, format: &dyn Format) -> String {
    of_extension(key, format.extension())
}

/// Returns the address of an artifact with a file extension.
pub(super) fn of_extension(key: impl std::fmt::Display, extension: &str) -> String {
    format!("/v1/artifacts/{key}.{extension}")
}

/// Returns the ETag of an artifact, or of its variant in a content coding.
pub(super) fn etag(key: &Key, coding: Option<Coding>) -> String {
    format!("\"{key}{}\"", coding.map_or("", Coding::suffix))
}

/// Maximum length of an address that contains a job, in bytes: every browser, proxy and server accepts as much. Some of
/// them cut twice of it; half of it holds jobs of half as many points.
pub(crate) const MAX_LINK_BYTES: usize = 8 << 10;
/// The path of addresses that contain a job in the query. (Addresses below [`KROKI`] contain it after the name of a
/// format.)
pub(super) const RENDER: &str = "/v1/render";
const KROKI: &str = "/kroki/";

/// Returns whether an address may contain a job, by its path and its length.
pub(super) fn is_link(address: &Uri) -> bool {
    let length = address.path_and_query().map_or(0, |both| both.as_str().len());
    length <= MAX_LINK_BYTES && (address.path() == RENDER || address.path().starts_with(KROKI))
}
