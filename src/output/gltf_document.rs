//! The JSON half of glTF: one node with one mesh, its material, and where its numbers lie in the buffer.

use std::collections::BTreeMap;

use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Stride, Target, View};
use gltf::json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;
use gltf::json::{self, Accessor, Asset, Extras, Index, Material, Mesh, Node, Root, Scene};
use serde_json::json;

use crate::math::parameter::{Default as Otherwise, Kind, Parameter, Values};
use crate::output::gltf_buffer::{Amounts, Buffer, Part, VECTOR};
use crate::output::numbers::{rounded, total};
use crate::output::{FormatError, ShapeKind};

/// Linear base colours of surfaces and of curves.
const SURFACE: [f32; 4] = [0.3, 0.47, 0.65, 1.0];
const CURVE: [f32; 4] = [0.03, 0.06, 0.1, 1.0];

/// Options of both containers.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "normals",
    kind: Kind::Choice(&["area", "none"]),
    unit: "",
    default: Otherwise::Text("area"),
    doc: "Vertex normals of a mesh: weighted by the area of the faces around the vertex, or none (flat shading)",
}];

/// Whether normals are asked for.
pub(super) fn with_normals(options: &Values) -> bool {
    options.choice("normals") != Some("none")
}

/// Most bytes of the document of a shape, a multiple of 4: 1,536 for a mesh, for curves 768 and 384 a polygon.
pub(super) fn room(kind: ShapeKind, polygons: u128) -> u128 {
    match kind {
        ShapeKind::Mesh => 1_536,
        ShapeKind::Curves { .. } => total(&[(768, 1), (384, polygons)]),
    }
}

/// The document that describes `buffer`, whose bytes are found at `uri` (in the container's own chunk without one).
///
/// # Errors
/// More polygons than 32-bit indices reach.
pub(super) fn document(buffer: &Buffer<'_>, uri: Option<&str>) -> Result<Vec<u8>, FormatError> {
    if u32::try_from(buffer.parts.len()).is_err() {
        let n = buffer.parts.len();
        return Err(FormatError::Unfit(format!("{n} polygons, glTF holds at most {}; ask for json", u32::MAX)));
    }
    let mut root = Root { asset: asset(), scene: Some(Index::new(0)), ..Root::default() };
    let mut node = Node { name: Some("planish".into()), translation: translation(buffer), ..Node::default() };
    root.scenes = vec![Scene { extensions: None, extras: Extras::default(), name: None, nodes: vec![Index::new(0)] }];
    let primitives = primitives(buffer, &mut root);
    if !primitives.is_empty() {
        node.mesh = Some(Index::new(0));
        root.materials = vec![material(buffer.is_mesh())];
        root.meshes = vec![Mesh { extensions: None, extras: Extras::default(), name: None, primitives, weights: None }];
        root.buffers = vec![json::Buffer {
            byte_length: length(buffer.amounts.bytes()).into(),
            name: None,
            uri: uri.map(Into::into),
            extensions: None,
            extras: Extras::default(),
        }];
        root.buffer_views = views(&buffer.amounts);
    }
    root.nodes = vec![node];
    root.to_vec().map_err(|error| FormatError::Unfit(format!("the glTF document cannot be written: {error}")))
}

fn asset() -> Asset {
    Asset { generator: Some("planish".into()), version: "2.0".into(), ..Asset::default() }
}

fn translation(buffer: &Buffer<'_>) -> Option<[f32; 3]> {
    let moved = buffer.center.iter().any(|&x| x != 0.0);
    moved.then(|| buffer.center.map(|x| rounded(x) + 0.0))
}

fn material(surface: bool) -> Material {
    Material {
        double_sided: true,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(if surface { SURFACE } else { CURVE }),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.5),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    }
}

/// The sections of the buffer: positions, normals, indices.
fn views(amounts: &Amounts) -> Vec<View> {
    let vectors = amounts.vertices * VECTOR;
    let mut views = vec![view(0, vectors, Target::ArrayBuffer)];
    if amounts.normals {
        views.push(view(vectors, vectors, Target::ArrayBuffer));
    }
    if amounts.triangles > 0 {
        let start = if amounts.normals { 2 * vectors } else { vectors };
        views.push(view(start, amounts.bytes() - start, Target::ElementArrayBuffer));
    }
    views
}

fn view(start: u128, bytes: u128, target: Target) -> View {
    View {
        buffer: Index::new(0),
        byte_length: length(bytes).into(),
        byte_offset: (start > 0).then(|| length(start).into()),
        byte_stride: (target == Target::ArrayBuffer).then_some(Stride(VECTOR as usize)),
        name: None,
        target: Some(Valid(target)),
        extensions: None,
        extras: Extras::default(),
    }
}

/// One primitive for the mesh or for each polygon with points; their accessors go into `root`.
fn primitives(buffer: &Buffer<'_>, root: &mut Root) -> Vec<Primitive> {
    let mut start = 0;
    let mut primitives = Vec::with_capacity(buffer.parts.len());
    for part in buffer.parts.iter().filter(|part| part.len() > 0) {
        let mut positions = accessor(0, start, part.len() as u128, ComponentType::F32, Type::Vec3);
        positions.min = Some(json!(buffer.local(part.bounds.min).map(|x| x + 0.0)));
        positions.max = Some(json!(buffer.local(part.bounds.max).map(|x| x + 0.0)));
        start += part.len() as u128 * VECTOR;
        let mut attributes = BTreeMap::from([(Valid(Semantic::Positions), root.push(positions))]);
        let Amounts { vertices, normals, triangles } = buffer.amounts;
        if normals {
            let normals = accessor(1, 0, vertices, ComponentType::F32, Type::Vec3);
            attributes.insert(Valid(Semantic::Normals), root.push(normals));
        }
        let view = if normals { 2 } else { 1 };
        let indices = (triangles > 0).then(|| accessor(view, 0, 3 * triangles, ComponentType::U32, Type::Scalar));
        primitives.push(Primitive {
            attributes,
            extensions: None,
            extras: Extras::default(),
            indices: indices.map(|indices| root.push(indices)),
            material: Some(Index::new(0)),
            mode: Valid(mode(part, triangles > 0)),
            targets: None,
        });
    }
    primitives
}

fn mode(part: &Part<'_>, surface: bool) -> Mode {
    match (surface, part.closed, part.len()) {
        (true, ..) => Mode::Triangles,
        (false, None, _) | (false, Some(_), 0 | 1) => Mode::Points,
        (false, Some(true), _) => Mode::LineLoop,
        (false, Some(false), _) => Mode::LineStrip,
    }
}

fn accessor(view: u32, start: u128, count: u128, component: ComponentType, kind: Type) -> Accessor {
    Accessor {
        buffer_view: Some(Index::new(view)),
        byte_offset: (start > 0).then(|| length(start).into()),
        count: length(count).into(),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: Extras::default(),
        type_: Valid(kind),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// A length that is known to be that of something in memory or behind 32-bit indices.
fn length(n: u128) -> u64 {
    u64::try_from(n).expect("numbers of rows are below 2^40")
}
