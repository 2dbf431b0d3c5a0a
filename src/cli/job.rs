//! Jobs from inputs: read from JSON, or made of a mesh file and flags.

use std::path::PathBuf;
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};

use super::error::{CliError, ExitKind};
use super::fault_translator::FaultTranslator;
use super::flags::JobFlags;
use super::folder::InputFolder;
use super::inputs::InputSource;
use super::sniff::sniffed;
use crate::fault::{did_you_mean, under};
use crate::input::{self, Alone, Beside};
use crate::job::limits::{Admitted, Limits};
use crate::output::{self, FORMATS, Format};
use crate::scheme::plan::{Plan, Subject};
use crate::wire::JobRequest;
use crate::wire::catalogue::readers;
use crate::wire::output::OutputRequest;
use crate::wire::read::read;
use crate::wire::text::MeshFile;

/// What a mesh file does not say by itself, and what takes the place of what a job says.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct JobOptions {
    /// Kind of the inputs, where neither extension nor content tells: job, json (a mesh), obj, ply, ...
    #[arg(long, value_name = "KIND", help_heading = "Input")]
    input_format: Option<String>,
    /// Job, or mesh file, from whose surface pictures with `--shading distance` measure, in place of the control net.
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    distance_to: Option<PathBuf>,
    #[command(flatten)]
    pub(super) flags: JobFlags,
}

/// A job that was read.
#[derive(Debug)]
pub(super) struct Loaded {
    /// The request of the job.
    pub(super) request: JobRequest,
    /// Whether the job was made of a mesh file.
    pub(super) is_file: bool,
    /// The flag that determines the format, if any.
    pub(super) format: Option<&'static str>,
}

