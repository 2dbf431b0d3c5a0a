//! `planish render --server`: renders jobs and mesh files to files on a remote service.

use std::time::Duration;

use futures_util::{StreamExt, stream};
use serde_json::Value;
use tokio::time::Instant;

use super::error::CliError;
use super::files::to_new_file;
use super::job::JobOptions;
use super::pieces::OutputTarget;
use super::progress::Progress;
use super::remote::Remote;
use super::say::answer;

/// The service that renders.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ServerOptions {
    /// Have a service render, at this address such as <http://127.0.0.1:8080>; what is busy is asked again.
    #[arg(long, value_name = "URL", help_heading = "Service")]
    server: Option<String>,
    /// The key that the service asks for.
    #[arg(long, value_name = "KEY", env = "PLANISH_KEY", hide_env_values = true, help_heading = "Service")]
    key: Option<String>,
    /// Seconds after which an input is given up that the service does not finish.
    #[arg(long, value_name = "SECONDS", default_value_t = 600, help_heading = "Service",
        value_parser = clap::value_parser!(u64).range(1..=86_400))]
    patience: u64,
    /// Inputs that are with the service at once.
    #[arg(long, value_name = "N", default_value_t = 4, help_heading = "Service",
        value_parser = clap::value_parser!(u64).range(1..=64))]
    parallel: u64,
}

/// The inputs that a service is to render, and whether missing folders are created for the files.
pub(super) struct RemoteRender<'a> {
    pub(super) pieces: &'a [OutputTarget],
    pub(super) makes_folders: bool,
    pub(super) options: &'a JobOptions,
}

impl ServerOptions {
    /// Connects to the service named by the flags, if any.
    pub(super) fn remote(&self, is_quiet: bool) -> Result<Option<Remote>, CliError> {
        let patience = Duration::from_secs(self.patience);
        self.server.as_deref().map(|url| Remote::new(url, self.key.as_deref(), patience, is_quiet)).transpose()
    }

    /// Renders all inputs, several at once; the failure of one does not stop the others.
    pub(super) fn render(
        &self,
        remote: &Remote,
        order: &RemoteRender<'_>,
        progress: &mut Progress,
    ) -> Result<(), CliError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(CliError::other)?;
        let parallel = usize::try_from(self.parallel).unwrap_or(1);
        runtime.block_on(async {
            let made = stream::iter(order.pieces).map(async |piece| (&piece.source, order.made(remote, piece).await));
            let mut made = std::pin::pin!(made.buffer_unordered(parallel));
            while let Some((source, outcome)) = made.next().await {
                progress.done(source, outcome);
            }
        });
        Ok(())
    }
}

impl RemoteRender<'_> {
    /// Renders one input on the service and writes its file. The patience is that of the input: its upload and its job
    /// have one together.
    async fn made(
        &self,
        remote: &Remote,
        OutputTarget { source, target, wanted }: &OutputTarget,
    ) -> Result<(), CliError> {
        let begun = Instant::now();
        let (mut job, file) = self.options.job_json(source, *wanted)?;
        if !job["outputs"][0]["lod"].is_null() {
            return Err(CliError::usage("--lod: levels of detail are several files; render them without --server"));
        }
        if let Some((bytes, media_type)) = file {
            job["input"]["blob"] = Value::from(remote.upload(&bytes, media_type, begun).await?);
        }
        let bytes = remote.render(&job, begun).await?;
        let Some(target) = target else { return answer(&bytes) };
        if let Some(folder) = target.parent().filter(|folder| self.makes_folders && !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)
                .map_err(|error| CliError::files(format!("cannot make a folder for {}: {error}", target.display())))?;
        }
        let cannot = |error| CliError::files(format!("cannot write {}: {error}", target.display()));
        to_new_file(target, |out| out.write_all(&bytes).map_err(cannot))
    }
}
