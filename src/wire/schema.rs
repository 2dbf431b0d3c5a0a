//! Schemas that types alone do not determine.

use utoipa::openapi::schema::{AdditionalProperties, SchemaType};
use utoipa::openapi::{ArrayBuilder, Object, ObjectBuilder, OneOfBuilder, RefOr, Schema, Type};

use crate::input::READERS;
use crate::math::expression;
use crate::shape::mesh::MAX_MESH_FRAMES;

/// Returns the schema of values of one type.
pub(super) fn of(kind: Type) -> ObjectBuilder {
    only(SchemaType::new(kind))
}

/// Returns the schema of values of one of these types.
pub(super) fn only(kinds: SchemaType) -> ObjectBuilder {
    ObjectBuilder::new().schema_type(kinds)
}

/// Returns the schema of a number or the text of an expression; it restricts the characters of the text only.
pub(super) fn literal() -> ObjectBuilder {
    only(SchemaType::from_iter([Type::Number, Type::String]))
        .min_length(Some(1))
        .max_length(Some(expression::MAX_EXPRESSION_BYTES))
        .pattern(Some("^[A-Za-z0-9_ .,()+*/^-]+$"))
}

/// Returns the schema of an end of a scan.
pub(super) fn end_of_scan() -> RefOr<Schema> {
    let doc = "The first value, or the last, which lies above it: a number, or a constant expression such as `1/81`, \
               which is exact where it is a fraction.";
    literal().description(Some(doc)).into()
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

/// Returns the schema of the format of a mesh file.
pub(super) fn file_format() -> RefOr<Schema> {
    let names = READERS.iter().map(|reader| reader.name).chain(["json"]);
    let doc = "The format of the file, see `/v1/readers`; `json` is a mesh as `input.mesh` has it.";
    of(Type::String).description(Some(doc)).enum_values(Some(names)).into()
}

/// Returns the schema of positions in space.
pub(super) fn positions() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 3, Some(3), "Vertex positions, `n x 3`, model units.")
}

/// Returns the schema of frames of positions in space.
pub(super) fn frames() -> RefOr<Schema> {
    let point = ArrayBuilder::new().items(of(Type::Number).build()).min_items(Some(3)).max_items(Some(3));
    let doc = "Other positions of the same vertices, frame after frame: frame 0 is `positions`, frame k entry k - 1 of \
               these. `glb` and `gltf` hold all frames, as morph targets; an output with a `frame` shows that one.";
    let frames = ArrayBuilder::new().items(ArrayBuilder::new().items(point));
    frames.max_items(Some(MAX_MESH_FRAMES - 1)).description(Some(doc)).into()
}

/// Returns the schema of points of a polygon.
pub(super) fn points() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 1, Some(4), "Points, all of the same 1 to 4 coordinates.")
}

/// Returns the schema of tangents of a polygon.
pub(super) fn tangents() -> RefOr<Schema> {
    let doc = "Tangents of the points, one a point, of any length but 0, for presets that use them (`incenter`); \
               without them each is that of the circle through the point and its neighbours.";
    let nullable = SchemaType::Array(vec![Type::Array, Type::Null]);
    listed(of(Type::Number).build(), 1, Some(4), doc).schema_type(nullable).into()
}

/// Returns the schema of texture coordinates.
pub(super) fn uv_values() -> RefOr<Schema> {
    lists(of(Type::Number).build(), 2, Some(2), "Values, `n x 2`; the second coordinate points up.")
}

/// Returns the schema of indices of values at the corners of faces.
pub(super) fn corner_values() -> RefOr<Schema> {
    let doc = "For each face of the mesh the values at its corners, in their order. Neighbours are joined where both \
               have the same values at both ends of their edge; all other edges are seams.";
    lists(index(), 3, None, doc)
}

/// Returns the schema of faces of a mesh.
pub(super) fn faces() -> RefOr<Schema> {
    let doc = "Faces as lists of 3 or more vertex indices, counted from 0, counter-clockwise seen from outside.";
    lists(index(), 3, None, doc)
}

