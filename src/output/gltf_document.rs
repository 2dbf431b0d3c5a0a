//! The JSON half of glTF: nodes, meshes with their materials, and the layout of the buffer.

use std::collections::BTreeMap;

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::{self, Valid};
use gltf::json::{self, Accessor, Asset, Extras, Index, Mesh, Node, Root, Scene};
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Map, Value, json};

use crate::math::parameter::Parameter;
use crate::output::bounds::CoordinateBounds;
use crate::output::error::FormatError;
use crate::output::gltf_amounts::{FLOAT_VECTOR_BYTES, ORIGIN_BYTES};
use crate::output::gltf_animation::{FRAME_RATE, animate};
use crate::output::gltf_buffer::{Buffer, PrimitiveFaces, PrimitiveVertices};
use crate::output::gltf_looks::{self, MaterialWriter};
use crate::output::gltf_packing::{COMPRESSION, VERTEX_ORDER};
use crate::output::gltf_targets::MorphTarget;
use crate::output::gltf_views::{CHANNEL_NUMBER_BYTES, Views, accessor, length};
use crate::output::hard_edges::CREASE_ANGLE;
use crate::output::numbers::rounded;
use crate::output::options::{IDS, POSITIONS};
use crate::shape::coordinate_system::{CoordinateSystem, Unit, Up};
use crate::shape::topology::index;

/// Linear base colour of curves.
const CURVE_BASE_COLOR: [f32; 4] = [0.03, 0.06, 0.1, 1.0];

/// Options of both containers.
pub(super) const GLTF_OPTIONS: &[Parameter] = &[
    Parameter::choice(
        "normals",
        &["area", "none", "limit"],
        "Vertex normals of a mesh: weighted by the area of the faces around the vertex, none (flat shading), or \
         those of the limit surface",
    ),
    CREASE_ANGLE,
    POSITIONS,
    IDS,
    FRAME_RATE,
    COMPRESSION,
    VERTEX_ORDER,
];

/// Returns the document that describes `buffer`, whose bytes are at `uri`, or, without a URI, in the container's own
/// chunk.
///
/// # Errors
/// More polygons than 32-bit indices reach.
pub(super) fn document(buffer: &Buffer<'_>, uri: Option<&str>) -> Result<Vec<u8>, FormatError> {
    let mut root = model(buffer)?;
    root.buffers.iter_mut().for_each(|buffer| buffer.uri = uri.map(Into::into));
    root.to_vec().map_err(|error| unwritten(&error))
}

/// Returns the document without the URI of its buffer.
///
/// The faces of a group are a mesh of a node of their own, both named by the group, below the node of all others.
///
/// # Errors
/// More polygons than 32-bit indices reach.
pub(super) fn model(buffer: &Buffer<'_>) -> Result<Root, FormatError> {
    if u32::try_from(buffer.parts.len()).is_err() {
        let n = buffer.parts.len();
        return Err(FormatError::Unfit(format!("{n} polygons, glTF holds at most {}; ask for json", u32::MAX)));
    }
    let mut root = Root { asset: asset(), scene: Some(Index::new(0)), ..Root::default() };
    let mut node = Node { name: Some("planish".into()), translation: translation(buffer), ..Node::default() };
    root.scenes = vec![Scene { extensions: None, extras: Extras::default(), name: None, nodes: vec![Index::new(0)] }];
    let parts = if buffer.is_mesh() { surface(buffer, &mut root)? } else { curves(buffer, &mut root) };
    let mut groups = Vec::new();
    for GroupPrimitives { group, primitives } in parts {
        let mesh = Some(Index::new(index(root.meshes.len())));
        let name = group.map(|group| buffer.attachments().groups.names[group].clone());
        let (extras, weights) = (target_names(buffer)?, buffer.targets.iter().map(|_| 0.0).collect());
        let weights = Some(weights).filter(|weights: &Vec<f32>| !weights.is_empty());
        root.meshes.push(Mesh { extensions: None, extras, name: name.clone(), primitives, weights });
        match name {
            None => node.mesh = mesh,
            name => groups.push(Node { name, mesh, ..Node::default() }),
        }
    }
    if !root.meshes.is_empty() {
        root.buffers = vec![buffer_of(buffer.amounts.bytes())];
    }
    root.nodes = oriented(node, buffer.coordinate_system);
    let first = root.nodes.len();
    if let Some(node) = root.nodes.last_mut().filter(|_| !groups.is_empty()) {
        node.children = Some((first..first + groups.len()).map(|child| Index::new(index(child))).collect());
    }
    root.nodes.extend(groups);
    if let Some(rate) = buffer.amounts.frame_rate.filter(|_| !root.meshes.is_empty()) {
        animate(&mut root, buffer.targets.len(), rate);
    }
    if !root.textures.is_empty() {
        MaterialWriter::of(buffer.attachments()).add_images(&mut root);
    }
    Ok(root)
}

/// Returns a buffer of this many bytes, without a URI.
pub(super) fn buffer_of(bytes: u128) -> json::Buffer {
    json::Buffer {
        byte_length: length(bytes).into(),
        name: None,
        uri: None,
        extensions: None,
        extras: Extras::default(),
    }
}

