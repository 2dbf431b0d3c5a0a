//! The catalogue of operators, presets and formats with their parameters, and of readers.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

use crate::input::{READERS, Reader};
use crate::math::parameter::{Default, Parameter, ParameterKind};
use crate::output::{FORMATS, Format, ShapeKind};
use crate::scheme::claim::Claim;
use crate::scheme::operator::Operator;
use crate::scheme::ops::OPERATORS;
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::preset::{Preset, Refines};
use crate::scheme::presets::PRESETS;

/// One parameter or option.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ParameterEntry {
    /// The name of the parameter or option.
    pub name: &'static str,
    /// What may be written, in words.
    pub expects: String,
    /// The unit of its values, where they have one.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Whether it must be given.
    pub required: bool,
    /// The value when the parameter is left out; null when there is none.
    pub default: Value,
    /// Bounds, choices or fields, by kind.
    #[serde(flatten)]
    pub bounds: BoundsEntry,
    /// What the parameter does.
    pub doc: &'static str,
}

/// What bounds a parameter, by its kind.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct BoundsEntry {
    /// The kind of its values.
    pub kind: &'static str,
    /// The smallest number allowed; null where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<f64>)]
    pub min: Option<Value>,
    /// The largest number allowed; null where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<f64>)]
    pub max: Option<Value>,
    /// The names to choose from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choices: Option<&'static [&'static str]>,
    /// The variable that an expression may use.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variable: Option<&'static str>,
    /// The fields of an object.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(no_recursion)]
    pub fields: Option<Vec<ParameterEntry>>,
    /// The most entries of a list.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most: Option<usize>,
}

/// One preset.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PresetEntry {
    /// The name of the preset.
    pub name: &'static str,
    /// What the preset refines: `polygons`, `meshes` or both.
    pub refines: &'static [&'static str],
    /// The parameters of the preset.
    pub parameters: Vec<ParameterEntry>,
    /// What the preset is, with the formula.
    pub doc: &'static str,
    /// What the preset claims of its limits, as POST /v1/analyses finds it at the values named.
    pub claims: Vec<ClaimEntry>,
    /// Author, year, page.
    pub source: &'static str,
}

/// What holds of a preset for some values of its parameters. Numbers are texts of constant expressions that may use the
/// parameters by their names.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ClaimEntry {
    /// For which values of the parameters it holds; absent where it does for all.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub range: &'static str,
    /// Values of parameters at which it is tested.
    #[schema(value_type = Vec<Object>)]
    pub at: Vec<BTreeMap<&'static str, &'static str>>,
    /// The largest k for which limits are C^k, of the static limit where levels change.
    pub smoothness: &'static str,
    /// The width of the support of the basic limit function.
    pub support: &'static str,
    /// The largest degree of polynomials that are limits of their own samples.
    pub reproduction_degree: &'static str,
    /// Of which shapes it is said: `polygons` or `meshes`, of which smoothness, support and reproduction are those
    /// where nothing is extraordinary.
    pub of: &'static str,
    /// On meshes the least and the greatest valence of vertices, or of faces where these take their place, at which
    /// limits are C1; absent on polygons, and where they are C1 nowhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c1_valences: Option<[u32; 2]>,
}

/// One operator.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct OperatorEntry {
    /// The letter of the operator in words.
    pub letter: char,
    /// The name of the operator.
    pub name: &'static str,
    /// The plan parameters that it uses.
    pub parameters: Vec<ParameterEntry>,
    /// What the operator does, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
}

/// One format.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct FormatEntry {
    /// The name of the format.
    pub name: &'static str,
    /// The media type of its files.
    pub media_type: &'static str,
    /// The extension of its files.
    pub extension: &'static str,
    /// What its files hold: `polygons`, `meshes` or both.
    pub holds: Vec<&'static str>,
    /// The options of the format.
    pub options: Vec<ParameterEntry>,
    /// What the format is.
    pub doc: &'static str,
}

/// One reader of mesh files.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ReaderEntry {
    /// The name of the reader, the `format` of `input.text`.
    pub name: &'static str,
    /// Media type of the files.
    pub media_type: &'static str,
    /// File extension.
    pub extension: &'static str,
    /// What the reader reads.
    pub doc: &'static str,
}

impl ParameterEntry {
    /// Creates the catalogue entry of a parameter.
    pub(crate) fn new(parameter: &Parameter) -> Self {
        Self {
            name: parameter.name,
            expects: parameter.kind.expected(),
            unit: parameter.unit,
            required: parameter.is_required(),
            default: default(parameter.default),
            bounds: bounds(&parameter.kind),
            doc: parameter.doc,
        }
    }

    fn all(parameters: &[Parameter]) -> Vec<Self> {
        parameters.iter().map(Self::new).collect()
    }
}

fn default(default: Default) -> Value {
    match default {
        Default::Absent | Default::Required => Value::Null,
        Default::Number(x) => number(x),
        Default::Flag(x) => json!(x),
        Default::Text(x) => json!(x),
        Default::Texts(x) => json!(x),
        Default::Fields => json!({}),
    }
}

