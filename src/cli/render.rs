//! `planish render`: renders jobs and mesh files to files.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use rayon::ThreadPoolBuilder;

use super::elsewhere::{RemoteRender, ServerOptions};
use super::error::CliError;
use super::fault_translator::FaultTranslator;
use super::files::Files;
use super::inputs::{InputSource, jobs_and_meshes};
use super::job::{JobOptions, Loaded, OutputChoice};
use super::library::CompanionFiles;
use super::pieces::{OutputTarget, pieces};
use super::progress::Progress;
use super::targets::{Target, of_extension};
use crate::fault::{did_you_mean, shortened};
use crate::job::limits::{Admitted, Limits};
use crate::job::{Report, RunError, run};
use crate::output::{self, FORMATS, Format};
use crate::watch::Watch;

/// Maximum estimated time of a job, in milliseconds, that runs on the calling thread alone. Starting a thread takes 25
/// us (measured), and memory. Half of it would start threads for more jobs; with twice of it the longest such jobs
/// would take up to 4 ms more than with several cores.
const ALONE_MS: u128 = 4;

/// What is rendered, and where to.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct RenderOptions {
    /// Jobs (JSON) or mesh files (obj, ply, stl, off, gltf, glb, 3mf, usda, json), or folders of them; - is standard
    /// input, and patterns like 'parts/*.obj' are looked up here where the shell does not.
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// The file to write; a folder (out/), where jobs have all outputs that they name unless --format says which, or a
    /// pattern (out/{stem}.glb) with {stem}, {name} and {dir} of each input; - is standard output.
    #[arg(short, long, value_name = "FILE|DIR|PATTERN")]
    output: PathBuf,
    /// Format of the output, where the extension does not tell.
    #[arg(long)]
    format: Option<String>,
    /// Most faces of a mesh at any level.
    #[arg(long, value_name = "FACES", value_parser = faces, conflicts_with = "server")]
    max_faces: Option<u64>,
    /// Say nothing but what fails: no bar, no notes, no summary.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    server: ServerOptions,
    #[command(flatten)]
    options: JobOptions,
}

impl RenderOptions {
    /// Renders all inputs; the failure of one does not stop the others.
    pub(super) fn render(&self) -> Result<(), CliError> {
        self.options.check()?;
        let format = self.format.as_deref().map(known).transpose()?;
        let sources = jobs_and_meshes(&self.inputs)?;
        let open = self.inputs.iter().any(|argument| !sources.contains(&InputSource::of(argument)));
        let place = Target::new(&self.output, (sources.len(), open), format)?;
        let wanted = wanted(&place, format)?;
        self.options.check_for(wanted)?;
        let pieces = pieces(&sources, &place, wanted, &self.options)?;
        let what = if pieces.len() > sources.len() { "outputs rendered" } else { "inputs rendered" };
        let mut progress = Progress::new(pieces.len(), self.quiet);
        if let Some(remote) = self.server.remote(self.quiet)? {
            let order = RemoteRender { pieces: &pieces, makes_folders: place.makes_folders(), options: &self.options };
            self.server.render(&remote, &order, &mut progress)?;
            return progress.end(what);
        }
        let limits = self.limits();
        for OutputTarget { source, target, wanted } in &pieces {
            let rendered = self.options.load(source).and_then(|mut loaded| {
                loaded.choose(*wanted, &self.options)?;
                let target = target.as_deref().map(|path| (path, place.makes_folders()));
                let task = InputRendering { source, target, options: &self.options, progress: &progress };
                task.render(loaded, &limits, pieces.len() == 1)
            });
            progress.done(source, rendered);
        }
        progress.end(what)
    }

    fn limits(&self) -> Limits {
        let default = Limits::default();
        let vertices = |faces: u64| faces.saturating_mul(2).min(u32::MAX.into());
        Limits {
            max_faces: self.max_faces.unwrap_or(default.max_faces),
            max_vertices: self.max_faces.map_or(default.max_vertices, vertices),
            max_output_bytes: if self.max_faces.is_some() { u64::MAX } else { default.max_output_bytes },
            ..default
        }
    }
}

/// Parses a number of faces.
fn faces(text: &str) -> Result<u64, &'static str> {
    text.parse().map_err(|_| "it is no whole number; write it like 20000000")
}

/// Returns the format of this name.
fn known(name: &str) -> Result<&'static dyn Format, CliError> {
    output::named(name).ok_or_else(|| {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name()).collect();
        let near = did_you_mean(name, names.iter().copied());
        let name = shortened(name);
        CliError::usage(format!("--format: there is no format \"{name}\"; {near}known are {}", names.join(", ")))
    })
}

