//! The outputs of a job as clients write them.

use serde::Deserialize;
use serde_json::{Map, Value};

use super::described::description as description_of;
use super::literal::{WireFields, WireLiteral, written};
use crate::fault::{Fault, did_you_mean, shortened, under};
use crate::job::Output;
use crate::math::parameter::{Literal, Parameter, ParameterKind, Values};
use crate::output::{self, Format, POSITIONS};
use crate::shape::mesh::MAX_MESH_FRAMES;

/// Maximum number of outputs of one job.
pub(crate) const MAX_OUTPUTS: usize = 64;

/// One requested output: a `format`, a `name` (by default that of the format) and the options of the format, see
/// `/v1/formats`.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
pub struct OutputRequest {
    fields: WireFields,
    /// Whether the format was chosen outside the request, which names no outputs.
    #[serde(skip)]
    is_chosen: bool,
}

impl OutputRequest {
    /// Creates an output of a format with its default options, for a request without outputs.
    pub fn of_format(name: &str) -> Self {
        Self { fields: WireFields(vec![("format".into(), Literal::Text(name.into()))]), is_chosen: true }
    }

    /// Creates a `stats` output of the shape that another output shows, or of the refined shape if there is none.
    ///
    /// # Errors
    /// All faults of the other output, with pointers below it.
    pub(crate) fn of_shape(other: Option<&Self>) -> Result<Self, Vec<Fault>> {
        let mut shape = Self::of_format("stats");
        if let Some(other) = other {
            other.check()?;
            let kept = other.fields.0.iter().filter(|(name, _)| name == POSITIONS.name || name == FRAME.name);
            shape.fields.0.extend(kept.cloned());
            shape.is_chosen = other.is_chosen;
        }
        Ok(shape)
    }

    /// Returns the output as JSON.
    pub(crate) fn to_json(&self) -> Map<String, Value> {
        self.fields.0.iter().map(|(name, value)| (name.clone(), written(value))).collect()
    }

    /// Whether the bytes are to contain the description of their job.
    pub(crate) fn describes(&self) -> bool {
        self.fields.0.iter().any(|(name, value)| name == DESCRIBE.name && *value == Literal::Flag(true))
    }

    /// Sets a field, also if the request gives it.
    pub(crate) fn set(&mut self, name: &str, WireLiteral(value): WireLiteral) {
        self.is_chosen = false;
        match self.fields.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = value,
            None => self.fields.0.push((name.to_owned(), value)),
        }
    }

    /// Sets a field unless the request gives it.
    pub(super) fn set_default(&mut self, name: &str, value: Literal) {
        if self.fields.0.iter().all(|(known, _)| known != name) {
            self.set(name, WireLiteral(value));
        }
    }

    /// Checks the output by itself.
    ///
    /// # Errors
    /// All faults, with pointers below the output.
    pub(crate) fn check(&self) -> Result<(), Vec<Fault>> {
        output(self, 0).map(drop)
    }

    /// Whether the request gives a field of this name.
    pub fn gives(&self, option: &str) -> bool {
        self.fields.0.iter().any(|(name, _)| name == option)
    }

    /// Returns the name of the format, if the request gives one as a text.
    pub fn format(&self) -> Option<&str> {
        self.fields.0.iter().find_map(|(name, value)| match value {
            Literal::Text(text) if name == "format" => Some(text.as_str()),
            _ => None,
        })
    }
}

