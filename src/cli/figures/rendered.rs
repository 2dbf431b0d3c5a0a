//! The rendering of one job of a folder to its pictures.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::manifest::{Entry, FigureManifest, hash, numbers};
use crate::cli::error::CliError;
use crate::cli::fault_translator::FaultTranslator;
use crate::cli::inputs::InputSource;
use crate::cli::job::{JobOptions, Loaded};
use crate::cli::peek::{self, NamedOutput};
use crate::job::limits::{Admitted, Limits};
use crate::job::{RunError, run};
use crate::output::{self, Format};
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::output::OutputRequest;

/// Name of the format of a job that names no output.
const DEFAULT_FORMAT: &str = "png";

/// A picture of a job.
#[derive(Debug)]
pub(super) struct Rendered {
    /// Name of the file.
    pub(super) name: String,
    /// Entry of the picture in the manifest.
    pub(super) entry: Entry,
    /// The bytes, if the picture was rendered now.
    pub(super) bytes: Option<Vec<u8>>,
}

/// Reads the job in a file.
pub(super) fn load(path: &Path) -> Result<JobRequest, CliError> {
    let Loaded { mut request, is_file, .. } = JobOptions::default().load(&InputSource::File(path.to_owned()))?;
    if is_file {
        return Err(CliError::refused("it is no job; a folder of figures holds jobs (JSON)"));
    }
    if request.outputs.is_empty() {
        request.outputs = vec![OutputRequest::of_format(DEFAULT_FORMAT)];
    }
    Ok(request)
}

/// Renders the pictures of a job; skips pictures that `folder` has already with the same key in the manifest.
pub(super) fn render(path: &Path, known: &FigureManifest, folder: Option<&Path>) -> Result<Vec<Rendered>, CliError> {
    let request = load(path)?;
    let job = part(path.file_name());
    let admitted = admitted(request.clone())?;
    let outputs = admitted.job().outputs.iter().map(|output| (output.format, output.name.as_str()));
    let pictures = pictures(path, outputs);
    if pictures.is_empty() {
        return Err(CliError::refused("it asks for no picture; pictures are png, apng, svg, ..."));
    }
    let mut all_numbers = None;
    let mut made = Vec::with_capacity(pictures.len());
    for (i, name) in pictures {
        let key = admitted.job().keys()[i].to_string();
        let old = known.figures.get(&name).filter(|entry| entry.key == key);
        let there = old.filter(|entry| folder.is_some_and(|folder| entry.is_in(folder, &name)));
        made.push(if let Some(entry) = there {
            Rendered { name, entry: Entry { job: job.clone(), ..entry.clone() }, bytes: None }
        } else {
            let bytes = bytes(&admitted, i)?;
            let hash = hash(&bytes);
            let numbers = match old.filter(|entry| entry.hash == hash) {
                Some(entry) => entry.numbers.clone(),
                None => all_numbers.get_or_insert_with(|| measured(&request)).clone(),
            };
            let entry = Entry { job: job.clone(), key, hash, bytes: bytes.len(), numbers };
            Rendered { name, entry, bytes: Some(bytes) }
        });
    }
    Ok(made)
}

/// Returns the names of the pictures that the job in a file makes, as its outputs say. A file that is no job has none;
/// it is refused when it is rendered.
pub(super) fn names(path: &Path) -> Vec<String> {
    let Some(mut outputs) = fs::read(path).ok().and_then(|bytes| peek::outputs(&bytes)) else { return Vec::new() };
    if outputs.is_empty() {
        outputs.push(NamedOutput { format: DEFAULT_FORMAT.to_owned(), name: None });
    }
    let outputs = outputs.iter().filter_map(|output| {
        let format = output::named(&output.format)?;
        Some((format, output.name.as_deref().unwrap_or(format.name())))
    });
    pictures(path, outputs).into_iter().map(|(_, name)| name).collect()
}

/// Returns the places of the pictures among the outputs of a job, which are given by format and name, and the names of
/// their files.
fn pictures<'a>(path: &Path, outputs: impl Iterator<Item = (&'static dyn Format, &'a str)>) -> Vec<(usize, String)> {
    let is_picture = |format: &dyn Format| {
        let media_type = format.media_type();
        media_type.starts_with("image/") || media_type == "application/pdf"
    };
    let stem = part(path.file_stem());
    let found: Vec<_> = outputs.enumerate().filter(|(_, (format, _))| is_picture(*format)).collect();
    let is_only = found.len() == 1;
    let named = |(i, (format, name)): (usize, (&dyn Format, &str))| {
        let extension = format.extension();
        (i, if is_only { format!("{stem}.{extension}") } else { format!("{stem}-{name}.{extension}") })
    };
    found.into_iter().map(named).collect()
}

/// Returns a part of a path as text.
pub(super) fn part(of: Option<&OsStr>) -> String {
    of.unwrap_or_default().to_string_lossy().into_owned()
}

/// Checks a job and admits it within the default limits.
pub(super) fn admitted(request: JobRequest) -> Result<Admitted, CliError> {
    let loaded = Loaded { request, is_file: false, format: None };
    loaded.admit(&JobOptions::default(), &Limits::default())
}

/// Renders an output and returns its bytes.
pub(super) fn bytes(admitted: &Admitted, output: usize) -> Result<Vec<u8>, CliError> {
    let output = &admitted.job().outputs[output];
    let mut bytes = Vec::new();
    match run(admitted, output, &mut bytes, &Watch::new()) {
        Ok(_) => Ok(bytes),
        Err(RunError::Impossible(fault)) => {
            let options = JobOptions::default();
            let translator = FaultTranslator { flags: &options.flags, is_file: false, format: None };
            Err(translator.refused(vec![admitted.job().entries(output).fault(fault)]))
        }
        Err(error) => Err(CliError::other(error)),
    }
}

/// Measures the shapes that a job shows; shapes that cannot be measured are skipped.
fn measured(request: &JobRequest) -> BTreeMap<String, Value> {
    let mut found = BTreeMap::new();
    let panels = request.figure.iter().flat_map(|figure| &figure.panels).map(|panel| &panel.job);
    for (n, panel) in panels.enumerate() {
        measure(&format!("panel {n}"), panel, &mut found);
    }
    if request.figure.is_none() {
        measure("", request, &mut found);
    }
    found
}

fn measure(of: &str, request: &JobRequest, found: &mut BTreeMap<String, Value>) {
    let mut request = request.clone();
    request.outputs = output::named("stats").map(|stats| OutputRequest::of_format(stats.name())).into_iter().collect();
    let stats = admitted(request).and_then(|admitted| bytes(&admitted, 0));
    let stats: Option<Value> = stats.ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    stats.into_iter().for_each(|stats| numbers(of, &stats, found));
}
