//! `planish evaluate`: values of the limit surface of a mesh at given places, and the closest places to given points.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value, json};

use super::error::CliError;
use super::files::to_new_file;
use super::inputs::InputSource;
use super::job::JobOptions;
use super::say::answer;
use crate::fault::Fault;
use crate::job::limits::Limits;
use crate::job::{Evaluation, Levels, RunError};
use crate::scheme::preset::BICUBIC_PRESET;
use crate::watch::Watch;
use crate::wire::evaluation::{EvaluationAnswer, EvaluationRequest, places};
use crate::wire::levels::LevelsRequest;
use crate::wire::output::OutputRequest;
use crate::wire::plan::PlanRequest;
use crate::wire::read::{ReadError, read};

/// What is asked of a limit surface.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct EvaluateOptions {
    /// A mesh file or a job (JSON), whose mesh and plan count; - is standard input.
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// A place: an input face, u and v from 0 to 1, and on faces that are no quads the corner; can be repeated.
    #[arg(long, value_name = "FACE,U,V[,CORNER]")]
    at: Vec<String>,
    /// A point whose closest place is looked for; can be repeated.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    closest: Vec<String>,
    /// A file (JSON) with `at`, `closest` and `values` as in a request to /v1/evaluate; flags add to it.
    #[arg(long, value_name = "FILE")]
    questions: Option<PathBuf>,
    /// What is told of each place: position, normal, derivatives and more, see docs/evaluate.md.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    values: Vec<String>,
    /// Where the answer goes (JSON), instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    options: JobOptions,
}

impl EvaluateOptions {
    /// Prints the values as JSON, or writes them to a file.
    pub(super) fn evaluate(&self) -> Result<(), CliError> {
        self.options.check()?;
        let request = self.request()?;
        let at = places(&request.at).map_err(|faults| fault_error(&faults))?;
        let values = request.values().map_err(|faults| fault_error(&faults))?;
        let source = InputSource::of(&self.input);
        let named = |error: CliError| error.about(&source);
        let mut loaded = self.options.load(&source).map_err(named)?;
        let usual = || PlanRequest { preset: Some(BICUBIC_PRESET.to_owned()), ..PlanRequest::default() };
        loaded.request.plan.get_or_insert_with(usual);
        loaded.request.levels = Some(LevelsRequest(Levels::Count(0)));
        loaded.request.outputs = vec![OutputRequest::of_format("stats")];
        let admitted = Arc::new(loaded.admit(&self.options, &Limits::default()).map_err(named)?);
        let evaluation =
            Evaluation::new(admitted, at, request.closest, values).map_err(|faults| fault_error(&faults))?;
        let found = evaluation.run(&Watch::new()).map_err(|error| match error {
            RunError::Impossible(fault) => fault_error(&[fault.fault]).about(&source),
            error => CliError::files(error),
        })?;
        let answered = EvaluationAnswer::new(&found, evaluation.values());
        let text = serde_json::to_string_pretty(&answered).map_err(CliError::other)?;
        let text = format!("{text}\n");
        match &self.output {
            Some(path) => to_new_file(path, |out| out.write_all(text.as_bytes()).map_err(CliError::files)),
            None => answer(text.as_bytes()),
        }
    }

    /// Combines the questions of the file and of the flags into a request without a mesh.
    fn request(&self) -> Result<EvaluationRequest, CliError> {
        let mut whole = match &self.questions {
            None => json!({}),
            Some(path) => {
                let source = InputSource::of(path);
                let bytes = source.read().map_err(|error| error.about(&source))?;
                serde_json::from_slice(&bytes).map_err(|error| CliError::refused(error).about(&source))?
            }
        };
        let fields = whole.as_object_mut().ok_or_else(|| {
            CliError::usage("--questions: expected an object with \"at\", \"closest\" and \"values\"")
        })?;
        for (name, given) in [("at", &self.at), ("closest", &self.closest)] {
            let given: Vec<Value> = given.iter().map(|text| numbers(name, text)).collect::<Result<_, _>>()?;
            let all = fields.entry(name).or_insert_with(|| json!([]));
            if let Value::Array(all) = all {
                all.extend(given);
            }
        }
        if !self.values.is_empty() {
            fields.insert("values".to_owned(), json!(self.values));
        }
        fields.insert("input".to_owned(), json!({}));
        fields.insert("plan".to_owned(), json!({}));
        read(whole.to_string().as_bytes()).map_err(|error| match error {
            ReadError::NotJson(detail) => CliError::refused(detail),
            ReadError::Unfit(faults) => fault_error(&faults),
        })
    }
}

/// Parses comma-separated numbers.
fn numbers(flag: &str, text: &str) -> Result<Value, CliError> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let found: Option<Vec<f64>> = text.split(',').map(number).collect();
    found.map(|numbers| json!(numbers)).ok_or_else(|| {
        CliError::usage(format!(
            "--{flag}: \"{text}\" is no list of numbers; write them with commas, such as 0,0.5,0.5"
        ))
    })
}

/// Converts faults to an error, with flags in place of JSON pointers.
fn fault_error(faults: &[Fault]) -> CliError {
    let flagged = |fault: &Fault| {
        let place = match fault.pointer.split_once('/') {
            Some(("", "input")) => "the input".to_owned(),
            Some(("", "plan")) => "--preset".to_owned(),
            Some(("", rest)) => format!("--{}", rest.replace('/', " ")),
            _ => fault.pointer.clone(),
        };
        Fault::new(place, fault.detail.clone())
    };
    CliError::faults(faults.iter().map(flagged))
}