/// Returns the schema of points in space.
pub(super) fn points_in_space() -> RefOr<Schema> {
    let doc = "Points, at most a million, whose closest places on the surface are looked for: `n x 3`, model units.";
    lists(of(Type::Number).build(), 3, Some(3), doc)
}

/// Returns the schema of places on faces.
pub(super) fn places() -> RefOr<Schema> {
    let doc = "Places on input faces, at most a million: `[face, u, v]`, u and v from 0 to 1. On a quad corner 0 is at \
               (0, 0), u runs towards corner 1 and v towards corner 3. Another face has a square for each of its \
               corners, `[face, u, v, corner]` (0 when left out): the corner is at (0, 0), u runs to the middle of the \
               edge to the next corner, v to that of the edge to the corner before, and the centre is at (1, 1).";
    lists(of(Type::Number).build(), 3, Some(4), doc)
}

/// Returns the schema of the two ends of an edge.
pub(super) fn ends() -> RefOr<Schema> {
    let doc = "The two ends of the edge, in any order.";
    ArrayBuilder::new().items(index()).min_items(Some(2)).max_items(Some(2)).description(Some(doc)).into()
}

/// Returns the schema of entries of a channel.
pub(super) fn channel_rows() -> RefOr<Schema> {
    let number = of(Type::Number).build();
    let row = ArrayBuilder::new().items(number.clone()).min_items(Some(1)).max_items(Some(4));
    ArrayBuilder::new().items(OneOfBuilder::new().item(number).item(row)).build().into()
}

/// The regular expression of texts that are colours.
pub(super) const COLOR_PATTERN: &str = "^(#([0-9a-fA-F]{3}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})|transparent)$";

/// Returns the schema of an optional colour with or without alpha.
pub(super) fn color() -> RefOr<Schema> {
    let component = of(Type::Number).minimum(Some(0)).maximum(Some(1));
    let doc = "Red, green, blue and perhaps alpha (1 when left out), sRGB from 0 to 1; or as a text like `#ff8800`.";
    let list = ArrayBuilder::new().items(component).min_items(Some(3)).max_items(Some(4));
    let text = of(Type::String).pattern(Some(COLOR_PATTERN));
    OneOfBuilder::new().item(list).item(text).item(of(Type::Null)).description(Some(doc)).into()
}

/// Returns the schema of edges as pairs of vertices.
pub(super) fn edges() -> RefOr<Schema> {
    lists(index(), 2, Some(2), "Edges as pairs of vertices, in any order.")
}

/// Returns the schema of pairs of vertices.
pub(super) fn pairs() -> RefOr<Schema> {
    lists(index(), 2, Some(2), "Pairs of vertices at the same place.")
}

/// Returns the schema of the numbers of columns and rows of a panel.
pub(super) fn span() -> RefOr<Schema> {
    let kind = SchemaType::Array(vec![Type::Array, Type::Null]);
    let number = of(Type::Integer).minimum(Some(1)).maximum(Some(12));
    let list = ArrayBuilder::new().items(number).min_items(Some(2)).max_items(Some(2));
    list.schema_type(kind).description(Some("Columns and rows that it spans, `[1, 1]` when left out.")).into()
}

/// Returns the schema of the seed of random perturbation.
pub(super) fn seed() -> RefOr<Schema> {
    let most = usize::try_from(u64::MAX).expect("pointers have 64 bits");
    let seed = only(SchemaType::from_iter([Type::Integer, Type::Null])).minimum(Some(0)).maximum(Some(most));
    seed.description(Some("Seed of random perturbation; without effect on plans that have none.")).into()
}

/// Returns the schema of counts by number; in JSON the numbers are texts.
pub(super) fn histogram() -> RefOr<Schema> {
    let properties = AdditionalProperties::from(of(Type::Integer).minimum(Some(0)));
    of(Type::Object).additional_properties(Some(properties)).description(Some("How many there are of each.")).into()
}
