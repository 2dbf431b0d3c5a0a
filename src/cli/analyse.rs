//! `planish analyse`: what can be said of a plan.

use std::path::PathBuf;

use super::error::{CliError, Kind};
use super::inputs::Source;
use super::say::answer;
use crate::fault::Fault;
use crate::math::parameter::Literal;
use crate::watch::Watch;
use crate::wire::analysis::{AnalysisAnswer, AnalysisRequest};
use crate::wire::literal::WireFields;
use crate::wire::plan::PlanRequest;
use crate::wire::read::{ReadError, read};

/// What is asked: a question in a file, or a plan in a few words.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub(crate) struct Question {
    /// The question, a JSON file as POST /v1/analyses takes it (- reads it from standard input).
    #[arg(required_unless_present_any = ["preset", "word"], conflicts_with_all = ["preset", "word"])]
    file: Option<PathBuf>,
    /// Name of a preset.
    #[arg(long)]
    preset: Option<String>,
    /// A word over operators.
    #[arg(long, conflicts_with = "preset")]
    word: Option<String>,
    /// A parameter of the preset or the word, such as w=1/16; lists are separated by commas.
    #[arg(short, long = "parameter", value_name = "NAME=VALUE", conflicts_with = "file")]
    parameters: Vec<String>,
    /// Most products of matrices that the search for bounds looks at.
    #[arg(long)]
    nodes: Option<u64>,
    /// Asks for values of the basic limit function at the multiples of arity^-grid.
    #[arg(long)]
    grid: Option<u32>,
    /// Asks about the scheme for surfaces, at vertices of these valences, separated by commas.
    #[arg(long, value_delimiter = ',')]
    valences: Vec<u64>,
}

impl Question {
    /// Prints what can be said as JSON.
    pub(super) fn analyse(&self) -> Result<(), CliError> {
        let watch = Watch::new();
        let refused = |faults: Vec<Fault>| CliError::faults(Kind::Refused, &faults);
        let analysis = self.request()?.resolve(&watch).map_err(refused)?;
        let found = AnalysisAnswer::of(&analysis, &watch).map_err(CliError::other)?;
        let text = serde_json::to_string_pretty(&found).map_err(CliError::other)?;
        answer(format!("{text}\n").as_bytes())
    }

    fn request(&self) -> Result<AnalysisRequest, CliError> {
        let Self { file, preset, word, parameters, nodes, grid, valences } = self;
        let valences = (!valences.is_empty()).then(|| valences.clone());
        if let Some(path) = file {
            let source = Source::of(path);
            let bytes = source.read().map_err(|error| error.about(&source))?;
            let mut request: AnalysisRequest = read(&bytes).map_err(|error| match error {
                ReadError::NotJson(detail) => CliError::refused(detail),
                ReadError::Unfit(faults) => CliError::faults(Kind::Refused, &faults),
            })?;
            request.nodes = nodes.or(request.nodes);
            request.grid = grid.or(request.grid);
            request.valences = valences.or(request.valences);
            return Ok(request);
        }
        let parameters = parameters.iter().map(|text| parameter(text)).collect::<Result<Vec<_>, _>>()?;
        let plan = PlanRequest {
            preset: preset.clone(),
            word: word.clone(),
            parameters: WireFields(parameters),
            ..PlanRequest::default()
        };
        Ok(AnalysisRequest { spec: None, plan, nodes: *nodes, grid: *grid, valences, tube: None, input: None })
    }
}

fn parameter(text: &str) -> Result<(String, Literal), CliError> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| CliError::usage(format!("\"{text}\" is no parameter; write NAME=VALUE, such as w=1/16")))?;
    // whole numbers are written as numbers, everything else as text, whose value is exact
    let one =
        |text: &str| text.parse::<i32>().map_or_else(|_| Literal::Text(text.into()), |n| Literal::Number(n.into()));
    let is_list = name == "mask" || name == "kernel" && value.contains(',');
    let value = if is_list { Literal::List(value.split(',').map(one).collect()) } else { one(value) };
    Ok((name.to_owned(), value))
}
