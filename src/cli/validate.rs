//! `planish validate`: checks jobs and mesh files, and describes their meshes.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::error::{CliError, ExitKind};
use super::fault_translator::FaultTranslator;
use super::inputs::{InputSource, jobs_and_meshes};
use super::job::JobOptions;
use super::say::answer;
use crate::http::validate::report;
use crate::job::limits::Limits;
use crate::watch::Watch;

/// What is looked at.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ValidateOptions {
    /// Jobs (JSON) or mesh files, or folders of them; - is standard input, and patterns like 'parts/*.obj' are looked
    /// up.
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Print nothing; the exit code tells.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    options: JobOptions,
}

impl ValidateOptions {
    /// Prints the answer of `POST /v1/validate`: for one input as it is, for several inputs one line each, with the
    /// name in `input`.
    pub(super) fn validate(&self) -> Result<(), CliError> {
        self.options.check()?;
        let sources = jobs_and_meshes(&self.inputs)?;
        let mut worst = None;
        for source in &sources {
            let found = match self.examined(source) {
                Ok(found) => found,
                Err(error) if error.kind == ExitKind::Refused => of_refusal(&error),
                Err(error) => {
                    eprintln!("planish: {source}: {error}");
                    worst = worst.max(Some(error.kind));
                    continue;
                }
            };
            if found["valid"] != true {
                worst = worst.max(Some(ExitKind::Refused));
            }
            if !self.quiet {
                print(source, &found, sources.len() == 1)?;
            }
        }
        worst.map_or(Ok(()), |kind| Err(CliError::printed(kind)))
    }

    /// Examines an input and returns the report as JSON.
    fn examined(&self, source: &InputSource) -> Result<Value, CliError> {
        let mut loaded = self.options.load(source)?;
        let purpose = loaded.request.stated_purpose();
        loaded.settle(&self.options)?;
        let translator = FaultTranslator { flags: &self.options.flags, is_file: loaded.is_file, format: loaded.format };
        let limits = Limits::default();
        let mut examined = loaded.request.examine(purpose, &limits.reading()).bounded(&limits, &Watch::new());
        examined.faults = examined.faults.into_iter().map(|fault| translator.with_flags(fault)).collect();
        serde_json::to_value(report(examined)).map_err(CliError::other)
    }
}

/// Makes the report on an input that could not be read as a job or a mesh.
fn of_refusal(error: &CliError) -> Value {
    let faults: Vec<Value> = error.details.iter().map(|detail| json!({ "pointer": "", "detail": detail })).collect();
    json!({ "valid": false, "errors": faults, "warnings": [] })
}

fn print(source: &InputSource, found: &Value, is_only: bool) -> Result<(), CliError> {
    if is_only {
        let text = serde_json::to_string_pretty(found).map_err(CliError::other)?;
        return answer(format!("{text}\n").as_bytes());
    }
    let mut line = json!({ "input": source.to_string() });
    for (name, value) in found.as_object().into_iter().flatten() {
        line[name] = value.clone();
    }
    answer(format!("{line}\n").as_bytes())
}
