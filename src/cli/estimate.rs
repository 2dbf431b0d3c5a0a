//! `planish estimate`: the predicted size and cost of a job.

use std::path::PathBuf;

use super::error::CliError;
use super::inputs::InputSource;
use super::job::JobOptions;
use super::say::answer;
use crate::job::limits::Limits;
use crate::wire::answer::EstimateAnswer;

/// What is estimated.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct EstimateOptions {
    /// A job (JSON) or a mesh file; - is standard input.
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    #[command(flatten)]
    options: JobOptions,
}

impl EstimateOptions {
    /// Prints the estimate as JSON.
    pub(super) fn estimate(&self) -> Result<(), CliError> {
        self.options.check()?;
        let source = InputSource::of(&self.input);
        let named = |error: CliError| error.about(&source);
        let mut loaded = self.options.load(&source).map_err(named)?;
        loaded.settle(&self.options)?;
        let admitted = loaded.admit(&self.options, &Limits::default()).map_err(named)?;
        let estimate = EstimateAnswer::new(admitted.job(), admitted.estimate());
        let text = serde_json::to_string_pretty(&estimate).map_err(CliError::other)?;
        answer(format!("{text}\n").as_bytes())
    }
}
