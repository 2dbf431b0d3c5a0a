//! The fields of a job that a short text can give, for flags and queries. They are read from the schemas of the request
//! and the declarations of the formats, so that no list has to be maintained.

use serde_json::Value;
use utoipa::{PartialSchema, ToSchema};

use super::input::InputRequest;
use super::output::{DESCRIBE, FRAME};
use super::plan::PlanRequest;
use super::written::{number, numbers, object, written};
use crate::math::parameter::{Parameter, ParameterKind};
use crate::output::{self, FORMATS};

/// The input field that names an upload. Flags and queries leave it out, because they accompany a mesh file.
const UPLOAD: &str = "blob";

/// The part of a job that has a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FieldSection {
    /// `input`.
    Input,
    /// `plan`.
    Plan,
}

/// The values that a field accepts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FieldValues {
    /// `true` or `false`.
    Flag,
    /// A text; one of these if the list is not empty.
    Text(Vec<String>),
    /// A number.
    Number,
    /// A whole number, or either a number or a flag.
    Scalar,
    /// A list of numbers, or a text in its place.
    Numbers,
    /// An object with these fields.
    Object(Vec<Field>),
}

/// A field of the input or of the plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Field {
    /// The part of the job that has the field.
    pub(crate) part: FieldSection,
    /// The name.
    pub(crate) name: String,
    /// The description.
    pub(crate) doc: String,
    /// The values that the field accepts.
    pub(crate) takes: FieldValues,
}

/// An option of outputs, with the declaration of each format that has it.
#[derive(Debug, Clone)]
pub(crate) struct OutputField {
    /// The name.
    pub(crate) name: &'static str,
    /// The declarations, each with the name of its format; at least one.
    pub(crate) declared: Vec<(&'static str, &'static Parameter)>,
}

impl Field {
    /// Converts a text to the JSON value of the field.
    pub(crate) fn value(&self, text: &str) -> Value {
        match &self.takes {
            FieldValues::Text(_) => text.into(),
            FieldValues::Flag | FieldValues::Number | FieldValues::Scalar => {
                text.parse().map_or_else(|_| number(text), Value::Bool)
            }
            FieldValues::Numbers => numbers(text),
            FieldValues::Object(fields) => object(text, |name, text| {
                let known = fields.iter().find(|field| field.name == name);
                known.map_or_else(|| number(text), |field| field.value(text))
            }),
        }
    }
}

impl OutputField {
    /// Returns the kind of the option; declarations of one name differ in their bounds only.
    pub(crate) fn kind(&self) -> &'static ParameterKind {
        &self.declared[0].1.kind
    }

    /// Converts a text to the JSON value of the option.
    pub(crate) fn value(&self, text: &str) -> Value {
        written(self.kind(), text)
    }
}

/// Returns the fields of the input and the plan of a job that take a text, a number, a flag, numbers or an object of
/// such values, in their order.
pub(crate) fn fields() -> Vec<Field> {
    let is_short = |field: &Field| field.name != UPLOAD;
    let all = [of::<InputRequest>(FieldSection::Input), of::<PlanRequest>(FieldSection::Plan)].concat();
    all.into_iter().filter(is_short).collect()
}

/// Returns the options of all formats, each name once, in the order of the formats.
pub(crate) fn output_fields() -> Vec<OutputField> {
    let describes = output::described().map(|format| (format, &DESCRIBE)).collect();
    let mut found = vec![
        OutputField { name: FRAME.name, declared: vec![("every format", &FRAME)] },
        OutputField { name: DESCRIBE.name, declared: describes },
    ];
    for (format, parameter) in FORMATS.iter().flat_map(|f| f.facts().parameters.iter().map(|p| (f.name(), p))) {
        match found.iter_mut().find(|field| field.name == parameter.name) {
            Some(field) => field.declared.push((format, parameter)),
            None => found.push(OutputField { name: parameter.name, declared: vec![(format, parameter)] }),
        }
    }
    found
}

