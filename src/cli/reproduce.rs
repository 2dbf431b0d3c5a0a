//! `planish reproduce`: renders files again from the job descriptions in them, and compares the bytes.

use std::path::PathBuf;
use std::sync::Arc;

use super::error::{CliError, ExitKind};
use super::inputs::{InputSource, inputs};
use super::job::{JobOptions, Loaded};
use super::say::answer;
use super::sniff::sniffed;
use crate::input::{self, Alone};
use crate::job::key::{RESULTS_VERSION, content};
use crate::job::limits::Limits;
use crate::job::run;
use crate::output::description::description;
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::described::Description;
use crate::wire::posted::uploads_of;
use crate::wire::read::{ReadError, read};
use crate::wire::text::MeshFile;

/// What is made again.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ReproduceOptions {
    /// Files that were rendered with the option `describe`.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The mesh file of jobs that name an upload, which their files do not hold.
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// Print nothing; the exit code tells.
    #[arg(short, long)]
    quiet: bool,
}

impl ReproduceOptions {
    /// Prints for each file whether it was reproduced exactly, and fails with code 1 if one was not.
    pub(super) fn reproduce(&self) -> Result<(), CliError> {
        let (mut is_same, mut worst) = (true, None);
        for source in &inputs(&self.files)? {
            match self.difference(source) {
                Ok(found) => {
                    is_same &= found.is_none();
                    if !self.quiet {
                        let said = found.unwrap_or_else(|| "the same bytes".to_owned());
                        answer(format!("{source}: {said}\n").as_bytes())?;
                    }
                }
                Err(error) => {
                    eprintln!("planish: {source}: {error}");
                    worst = worst.max(Some(error.kind));
                }
            }
        }
        match worst {
            Some(kind) => Err(CliError::printed(kind)),
            None if is_same => Ok(()),
            None => Err(CliError::printed(ExitKind::Other)),
        }
    }

    /// Renders a file again and describes the difference; `None` if the bytes are the same.
    fn difference(&self, source: &InputSource) -> Result<Option<String>, CliError> {
        let bytes = source.read()?;
        let said = description(&bytes).ok_or_else(|| {
            CliError::refused("it does not say of which job it is; render it with the option \"describe\" (--describe)")
        })?;
        let said: Description = read(said.as_bytes()).map_err(unread)?;
        let version = said.results_version;
        let text = said.job.to_string();
        let mut request: JobRequest = read(text.as_bytes()).map_err(unread)?;
        for named in uploads_of(text.as_bytes()) {
            let file = self.upload(&named.id)?;
            request.attach(named.place, file);
        }
        request.source = Some(text.into());
        let admitted =
            Loaded { request, is_file: false, format: None }.admit(&JobOptions::default(), &Limits::default());
        let (admitted, mut made) = (admitted?, Vec::new());
        run(&admitted, &admitted.job().outputs[0], &mut made, &Watch::new()).map_err(CliError::refused)?;
        let given = without_library(&bytes, &made);
        if given == made {
            return Ok(None);
        }
        let same = given.iter().zip(&made).take_while(|(a, b)| a == b).count();
        let other = if version == RESULTS_VERSION {
            String::new()
        } else {
            format!("; it was made by version {version} of the results, this is version {RESULTS_VERSION}")
        };
        Ok(Some(format!("differs from byte {same} on ({} bytes, made again {}){other}", given.len(), made.len())))
    }

    /// Reads the file of an upload that a job names.
    fn upload(&self, id: &str) -> Result<MeshFile, CliError> {
        let needed = || CliError::refused(format!("its job names the upload {id}; give that file with --input"));
        let source = InputSource::of(self.input.as_ref().ok_or_else(needed)?);
        let bytes = source.read().map_err(|error| error.about(&source))?;
        let found = format!("b3-{}", content(&bytes));
        if found != id {
            return Err(CliError::refused(format!("its job names the upload {id}, and {source} is {found}")));
        }
        let by_name = source.extension().and_then(input::of_extension).map(|reader| reader.name);
        let format = by_name.map_or_else(|| sniffed(&bytes).map_err(CliError::refused), Ok)?;
        Ok(MeshFile { format: format.to_owned(), bytes, beside: Arc::new(Alone) })
    }
}

/// Removes the line that names the material library of an OBJ file; `planish render` adds it, and it is not part of the
/// artifact.
fn without_library<'a>(given: &'a [u8], made: &[u8]) -> &'a [u8] {
    let end = given.iter().position(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    if given.starts_with(b"mtllib ") && !made.starts_with(b"mtllib ") { &given[end..] } else { given }
}

fn unread(error: ReadError) -> CliError {
    let detail = "it says of a job that this version cannot read";
    match error {
        ReadError::NotJson(why) => CliError::refused(format!("{detail}: {why}")),
        ReadError::Unfit(faults) => {
            CliError::refused(format!("{detail}: {}", faults.first().map_or_else(String::new, ToString::to_string)))
        }
    }
}