/// Determines the format of the outputs from the flag, or from the extension of the target.
fn wanted(target: &Target, format: Option<&'static dyn Format>) -> Result<OutputChoice, CliError> {
    match (format, target.extension()) {
        (Some(format), _) => Ok(OutputChoice::Named(format)),
        (None, None) => Ok(OutputChoice::Only),
        (None, Some(extension)) => of_extension(extension).map(OutputChoice::Extension).ok_or_else(|| {
            let near = did_you_mean(extension, FORMATS.iter().map(|format| format.extension()));
            let detail =
                format!("--output: no format has the extension .{extension}; {near}name a format with --format");
            CliError::usage(detail)
        }),
    }
}

/// The rendering of one input.
struct InputRendering<'a> {
    source: &'a InputSource,
    /// The target file, and whether missing folders are created for it; `None` is standard output.
    target: Option<(&'a Path, bool)>,
    options: &'a JobOptions,
    progress: &'a Progress,
}

impl InputRendering<'_> {
    /// Renders a job. If it is the only one of the command and short, it runs on the calling thread alone.
    fn render(&self, loaded: Loaded, limits: &Limits, is_only: bool) -> Result<(), CliError> {
        let (is_file, format) = (loaded.is_file, loaded.format);
        let admitted = loaded.admit(self.options, limits)?;
        let is_short = is_only && admitted.estimate().time_ms <= ALONE_MS;
        let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().map_err(CliError::other);
        let _pool = is_short.then(alone).transpose()?;
        let translator = FaultTranslator { flags: &self.options.flags, is_file, format };
        if self.target.is_none() && admitted.job().detail_keys().next().is_some() {
            return Err(CliError::usage("--output: levels of detail are files beside the document; give it a file"));
        }
        let report = match self.target {
            None => self.write(&admitted, &translator, &mut io::stdout().lock())?,
            Some((target, makes_folders)) => {
                let folder = target.parent().filter(|folder| makes_folders && !folder.as_os_str().is_empty());
                let made = folder.map_or(Ok(()), std::fs::create_dir_all);
                made.map_err(|error| {
                    CliError::files(format!("cannot make a folder for {}: {error}", target.display()))
                })?;
                let library = CompanionFiles::of(&admitted, target);
                let mut files = Files::default();
                let report =
                    to_file(&mut files, target, library.as_ref(), |out| self.write(&admitted, &translator, out))?;
                self.write_details(&admitted, &translator, (&mut files, target), limits)?;
                files.finish().map_err(|error| unwritten(target, &error))?;
                report
            }
        };
        if let Some(reached) = admitted.job().reached {
            let text = match reached.bound {
                Some(bound) => format!("level {} is at most {bound} from the limit", reached.level),
                None => format!("level {} has faces of about a pixel", reached.level),
            };
            self.progress.note(self.source, &text);
        }
        report.warnings.iter().for_each(|warning| self.progress.note(self.source, warning));
        Ok(())
    }

    /// Writes the files beside the output that it refers to.
    fn write_details(
        &self,
        admitted: &Admitted,
        translator: &FaultTranslator<'_>,
        (files, target): (&mut Files, &Path),
        limits: &Limits,
    ) -> Result<(), CliError> {
        let job = admitted.job();
        for detail in job.details(&job.outputs[0]) {
            let name = format!("{}.{}", detail.keys()[0], detail.outputs[0].format.extension());
            let detail = limits.admit(detail).map_err(|refusal| translator.not_admitted(refusal))?;
            to_file(files, &target.with_file_name(name), None, |out| self.write(&detail, translator, out))?;
        }
        Ok(())
    }

    /// Runs the job.
    fn write(
        &self,
        admitted: &Admitted,
        translator: &FaultTranslator<'_>,
        out: &mut dyn Write,
    ) -> Result<Report, CliError> {
        let watch = Watch::new();
        let output = &admitted.job().outputs[0];
        let work = admitted.estimate().forecast.work;
        let report = self.progress.during(&watch, work, || run(admitted, output, out, &watch));
        report.map_err(|error| match error {
            RunError::Impossible(fault) => translator.refused(vec![admitted.job().entries(output).fault(fault)]),
            RunError::Io(error) => CliError::files(format!("cannot write the result: {error}")),
            RunError::Stopped(stopped) => CliError::other(stopped),
        })
    }
}

/// Writes the file of an output, and its material library.
fn to_file(
    files: &mut Files,
    target: &Path,
    library: Option<&CompanionFiles<'_>>,
    write: impl FnOnce(&mut dyn Write) -> Result<Report, CliError>,
) -> Result<Report, CliError> {
    let cannot = |error: io::Error| unwritten(target, &error);
    let mut out = BufWriter::with_capacity(1 << 20, files.create(target).map_err(cannot)?);
    if let Some(library) = library {
        out.write_all(library.line().as_bytes()).map_err(cannot)?;
    }
    let report = write(&mut out)?;
    out.flush().map_err(cannot)?;
    drop(out);
    let Some(library) = library else { return Ok(report) };
    library.write(files).map_err(cannot)?;
    Ok(Report { warnings: library.warnings(report.warnings) })
}

fn unwritten(target: &Path, error: &io::Error) -> CliError {
    CliError::files(format!("cannot write {}: {error}", target.display()))
}
