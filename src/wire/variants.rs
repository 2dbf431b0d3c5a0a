//! Schemas of inputs, plans and outputs: one for each kind, preset and format, with its own fields.

use std::borrow::Cow;

use utoipa::openapi::schema::{AdditionalProperties, Discriminator};
use utoipa::openapi::{Object, ObjectBuilder, OneOfBuilder, Ref, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::declared::{object, with_all};
use super::input::InputRequest;
use super::output::{OutputRequest, common};
use super::plan::PlanRequest;
use super::schema::of;
use crate::math::parameter::Parameter;
use crate::output::FORMATS;
use crate::scheme::ops::OPERATORS;
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::presets::PRESETS;
use crate::scheme::word;

/// A schema with its name.
type NamedSchema = (String, RefOr<Schema>);

/// The schema of an input: the alternatives are the kinds of inputs.
#[derive(Debug)]
pub(super) struct InputSchema;

/// The kinds of inputs: the field, the name of the schema, and whether the input is a mesh.
const INPUT_KINDS: [(&str, &str, bool); 5] = [
    ("mesh", "MeshInput", true),
    ("text", "TextInput", true),
    ("blob", "BlobInput", true),
    ("polygon", "PolygonInput", false),
    ("polygons", "PolygonsInput", false),
];
/// The fields of every kind of input; all others are about meshes.
const COMMON_INPUT_FIELDS: [&str; 2] = ["unit", "up"];

impl PartialSchema for InputSchema {
    fn schema() -> RefOr<Schema> {
        let kinds = INPUT_KINDS.iter().map(|(_, name, _)| Ref::from_schema_name(*name));
        kinds.fold(OneOfBuilder::new(), OneOfBuilder::item).description(Some("What is refined.")).into()
    }
}

impl ToSchema for InputSchema {
    fn name() -> Cow<'static, str> {
        Cow::Borrowed("InputRequest")
    }

    fn schemas(schemas: &mut Vec<NamedSchema>) {
        InputRequest::schemas(schemas);
        let RefOr::T(Schema::Object(all)) = InputRequest::schema() else { return };
        for (kind, name, is_mesh) in INPUT_KINDS {
            let belongs = |field: &str| {
                let is_kind = INPUT_KINDS.iter().any(|(other, ..)| *other == field);
                if is_kind { field == kind } else { is_mesh || COMMON_INPUT_FIELDS.contains(&field) }
            };
            let fields = all.properties.iter().filter(|(field, _)| belongs(field));
            let fields =
                fields.map(|(field, schema)| (field, if field == kind { given(schema) } else { schema.clone() }));
            let input = fields.fold(of(Type::Object), |input, (field, schema)| input.property(field, schema));
            let input = input.required(kind).additional_properties(Some(AdditionalProperties::FreeForm(false)));
            schemas.push((name.to_owned(), input.into()));
        }
    }
}

/// Returns the schema of a nullable field without null.
fn given(schema: &RefOr<Schema>) -> RefOr<Schema> {
    match schema {
        RefOr::T(Schema::OneOf(either)) => {
            let given = either.items.iter().find(|item| matches!(item, RefOr::Ref(_)));
            given.unwrap_or(schema).clone()
        }
        RefOr::T(Schema::Array(list)) => {
            let mut given = list.clone();
            given.schema_type = Type::Array.into();
            Schema::Array(given).into()
        }
        other => other.clone(),
    }
}

/// The schema of a plan: that of a preset, chosen by its name, or that of a word.
#[derive(Debug)]
pub(super) struct PlanSchema;

/// The name of the schema of all presets.
const PRESET: &str = "PresetPlan";
/// The name of the schema of words.
const WORD_SCHEMA: &str = "WordPlan";

impl PartialSchema for PlanSchema {
    fn schema() -> RefOr<Schema> {
        let either =
            [PRESET, WORD_SCHEMA].into_iter().map(Ref::from_schema_name).fold(OneOfBuilder::new(), OneOfBuilder::item);
        either.description(Some("How the input is refined: a preset or a word.")).into()
    }
}

