//! Jobs in the query of an address, beside a mesh file: names with dots are places in the job, and texts are converted
//! to the types that the job, presets, operators and formats declare.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use base64::Engine;
use serde_json::{Map, Value, json};

use super::fields::{Field, FieldSection, FieldValues, fields, output_fields};
use super::job::JobRequest;
use super::output::OutputRequest;
use super::read::{ReadError, read};
use super::text::MeshFile;
use super::written::{number, written};
use crate::fault::{Fault, did_you_mean, shortened};
use crate::math::parameter::{Parameter, ParameterKind};
use crate::output;
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::presets::PRESETS;

/// Query parameters that are not part of the job.
pub const BESIDE_THE_JOB: &[&str] = &["keep"];
/// Names without dots that are not fields of the plan; all others without dots are.
const PLAIN_NAMES: [&str; 2] = ["levels", "format"];
/// First parts of names with dots, and their places in the job. The one output is called `output` until the job is
/// complete.
const NAME_FAMILIES: [(&str, &[&str]); 4] =
    [("parameters", &["plan", "parameters"]), ("output", &["output"]), ("input", &["input"]), ("levels", &["levels"])];

/// The declared fields, computed once.
static QUERY_FIELDS: LazyLock<Vec<Field>> = LazyLock::new(fields);

/// Returns the job of a query, without its input, as JSON.
///
/// # Errors
/// Names that are unknown or repeated; the faults point at them as `?name`.
pub fn job(query: &str) -> Result<Map<String, Value>, Vec<Fault>> {
    let pairs: Vec<_> = form_urlencoded::parse(query.as_bytes()).collect();
    let pairs: Vec<_> = pairs.iter().filter(|(name, _)| !BESIDE_THE_JOB.contains(&&**name)).collect();
    let given = |wanted: &str| pairs.iter().find(|(name, _)| name == wanted).map(|(_, text)| &**text);
    let declared = DeclaredParameters {
        parameters: match given("preset") {
            Some(preset) => PRESETS.iter().find(|known| known.name == preset).map_or(&[], |known| known.parameters),
            None => WORD_PARAMETERS,
        },
        options: given("format").and_then(output::named).map(|format| format.facts().parameters),
    };
    let (mut job, mut faults) = (Map::new(), Vec::new());
    for (name, text) in &pairs {
        let put = place(name).and_then(|place| put(&mut job, &place, declared.typed(name, text)));
        faults.extend(put.err().map(|detail| Fault::new(format!("?{}", shortened(name)), detail)));
    }
    if let Some(output) = job.remove("output") {
        job.insert("outputs".to_owned(), Value::Array(vec![output]));
    }
    job.entry("input").or_insert_with(|| Value::Object(Map::new()));
    if faults.is_empty() { Ok(job) } else { Err(faults) }
}

