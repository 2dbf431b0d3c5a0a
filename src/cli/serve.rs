//! `planish serve`: runs the service.

use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::error::CliError;
use super::log::Log;
use super::signals::Signals;
use crate::config::{PartialSettings, Settings, memory};
use crate::http::serve::{StartError, bind, serve as serve_http};
use crate::kept::keep_at_most;
use crate::service::account::kept_buffers;

/// Serves until a signal asks the process to stop. Then each store and table gets what is left of the shutdown timeout
/// to write its pending records, and threads that still wait for a disk are abandoned.
pub(super) fn serve(given: PartialSettings, file: Option<&Path>) -> Result<(), CliError> {
    let given = given.or(PartialSettings::of_variables(std::env::vars_os()).map_err(CliError::usage)?);
    let available = memory::available();
    let settings = Settings::read_within(given, file, available).map_err(CliError::usage)?;
    keep_at_most(usize::try_from(kept_buffers(settings.max_memory_bytes)).unwrap_or(usize::MAX));
    let log = Log::start(&settings.log, settings.log_json).map_err(CliError::other)?;
    if let Some(available) = available.filter(|available| *available < settings.max_memory_bytes) {
        tracing::warn!(available, budget = settings.max_memory_bytes, "max-memory-bytes is more than there is");
    }
    if settings.cache_store != "s3" && !settings.s3_bucket.is_empty() {
        tracing::warn!(bucket = settings.s3_bucket, "s3-bucket is without effect unless cache-store is s3");
    }
    #[cfg(target_os = "linux")]
    let settings = Settings { max_connections: connections_within_files(settings.max_connections), ..settings };
    let patience = Duration::from_secs(settings.shutdown_timeout_s);
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().map_err(CliError::other)?;
    let asked = OnceLock::new();
    let served = runtime.block_on(async {
        let (listener, app) = bind(settings).await.map_err(unstarted)?;
        let address = listener.local_addr().map_err(CliError::other)?;
        // Signals are caught before anybody is told that the service is there.
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
        let left = || patience.saturating_sub(asked.get().map_or(Duration::ZERO, Instant::elapsed));
        app.desk.tiers.close(left());
        app.desk.jobs.close(left());
        app.desk.batches.close(left());
        app.desk.uploads.close();
    }
    runtime.shutdown_background();
    served.map(drop)
}

/// Converts the reason why the service did not start to an error of its kind.
fn unstarted(error: StartError) -> CliError {
    match error {
        StartError::Listen { .. } | StartError::Store { .. } | StartError::Bucket { .. } | StartError::Keys(_) => {
            CliError::files(error)
        }
        StartError::NoKeys { .. } | StartError::NoSuchStore { .. } => CliError::usage(error),
        StartError::Threads(_) => CliError::other(error),
    }
}

/// Number of open files besides connections: those of the stores, of the runtime and of downloads from disk. Half of it
/// is enough for a quiet service; twice of it would take another quarter of the usual 1,024 from connections.
#[cfg(target_os = "linux")]
const OTHER_FILES: u64 = 256;

/// Raises the limit of open files to the number that connections need, and returns how many connections the granted
/// limit allows. The limit of connections must be reached first: a connection beyond it replaces an idle one, but
/// beyond the limit of files no client can connect.
#[cfg(target_os = "linux")]
fn connections_within_files(wanted: usize) -> usize {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let files = u64::try_from(wanted).unwrap_or(u64::MAX).saturating_add(OTHER_FILES);
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let Some(current) = current.filter(|current| *current < files) else { return wanted };
    let asked = maximum.map_or(files, |maximum| files.min(maximum));
    let raised = setrlimit(Resource::Nofile, Rlimit { current: Some(asked), maximum });
    let granted = if raised.is_ok() { asked } else { current };
    if granted >= files {
        return wanted;
    }
    let connections = granted.saturating_sub(OTHER_FILES).max(granted / 2).max(1);
    tracing::warn!(
        files = granted,
        connections,
        "the limit on open files leaves room for fewer connections than max-connections; raise it (ulimit -n)"
    );
    usize::try_from(connections).unwrap_or(wanted)
}