impl ToSchema for PlanSchema {
    fn name() -> Cow<'static, str> {
        Cow::Borrowed("PlanRequest")
    }

    fn schemas(schemas: &mut Vec<NamedSchema>) {
        PlanRequest::schemas(schemas);
        let presets = PRESETS.iter().map(|preset| {
            let parameters = object(preset.parameters).description(Some("Parameters of the preset."));
            let is_needed = preset.parameters.iter().any(Parameter::is_required);
            (preset.name, plan(("preset", chosen(preset.name)), parameters, is_needed, preset.doc))
        });
        schemas.extend(chosen_by(PRESET, "preset", "A preset with its parameters.", presets.collect()));
        let text = word().description(Some("A word over operators, see `/v1/operators`.")).examples(["UCP"]);
        let parameters = object(WORD_PARAMETERS).description(Some("Parameters of the word."));
        let word = plan(("word", text), parameters, false, "A word over operators with its parameters.");
        schemas.push((WORD_SCHEMA.to_owned(), word.into()));
    }
}

/// Returns the schema of a word over operators.
pub(super) fn word() -> ObjectBuilder {
    let letters: String = OPERATORS.iter().filter_map(|operator| operator.facts().letter).collect();
    of(Type::String).pattern(Some(format!("^[{letters}0-9^()]+$"))).max_length(Some(word::MAX_WORD_BYTES))
}

/// Returns the schema of one kind of plan: the fields of all plans, the field that identifies the kind, and the
/// parameters.
fn plan(
    (field, of_field): (&str, ObjectBuilder),
    parameters: ObjectBuilder,
    needs_parameters: bool,
    doc: &str,
) -> ObjectBuilder {
    let mut plan = of(Type::Object).property(field, of_field).required(field).property("parameters", parameters);
    if needs_parameters {
        plan = plan.required("parameters");
    }
    let RefOr::T(Schema::Object(common)) = PlanRequest::schema() else { return plan };
    let common =
        common.properties.into_iter().filter(|(name, _)| !["preset", "word", "parameters"].contains(&name.as_str()));
    let plan = common.fold(plan, |plan, (name, schema)| plan.property(name, schema));
    plan.additional_properties(Some(AdditionalProperties::FreeForm(false))).description(Some(doc))
}

impl PartialSchema for OutputRequest {
    fn schema() -> RefOr<Schema> {
        let variants = FORMATS.iter().map(|format| format.name());
        one_by("format", "Output", "One result: a format with its options.", variants).into()
    }
}

impl ToSchema for OutputRequest {
    fn schemas(schemas: &mut Vec<NamedSchema>) {
        schemas.extend(FORMATS.iter().map(|format| {
            let facts = format.facts();
            let doc = "Name among the outputs of the job; the format's when left out.";
            let name = of(Type::String).pattern(Some("^[A-Za-z0-9._-]{1,64}$")).description(Some(doc));
            let output = object(&common(facts.name)).property("format", chosen(facts.name));
            let output = output.required("format").property("name", name);
            let output = with_all(output, facts.parameters).description(Some(facts.doc));
            (variant(facts.name, "Output"), output.into())
        }));
    }
}

/// Returns the schema of a field with this single value.
fn chosen(name: &'static str) -> ObjectBuilder {
    of(Type::String).enum_values(Some([name])).description(Some("The name that chooses what the other fields mean."))
}

/// Returns the schemas of plans that a field chooses by name, preceded by their union.
fn chosen_by(name: &str, field: &str, doc: &str, variants: Vec<(&'static str, ObjectBuilder)>) -> Vec<NamedSchema> {
    let any = one_by(field, "Plan", doc, variants.iter().map(|(name, _)| *name));
    let of_variant = |(name, schema): (&str, ObjectBuilder)| (variant(name, "Plan"), Object::from(schema).into());
    let variants = variants.into_iter().map(of_variant);
    std::iter::once((name.to_owned(), any.into())).chain(variants).collect()
}

/// Returns the union of the schemas that a field chooses by name.
fn one_by(field: &str, kind: &str, doc: &str, names: impl Iterator<Item = &'static str> + Clone) -> OneOfBuilder {
    let location = |name| Ref::from_schema_name(variant(name, kind));
    let mapping = names.clone().map(|name| (name, location(name).ref_location));
    let any = names.map(location).fold(OneOfBuilder::new(), OneOfBuilder::item);
    any.discriminator(Some(Discriminator::with_mapping(field, mapping))).description(Some(doc))
}

/// Returns the name of the schema of a preset or format, such as `CatmullClarkPlan` or `GlbOutput`.
fn variant(name: &str, kind: &str) -> String {
    let capital = |part: &str| {
        let (first, rest) = part.split_at(part.len().min(1));
        first.to_uppercase() + rest
    };
    name.split(['-', '_']).map(capital).chain([kind.to_owned()]).collect()
}
