//! `planish health`: checks whether a running service is ready.

use std::time::Duration;

use super::error::CliError;
use super::remote::{client, innermost};

/// Requests `GET /readyz`.
pub(super) fn health(url: &str) -> Result<(), CliError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(CliError::other)?;
    let client = client("--url", url)?.timeout(Duration::from_secs(5)).build().map_err(CliError::other)?;
    let answer = runtime.block_on(async { client.get(format!("{}/readyz", url.trim_end_matches('/'))).send().await });
    let status =
        answer.map_err(|error| CliError::other(format!("no answer from {url}: {}", innermost(&error))))?.status();
    if status.is_success() { Ok(()) } else { Err(CliError::other(format!("{url} answers {status}"))) }
}
