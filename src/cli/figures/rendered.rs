//! The rendering of one job of a folder to its pictures.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::manifest::{Entry, Manifest, hash, numbers};
use crate::cli::error::CliError;
use crate::cli::inputs::Source;
use crate::cli::job::{JobOptions, Loaded};
use crate::cli::told::Teller;
use crate::job::limits::{Admitted, Limits};
use crate::job::{RunError, run};
use crate::output;
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::output::OutputRequest;

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
    let Loaded { mut request, is_file, .. } = JobOptions::default().load(&Source::File(path.to_owned()))?;
    if is_file {
        return Err(CliError::refused("it is no job; a folder of figures holds jobs (JSON)"));
    }
    if request.outputs.is_empty() {
        request.outputs = vec![OutputRequest::of_format("png")];
    }
    Ok(request)
}

/// Renders the pictures of a job; skips pictures that `folder` has already with the same key in the manifest.
pub(super) fn render(path: &Path, known: &Manifest, folder: Option<&Path>) -> Result<Vec<Rendered>, CliError> {
    let request = load(path)?;
    let part = |of: Option<&std::ffi::OsStr>| of.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, job) = (part(path.file_stem()), part(path.file_name()));
    let admitted = admitted(request.clone())?;
    let pictures: Vec<usize> = (0..admitted.job().outputs.len()).filter(|&i| is_picture(&admitted, i)).collect();
    if pictures.is_empty() {
        return Err(CliError::refused("it asks for no picture; pictures are png, apng, svg, ..."));
    }
    let mut all_numbers = None;
    let mut made = Vec::with_capacity(pictures.len());
    for &i in &pictures {
        let (asked, key) = (&admitted.job().outputs[i], admitted.job().keys()[i].to_string());
        let extension = asked.format.extension();
        let name = if pictures.len() == 1 {
            format!("{stem}.{extension}")
        } else {
            format!("{stem}-{}.{extension}", asked.name)
        };
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

fn is_picture(admitted: &Admitted, output: usize) -> bool {
    let media_type = admitted.job().outputs[output].format.media_type();
    media_type.starts_with("image/") || media_type == "application/pdf"
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
            let teller = Teller { flags: &options.flags, is_file: false, format: None };
            Err(teller.refused(vec![admitted.job().entries(output).fault(fault)]))
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