/// Returns the fields of a part that a short text can give.
fn of<T: ToSchema>(part: FieldSection) -> Vec<Field> {
    let mut referred = Vec::new();
    T::schemas(&mut referred);
    let json = |schema| serde_json::to_value(schema).unwrap_or_default();
    let referred: Vec<(String, Value)> = referred.into_iter().map(|(name, schema)| (name, json(schema))).collect();
    let mut declared = Vec::new();
    properties(&json(<T as PartialSchema>::schema()), &mut declared);
    simple(part, declared, &referred)
}

/// Returns the fields among `declared` that a short text can give; `referred` holds the schemas that they refer to.
fn simple(part: FieldSection, declared: Vec<(String, Value)>, referred: &[(String, Value)]) -> Vec<Field> {
    let mut found = Vec::new();
    for (name, schema) in declared {
        let mut met = Met { doc: None, types: Vec::new(), choices: Vec::new(), inner: None };
        met.read(&schema, referred);
        let known = found.iter().any(|field: &Field| field.name == name);
        let inner = met.inner.take().map(|inner| simple(part, inner, referred));
        if let (Some(takes), false) = (met.takes(inner), known) {
            found.push(Field { part, name, doc: met.doc.unwrap_or_default().replace('\n', " "), takes });
        }
    }
    found
}

/// Appends the properties of an object, or of all its alternatives.
fn properties(schema: &Value, found: &mut Vec<(String, Value)>) {
    let own = schema["properties"].as_object().into_iter().flatten();
    found.extend(own.map(|(name, schema)| (name.clone(), schema.clone())));
    alternatives(schema).for_each(|schema| properties(schema, found));
}

fn alternatives(schema: &Value) -> impl Iterator<Item = &Value> {
    ["oneOf", "anyOf", "allOf"].into_iter().filter_map(|of| schema[of].as_array()).flatten()
}

/// The facts gathered from the schema of a field.
struct Met {
    doc: Option<String>,
    types: Vec<String>,
    choices: Vec<String>,
    /// The properties of an object schema without required properties.
    inner: Option<Vec<(String, Value)>>,
}

impl Met {
    fn read(&mut self, schema: &Value, referred: &[(String, Value)]) {
        if let (Some(doc), None) = (schema["description"].as_str(), &self.doc) {
            self.doc = Some(doc.to_owned());
        }
        let types = schema["type"].as_array().map_or(std::slice::from_ref(&schema["type"]), Vec::as_slice);
        self.types.extend(types.iter().filter_map(Value::as_str).map(str::to_owned));
        self.choices.extend(schema["enum"].as_array().into_iter().flatten().filter_map(Value::as_str).map(Into::into));
        if schema["properties"].is_object() && schema["required"].is_null() {
            properties(schema, self.inner.get_or_insert_default());
        }
        alternatives(schema).for_each(|schema| self.read(schema, referred));
        let name = schema["$ref"].as_str().and_then(|place| place.rsplit('/').next());
        if let Some((_, schema)) = referred.iter().find(|(known, _)| Some(known.as_str()) == name) {
            self.read(schema, referred);
        }
    }

    /// Returns the values that a field of these types accepts; `None` if a short text cannot give them.
    fn takes(&self, inner: Option<Vec<Field>>) -> Option<FieldValues> {
        let mut types: Vec<&str> = self.types.iter().map(String::as_str).filter(|name| *name != "null").collect();
        types.dedup();
        match types.as_slice() {
            ["boolean"] => Some(FieldValues::Flag),
            ["string"] => Some(FieldValues::Text(self.choices.clone())),
            ["number"] => Some(FieldValues::Number),
            ["object"] => inner.map(FieldValues::Object),
            ["array", "string"] => Some(FieldValues::Numbers),
            [] => None,
            types if types.iter().all(|name| ["boolean", "number", "integer"].contains(name)) => {
                Some(FieldValues::Scalar)
            }
            _ => None,
        }
    }
}
