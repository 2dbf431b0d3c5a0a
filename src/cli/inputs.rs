//! The inputs of a command: files, patterns of file names, standard input.

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::CliError;
use crate::input;

/// Most inputs of one command. A hundred thousand names are some ten megabytes, and more files than folders of meshes
/// have; with half of it a large collection would have to be split, twice as many take a folder tree too many.
const MOST_INPUTS: usize = 100_000;

/// One input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Source {
    /// Standard input.
    Standard,
    /// A file.
    File(PathBuf),
}

impl Source {
    /// What an argument that is no pattern names.
    pub(super) fn of(argument: &Path) -> Self {
        if argument == Path::new("-") { Self::Standard } else { Self::File(argument.to_owned()) }
    }

    /// The path of the file; that of standard input has only a stem.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Standard => Path::new("stdin"),
            Self::File(path) => path,
        }
    }

    /// The extension, as far as it is text.
    pub(super) fn extension(&self) -> Option<&str> {
        self.path().extension().and_then(|extension| extension.to_str())
    }

    /// All that it holds.
    pub(super) fn read(&self) -> Result<Vec<u8>, CliError> {
        let mut bytes = Vec::new();
        let read = match self {
            Self::Standard => std::io::stdin().read_to_end(&mut bytes).map(drop),
            Self::File(path) if path.is_dir() => {
                let detail = format!("it is a folder; name its files, as in '{}/*.obj'", path.display());
                return Err(CliError::files(detail));
            }
            Self::File(path) => std::fs::read(path).map(|found| bytes = found),
        };
        read.map(|()| bytes).map_err(|error| CliError::files(format!("cannot be read: {error}")))
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => f.write_str("standard input"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// The inputs that arguments name, each once. What is no file and has `*`, `?` or `[` is a pattern, for shells that
/// hand patterns on.
pub(super) fn inputs(arguments: &[PathBuf]) -> Result<Vec<Source>, CliError> {
    let mut found: Vec<Source> = Vec::new();
    for argument in arguments {
        let pattern = argument.to_str().filter(|text| text.contains(['*', '?', '[']) && !argument.exists());
        match pattern {
            Some(pattern) => found.extend(matching(pattern)?.map(Source::File)),
            None => found.push(Source::of(argument)),
        }
        if found.len() > MOST_INPUTS {
            let detail = format!("more than {MOST_INPUTS} inputs; name fewer at once");
            return Err(CliError::usage(detail));
        }
    }
    let mut seen = std::collections::HashSet::new();
    found.retain(|source| seen.insert(source.path().to_owned()));
    Ok(found)
}

/// As [`inputs`], where folders stand for the jobs and mesh files in them, in the order of their names.
pub(super) fn jobs_and_meshes(arguments: &[PathBuf]) -> Result<Vec<Source>, CliError> {
    let mut all = Vec::new();
    for argument in arguments {
        if argument.is_dir() { all.extend(within(argument)?) } else { all.push(argument.clone()) }
    }
    inputs(&all)
}

/// The jobs and mesh files in a folder, by their extensions, in the order of their names.
fn within(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let cannot = |error| CliError::files(format!("{}: cannot be read: {error}", folder.display()));
    let is_input = |path: &PathBuf| {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        path.is_file() && (extension.eq_ignore_ascii_case("json") || input::of_extension(extension).is_some())
    };
    let entries = std::fs::read_dir(folder).map_err(cannot)?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_input).collect();
    found.sort();
    if found.is_empty() {
        let detail = "there are no jobs or mesh files in the folder; those of folders in it are named by a pattern";
        return Err(CliError::files(format!("{}: {detail}, as in '{0}/*/*.obj'", folder.display())));
    }
    Ok(found)
}

/// The files that a pattern names, in the order of their names.
fn matching(pattern: &str) -> Result<impl Iterator<Item = PathBuf>, CliError> {
    let paths = glob::glob(pattern).map_err(|error| CliError::usage(format!("the pattern {pattern}: {error}")))?;
    let files: Vec<PathBuf> = paths.flatten().filter(|path| path.is_file()).take(MOST_INPUTS + 1).collect();
    if files.is_empty() {
        return Err(CliError::files(format!("no file has a name like {pattern}")));
    }
    Ok(files.into_iter())
}