/// Converts a number to JSON, without a fraction if it is whole.
fn number(x: f64) -> Value {
    #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
    if x.fract() == 0.0 && x.abs() < 1e15 { json!(x as i64) } else { json!(x) }
}

fn bounds(kind: &ParameterKind) -> BoundsEntry {
    let bound = |x: f64| Some(if x.is_finite() { number(x) } else { Value::Null });
    let of = |kind| BoundsEntry { kind, ..BoundsEntry::default() };
    match kind {
        ParameterKind::Number { min, max } => BoundsEntry { min: bound(*min), max: bound(*max), ..of("number") },
        ParameterKind::Integer { min, max } => {
            BoundsEntry { min: Some(json!(min)), max: Some(json!(max)), ..of("integer") }
        }
        ParameterKind::Flag => of("flag"),
        ParameterKind::Choice(names) => BoundsEntry { choices: Some(names), ..of("choice") },
        ParameterKind::Name => of("name"),
        ParameterKind::Choices(names) => BoundsEntry { choices: Some(names), ..of("choices") },
        ParameterKind::Expression { variable } => BoundsEntry { variable: Some(variable), ..of("expression") },
        ParameterKind::Expressions { variable, most } => {
            BoundsEntry { variable: Some(variable), most: Some(*most), ..of("expressions") }
        }
        ParameterKind::Numbers { most } => BoundsEntry { most: Some(*most), ..of("numbers") },
        ParameterKind::Color => of("color"),
        ParameterKind::Vector => of("vector"),
        ParameterKind::Direction => of("direction"),
        ParameterKind::Group(fields) => BoundsEntry { fields: Some(ParameterEntry::all(fields)), ..of("group") },
        ParameterKind::Groups { fields, most } => {
            BoundsEntry { fields: Some(ParameterEntry::all(fields)), most: Some(*most), ..of("groups") }
        }
    }
}

impl ClaimEntry {
    fn new(claim: &Claim) -> Self {
        let Claim { range, at, smoothness, support, reproduction_degree, valences: c1_valences, is_of_meshes } = *claim;
        let at = at.iter().map(|values| values.iter().copied().collect()).collect();
        let of = if is_of_meshes { "meshes" } else { "polygons" };
        Self { range, at, smoothness, support, reproduction_degree, of, c1_valences }
    }
}

impl PresetEntry {
    fn new(preset: &Preset) -> Self {
        let refines: &[&str] = match preset.refines {
            Refines::Curves => &["polygons"],
            Refines::Meshes => &["meshes"],
            Refines::Both => &["polygons", "meshes"],
        };
        Self {
            name: preset.name,
            refines,
            parameters: ParameterEntry::all(preset.parameters),
            doc: preset.doc,
            claims: preset.claims.iter().map(ClaimEntry::new).collect(),
            source: preset.source,
        }
    }
}

impl OperatorEntry {
    fn new(operator: &dyn Operator) -> Option<Self> {
        let used = WORD_PARAMETERS.iter().filter(|parameter| operator.facts().uses.contains(&parameter.name));
        Some(Self {
            letter: operator.facts().letter?,
            name: operator.facts().name,
            parameters: used.map(ParameterEntry::new).collect(),
            doc: operator.facts().doc,
            source: operator.facts().source,
        })
    }
}

impl FormatEntry {
    fn new(format: &dyn Format) -> Self {
        let kinds = [("polygons", ShapeKind::Curves { dimension: 2 }), ("meshes", ShapeKind::Mesh)];
        Self {
            name: format.name(),
            media_type: format.media_type(),
            extension: format.extension(),
            holds: kinds.into_iter().filter(|(_, kind)| format.holds(*kind).is_ok()).map(|(name, _)| name).collect(),
            options: ParameterEntry::all(format.facts().parameters),
            doc: format.facts().doc,
        }
    }
}

/// Returns all presets.
pub fn presets() -> Vec<PresetEntry> {
    PRESETS.iter().map(|preset| PresetEntry::new(preset)).collect()
}

/// Returns all operators that have a letter.
pub fn operators() -> Vec<OperatorEntry> {
    OPERATORS.iter().filter_map(|operator| OperatorEntry::new(*operator)).collect()
}

/// Returns all formats.
pub fn formats() -> Vec<FormatEntry> {
    FORMATS.iter().map(|format| FormatEntry::new(*format)).collect()
}

/// Returns all readers of mesh files, and `json`, which the request itself reads.
pub fn readers() -> Vec<ReaderEntry> {
    let of = |&Reader { name, media_type, doc, .. }: &Reader| ReaderEntry { name, media_type, extension: name, doc };
    let doc = "A mesh as input.mesh has it, with all that belongs to it";
    let json = ReaderEntry { name: "json", media_type: "application/json", extension: "json", doc };
    READERS.iter().map(of).chain([json]).collect()
}
