//! `planish serve`: the service.

use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::error::CliError;
use super::log::Log;
use super::signals::Signals;
use crate::config::{Given, Settings, memory};
use crate::http::serve::{StartError, bind, serve as serve_http};
use crate::kept::keep_at_most;
use crate::service::account::kept_buffers;

/// Serves until the process is asked to stop; from then on it takes no longer than the setting allows, whatever
/// threads still wait for a disk that hangs.
pub(super) fn serve(given: Given, file: Option<&Path>) -> Result<(), CliError> {
    let given = given.or(Given::of_variables(std::env::vars_os()).map_err(CliError::usage)?);
    let available = memory::available();
    let settings = Settings::read_within(given, file, available).map_err(CliError::usage)?;
    keep_at_most(usize::try_from(kept_buffers(settings.max_memory_bytes)).unwrap_or(usize::MAX));
    let log = Log::start(&settings.log, settings.log_json).map_err(CliError::other)?;
    if let Some(available) = available.filter(|available| *available < settings.max_memory_bytes) {
        tracing::warn!(available, budget = settings.max_memory_bytes, "max-memory-bytes is more than there is");
    }
    let patience = Duration::from_secs(settings.shutdown_timeout_s);
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().map_err(CliError::other)?;
    let asked = OnceLock::new();
    let served = runtime.block_on(async {
        let (listener, app) = bind(settings).await.map_err(unstarted)?;
        let address = listener.local_addr().map_err(CliError::other)?;
        // asked for before anybody knows that the service is there
        let signals = Signals::new().map_err(CliError::other)?;
        tracing::info!(%address, cache = %app.settings.data_dir.display(), "planish is listening");
        log.say(&format!("planish is listening on http://{address}"));
        let stop = async {
            signals.first().await;
            asked.get_or_init(Instant::now);
        };
        serve_http(listener, app.clone(), stop).await;
        Ok(app)
    });
    if let Ok(app) = &served {
        let left = patience.saturating_sub(asked.get().map_or(Duration::ZERO, Instant::elapsed));
        app.desk.tiers.close(left);
        app.desk.jobs.close(left);
        app.desk.batches.close(left);
        app.desk.uploads.close();
    }
    runtime.shutdown_background();
    served.map(drop)
}

/// Why the service did not start, with the code of its kind.
fn unstarted(error: StartError) -> CliError {
    match error {
        StartError::Listen { .. } | StartError::Store { .. } | StartError::Bucket { .. } | StartError::Keys(_) => {
            CliError::files(error)
        }
        StartError::NoKeys { .. } | StartError::NoSuchStore { .. } => CliError::usage(error),
        StartError::Threads(_) => CliError::other(error),
    }
}
