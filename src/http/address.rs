//! The addresses of artifacts, and their entity tags.

use axum::http::Uri;

use crate::job::key::Key;
use crate::output::Format;
use crate::service::variant::Coding;

/// Where an artifact has its address.
pub(super) fn address(key: impl std::fmt::Display, format: &dyn Format) -> String {
    of_extension(key, format.extension())
}

/// Where an artifact of an extension has its address.
pub(super) fn of_extension(key: impl std::fmt::Display, extension: &str) -> String {
    format!("/v1/artifacts/{key}.{extension}")
}

/// The ETag of an artifact, or of its variant in a coding.
pub(super) fn etag(key: &Key, coding: Option<Coding>) -> String {
    format!("\"{key}{}\"", coding.map_or("", Coding::suffix))
}

/// Longest address that says a job, bytes: what every browser, proxy and server lets through.
/// Twice of it is cut by some of them; half of it holds jobs of half as many points.
pub(super) const MOST_LINK_BYTES: usize = 8 << 10;
/// Where addresses say jobs: in the query, or behind the name of a format.
pub(super) const RENDER: &str = "/v1/render";
const KROKI: &str = "/kroki/";

/// Whether an address may say a job.
pub(super) fn is_link(address: &Uri) -> bool {
    let length = address.path_and_query().map_or(0, |both| both.as_str().len());
    length <= MOST_LINK_BYTES && (address.path() == RENDER || address.path().starts_with(KROKI))
}
