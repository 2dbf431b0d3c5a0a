//! Schemas of parameters, derived from their declarations.

use utoipa::openapi::schema::AdditionalProperties;
use utoipa::openapi::{Array, ArrayBuilder, Object, ObjectBuilder, OneOfBuilder, RefOr, Schema, Type};

use super::schema::{COLOR_PATTERN, literal, of};
use crate::math::parameter::{Default, MAX_PARAMETER_NAME, Parameter, ParameterKind};

/// Adds a property for each declared parameter to the schema of an object.
pub(super) fn with_all(object: ObjectBuilder, declared: &[Parameter]) -> ObjectBuilder {
    declared.iter().fold(object, |object, parameter| {
        let object = object.property(parameter.name, described(parameter));
        if parameter.is_required() { object.required(parameter.name) } else { object }
    })
}

/// Returns the schema of an object with these parameters and no other fields.
pub(super) fn object(declared: &[Parameter]) -> ObjectBuilder {
    with_all(of(Type::Object), declared).additional_properties(Some(AdditionalProperties::FreeForm(false)))
}

/// Returns the schema of a parameter, whose description states its effect, its unit and its default.
///
/// Only the description states the default: generators treat a field with the keyword `default` as always present.
fn described(parameter: &Parameter) -> RefOr<Schema> {
    let mut doc = parameter.doc.trim_end_matches('.').to_owned();
    doc.push('.');
    if !parameter.unit.is_empty() {
        doc = format!("{doc} In {}.", parameter.unit);
    }
    let usual = match parameter.default {
        Default::Absent | Default::Required | Default::Fields => None,
        Default::Number(x) => Some(x.to_string()),
        Default::Flag(x) => Some(x.to_string()),
        Default::Text(x) => Some(x.to_owned()),
        Default::Texts(x) => Some(x.join(", ")),
    };
    if let Some(usual) = usual {
        doc = format!("{doc} `{usual}` when left out.");
    }
    value(&parameter.kind, Some(&doc))
}

/// Returns the schema of the values that a kind of parameter accepts.
pub(super) fn value(kind: &ParameterKind, doc: Option<&str>) -> RefOr<Schema> {
    match kind {
        ParameterKind::Number { min, max } => number(*min, *max).description(doc).into(),
        ParameterKind::Integer { min, max } => {
            of(Type::Integer).minimum(Some(whole(*min))).maximum(Some(whole(*max))).description(doc).into()
        }
        ParameterKind::Flag => of(Type::Boolean).description(doc).into(),
        ParameterKind::Choice(names) => one_of(names).description(doc).into(),
        ParameterKind::Name => {
            of(Type::String).min_length(Some(1)).max_length(Some(MAX_PARAMETER_NAME)).description(doc).into()
        }
        ParameterKind::Choices(names) => {
            let list = ArrayBuilder::new().items(one_of(names)).unique_items(true);
            list.max_items(Some(names.len())).description(doc).into()
        }
        ParameterKind::Expression { .. } => any_number().description(doc).into(),
        ParameterKind::Expressions { most, .. } => {
            let either = OneOfBuilder::new().item(any_number()).item(numbers(1, *most));
            either.description(doc).into()
        }
        ParameterKind::Numbers { most } => described_list(numbers(1, *most), doc),
        ParameterKind::Vector | ParameterKind::Direction => described_list(numbers(3, 3), doc),
        ParameterKind::Color => of(Type::String).pattern(Some(COLOR_PATTERN)).description(doc).into(),
        ParameterKind::Group(fields) => object(fields).description(doc).into(),
        ParameterKind::Groups { fields, most } => {
            let list = ArrayBuilder::new().items(object(fields));
            list.min_items(Some(1)).max_items(Some(*most)).description(doc).into()
        }
    }
}

/// Converts the bound of a whole number, which has 64 bits at most, for the schema.
fn whole(bound: i64) -> isize {
    isize::try_from(bound).expect("pointers have 64 bits")
}

fn one_of(names: &[&'static str]) -> ObjectBuilder {
    of(Type::String).enum_values(Some(names.iter().copied()))
}

/// Returns the schema of a number within bounds or the text of an expression.
fn number(min: f64, max: f64) -> ObjectBuilder {
    let finite = |bound: f64| bound.is_finite().then_some(bound);
    literal().minimum(finite(min)).maximum(finite(max))
}

fn any_number() -> ObjectBuilder {
    number(f64::NEG_INFINITY, f64::INFINITY)
}

fn numbers(least: usize, most: usize) -> ArrayBuilder {
    ArrayBuilder::new().items(Object::from(any_number())).min_items(Some(least)).max_items(Some(most))
}

fn described_list(list: ArrayBuilder, doc: Option<&str>) -> RefOr<Schema> {
    Schema::from(Array::from(list.description(doc))).into()
}