/// Checks the outputs of a job with the text `source`; `before` outputs of the request precede these.
pub(super) fn outputs(
    requests: &[OutputRequest],
    before: usize,
    source: Option<&str>,
) -> Result<Vec<Output>, Vec<Fault>> {
    if requests.is_empty() || requests.len() > MAX_OUTPUTS {
        let detail = format!("{} outputs; ask for 1 to {MAX_OUTPUTS}", requests.len());
        return Err(vec![Fault::new("/outputs", detail)]);
    }
    let mut faults = Vec::new();
    let mut found: Vec<Output> = Vec::with_capacity(requests.len());
    for (i, request) in (before..).zip(requests) {
        match output(request, i).and_then(|output| described(output, request, source)) {
            Ok(output) if found.iter().any(|known| known.name == output.name) => {
                let detail = format!("the name \"{}\" is taken; give each output its own", shortened(&output.name));
                faults.push(Fault::new(format!("/outputs/{i}/name"), detail));
            }
            Ok(output) => found.push(output),
            Err(wrong) => faults.extend(under(&format!("/outputs/{i}"), wrong)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// Adds the description of the job to an output that requests one.
fn described(output: Output, request: &OutputRequest, source: Option<&str>) -> Result<Output, Vec<Fault>> {
    if !request.describes() {
        return Ok(output);
    }
    let text = description_of(source, request.to_json()).map_err(|fault| vec![fault])?;
    Ok(Output { description: Some(text), ..output })
}

/// Checks one output, except for its description; `index` is its position among the outputs of the request.
pub(super) fn output(request: &OutputRequest, index: usize) -> Result<Output, Vec<Fault>> {
    let (mut format, mut name, mut frame, mut describes) = (None, None, None, false);
    let mut options = Vec::new();
    for (field, value) in &request.fields.0 {
        match field.as_str() {
            "format" => format = Some(known_format(value)?),
            "name" => name = Some(output_name(value)?),
            "frame" => frame = known_frame(value)?,
            "describe" => describes = known_flag(value)?,
            _ => options.push((field.clone(), value.clone())),
        }
    }
    let Some(format) = format else {
        return Err(vec![Fault::new("", format!("an output has a \"format\": one of {}", format_names()))]);
    };
    let options = Values::resolve(format.facts().parameters, &options).map_err(|faults| {
        let known =
            |fault: Fault| Fault { detail: fault.detail.replace("unknown parameter", "unknown option"), ..fault };
        faults.into_iter().map(known).collect::<Vec<_>>()
    })?;
    if describes && format.facts().description.is_none() {
        let can: Vec<&str> = output::described().collect();
        let detail = format!("{} has no place for a description; ask for {}", format.name(), can.join(", "));
        return Err(vec![Fault::new("/describe", detail)]);
    }
    let index = (!request.is_chosen).then_some(index);
    let name = name.unwrap_or_else(|| format.name().to_owned());
    Ok(Output { name, format, options, frame, description: None, index })
}

fn known_format(value: &Literal) -> Result<&'static dyn Format, Vec<Fault>> {
    let Literal::Text(name) = value else {
        return Err(vec![Fault::new("/format", format!("expected a text: one of {}", format_names()))]);
    };
    output::named(name).ok_or_else(|| {
        let meant = did_you_mean(name, output::FORMATS.iter().map(|format| format.name()));
        let detail = format!("there is no format \"{}\"; {meant}known are {}", shortened(name), format_names());
        vec![Fault::new("/format", detail)]
    })
}

/// The frame field, common to all formats.
pub(super) const FRAME: Parameter = Parameter::optional(
    "frame",
    ParameterKind::Integer { min: 0, max: MAX_MESH_FRAMES.cast_signed() as i64 - 1 },
    "The frame of a mesh that is shown, as if the mesh had these positions alone.",
);

/// The description field, common to the formats with room for a description.
pub(super) const DESCRIBE: Parameter = Parameter::flag(
    "describe",
    "Whether the bytes say of which job they are: \"planish reproduce\" reads it, renders it again and compares.",
);

/// Returns the common fields of the format with this name.
pub(super) fn common(format: &str) -> Vec<Parameter> {
    let describes = output::described().any(|name| name == format);
    [FRAME].into_iter().chain(describes.then_some(DESCRIBE)).collect()
}

fn known_frame(value: &Literal) -> Result<Option<usize>, Vec<Fault>> {
    let found = Values::resolve(&[FRAME], &[(FRAME.name.into(), value.clone())])?.integer(FRAME.name);
    Ok(found.and_then(|frame| usize::try_from(frame).ok()))
}

fn known_flag(value: &Literal) -> Result<bool, Vec<Fault>> {
    Ok(Values::resolve(&[DESCRIBE], &[(DESCRIBE.name.into(), value.clone())])?.flag(DESCRIBE.name))
}

fn format_names() -> String {
    output::FORMATS.iter().map(|format| format.name()).collect::<Vec<_>>().join(", ")
}

fn output_name(value: &Literal) -> Result<String, Vec<Fault>> {
    let Literal::Text(name) = value else { return Err(vec![Fault::new("/name", "expected a text")]) };
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if (1..=64).contains(&name.len()) && name.chars().all(fits) {
        Ok(name.clone())
    } else {
        let detail = format!("\"{}\" is no name; use 1 to 64 letters, digits, \"-\", \"_\" and \".\"", shortened(name));
        Err(vec![Fault::new("/name", detail)])
    }
}