/// The bytes of a mesh file, and their media type.
pub(super) type MediaFile = (Vec<u8>, &'static str);

/// Which output to render.
#[derive(Debug, Clone, Copy)]
pub(super) enum OutputChoice {
    /// The only output of the job.
    Only,
    /// The output of the job with this index.
    At(usize),
    /// The format named by a flag.
    Named(&'static dyn Format),
    /// A requested output of the job with the same file extension as this format, else this format.
    Extension(&'static dyn Format),
}

impl JobOptions {
    /// Checks everything that does not depend on an input.
    pub(super) fn check(&self) -> Result<(), CliError> {
        let known: Vec<&str> = readers().iter().map(|reader| reader.name).chain(["job"]).collect();
        if let Some(kind) = self.input_format.as_deref().filter(|kind| !known.contains(kind)) {
            let near = did_you_mean(kind, known.iter().copied());
            let detail = format!("--input-format: there is no kind \"{kind}\"; {near}known are {}", known.join(", "));
            return Err(CliError::usage(detail));
        }
        let job = self.whole(json!({ "input": {} }))?;
        let usage = |error: CliError| CliError { kind: ExitKind::Usage, ..error };
        let translator = FaultTranslator { flags: &self.flags, is_file: true, format: None };
        let request: JobRequest = read(job.to_string().as_bytes()).map_err(|error| usage(translator.unread(error)))?;
        // Whether a scheme fits its input depends on the input.
        let Some(plan) = request.plan.filter(|plan| plan.preset.is_some() || plan.word.is_some()) else {
            return Ok(());
        };
        let plan = plan.resolve();
        let under = |faults| usage(translator.refused(under("/plan", faults)));
        let polygons = Plan::resolve(&plan, Subject::default());
        polygons
            .map(drop)
            .or_else(|_| Plan::resolve(&plan, Subject { is_mesh: true, ..Subject::default() }).map(drop))
            .map_err(under)
    }

    /// Checks the output options of the flags, if the format is known.
    pub(super) fn check_for(&self, wanted: OutputChoice) -> Result<(), CliError> {
        let (OutputChoice::Named(format) | OutputChoice::Extension(format)) = wanted else { return Ok(()) };
        let translator = FaultTranslator { flags: &self.flags, is_file: true, format: Some("--format") };
        let is_meant = |other: &&&dyn Format| match wanted {
            OutputChoice::Extension(_) => other.extension() == format.extension(),
            _ => other.name() == format.name(),
        };
        let mut wrong = None;
        for format in FORMATS.iter().filter(is_meant) {
            let mut output = OutputRequest::of_format(format.name());
            self.flagged_output(&mut output)?;
            match output.check() {
                Ok(()) => return Ok(()),
                Err(faults) => wrong = wrong.or(Some(faults)),
            }
        }
        let refused = |faults| translator.refused(under("/outputs/0", faults));
        wrong.map_or(Ok(()), |faults| Err(CliError { kind: ExitKind::Usage, ..refused(faults) }))
    }

    /// Writes the output options of the flags into an output.
    fn flagged_output(&self, output: &mut OutputRequest) -> Result<(), CliError> {
        for (name, value) in &self.flags.options {
            output.set(name, serde_json::from_value(value.clone()).map_err(CliError::usage)?);
        }
        Ok(())
    }

    /// Reads an input and makes its job.
    pub(super) fn load(&self, source: &InputSource) -> Result<Loaded, CliError> {
        self.read(source, source.read()?)
    }

    /// Returns the kind of an input with these bytes: from `--input-format`, the extension, or the contents.
    pub(super) fn kind(&self, source: &InputSource, bytes: &[u8]) -> Result<&str, CliError> {
        let by_name = || source.extension().and_then(input::of_extension).map(|reader| reader.name);
        match &self.input_format {
            Some(kind) => Ok(kind),
            None => by_name().map_or_else(|| sniffed(bytes).map_err(CliError::refused), Ok),
        }
    }

    /// Returns the job of an input as JSON with its one output. If the input is a mesh file, also returns its bytes and
    /// media type; the job then has no mesh yet.
    pub(super) fn job_json(
        &self,
        source: &InputSource,
        wanted: OutputChoice,
    ) -> Result<(Value, Option<MediaFile>), CliError> {
        let bytes = source.read()?;
        let kind = self.kind(source, &bytes)?.to_owned();
        let is_file = kind != "job";
        let mut job = if is_file { json!({ "input": {} }) } else { Value::Null };
        let mut loaded = self.read(source, bytes.clone())?;
        loaded.choose(wanted, self)?;
        if !is_file {
            job = serde_json::from_slice(&bytes).map_err(CliError::refused)?;
        }
        job = self.whole(job)?;
        job["outputs"] = json!([loaded.request.outputs[0].to_json()]);
        let media_type = input::named(&kind).map_or("application/json", |reader| reader.media_type);
        Ok((job, is_file.then_some((bytes, media_type))))
    }

    /// Makes the job of an input with these bytes.
    pub(super) fn read(&self, source: &InputSource, bytes: Vec<u8>) -> Result<Loaded, CliError> {
        let kind = self.kind(source, &bytes)?;
        let is_file = kind != "job";
        let translator = FaultTranslator { flags: &self.flags, is_file, format: None };
        let request = if is_file {
            let beside: Arc<dyn Beside> = match source {
                InputSource::File(path) => Arc::new(InputFolder::of(path)),
                InputSource::Standard => Arc::new(Alone),
            };
            let job = self.whole(json!({ "input": {} }))?.to_string();
            let mut request: JobRequest = read(job.as_bytes()).map_err(|error| translator.unread(error))?;
            request.source = if self.describes() { self.text_of_file(kind, &bytes)? } else { None };
            request.input.file = Some(MeshFile { format: kind.to_owned(), bytes, beside });
            request
        } else {
            let mut request: JobRequest = read(&bytes).map_err(|error| translator.unread(error))?;
            let mut text = bytes;
            if !self.flags.fields.is_empty() || self.distance_to.is_some() {
                let job = self.whole(serde_json::from_slice(&text).map_err(CliError::refused)?)?;
                text = job.to_string().into_bytes();
                request = read(&text).map_err(|error| translator.unread(error))?;
            }
            if self.describes() || request.describes() {
                request.source = String::from_utf8(text).ok().map(Arc::from);
            }
            request
        };
        Ok(Loaded { request, is_file, format: None })
    }

    /// Returns whether the flags request outputs that contain the description of their job.
    fn describes(&self) -> bool {
        self.flags.options.iter().any(|(name, value)| *name == "describe" && *value == true)
    }

    /// Returns the job of a mesh file as text, for outputs that describe their job; `None` if the mesh file may refer
    /// to other files.
    fn text_of_file(&self, kind: &str, bytes: &[u8]) -> Result<Option<Arc<str>>, CliError> {
        let names_others: &[u8] = if kind == "obj" { b"\nmtllib " } else { b"\"uri\"" };
        if bytes.windows(names_others.len()).any(|part| part == names_others) {
            return Ok(None);
        }
        Ok(Some(self.whole(of_file(kind, bytes))?.to_string().into()))
    }

    /// Adds the values of the flags to a job.
    fn whole(&self, mut job: Value) -> Result<Value, CliError> {
        self.flags.onto(&mut job);
        if let Some(path) = &self.distance_to {
            let source = InputSource::of(path);
            let other = || {
                let bytes = source.read()?;
                match Self::default().kind(&source, &bytes)? {
                    "job" => serde_json::from_slice(&bytes).map_err(CliError::refused),
                    kind => Ok(of_file(kind, &bytes)),
                }
            };
            job["distance_to"] = other().map_err(|error: CliError| error.about(&source))?;
        }
        Ok(job)
    }
}

/// Makes the JSON of a job whose input is the contents of a mesh file, and which has no plan.
fn of_file(kind: &str, bytes: &[u8]) -> Value {
    let data = BASE64_STANDARD.encode(bytes);
    json!({ "input": { "text": { "format": kind, "data": data, "encoding": "base64" } } })
}

impl Loaded {
    /// Keeps one output only: the first requested output that fits `wanted`, else a new one. If nothing determines the
    /// format, it is the job's only output. Then sets the output options of the flags.
    pub(super) fn choose(&mut self, wanted: OutputChoice, options: &JobOptions) -> Result<(), CliError> {
        let request = &mut self.request;
        let fits = |asked: &'static dyn Format| match wanted {
            OutputChoice::Named(format) => asked.name() == format.name(),
            OutputChoice::Extension(format) => asked.extension() == format.extension(),
            OutputChoice::Only | OutputChoice::At(_) => true,
        };
        let asked = |output: &OutputRequest| output.format().and_then(output::named).is_some_and(fits);
        match (wanted, request.outputs.iter().position(asked)) {
            (OutputChoice::Only, _) if request.outputs.len() == 1 => {}
            (OutputChoice::At(i), _) if i < request.outputs.len() => {
                (request.outputs, request.left_out) = (vec![request.outputs.swap_remove(i)], i);
            }
            (OutputChoice::Only | OutputChoice::At(_), _) => {
                return Err(CliError::usage("nothing tells the format of the output; name one with --format"));
            }
            (_, Some(i)) => (request.outputs, request.left_out) = (vec![request.outputs.swap_remove(i)], i),
            (OutputChoice::Named(format) | OutputChoice::Extension(format), None) => {
                self.format = Some(if matches!(wanted, OutputChoice::Named(_)) { "--format" } else { "--output" });
                (request.outputs, request.left_out) = (vec![OutputRequest::of_format(format.name())], 0);
            }
        }
        options.flagged_output(&mut request.outputs[0])
    }

    /// Adds the default output if the job requests none, and sets the output options of the flags in all outputs.
    pub(super) fn settle(&mut self, options: &JobOptions) -> Result<(), CliError> {
        let request = &mut self.request;
        if request.outputs.is_empty() {
            request.outputs = vec![OutputRequest::of_format(request.usual_format())];
        }
        request.outputs.iter_mut().try_for_each(|output| options.flagged_output(output))
    }

    /// Checks the job and admits it within the limits.
    pub(super) fn admit(self, options: &JobOptions, limits: &Limits) -> Result<Admitted, CliError> {
        let translator = FaultTranslator { flags: &options.flags, is_file: self.is_file, format: self.format };
        let job = self.request.resolve_within(&limits.reading()).map_err(|faults| translator.refused(faults))?;
        limits.admit(job).map_err(|refusal| translator.not_admitted(refusal))
    }
}