/// Refuses query parameters beside a job in the body. Only `_` and the names in `beside` are allowed, each once.
///
/// # Errors
/// A fault for each refused parameter, with its place in the job if it has one.
pub fn refuse_parameters(query: &str, beside: &[&str]) -> Result<(), Vec<Fault>> {
    let fault = |name: &str| {
        let detail = match place(name).as_deref() {
            // pages use `_` to bypass caches
            _ if name == "_" || beside.contains(&name) => return None,
            Ok([first, rest @ ..]) if first == "output" => stands_beside(&format!("/outputs/0/{}", rest.join("/"))),
            Ok(all) => stands_beside(&format!("/{}", all.join("/"))),
            Err(_) if beside.is_empty() => "nothing is read from the query here; leave it out".to_owned(),
            Err(_) => {
                let meant = did_you_mean(name, beside.iter().copied());
                format!("it is unknown; {meant}known are {}", beside.join(", "))
            }
        };
        Some(Fault::new(format!("?{}", shortened(name)), detail))
    };
    let mut faults = repeated(query);
    faults.extend(form_urlencoded::parse(query.as_bytes()).filter_map(|(name, _)| fault(&name)));
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// Returns a fault for each repetition of a name in a query.
pub fn repeated(query: &str) -> Vec<Fault> {
    let mut seen = BTreeSet::new();
    let names = form_urlencoded::parse(query.as_bytes()).map(|(name, _)| name);
    let again = names.filter(|name| !seen.insert(name.clone()));
    again.map(|name| Fault::new(format!("?{}", shortened(&name)), "it is given twice; give it once")).collect()
}

fn stands_beside(place: &str) -> String {
    format!("it stands beside a mesh file as the body; a job says it itself, at {place}")
}

/// Reads the job of a mesh file and a query.
///
/// # Errors
/// As [`job`], and values that do not fit into a job.
pub fn job_of_file(query: &str, file: MeshFile) -> Result<JobRequest, ReadError> {
    let job = Value::Object(job(query).map_err(ReadError::Unfit)?);
    let mut request: JobRequest = read(job.to_string().as_bytes())?;
    request.input.file = Some(file);
    Ok(request)
}

/// Returns the text of the job of a mesh file and a query that were read before; it contains the file in base64.
pub fn job_text(query: &str, format: &str, bytes: &[u8]) -> String {
    let mut job = job(query).unwrap_or_default();
    if let Some(Value::Object(input)) = job.get_mut("input") {
        let data = base64::engine::general_purpose::STANDARD.encode(bytes);
        input.insert("text".to_owned(), json!({ "format": format, "data": data, "encoding": "base64" }));
    }
    Value::Object(job).to_string()
}

/// Reads a job without outputs and gives it one output of this format.
///
/// # Errors
/// [`ReadError`], also if the job names outputs itself.
pub fn read_as(format: &str, bytes: &[u8]) -> Result<JobRequest, ReadError> {
    let mut request: JobRequest = read(bytes)?;
    if !request.outputs.is_empty() {
        let detail = "the address names the format; leave the outputs out of the job";
        return Err(ReadError::Unfit(vec![Fault::new("/outputs", detail)]));
    }
    request.outputs = vec![OutputRequest::of_format(format)];
    Ok(request)
}

/// Returns the text of a job that [`read_as`] has read, with an output of this format.
pub fn text_as(format: &str, bytes: &[u8]) -> String {
    let mut job: Map<String, Value> = serde_json::from_slice(bytes).unwrap_or_default();
    job.insert("outputs".to_owned(), json!([{ "format": format }]));
    Value::Object(job).to_string()
}

/// Returns the query parameter for a pointer into the job: `?parameters.w` for `/plan/parameters/w`, and an empty text
/// for the file.
pub fn name_of(pointer: &str) -> String {
    let is = |place: &str| pointer.strip_prefix(place).filter(|rest| rest.is_empty() || rest.starts_with('/'));
    let named = |name: String| format!("?{}", name.trim_matches('.').replace("~1", "/").replace("~0", "~"));
    let dotted = |rest: &str| rest.replace('/', ".");
    if is("/input/text").is_some() || pointer == "/input" || pointer.is_empty() {
        String::new()
    } else if let Some(rest) = is("/outputs/0") {
        let rest = if rest == "/format" { "" } else { rest };
        if rest.is_empty() { "?format".to_owned() } else { named(format!("output{}", dotted(rest))) }
    } else if pointer == "/outputs" {
        "?format".to_owned()
    } else if let Some(rest) = is("/plan") {
        if rest.is_empty() { "?preset".to_owned() } else { named(dotted(rest)) }
    } else if pointer.starts_with('/') {
        named(dotted(pointer))
    } else {
        pointer.to_owned()
    }
}

/// Returns the names of the fields of the plan.
fn plan_fields() -> impl Iterator<Item = &'static str> {
    QUERY_FIELDS.iter().filter(|field| field.part == FieldSection::Plan).map(|field| field.name.as_str())
}

