//! The query parameters beside a mesh file in the OpenAPI document: one for each place that a short text can give, from
//! the declarations of presets, formats and fields.

use utoipa::PartialSchema;
use utoipa::openapi::path::{Parameter as Described, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::AnyOfBuilder;
use utoipa::openapi::{RefOr, Schema, Type};

use super::declared;
use super::fields::{Field, FieldSection, FieldValues, fields, output_fields};
use super::levels::MAX_LEVELS_ASKED;
use super::schema::of;
use super::variants;
use super::weld::WeldRequest;
use crate::math::parameter::{Parameter, ParameterKind};
use crate::output::FORMATS;
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::preset::Refines;
use crate::scheme::presets::PRESETS;

/// A declaration, with the name of the preset or format that makes it.
type NamedParameter = (&'static str, &'static Parameter);

/// Returns all query parameters but `keep`, in the order of the documentation.
pub fn described() -> Vec<Described> {
    let presets = PRESETS.iter().filter(|preset| preset.refines != Refines::Curves);
    let names = of(Type::String).enum_values(Some(presets.clone().map(|preset| preset.name)));
    let formats = of(Type::String).enum_values(Some(FORMATS.iter().map(|format| format.name())));
    let count = of(Type::Integer).minimum(Some(0)).maximum(Some(MAX_LEVELS_ASKED));
    let levels = AnyOfBuilder::new().item(count).item(of(Type::String).enum_values(Some(["auto"])));
    let tolerance = of(Type::Number).exclusive_minimum(Some(0.0));
    let mut found = vec![
        parameter("preset", "The preset that refines the mesh, see `/v1/presets`.", names),
        parameter("word", "A word over operators in place of a preset, see `/v1/operators`.", variants::word()),
        parameter("levels", "How often the plan is applied; `auto` for pictures.", levels),
        parameter("levels.tolerance", "How far the result may be from its limit, in place of `levels`.", tolerance),
        parameter("format", "The format of the result; without it `Accept` chooses.", formats),
    ];
    let fields = fields().into_iter().filter(|field| !["preset", "word"].contains(&field.name.as_str()));
    fields.for_each(|field| {
        let family = if field.part == FieldSection::Input { "input." } else { "" };
        of_field(family, &field, &mut found);
    });
    let of_presets = presets.flat_map(|preset| preset.parameters.iter().map(|parameter| (preset.name, parameter)));
    let of_words = WORD_PARAMETERS.iter().map(|parameter| ("word", parameter));
    for (name, declared) in by_name(of_presets.chain(of_words)) {
        put(&format!("parameters.{name}"), &declared, &mut found);
    }
    for field in output_fields() {
        put(&format!("output.{}", field.name), &field.declared, &mut found);
    }
    found
}

fn parameter(name: &str, doc: &str, schema: impl Into<RefOr<Schema>>) -> Described {
    let doc = format!("Beside a mesh file: {doc}");
    ParameterBuilder::new()
        .name(name)
        .parameter_in(ParameterIn::Query)
        .description(Some(doc))
        .schema(Some(schema))
        .build()
}

/// Adds the parameters of a field; an object gives one for each of its fields.
fn of_field(family: &str, field: &Field, found: &mut Vec<Described>) {
    let name = format!("{family}{}", field.name);
    let schema: RefOr<Schema> = match &field.takes {
        FieldValues::Flag => of(Type::Boolean).into(),
        FieldValues::Text(names) if names.is_empty() => of(Type::String).into(),
        FieldValues::Text(names) => of(Type::String).enum_values(Some(names.clone())).into(),
        FieldValues::Scalar if field.name == "weld" => WeldRequest::schema(),
        FieldValues::Number => of(Type::Number).into(),
        FieldValues::Scalar => of(Type::Integer).minimum(Some(0)).into(),
        FieldValues::Numbers => of(Type::String).min_length(Some(1)).into(),
        FieldValues::Object(fields) => {
            fields.iter().for_each(|field| of_field(&format!("{name}."), field, found));
            return;
        }
    };
    found.push(parameter(&name, &field.doc, schema));
}

/// Groups declarations by name, in the order of their first occurrence.
fn by_name(all: impl Iterator<Item = NamedParameter>) -> Vec<(&'static str, Vec<NamedParameter>)> {
    let mut found: Vec<(&'static str, Vec<NamedParameter>)> = Vec::new();
    for (who, parameter) in all {
        match found.iter_mut().find(|(name, _)| *name == parameter.name) {
            Some((_, declared)) => declared.push((who, parameter)),
            None => found.push((parameter.name, vec![(who, parameter)])),
        }
    }
    found
}

/// Adds the parameters of one declared name: groups give one for each field, lists are texts.
fn put(name: &str, declared: &[NamedParameter], found: &mut Vec<Described>) {
    let fields = declared.iter().filter_map(|(who, parameter)| match parameter.kind {
        ParameterKind::Group(fields) => Some(fields.iter().map(move |field| (*who, field))),
        _ => None,
    });
    let fields = by_name(fields.flatten());
    if !fields.is_empty() {
        fields.iter().for_each(|(field, declared)| put(&format!("{name}.{field}"), declared, found));
        return;
    }
    let (mut schemas, mut choices): (Vec<RefOr<Schema>>, Vec<&str>) = (Vec::new(), Vec::new());
    for (_, parameter) in declared {
        if let ParameterKind::Choice(names) = parameter.kind {
            choices.extend(names.iter().filter(|name| !choices.contains(name)).collect::<Vec<_>>());
            continue;
        }
        let schema = text_of(&parameter.kind);
        if !schemas.contains(&schema) {
            schemas.push(schema);
        }
    }
    if !choices.is_empty() {
        schemas.push(of(Type::String).enum_values(Some(choices)).into());
    }
    let schema = match schemas.as_slice() {
        [one] => one.clone(),
        several => several.iter().cloned().fold(AnyOfBuilder::new(), AnyOfBuilder::item).into(),
    };
    found.push(parameter(name, &joined_docs(declared), schema));
}

/// Joins the descriptions of a parameter, each with the presets or formats that give it.
fn joined_docs(declared: &[NamedParameter]) -> String {
    let mut said: Vec<(&str, Vec<&str>)> = Vec::new();
    for (who, parameter) in declared {
        match said.iter_mut().find(|(doc, _)| *doc == parameter.doc) {
            Some((_, whose)) => whose.push(who),
            None => said.push((parameter.doc, vec![who])),
        }
    }
    let sentence = |(doc, whose): &(&str, Vec<&str>)| format!("{doc} (`{}`)", whose.join("`, `"));
    said.iter().map(sentence).collect::<Vec<_>>().join(" ")
}

/// Returns the schema of a value as text in a query. Lists are one text, with commas or as JSON; for an array, clients
/// would repeat the name.
fn text_of(kind: &ParameterKind) -> RefOr<Schema> {
    match kind {
        ParameterKind::Choices(_)
        | ParameterKind::Expressions { .. }
        | ParameterKind::Numbers { .. }
        | ParameterKind::Vector
        | ParameterKind::Direction
        | ParameterKind::Groups { .. } => of(Type::String).min_length(Some(1)).into(),
        ParameterKind::Number { .. }
        | ParameterKind::Integer { .. }
        | ParameterKind::Flag
        | ParameterKind::Choice(_)
        | ParameterKind::Name
        | ParameterKind::Expression { .. }
        | ParameterKind::Color
        | ParameterKind::Group(_) => declared::value(kind, None),
    }
}
