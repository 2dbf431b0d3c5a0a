//! What a job asks for, as clients write it.

use serde::Deserialize;

use super::literal::{WireFields, WireLiteral};
use crate::fault::{Fault, did_you_mean, shortened, under};
use crate::job::Output;
use crate::math::parameter::{Default, Kind, Literal, Parameter, Values};
use crate::output::{self, Format};
use crate::shape::mesh::MAX_FRAMES;

/// Most outputs of one job.
pub(crate) const MAX_OUTPUTS: usize = 64;

/// One result: a `format`, a `name` (the format's when left out) and the format's options, see `/v1/formats`.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
pub struct OutputRequest {
    fields: WireFields,
    /// Whether the format was chosen otherwise, as the request names no outputs.
    #[serde(skip)]
    is_chosen: bool,
}

impl OutputRequest {
    /// The output of a format with its default options, where the request names none.
    pub fn of_format(name: &str) -> Self {
        Self { fields: WireFields(vec![("format".into(), Literal::Text(name.into()))]), is_chosen: true }
    }

    /// Sets a field, whatever the request says of it.
    pub(crate) fn set(&mut self, name: &str, WireLiteral(value): WireLiteral) {
        self.is_chosen = false;
        match self.fields.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = value,
            None => self.fields.0.push((name.to_owned(), value)),
        }
    }

    /// Sets a field that the request says nothing of.
    pub(super) fn set_default(&mut self, name: &str, value: Literal) {
        if self.fields.0.iter().all(|(known, _)| known != name) {
            self.set(name, WireLiteral(value));
        }
    }

    /// Checks it by itself.
    ///
    /// # Errors
    /// All faults, with pointers below the output.
    pub(crate) fn check(&self) -> Result<(), Vec<Fault>> {
        output(self, 0).map(drop)
    }

    /// The name of its format, where it is a text.
    pub fn format(&self) -> Option<&str> {
        self.fields.0.iter().find_map(|(name, value)| match value {
            Literal::Text(text) if name == "format" => Some(text.as_str()),
            _ => None,
        })
    }
}

/// Checks what is asked for; `before` outputs of the request were left out.
pub(super) fn outputs(requests: &[OutputRequest], before: usize) -> Result<Vec<Output>, Vec<Fault>> {
    if requests.is_empty() || requests.len() > MAX_OUTPUTS {
        let detail = format!("{} outputs; ask for 1 to {MAX_OUTPUTS}", requests.len());
        return Err(vec![Fault::new("/outputs", detail)]);
    }
    let mut faults = Vec::new();
    let mut found: Vec<Output> = Vec::with_capacity(requests.len());
    for (i, request) in (before..).zip(requests) {
        match output(request, i) {
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

/// Checks one output, at this place among those of the request.
pub(super) fn output(request: &OutputRequest, index: usize) -> Result<Output, Vec<Fault>> {
    let (mut format, mut name, mut frame) = (None, None, None);
    let mut options = Vec::new();
    for (field, value) in &request.fields.0 {
        match field.as_str() {
            "format" => format = Some(known_format(value)?),
            "name" => name = Some(output_name(value)?),
            "frame" => frame = known_frame(value)?,
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
    let index = (!request.is_chosen).then_some(index);
    Ok(Output { name: name.unwrap_or_else(|| format.name().to_owned()), format, options, frame, index })
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

/// The field that formats have in common.
pub(super) const FRAME: &[Parameter] = &[Parameter {
    name: "frame",
    kind: Kind::Integer { min: 0, max: MAX_FRAMES.cast_signed() as i64 - 1 },
    unit: "",
    default: Default::Absent,
    doc: "The frame of a mesh that is shown, as if the mesh had these positions alone.",
}];

fn known_frame(value: &Literal) -> Result<Option<usize>, Vec<Fault>> {
    let found = Values::resolve(FRAME, &[("frame".into(), value.clone())])?.integer("frame");
    Ok(found.and_then(|frame| usize::try_from(frame).ok()))
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
