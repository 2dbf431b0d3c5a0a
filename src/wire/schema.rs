//! Schemas that are not told by the types alone.

use utoipa::openapi::schema::{AdditionalProperties, SchemaType};
use utoipa::openapi::{ArrayBuilder, Object, ObjectBuilder, OneOfBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::output::OutputRequest;
use crate::input::READERS;
use crate::output::FORMATS;
use crate::shape::mesh::MAX_FRAMES;

fn of(kind: Type) -> ObjectBuilder {
    ObjectBuilder::new().schema_type(SchemaType::new(kind))
}

fn index() -> Object {
    of(Type::Integer).minimum(Some(0)).build()
}

fn lists(item: Object, least: usize, most: Option<usize>, doc: &str) -> RefOr<Schema> {
    listed(item, least, most, doc).into()
}

fn listed(item: Object, least: usize, most: Option<usize>, doc: &str) -> ArrayBuilder {
    let inner = ArrayBuilder::new().items(item).min_items(Some(least)).max_items(most);
    ArrayBuilder::new().items(inner).description(Some(doc))
}

/// The format of a mesh file.
pub(super) fn file_format() -> RefOr<Schema> {
    let names: Vec<&str> = READERS.iter().map(|reader| reader.name).collect();
    let doc = format!("The format of the file: `{}`, or `json` for a mesh as `input.mesh` has it.", names.join("`, `"));
    let pattern = format!("^({}|json)$", names.join("|"));
    of(Type::String).description(Some(doc)).pattern(Some(pattern)).into()
}

/// Positions in space.
pub(super) fn positions() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 3, Some(3), "Vertex positions, `n x 3`, model units.")
}

/// Positions in space, frame after frame.
pub(super) fn frames() -> RefOr<Schema> {
    let point = ArrayBuilder::new().items(of(Type::Number).build()).min_items(Some(3)).max_items(Some(3));
    let doc = "Other positions of the same vertices, frame after frame: frame 0 is `positions`, frame k entry k - 1 of \
               these. `glb` and `gltf` hold all frames, as morph targets; an output with a `frame` shows that one.";
    let frames = ArrayBuilder::new().items(ArrayBuilder::new().items(point));
    frames.max_items(Some(MAX_FRAMES - 1)).description(Some(doc)).into()
}

/// Points of a polygon.
pub(super) fn points() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 1, Some(4), "Points, all of the same 1 to 4 coordinates.")
}

/// Tangents of a polygon.
pub(super) fn tangents() -> RefOr<Schema> {
    let doc = "Tangents of the points, one a point, of any length but 0, for presets that use them (`incenter`); \
               without them each is that of the circle through the point and its neighbours.";
    let nullable = SchemaType::Array(vec![Type::Array, Type::Null]);
    listed(of(Type::Number).build(), 1, Some(4), doc).schema_type(nullable).into()
}

/// Texture coordinates.
pub(super) fn uv_values() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 2, Some(2), "Values, `n x 2`; the second coordinate points up.")
}

/// Texture coordinates at the corners of faces.
pub(super) fn uv_faces() -> RefOr<Schema> {
    let doc = "For each face of the mesh the values at its corners, in their order. Neighbours are joined where both \
               have the same values at both ends of their edge; all other edges are seams.";
    lists(index(), 3, None, doc)
}

/// Faces of a mesh.
pub(super) fn faces() -> RefOr<Schema> {
    let doc = "Faces as lists of 3 or more vertex indices, counted from 0, counter-clockwise seen from outside.";
    lists(index(), 3, None, doc)
}

/// The two ends of an edge.
pub(super) fn ends() -> RefOr<Schema> {
    let doc = "The two ends of the edge, in any order.";
    ArrayBuilder::new().items(index()).min_items(Some(2)).max_items(Some(2)).description(Some(doc)).into()
}

/// Channels of numbers on vertices.
pub(super) fn channels() -> RefOr<Schema> {
    let number = of(Type::Number).build();
    let row = ArrayBuilder::new().items(number.clone()).min_items(Some(1)).max_items(Some(4));
    let entry = OneOfBuilder::new().item(number).item(row);
    let properties = AdditionalProperties::from(RefOr::from(Schema::from(ArrayBuilder::new().items(entry).build())));
    let doc = "Numbers that vertices carry, by name: a number or a list of 1 to 4 numbers for each vertex. `color` \
               (red, green, blue, perhaps alpha; sRGB from 0 to 1) is the colour of the vertices.";
    of(Type::Object).additional_properties(Some(properties)).description(Some(doc)).into()
}

/// A colour with or without alpha.
pub(super) fn color() -> RefOr<Schema> {
    let component = of(Type::Number).minimum(Some(0)).maximum(Some(1));
    let doc = "Red, green, blue and perhaps alpha (1 when left out), sRGB from 0 to 1.";
    let kind = SchemaType::Array(vec![Type::Array, Type::Null]);
    let list = ArrayBuilder::new().items(component).min_items(Some(3)).max_items(Some(4));
    list.schema_type(kind).description(Some(doc)).into()
}

/// Edges as pairs of vertices.
pub(super) fn edges() -> RefOr<Schema> {
    lists(index(), 2, Some(2), "Edges as pairs of vertices, in any order.")
}

/// Pairs of vertices.
pub(super) fn pairs() -> RefOr<Schema> {
    lists(index(), 2, Some(2), "Pairs of vertices at the same place.")
}

/// How many there are of each number; as JSON has it, the numbers are texts.
pub(super) fn histogram() -> RefOr<Schema> {
    let properties = AdditionalProperties::from(of(Type::Integer).minimum(Some(0)));
    of(Type::Object).additional_properties(Some(properties)).description(Some("How many there are of each.")).into()
}

impl PartialSchema for OutputRequest {
    fn schema() -> RefOr<Schema> {
        let names = FORMATS.iter().map(|format| format.name());
        let format = of(Type::String).enum_values(Some(names)).description(Some("The format, see `/v1/formats`."));
        let doc = "Name among the outputs of the job; the format's when left out.";
        let name = of(Type::String).pattern(Some("^[A-Za-z0-9._-]{1,64}$")).description(Some(doc));
        let doc = "The frame of a mesh that it shows, as if the mesh had these positions alone.";
        let frame = of(Type::Integer).minimum(Some(0)).maximum(Some(MAX_FRAMES - 1)).description(Some(doc));
        let output = of(Type::Object).property("format", format).property("name", name).property("frame", frame);
        let doc = "One result: a `format`, a `name`, and the format's options, see `/v1/formats`.";
        let output = output.required("format");
        output.additional_properties(Some(AdditionalProperties::FreeForm(true))).description(Some(doc)).into()
    }
}

impl ToSchema for OutputRequest {}