/// The primitives of the faces of one group, or of faces without a group.
struct GroupPrimitives {
    group: Option<usize>,
    primitives: Vec<Primitive>,
}

impl GroupPrimitives {
    /// Returns the primitives of faces without a group, if there are any.
    fn ungrouped(primitives: Vec<Primitive>) -> Vec<Self> {
        if primitives.is_empty() { Vec::new() } else { vec![Self { group: None, primitives }] }
    }
}

pub(super) fn unwritten(error: &serde_json::Error) -> FormatError {
    FormatError::Unfit(format!("the glTF document cannot be written: {error}"))
}

fn asset() -> Asset {
    Asset { generator: Some("planish".into()), version: "2.0".into(), ..Asset::default() }
}

fn translation(buffer: &Buffer<'_>) -> Option<[f32; 3]> {
    let moved = buffer.center.iter().any(|&x| x != 0.0);
    moved.then(|| buffer.center.map(|x| rounded(x) + 0.0))
}

/// Returns the node, turned so that y is up and scaled to metres. A node with a translation stays unchanged below
/// another one that turns and scales, so that its translation remains exact. The rotation is a matrix, whose entries
/// are exact: those of a quaternion are not, and far models would move because its length is not exactly 1.
fn oriented(mut node: Node, coordinate_system: CoordinateSystem) -> Vec<Node> {
    if coordinate_system.is_default() {
        return vec![node];
    }
    let metres = rounded(coordinate_system.unit.metres());
    // a quarter turn about x brings z to y; columns one after another
    let turned = [metres, 0., 0., 0., 0., 0., -metres, 0., 0., metres, 0., 0., 0., 0., 0., 1.];
    let (matrix, scale) = match coordinate_system.up {
        Up::Z => (Some(turned), None),
        Up::Y => (None, (coordinate_system.unit != Unit::Metre).then_some([metres; 3])),
    };
    if node.translation.is_none() {
        return vec![Node { matrix, scale, ..node }];
    }
    let name = node.name.take();
    vec![Node { name, matrix, scale, children: Some(vec![Index::new(1)]), ..Node::default() }, node]
}

/// Returns one primitive for each polygon with points.
fn curves(buffer: &Buffer<'_>, root: &mut Root) -> Vec<GroupPrimitives> {
    let mut primitives = Vec::with_capacity(buffer.parts.len());
    if buffer.amounts.vertices == 0 {
        return Vec::new();
    }
    let view = Views::of(root).vertices(buffer.amounts.vertices, FLOAT_VECTOR_BYTES);
    let mut start = 0;
    for part in buffer.parts.iter().filter(|part| part.len() > 0) {
        let positions = root.push(positions(buffer, part, view, start));
        start += part.len() as u128 * FLOAT_VECTOR_BYTES;
        let mode = match (part.closed, part.len()) {
            (_, 1) => Mode::Points,
            (Some(true), _) => Mode::LineLoop,
            _ => Mode::LineStrip,
        };
        primitives.push(primitive(BTreeMap::from([(Valid(Semantic::Positions), positions)]), mode));
    }
    root.materials = vec![gltf_looks::surface(CURVE_BASE_COLOR, None)];
    GroupPrimitives::ungrouped(primitives)
}

/// Returns one primitive for each group and material, or points if there are no faces.
fn surface(buffer: &Buffer<'_>, root: &mut Root) -> Result<Vec<GroupPrimitives>, FormatError> {
    let Some(part) = buffer.parts.first().filter(|part| part.len() > 0) else { return Ok(Vec::new()) };
    let attributes = attributes(buffer, part, root);
    let looks = MaterialWriter::of(buffer.attachments());
    if buffer.faces.is_empty() {
        looks.add(None, root);
        let targets = targets(buffer, root);
        return Ok(GroupPrimitives::ungrouped(vec![Primitive { targets, ..primitive(attributes, Mode::Points) }]));
    }
    let (triangles, triangle) = (buffer.amounts.triangles, buffer.amounts.triangle());
    let component = if triangle == 6 { ComponentType::U16 } else { ComponentType::U32 };
    let corners = Views::of(root).indices(triangles * triangle);
    let origins = buffer.amounts.ids.then(|| Views::of(root).loose(triangles * 4));
    let targets = targets(buffer, root);
    let mut known: Vec<Option<usize>> = Vec::new();
    let mut groups: Vec<GroupPrimitives> = Vec::new();
    let mut start = 0;
    for section in &buffer.faces {
        let material = known.iter().position(|&material| material == section.material).unwrap_or_else(|| {
            looks.add(section.material, root);
            known.push(section.material);
            known.len() - 1
        });
        let n = section.triangles;
        let indices = root.push(accessor(corners, start * triangle, 3 * n, component, Type::Scalar));
        let faces = origins.map(|view| root.push(accessor(view, start * 4, n, ComponentType::U32, Type::Scalar)));
        start += n;
        let group = groups.iter().position(|known| known.group == section.group).unwrap_or_else(|| {
            groups.push(GroupPrimitives { group: section.group, primitives: Vec::new() });
            groups.len() - 1
        });
        groups[group].primitives.push(Primitive {
            indices: Some(indices),
            material: Some(Index::new(u32::try_from(material).expect("there are few materials"))),
            extras: extras(buffer, section, faces)?,
            targets: targets.clone(),
            ..primitive(attributes.clone(), Mode::Triangles)
        });
    }
    Ok(groups)
}

