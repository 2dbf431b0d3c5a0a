//! Jobs from files: as they are written, or made of a mesh file and a few flags.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use super::error::CliError;
use super::folder::Folder;
use crate::fault::Fault;
use crate::input::{self, Alone};
use crate::job::Levels;
use crate::job::limits::{Admitted, Limits, Refusal};
use crate::wire::JobRequest;
use crate::wire::input::{InputRequest, OrientRequest};
use crate::wire::levels::LevelsRequest;
use crate::wire::plan::PlanRequest;
use crate::wire::read::{ReadError, read};
use crate::wire::text::MeshFile;

/// What a mesh file does not say by itself; a job says it in its own words.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "For mesh files")]
pub(crate) struct MeshOptions {
    /// Preset that refines the mesh; without one it is converted or drawn as it is.
    #[arg(long)]
    preset: Option<String>,
    /// How often the preset is applied.
    #[arg(long)]
    levels: Option<u64>,
    /// Merge vertices that are at most so far apart; 0 merges equal positions.
    #[arg(long)]
    weld: Option<f64>,
    /// Turn faces to agree with their neighbours.
    #[arg(long)]
    repair: bool,
    /// Join pairs of triangles into quads, where there is one way to do it.
    #[arg(long)]
    pair_quads: bool,
}

/// Reads a job, or makes one of a mesh file; `-` is a job on standard input.
pub(super) fn load(path: &Path, options: &MeshOptions) -> Result<JobRequest, CliError> {
    let bytes = bytes(path)?;
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let file = match input::of_extension(extension) {
        Some(reader) => Some(MeshFile { format: reader.name.to_owned(), bytes, beside: Arc::new(Folder::of(path)) }),
        None if is_mesh(&bytes) => Some(MeshFile { format: "json".to_owned(), bytes, beside: Arc::new(Alone) }),
        None if *options == MeshOptions::default() => return read(&bytes).map_err(refused),
        None => None,
    };
    let file = file.ok_or_else(|| {
        let known: Vec<&str> = input::READERS.iter().map(|reader| reader.name).collect();
        CliError::new(format!(
            "{} is a job, which says preset, levels, weld, orient and pair_quads itself; the flags are for mesh files \
             (.{}, or the JSON of a mesh)",
            path.display(),
            known.join(", .")
        ))
    })?;
    Ok(of_file(file, options))
}

/// The bytes of a file; `-` is standard input.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    let bytes = if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    bytes.map_err(|error| CliError::new(format!("cannot read {}: {error}", path.display())))
}

/// Whether it is the JSON of a mesh rather than a job.
fn is_mesh(bytes: &[u8]) -> bool {
    #[derive(serde::Deserialize)]
    struct Head {
        positions: Option<serde::de::IgnoredAny>,
    }
    serde_json::from_slice::<Head>(bytes).is_ok_and(|head| head.positions.is_some())
}

fn of_file(file: MeshFile, options: &MeshOptions) -> JobRequest {
    let plan =
        options.preset.as_ref().map(|preset| PlanRequest { preset: Some(preset.clone()), ..PlanRequest::default() });
    let input = InputRequest {
        orient: options.repair.then_some(OrientRequest::Repair),
        weld: options.weld,
        pair_quads: options.pair_quads,
        file: Some(file),
        ..InputRequest::default()
    };
    let levels = options.levels.map(|levels| LevelsRequest(Levels::Count(levels)));
    JobRequest { spec: None, input, plan, levels, outputs: Vec::new(), left_out: 0 }
}

pub(super) fn refused(error: ReadError) -> CliError {
    match error {
        ReadError::NotJson(detail) => CliError::Plain(detail),
        ReadError::Unfit(faults) => CliError::Faults(faults),
    }
}

/// Checks and admits a job.
pub(super) fn admit(request: JobRequest, limits: &Limits) -> Result<Admitted, CliError> {
    let is_file = request.input.file.is_some();
    let job = request
        .resolve_within(&limits.reading())
        .map_err(|faults| CliError::Faults(if is_file { faults.into_iter().map(told).collect() } else { faults }))?;
    limits.admit(job).map_err(|refusal| match refusal {
        Refusal::Impossible(faults) => CliError::Faults(faults),
        Refusal::TooLarge { detail, .. } => CliError::Plain(detail),
        Refusal::Stopped => CliError::Plain("the forecast of the job was stopped".to_owned()),
    })
}

/// A fault in the words of the command line, where no request was written.
fn told(fault: Fault) -> Fault {
    match fault.pointer.as_str() {
        "/input/text/data" => Fault::new("", fault.detail),
        _ => fault,
    }
}
