//! `planish analyse`: the analysis of a plan.

use std::path::PathBuf;

use super::error::CliError;
use super::files::to_new_file;
use super::inputs::InputSource;
use super::say::answer;
use crate::job::Form;
use crate::math::parameter::Literal;
use crate::watch::Watch;
use crate::wire::analysis::{AnalysisAnswer, AnalysisRequest, MatricesRequest, ScanRequest, SmallPolygon};
use crate::wire::literal::{WireFields, WireLiteral};
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
    /// Asks for the matrices of one step on a closed polygon of so many points, 5 when no number is given.
    #[arg(long, value_name = "POINTS", num_args = 0..=1, default_missing_value = "5")]
    matrices: Option<u32>,
    /// Asks what is proved at values of a parameter, such as eta=0..1/60, and between them.
    #[arg(long, value_name = "NAME=FROM..TO")]
    scan: Option<String>,
    /// Equal steps of the scan.
    #[arg(long, requires = "scan")]
    steps: Option<u32>,
    /// Asks about the scheme for surfaces, at vertices of these valences, separated by commas.
    #[arg(long, value_delimiter = ',')]
    valences: Vec<u64>,
    /// Asks about boundary vertices with these numbers of faces, separated by commas.
    #[arg(long, value_delimiter = ',')]
    boundaries: Vec<u64>,
    /// How it is answered: as json with every number by its name, as markdown to read, or as a figure (svg, png). Left
    /// out, the extension of the output tells; standard output gets json.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Form::ALL.map(Form::name)))]
    format: Option<String>,
    /// The file to write; standard output when left out.
    #[arg(short, long)]
    output: Option<PathBuf>,
}

impl Question {
    /// Prints the result of the analysis, or writes it to a file.
    pub(super) fn analyse(&self) -> Result<(), CliError> {
        let watch = Watch::new();
        let form = self.form()?;
        let analysis = self.request()?.resolve(form, &watch).map_err(CliError::faults)?;
        let found = AnalysisAnswer::of(&analysis, &watch).map_err(CliError::other)?;
        let mut bytes = Vec::new();
        if form == Form::Json {
            // Indented for people; programs read either form.
            serde_json::to_writer_pretty(&mut bytes, &found).map_err(CliError::other)?;
            bytes.push(b'\n');
        } else {
            found.write(form, &mut bytes, &watch).map_err(CliError::other)?;
        }
        match self.output.as_deref().filter(|path| path.as_os_str() != "-") {
            None => answer(&bytes),
            Some(path) => to_new_file(path, |out| {
                let cannot = |error| CliError::files(format!("cannot write {}: {error}", path.display()));
                out.write_all(&bytes).map_err(cannot)
            }),
        }
    }

    fn form(&self) -> Result<Form, CliError> {
        let named = |name: &str| Form::ALL.into_iter().find(|form| form.name() == name);
        if let Some(form) = self.format.as_deref().and_then(named) {
            return Ok(form);
        }
        let Some(extension) = self.output.as_ref().and_then(|path| path.extension()) else { return Ok(Form::Json) };
        let found = Form::ALL.into_iter().find(|form| extension == form.extension());
        let unknown = || {
            let known = Form::ALL.map(Form::extension).join(", ");
            CliError::usage(format!("--output: analyses have the extensions {known}; name a format with --format"))
        };
        found.ok_or_else(unknown)
    }

    fn request(&self) -> Result<AnalysisRequest, CliError> {
        let Self { file, preset, word, parameters, nodes, grid, matrices, scan, steps, .. } = self;
        let of = |points| MatricesRequest::Of(SmallPolygon { points: Some(points), closed: None, powers: None });
        let matrices = matrices.map(of);
        let scan = scan.as_deref().map(|text| scanned(text, *steps)).transpose()?;
        let given = |numbers: &Vec<u64>| (!numbers.is_empty()).then(|| numbers.clone());
        let (valences, boundaries) = (given(&self.valences), given(&self.boundaries));
        if let Some(path) = file {
            let source = InputSource::of(path);
            let bytes = source.read().map_err(|error| error.about(&source))?;
            let mut request: AnalysisRequest = read(&bytes).map_err(|error| match error {
                ReadError::NotJson(detail) => CliError::refused(detail),
                ReadError::Unfit(faults) => CliError::faults(faults),
            })?;
            request.nodes = nodes.or(request.nodes);
            request.grid = grid.or(request.grid);
            request.matrices = matrices.or(request.matrices);
            request.scan = scan.or(request.scan);
            request.valences = valences.or(request.valences);
            request.boundaries = boundaries.or(request.boundaries);
            return Ok(request);
        }
        let parameters = parameters.iter().map(|text| parameter(text)).collect::<Result<Vec<_>, _>>()?;
        let plan = PlanRequest {
            preset: preset.clone(),
            word: word.clone(),
            parameters: WireFields(parameters),
            ..PlanRequest::default()
        };
        let (spec, tube, input) = (None, None, None);
        let (nodes, grid) = (*nodes, *grid);
        Ok(AnalysisRequest { spec, plan, nodes, grid, matrices, scan, valences, boundaries, tube, input })
    }
}

fn parameter(text: &str) -> Result<(String, Literal), CliError> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| CliError::usage(format!("\"{text}\" is no parameter; write NAME=VALUE, such as w=1/16")))?;
    let is_list = name == "mask" || name == "kernel" && value.contains(',');
    let value = if is_list { Literal::List(value.split(',').map(one).collect()) } else { one(value) };
    Ok((name.to_owned(), value))
}

/// Reads a whole number as a number, and any other text as text, whose value is exact.
fn one(text: &str) -> Literal {
    text.parse::<i32>().map_or_else(|_| Literal::Text(text.into()), |n| Literal::Number(n.into()))
}

fn scanned(text: &str, steps: Option<u32>) -> Result<ScanRequest, CliError> {
    let parts = text.split_once('=').and_then(|(name, range)| Some((name, range.split_once("..")?)));
    let (parameter, (from, to)) = parts
        .ok_or_else(|| CliError::usage(format!("\"{text}\" is no scan; write NAME=FROM..TO, such as eta=0..1/60")))?;
    Ok(ScanRequest { parameter: parameter.to_owned(), from: WireLiteral(one(from)), to: WireLiteral(one(to)), steps })
}