/// Returns the path in the job that a name of the query denotes.
fn place(name: &str) -> Result<Vec<String>, String> {
    let of = |places: &[&str], rest: &[&str]| places.iter().chain(rest).map(|&part| part.to_owned()).collect();
    match name {
        "levels" => return Ok(of(&["levels"], &[])),
        "format" => return Ok(of(&["output", "format"], &[])),
        name if plan_fields().any(|known| known == name) => return Ok(of(&["plan"], &[name])),
        _ => {}
    }
    let parts: Vec<&str> = name.split('.').collect();
    let family = NAME_FAMILIES.iter().find(|(known, _)| parts.len() > 1 && *known == parts[0]);
    if let Some((_, place)) = family.filter(|_| parts.iter().all(|part| !part.is_empty())) {
        return Ok(of(place, &parts[1..]));
    }
    let known: Vec<&str> = plan_fields().chain(PLAIN_NAMES).chain(BESIDE_THE_JOB.iter().copied()).collect();
    Err(format!(
        "there is no such parameter; {}known are {}, and parameters.NAME, output.OPTION, input.FIELD, levels.tolerance",
        did_you_mean(name, known.iter().copied()),
        known.join(", ")
    ))
}

/// Inserts a value at a path of the job.
fn put(job: &mut Map<String, Value>, place: &[String], value: Value) -> Result<(), String> {
    let Some((last, before)) = place.split_last() else { return Ok(()) };
    let mut at = job;
    for part in before {
        let inner = at.entry(part.clone()).or_insert_with(|| Value::Object(Map::new()));
        at = inner.as_object_mut().ok_or("it is given as a whole and in parts; give one of them")?;
    }
    match at.insert(last.clone(), value) {
        None => Ok(()),
        Some(_) => Err("it is given twice; give it once".to_owned()),
    }
}

/// The declared parameters of the plan, and the options of the format if the query names one.
struct DeclaredParameters {
    parameters: &'static [Parameter],
    options: Option<&'static [Parameter]>,
}

impl DeclaredParameters {
    /// Converts the text of a query parameter to the declared type; a text that does not fit remains unchanged, and is
    /// refused later with a reason.
    fn typed(&self, name: &str, text: &str) -> Value {
        let (family, rest) = name.split_once('.').unwrap_or(("", name));
        let field = |part| {
            let (first, inner) = rest.split_once('.').unwrap_or((rest, ""));
            let field = QUERY_FIELDS.iter().find(|field| field.part == part && field.name == first)?;
            match &field.takes {
                FieldValues::Object(fields) if !inner.is_empty() => fields.iter().find(|field| field.name == inner),
                _ => Some(field).filter(|_| inner.is_empty()),
            }
        };
        let field = match family {
            "" => field(FieldSection::Plan),
            "input" => field(FieldSection::Input),
            _ => None,
        };
        match (self.kind(family, rest), field) {
            (Some(ParameterKind::Flag), _) if text.is_empty() => Value::Bool(true),
            (Some(kind), _) => written(&kind, text),
            (None, Some(field)) => field.value(text),
            (None, None) if matches!(name, "format" | "output.name") => text.into(),
            (None, None) => number(text),
        }
    }

    /// Returns the kind of a parameter or an option.
    fn kind(&self, family: &str, name: &str) -> Option<ParameterKind> {
        let mut parts = name.split('.');
        let first = parts.next()?;
        let named = |declared: &'static [Parameter], name: &str| {
            declared.iter().find(|parameter| parameter.name == name).map(|parameter| parameter.kind)
        };
        let mut kind = match (family, self.options) {
            ("parameters", _) => named(self.parameters, first)?,
            ("output", Some(options)) if named(options, first).is_some() => named(options, first)?,
            ("output", _) => *output_fields().iter().find(|field| field.name == first)?.kind(),
            _ => return None,
        };
        for part in parts {
            let ParameterKind::Group(fields) = kind else { return None };
            kind = named(fields, part)?;
        }
        Some(kind)
    }
}