/// Returns the extras of a primitive: its group, and the accessor with the input face of each triangle.
fn extras(
    buffer: &Buffer<'_>,
    section: &PrimitiveFaces,
    faces: Option<Index<Accessor>>,
) -> Result<Option<Box<RawValue>>, FormatError> {
    let mut extras = Map::new();
    if let Some(group) = section.group {
        extras.insert("group".into(), json!(buffer.attachments().groups.names[group]));
    }
    if let Some(faces) = faces {
        extras.insert("faces".into(), json!(faces.value()));
    }
    if extras.is_empty() {
        return Ok(None);
    }
    to_raw_value(&Value::Object(extras)).map(Some).map_err(|error| unwritten(&error))
}

/// Returns the names of the morph targets, by which viewers distinguish them.
fn target_names(buffer: &Buffer<'_>) -> Result<Extras, FormatError> {
    if buffer.targets.is_empty() {
        return Ok(Extras::default());
    }
    let names: Vec<String> = (1..=buffer.targets.len()).map(|frame| format!("frame {frame}")).collect();
    to_raw_value(&json!({ "targetNames": names })).map(Some).map_err(|error| unwritten(&error))
}

/// Returns the morph targets that all primitives of a mesh share.
fn targets(buffer: &Buffer<'_>, root: &mut Root) -> Option<Vec<json::mesh::MorphTarget>> {
    let n = buffer.amounts.vertices;
    let displaced = |root: &mut Root, bounds: Option<CoordinateBounds<3>>| {
        let view = Views::of(root).vertices(n, FLOAT_VECTOR_BYTES);
        let limit = |corner: [f64; 3]| json!(corner.map(rounded));
        let (min, max) = (bounds.map(|bounds| limit(bounds.min)), bounds.map(|bounds| limit(bounds.max)));
        root.push(Accessor { min, max, ..accessor(view, 0, n, ComponentType::F32, Type::Vec3) })
    };
    let target = |target: &MorphTarget<'_>| json::mesh::MorphTarget {
        positions: Some(displaced(root, Some(target.bounds))),
        normals: buffer.amounts.normals.then(|| displaced(root, None)),
        tangents: None,
    };
    let targets: Vec<_> = buffer.targets.iter().map(target).collect();
    Some(targets).filter(|targets| !targets.is_empty())
}

type AttributeMap = BTreeMap<Checked<Semantic>, Index<Accessor>>;

/// Returns the attributes of the vertices of a mesh.
fn attributes(buffer: &Buffer<'_>, part: &PrimitiveVertices<'_>, root: &mut Root) -> AttributeMap {
    let n = buffer.amounts.vertices;
    let view = Views::of(root).vertices(n, FLOAT_VECTOR_BYTES);
    let mut attributes = BTreeMap::from([(Valid(Semantic::Positions), root.push(positions(buffer, part, view, 0)))]);
    let mut floats = |root: &mut Root, semantic, width: u128| {
        let view = Views::of(root).vertices(n, width * CHANNEL_NUMBER_BYTES);
        let kind = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][usize::try_from(width - 1).unwrap_or(3).min(3)];
        attributes.insert(Valid(semantic), root.push(accessor(view, 0, n, ComponentType::F32, kind)));
    };
    if buffer.amounts.normals {
        floats(root, Semantic::Normals, FLOAT_VECTOR_BYTES / CHANNEL_NUMBER_BYTES);
    }
    for channel in &buffer.attachments().channels {
        let custom = || Semantic::Extras(channel.name.to_ascii_uppercase());
        floats(root, if channel.is_color() { Semantic::Colors(0) } else { custom() }, channel.width as u128);
    }
    if buffer.amounts.uvs {
        floats(root, Semantic::TexCoords(0), 2);
    }
    if buffer.amounts.ids {
        floats(root, Semantic::Extras("ORIGIN".into()), ORIGIN_BYTES / CHANNEL_NUMBER_BYTES);
    }
    attributes
}

fn positions(buffer: &Buffer<'_>, part: &PrimitiveVertices<'_>, view: u32, start: u128) -> Accessor {
    let mut positions = accessor(view, start, part.len() as u128, ComponentType::F32, Type::Vec3);
    positions.min = Some(json!(buffer.local(part.bounds.min).map(|x| x + 0.0)));
    positions.max = Some(json!(buffer.local(part.bounds.max).map(|x| x + 0.0)));
    positions
}

fn primitive(attributes: AttributeMap, mode: Mode) -> Primitive {
    Primitive {
        attributes,
        extensions: None,
        extras: Extras::default(),
        indices: None,
        material: Some(Index::new(0)),
        mode: Valid(mode),
        targets: None,
    }
}
