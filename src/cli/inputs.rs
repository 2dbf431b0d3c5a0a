//! The inputs of a command: files, patterns of file names, standard input.

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::CliError;
use crate::input;

/// Maximum number of inputs of one command. A hundred thousand names take some ten megabytes, and folders of meshes
/// have fewer files; half of it would split large collections, twice of it would accept a folder tree named by mistake.
const MAX_INPUTS: usize = 100_000;

/// One input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum InputSource {
    /// Standard input.
    Standard,
    /// A file.
    File(PathBuf),
}

impl InputSource {
    /// Returns the input named by an argument that is not a pattern.
    pub(super) fn of(argument: &Path) -> Self {
        if argument == Path::new("-") { Self::Standard } else { Self::File(argument.to_owned()) }
    }

    /// Returns the path of the file; for standard input, a path that consists of a stem only.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Standard => Path::new("stdin"),
            Self::File(path) => path,
        }
    }

    /// Returns the extension, if it is valid text.
    pub(super) fn extension(&self) -> Option<&str> {
        self.path().extension().and_then(|extension| extension.to_str())
    }

    /// Reads the whole input.
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

impl fmt::Display for InputSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => f.write_str("standard input"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// Returns the inputs named by the arguments, without duplicates. An argument that is not an existing file and contains
/// `*`, `?` or `[` is a pattern, for shells that do not expand patterns.
pub(super) fn inputs(arguments: &[PathBuf]) -> Result<Vec<InputSource>, CliError> {
    let mut found: Vec<InputSource> = Vec::new();
    for argument in arguments {
        let pattern = argument.to_str().filter(|text| text.contains(['*', '?', '[']) && !argument.exists());
        match pattern {
            Some(pattern) => found.extend(matching(pattern)?.map(InputSource::File)),
            None => found.push(InputSource::of(argument)),
        }
        if found.len() > MAX_INPUTS {
            return Err(CliError::usage(format!("more than {MAX_INPUTS} inputs; name fewer at once")));
        }
    }
    let mut seen = std::collections::HashSet::new();
    found.retain(|source| seen.insert(source.path().to_owned()));
    Ok(found)
}

/// Returns the inputs like [`inputs`], but expands folders to the jobs and mesh files in them, sorted by name.
pub(super) fn jobs_and_meshes(arguments: &[PathBuf]) -> Result<Vec<InputSource>, CliError> {
    let mut all = Vec::new();
    for argument in arguments {
        if argument.is_dir() { all.extend(within(argument)?) } else { all.push(argument.clone()) }
    }
    inputs(&all)
}

/// Returns the jobs and mesh files in a folder, recognised by their extensions and sorted by name.
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

/// Returns the files that match a pattern, sorted by name.
fn matching(pattern: &str) -> Result<impl Iterator<Item = PathBuf>, CliError> {
    let paths = glob::glob(pattern).map_err(|error| CliError::usage(format!("the pattern {pattern}: {error}")))?;
    let files: Vec<PathBuf> = paths.flatten().filter(|path| path.is_file()).take(MAX_INPUTS + 1).collect();
    if files.is_empty() {
        return Err(CliError::files(format!("no file has a name like {pattern}")));
    }
    Ok(files.into_iter())
}
