//! The targets of outputs: standard output, files, folders and patterns.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use super::error::CliError;
use super::inputs::InputSource;
use crate::output::{self, FORMATS, Format};

/// The placeholders of patterns for parts of the path of an input: the name without extension, the name, and the
/// folder.
const PLACEHOLDERS: [&str; 3] = ["stem", "name", "dir"];

/// The target of the outputs of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Target {
    /// Standard output.
    Standard,
    /// One file.
    File(PathBuf),
    /// One file for each input: a path with placeholders.
    Pattern(String),
    /// A folder, with files in the formats that the jobs name.
    Folder(PathBuf),
}

impl Target {
    /// Interprets the argument of `-o` for the given number of inputs; `open` tells whether folders or patterns named
    /// them, so that their number may change. `format` is the format of `--format`.
    pub(super) fn new(
        path: &Path,
        (inputs, open): (usize, bool),
        format: Option<&'static dyn Format>,
    ) -> Result<Self, CliError> {
        if path == Path::new("-") {
            return match inputs {
                1 => Ok(Self::Standard),
                _ => Err(CliError::usage("--output: several inputs cannot go to standard output; give a folder")),
            };
        }
        let text = path.to_str();
        if let Some(pattern) = text.filter(|text| text.contains('{')) {
            check(pattern)?;
            return Ok(Self::Pattern(pattern.to_owned()));
        }
        let says_folder = text.is_some_and(|text| text.ends_with(std::path::is_separator)) || path.is_dir();
        let is_format = path.extension().and_then(|e| e.to_str()).is_some_and(|e| of_extension(e).is_some());
        if !says_folder && inputs == 1 && (is_format || !open) {
            return Ok(Self::File(path.to_owned()));
        }
        if !says_folder && is_format {
            let detail = format!(
                "--output: {inputs} inputs cannot go to the one file {}; give a folder, as in -o out/ --format glb, \
                 or a pattern, as in -o 'out/{{stem}}.glb'",
                path.display()
            );
            return Err(CliError::usage(detail));
        }
        let (Some(format), Some(text)) = (format, text) else { return Ok(Self::Folder(path.to_owned())) };
        let folder = text.trim_end_matches(std::path::is_separator);
        let root = if folder.is_empty() { "/" } else { "" };
        Ok(Self::Pattern(format!("{root}{folder}/{{stem}}.{}", format.extension())))
    }

    /// Returns whether missing folders are created for the files.
    pub(super) fn makes_folders(&self) -> bool {
        matches!(self, Self::Pattern(_) | Self::Folder(_))
    }

    /// Returns the extension of the files, if the target determines it.
    pub(super) fn extension(&self) -> Option<&str> {
        let path = match self {
            Self::Standard | Self::Folder(_) => return None,
            Self::File(path) => path.as_path(),
            Self::Pattern(pattern) => Path::new(pattern),
        };
        path.extension().and_then(|extension| extension.to_str())
    }

    /// Returns the file of an input; `None` for standard output, and for a folder without a format.
    pub(super) fn of(&self, input: &InputSource) -> Option<PathBuf> {
        match self {
            Self::Standard | Self::Folder(_) => None,
            Self::File(path) => Some(path.clone()),
            Self::Pattern(pattern) => Some(filled(pattern, input.path()).into()),
        }
    }
}

/// Replaces the placeholders of a pattern by parts of a path; components such as `..` are removed from its folder.
fn filled(pattern: &str, path: &Path) -> String {
    let inner = path.parent().into_iter().flat_map(Path::components);
    let inner: PathBuf = inner.filter(|part| matches!(part, Component::Normal(_))).collect();
    let parts = [path.file_stem(), path.file_name(), Some(inner.as_os_str())];
    let part = |name: &str| {
        let at = PLACEHOLDERS.iter().position(|known| *known == name)?;
        let text = parts[at].unwrap_or_default().to_string_lossy();
        Some(if text.is_empty() { ".".to_owned() } else { text.into_owned() })
    };
    let mut pieces = pattern.split('{');
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces
        .filter_map(|piece| piece.split_once('}'))
        .fold(first, |text, (name, rest)| text + &part(name).unwrap_or_default() + rest)
}

/// Returns the format for a file extension, case-insensitively: the format of that name, else the first with that
/// extension.
pub(super) fn of_extension(extension: &str) -> Option<&'static dyn Format> {
    let extension = extension.to_ascii_lowercase();
    let by_extension = || FORMATS.iter().copied().find(|format| format.extension() == extension);
    output::named(&extension).or_else(by_extension)
}

/// Checks that all placeholders of a pattern are closed and known.
fn check(pattern: &str) -> Result<(), CliError> {
    let known = "{stem} (name without extension), {name} (name), {dir} (folder)";
    for rest in pattern.split('{').skip(1) {
        let Some((name, _)) = rest.split_once('}') else {
            let detail = format!("--output: the placeholder {{{rest} has no closing brace; known are {known}");
            return Err(CliError::usage(detail));
        };
        if !PLACEHOLDERS.contains(&name) {
            return Err(CliError::usage(format!("--output: there is no placeholder {{{name}}}; known are {known}")));
        }
    }
    Ok(())
}

/// Checks that all target files are different, and that none of them is an input.
///
/// # Errors
/// Names the first two inputs with the same target file, or the input that would be overwritten.
pub(super) fn keep_apart<'a>(files: impl Iterator<Item = (&'a Path, &'a InputSource)> + Clone) -> Result<(), CliError> {
    let mut taken: HashMap<PathBuf, &InputSource> = HashMap::new();
    for (target, input) in files.clone() {
        if let Some(other) = taken.insert(target.components().collect(), input) {
            let detail = format!(
                "{other} and {input} would both become {}; tell them apart, as in -o 'out/{{name}}.glb' or \
                 -o 'out/{{dir}}/{{stem}}.glb'; nothing was rendered",
                target.display()
            );
            return Err(CliError::usage(detail));
        }
    }
    let real = |path: &Path| path.canonicalize().ok();
    let read: HashMap<PathBuf, &InputSource> =
        files.clone().filter_map(|(_, input)| Some((real(input.path())?, input))).collect();
    let hit = files.map(|(target, _)| target).find_map(|target| Some((target, read.get(&real(target)?)?)));
    hit.map_or(Ok(()), |(target, input)| {
        let detail = format!(
            "the output {} would take the place of the input {input}; give it another place; nothing was rendered",
            target.display()
        );
        Err(CliError::usage(detail))
    })
}
