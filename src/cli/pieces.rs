//! The outputs that a command makes: one output of an input each, with its target file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::CliError;
use super::inputs::InputSource;
use super::job::{JobOptions, OutputChoice};
use super::peek::{self, NamedOutput};
use super::targets::{Target, keep_apart};
use crate::output;

/// An output of an input, and its target file; `None` is standard output.
#[derive(Debug, Clone)]
pub(super) struct OutputTarget {
    pub(super) source: InputSource,
    pub(super) target: Option<PathBuf>,
    pub(super) wanted: OutputChoice,
}

/// Returns one output of each input, of the same format or the input's only one; if the target is a folder and no
/// format is given, returns all outputs that the jobs name.
///
/// # Errors
/// When two outputs would have the same file, an output would overwrite an input, or a mesh file, which names no
/// outputs, is to be rendered to a folder without a given format.
pub(super) fn pieces(
    sources: &[InputSource],
    target: &Target,
    wanted: OutputChoice,
    options: &JobOptions,
) -> Result<Vec<OutputTarget>, CliError> {
    let mut found = Vec::with_capacity(sources.len());
    for source in sources {
        match target {
            Target::Folder(folder) => found.extend(named(source, folder, options)?),
            _ => found.push(OutputTarget { source: source.clone(), target: target.of(source), wanted }),
        }
    }
    let files = found.iter().filter_map(|piece| Some((piece.target.as_deref()?, &piece.source)));
    keep_apart(files)?;
    Ok(found)
}

/// Returns the outputs that a job names, as files in a folder: the name of the job with the extension of each output,
/// numbered if several have the same extension.
fn named(source: &InputSource, folder: &Path, options: &JobOptions) -> Result<Vec<OutputTarget>, CliError> {
    let stem = source.path().file_stem().unwrap_or_default().to_string_lossy();
    let piece = |name: String, wanted| {
        let target = Some(folder.join(name));
        OutputTarget { source: source.clone(), target, wanted }
    };
    // An unreadable input is reported later, when it is rendered.
    let unread = || vec![piece(stem.clone().into_owned(), OutputChoice::Only)];
    if matches!(source, InputSource::Standard) {
        return Err(no_format(source));
    }
    let Ok(bytes) = source.read() else { return Ok(unread()) };
    match options.kind(source, &bytes) {
        Ok("job") => {}
        Ok(_) => return Err(no_format(source)),
        Err(_) => return Ok(unread()),
    }
    let extensions = extensions(&bytes);
    if extensions.is_empty() {
        return Ok(unread());
    }
    let mut met: BTreeMap<&str, usize> = BTreeMap::new();
    let pieces = extensions.into_iter().enumerate().map(|(at, extension)| {
        let number = met.entry(extension).and_modify(|number| *number += 1).or_insert(1);
        let name = if *number > 1 { format!("{stem}-{number}.{extension}") } else { format!("{stem}.{extension}") };
        piece(name, OutputChoice::At(at))
    });
    Ok(pieces.collect())
}

/// Returns the extensions of the outputs that a job names; empty if the job cannot be read or names an unknown format.
fn extensions(job: &[u8]) -> Vec<&'static str> {
    let extension = |output: NamedOutput| Some(output::named(&output.format)?.extension());
    peek::outputs(job).and_then(|outputs| outputs.into_iter().map(extension).collect()).unwrap_or_default()
}

fn no_format(source: &InputSource) -> CliError {
    CliError::usage(format!(
        "--output: a folder does not tell the format, nor does {source}; name one, as in --format glb, or give a \
         pattern, as in -o 'out/{{stem}}.glb'"
    ))
}
