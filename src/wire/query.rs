//! Jobs as the query of an address says them, beside a mesh file: names with dots for the places in the job, and texts
//! that are typed by what presets, operators and formats declare.

use base64::Engine;
use serde_json::{Map, Value, json};

use super::job::JobRequest;
use super::read::{ReadError, read};
use super::text::MeshFile;
use super::written::written;
use crate::fault::{Fault, shortened};
use crate::math::parameter::{Kind, Parameter};
use crate::output;
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::presets::PRESETS;

/// What a query says that is no part of the job.
const BESIDE_THE_JOB: &[&str] = &["keep"];
/// Names without dots, and their places in the job. The one output has the name `output` until the job is whole.
const NAMES: &[(&str, &[&str])] = &[
    ("preset", &["plan", "preset"]),
    ("word", &["plan", "word"]),
    ("boundary", &["plan", "boundary"]),
    ("ends", &["plan", "ends"]),
    ("seed", &["plan", "seed"]),
    ("levels", &["levels"]),
    ("format", &["output", "format"]),
    ("spec", &["spec"]),
];
/// First names of those with dots, and their places in the job.
const FAMILIES: &[(&str, &[&str])] =
    &[("parameters", &["plan", "parameters"]), ("output", &["output"]), ("input", &["input"]), ("levels", &["levels"])];
/// Fields that hold texts, whatever these look like.
const TEXTS: &[&str] = &["preset", "word", "boundary", "ends", "format", "output.name"];

/// The job that a query says, but for its input, as JSON.
///
/// # Errors
/// Names that are unknown or stand twice; their faults point at them as `?name`.
pub fn job(query: &str) -> Result<Map<String, Value>, Vec<Fault>> {
    let pairs: Vec<_> = form_urlencoded::parse(query.as_bytes()).collect();
    let pairs: Vec<_> = pairs.iter().filter(|(name, _)| !BESIDE_THE_JOB.contains(&&**name)).collect();
    let given = |wanted: &str| pairs.iter().find(|(name, _)| name == wanted).map(|(_, text)| &**text);
    let declared = Declared {
        parameters: match given("preset") {
            Some(preset) => PRESETS.iter().find(|known| known.name == preset).map_or(&[], |known| known.parameters),
            None => WORD_PARAMETERS,
        },
        options: given("format").and_then(output::named).map_or(&[], |format| format.facts().parameters),
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

/// The job of a mesh file and a query.
///
/// # Errors
/// As [`job`], and what does not fit into a job.
pub fn job_of_file(query: &str, file: MeshFile) -> Result<JobRequest, ReadError> {
    let job = Value::Object(job(query).map_err(ReadError::Unfit)?);
    let mut request: JobRequest = read(job.to_string().as_bytes())?;
    request.input.file = Some(file);
    Ok(request)
}

/// The text of the job of a mesh file and a query that were read before: the file stands in it in base64.
pub fn job_text(query: &str, format: &str, bytes: &[u8]) -> String {
    let mut job = job(query).unwrap_or_default();
    if let Some(Value::Object(input)) = job.get_mut("input") {
        let data = base64::engine::general_purpose::STANDARD.encode(bytes);
        input.insert("text".to_owned(), json!({ "format": format, "data": data, "encoding": "base64" }));
    }
    Value::Object(job).to_string()
}

/// The name in a query of a place in its job: `?parameters.w` for `/plan/parameters/w`, and nothing for the file.
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

/// Where in a job a name leads.
fn place(name: &str) -> Result<Vec<String>, String> {
    let of = |places: &[&str], rest: &[&str]| places.iter().chain(rest).map(|&part| part.to_owned()).collect();
    if let Some((_, place)) = NAMES.iter().find(|(known, _)| *known == name) {
        return Ok(of(place, &[]));
    }
    let parts: Vec<&str> = name.split('.').collect();
    let family = FAMILIES.iter().find(|(known, _)| parts.len() > 1 && *known == parts[0]);
    if let Some((_, place)) = family.filter(|_| parts.iter().all(|part| !part.is_empty())) {
        return Ok(of(place, &parts[1..]));
    }
    let names: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
    Err(format!(
        "there is no such parameter; known are {}, keep, and parameters.NAME, output.OPTION, input.FIELD, \
         levels.tolerance",
        names.join(", ")
    ))
}

/// Puts a value at its place.
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

/// What is declared of the parameters of a plan, and of the options of a format.
struct Declared {
    parameters: &'static [Parameter],
    options: &'static [Parameter],
}

impl Declared {
    /// The value that a text stands for.
    fn typed(&self, name: &str, text: &str) -> Value {
        match self.kind(name) {
            _ if TEXTS.contains(&name) => Value::from(text),
            Some(Kind::Flag) if text.is_empty() => Value::Bool(true),
            Some(kind) => written(&kind, text),
            None => serde_json::from_str(text).unwrap_or_else(|_| Value::from(text)),
        }
    }

    /// What may be written for a parameter or an option.
    fn kind(&self, name: &str) -> Option<Kind> {
        let mut parts = name.split('.');
        let mut declared = match parts.next()? {
            "parameters" => self.parameters,
            "output" => self.options,
            _ => return None,
        };
        let mut kind = None;
        for part in parts {
            let parameter = declared.iter().find(|parameter| parameter.name == part)?;
            declared = if let Kind::Group(fields) = parameter.kind { fields } else { &[] };
            kind = Some(parameter.kind);
        }
        kind
    }
}
