//! Traversal of the nodes of a scene, and the triangles of their meshes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use gltf::json::accessor::Accessor;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Index, Material, Node};

use super::accessor::AccessorRows;
use super::buffers::GltfDocument;
use super::carried::{Channels, Groups, UnreadAttributes, group, name};
use super::looks;
use super::transform::Placement;
use super::triangles::triangle;
use crate::input::collect::MeshBuilder;
use crate::input::colors::encoded;
use crate::input::reader::{CornerUvs, ReadLimits, ReadMesh};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::transform::Transform;
use crate::shape::attachments::ChannelInput;
use crate::shape::labels::FaceSet;
use crate::shape::topology::index;

/// Number of primitives that a file may always have after instancing; a longer file may have as many primitives as
/// bytes, and three corners for each. Nodes that share a mesh must not make much work of a small file, even if nothing
/// of it is kept.
const LEAST_PRIMITIVES: usize = 1_000_000;

/// Bytes of memory of the position, texture coordinates and colour of a vertex, each kept in lists that grow.
const GLTF_POSITION_BYTES: usize = GROWN * 24;
const GLTF_UV_BYTES: usize = GROWN * 16;
const GLTF_COLOR_BYTES: usize = GROWN * 32 + 32;
/// Bytes of memory of a triangle: three corners, a start, and perhaps three corners of texture coordinates.
const GLTF_TRIANGLE_BYTES: usize = GROWN * 16 + 12;
/// Bytes of a triangle's index in the set of its material, or of its node or group.
const GLTF_MEMBER_BYTES: usize = GROWN * 8;
/// Bytes of a set, with its name and its index by name.
const GLTF_SET_BYTES: usize = GROWN * size_of::<FaceSet>() + 128;
/// Bytes of a node on the path from the root to the current node.
const GLTF_FRAME_BYTES: usize = GROWN * size_of::<NodeFrame<'static>>();

/// The children of a node that are still to be read, and the transform of the node.
type NodeFrame<'a> = (std::slice::Iter<'a, Index<Node>>, Transform);

/// Reads the default scene, otherwise the first scene, otherwise all nodes without a parent.
pub(super) fn read(
    document: &GltfDocument<'_>,
    length: usize,
    room: MemoryBudget,
    limits: &ReadLimits,
) -> Result<ReadMesh, String> {
    let mut reading = GltfReader {
        document,
        mesh: MeshBuilder::new(limits),
        room,
        most_primitives: length.max(LEAST_PRIMITIVES),
        primitives: 0,
        corners: 0,
        uvs: Some(Vec::new()),
        without_uvs: 0,
        colors: Some(Vec::new()),
        with_colors: 0,
        color_width: 3,
        materials: BTreeMap::new(),
        channels: Channels::default(),
        unread: UnreadAttributes::default(),
        groups: Groups::default(),
        shared: SharedVertices::at(Transform::IDENTITY),
        degenerate: 0,
        other: 0,
        is_posed: false,
    };
    let mut seen = vec![false; document.root.nodes.len()];
    for root in roots(document)? {
        reading.tree(root, &mut seen)?;
    }
    Ok(reading.finish())
}

fn roots(document: &GltfDocument<'_>) -> Result<Vec<usize>, String> {
    let root = &document.root;
    let missing = |i: usize| format!("there is no scene {i}; the file has {}", root.scenes.len());
    let scene = match root.scene.map(|scene| scene.value()) {
        Some(i) => Some(root.scenes.get(i).ok_or_else(|| missing(i))?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene {
        return Ok(scene.nodes.iter().map(Index::value).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        is_child.get_mut(child.value()).into_iter().for_each(|flag| *flag = true);
    }
    Ok((0..root.nodes.len()).filter(|&i| !is_child[i]).collect())
}

struct GltfReader<'a> {
    document: &'a GltfDocument<'a>,
    mesh: MeshBuilder,
    room: MemoryBudget,
    most_primitives: usize,
    primitives: usize,
    corners: usize,
    /// Texture coordinates of vertices, zero where a vertex has none.
    uvs: Option<Vec<[f64; 2]>>,
    /// Number of vertices without texture coordinates.
    without_uvs: usize,
    /// Red, green, blue and alpha of vertices, as long as all have a colour.
    colors: Option<Vec<f64>>,
    /// Number of vertices with a colour.
    with_colors: usize,
    color_width: usize,
    /// Faces of each material; faces without a material are not listed.
    materials: BTreeMap<usize, Vec<u64>>,
    /// Application-specific attributes.
    channels: Channels,
    unread: UnreadAttributes,
    groups: Groups,
    shared: SharedVertices,
    degenerate: usize,
    other: usize,
    is_posed: bool,
}

/// Vertices that primitives with one transform share. They are shared among consecutive nodes with equal transforms, as
/// long as no mesh is repeated.
struct SharedVertices {
    transform: Transform,
    meshes: BTreeSet<usize>,
    /// The first vertex and the number of vertices, by attributes.
    vertices: BTreeMap<VertexAccessors, (usize, usize)>,
}

impl SharedVertices {
    fn at(transform: Transform) -> Self {
        Self { transform, meshes: BTreeSet::new(), vertices: BTreeMap::new() }
    }
}

/// The accessors of the vertices of a primitive: positions, texture coordinates, colours, and application-specific
/// attributes by name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct VertexAccessors {
    known: [Option<usize>; 3],
    own: Vec<(String, usize)>,
}

impl GltfReader<'_> {
    /// Reads a node and its descendants, parents before children.
    fn tree(&mut self, root: usize, seen: &mut [bool]) -> Result<(), String> {
        let mut path: Vec<NodeFrame<'_>> = Vec::new();
        let mut longest = 0;
        let mut next = Some((root, Transform::IDENTITY));
        while let Some((i, outer)) = next {
            let document = self.document;
            let nodes = &document.root.nodes;
            let node = nodes.get(i).ok_or_else(|| format!("there is no node {i}; the file has {}", nodes.len()))?;
            if std::mem::replace(&mut seen[i], true) {
                return Err(format!("node {i} is reached twice; nodes are to form trees"));
            }
            let placement = document.placements.get(i).and_then(Option::as_deref);
            let inner = placement.map_or(Ok(Transform::IDENTITY), Placement::transform);
            let transform = outer.after(&inner.map_err(|detail| format!("node {i}: {detail}"))?);
            self.node(i, node, &transform)?;
            path.push((node.children.as_deref().unwrap_or_default().iter(), transform));
            if path.len() > longest {
                longest = path.len();
                self.room.take(GLTF_FRAME_BYTES)?;
            }
            next = None;
            while let Some((children, transform)) = path.last_mut() {
                if let Some(child) = children.next() {
                    next = Some((child.value(), *transform));
                    break;
                }
                path.pop();
            }
        }
        self.room.give(GLTF_FRAME_BYTES * longest);
        Ok(())
    }

    fn node(&mut self, i: usize, node: &Node, transform: &Transform) -> Result<(), String> {
        let Some(mesh) = node.mesh else { return Ok(()) };
        let m = mesh.value();
        let mesh = self.document.root.meshes.get(m).ok_or_else(|| format!("node {i}: there is no mesh {m}"))?;
        self.is_posed |= node.skin.is_some();
        let first = self.mesh.mesh.faces.len();
        if self.shared.transform != *transform || self.shared.meshes.contains(&m) {
            self.shared = SharedVertices::at(*transform);
        }
        self.shared.meshes.insert(m);
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let place = |detail: String| format!("mesh {m}, primitive {p}: {detail}");
            self.primitives += 1;
            let most = self.most_primitives;
            if self.primitives > most {
                return Err(place(format!("the file comes to more than {most} primitives; send fewer")));
            }
            self.primitive(primitive, transform).map_err(place)?;
        }
        let name = node.name.clone().or_else(|| mesh.name.clone()).unwrap_or_else(|| format!("node {i}"));
        let faces = first..self.mesh.mesh.faces.len();
        let bytes = if faces.is_empty() { 0 } else { GLTF_SET_BYTES + name.len() + faces.len() * GLTF_MEMBER_BYTES };
        self.room.take(bytes)?;
        self.groups.node(name, faces);
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, transform: &Transform) -> Result<(), String> {
        let Valid(mode) = primitive.mode else { return Err("its mode is not known".to_owned()) };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.other += 1;
            return Ok(());
        }
        self.is_posed |= primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty());
        self.unread.take(primitive);
        let attribute = |semantic: Semantic| primitive.attributes.get(&Valid(semantic)).copied();
        let positions = attribute(Semantic::Positions).ok_or("it has no POSITION")?;
        let others = [attribute(Semantic::TexCoords(0)), attribute(Semantic::Colors(0))];
        let known = [Some(positions), others[0], others[1]].map(|accessor| accessor.map(|accessor| accessor.value()));
        let own: Vec<_> =
            primitive.attributes.iter().filter_map(|(semantic, &at)| Some((name(semantic)?, at))).collect();
        let key = VertexAccessors { known, own: own.iter().map(|(name, at)| (name.clone(), at.value())).collect() };
        let (start, n) = if let Some(&known) = self.shared.vertices.get(&key) {
            known
        } else {
            let found = self.vertices(positions, others, transform)?;
            self.channels.take(self.document, &own, found, &mut self.room);
            self.shared.vertices.insert(key, found);
            found
        };
        let order = self.order(primitive, n)?;
        if mode == Mode::Triangles && !order.len().is_multiple_of(3) {
            return Err(format!("{} corners; triangles have 3 each", order.len()));
        }
        let made = self.faces(mode, &order, start, transform)?;
        self.room.give(order.len() * size_of::<u32>());
        let members = (made.end - made.start) * GLTF_MEMBER_BYTES;
        let made = made.start as u64..made.end as u64;
        if let Some(group) = group(primitive) {
            self.room.take(GLTF_SET_BYTES + 2 * group.len() + members)?;
            self.groups.add_faces(group, made.clone());
        }
        if let Some(material) = primitive.material {
            self.room.take(GLTF_SET_BYTES + members)?;
            self.materials.entry(material.value()).or_default().extend(made);
        }
        Ok(())
    }

    /// Returns the indices of the vertices of a primitive, which has `n` vertices, in the order of its triangles.
    fn order(&mut self, primitive: &Primitive, n: usize) -> Result<Vec<u32>, String> {
        let order = if let Some(indices) = primitive.indices {
            self.document.indices(indices, &mut self.room)?
        } else {
            self.room.take(n * size_of::<u32>())?;
            (0..index(n)).collect()
        };
        self.corners += order.len();
        let most = self.most_primitives.saturating_mul(3);
        if self.corners > most {
            return Err(format!("the file comes to more than {most} corners of triangles; send less at once"));
        }
        if let Some(beyond) = order.iter().find(|&&v| v as usize >= n) {
            return Err(format!("there is no vertex {beyond}; it has {n}, counted from 0"));
        }
        Ok(order)
    }

    /// Adds the triangles of a primitive whose vertices start at `start`. Returns the range of the new faces.
    fn faces(
        &mut self,
        mode: Mode,
        order: &[u32],
        start: usize,
        transform: &Transform,
    ) -> Result<Range<usize>, String> {
        let faces = self.mesh.mesh.faces.len();
        let n_triangles = if mode == Mode::Triangles { order.len() / 3 } else { order.len().saturating_sub(2) };
        // the memory of triangles that are left out is returned
        self.room.take(n_triangles * GLTF_TRIANGLE_BYTES)?;
        for triangle in (0..n_triangles).map(|t| triangle(mode, order, t)) {
            let mut corners = triangle.map(|v| index(start) + v);
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                self.degenerate += 1;
                continue;
            }
            if transform.is_mirror() {
                corners.swap(1, 2);
            }
            self.mesh.face(&corners)?;
        }
        let made = faces..self.mesh.mesh.faces.len();
        self.room.give((n_triangles - made.len()) * GLTF_TRIANGLE_BYTES);
        Ok(made)
    }

    /// Appends the vertices of a primitive, and returns the first one and their number.
    fn vertices(
        &mut self,
        positions: Index<Accessor>,
        [uvs, colors]: [Option<Index<Accessor>>; 2],
        transform: &Transform,
    ) -> Result<(usize, usize), String> {
        let start = self.mesh.mesh.positions.len();
        let rows = self.document.rows(positions, &mut self.room)?;
        let places = rows.rows::<3>().ok_or("POSITION is to be VEC3")?;
        let n = places.len();
        self.room
            .take(n * (GLTF_POSITION_BYTES + GLTF_UV_BYTES + if colors.is_some() { GLTF_COLOR_BYTES } else { 0 }))?;
        for (i, place) in places.iter().enumerate() {
            let place = transform.point(*place);
            if place.iter().any(|x| !x.is_finite()) {
                return Err(format!("POSITION {i} comes to a place that is not finite"));
            }
            self.mesh.vertex(place)?;
        }
        let (uvs, colors) = (self.others(uvs, n)?, self.others(colors, n)?);
        match (uvs.as_ref().and_then(|rows| rows.rows::<2>()), &mut self.uvs) {
            // glTF places the origin at the upper left corner of a picture
            (Some(rows), Some(all)) => all.extend(rows.iter().map(|[u, v]| [*u, 1.0 - v])),
            (None, Some(all)) => {
                self.without_uvs += n;
                all.resize(all.len() + n, [0.0; 2]);
            }
            _ => self.uvs = None,
        }
        self.with_colors += if colors.is_some() { n } else { 0 };
        match (colors.as_ref().filter(|rows| rows.width > 2), &mut self.colors) {
            (Some(rows), Some(all)) => {
                self.color_width = self.color_width.max(rows.width);
                let rgba = |row: &[f64]| {
                    [encoded(row[0]), encoded(row[1]), encoded(row[2]), row.get(3).copied().unwrap_or(1.0)]
                };
                all.extend(rows.values.chunks_exact(rows.width).flat_map(rgba));
            }
            (None, _) if places.is_empty() => {}
            _ => self.colors = None,
        }
        self.room.give(rows.bytes() + [&uvs, &colors].into_iter().flatten().map(AccessorRows::bytes).sum::<usize>());
        Ok((start, n))
    }

    /// Reads an optional accessor of finite numbers, one row for each of `n` vertices.
    fn others(&mut self, accessor: Option<Index<Accessor>>, n: usize) -> Result<Option<AccessorRows>, String> {
        let Some(accessor) = accessor else { return Ok(None) };
        let found = self.document.rows(accessor, &mut self.room)?;
        if found.len() != n || found.values.iter().any(|x| !x.is_finite()) {
            let (i, given) = (accessor.value(), found.len());
            return Err(format!("accessor {i}: {given} rows of finite numbers are to be {n}"));
        }
        Ok(Some(found))
    }

    fn finish(mut self) -> ReadMesh {
        let mut mesh = self.mesh.mesh;
        let mut note = |n: usize, what: &str| {
            if n > 0 {
                mesh.notes.push(format!("{what}: {n}"));
            }
        };
        note(self.degenerate, "triangles left out because two of their corners are one vertex");
        note(self.other, "primitives of points or lines are left out");
        note(self.document.root.animations.len(), "animations are left out");
        note(self.document.root.cameras.len(), "cameras are left out");
        if self.is_posed {
            mesh.notes.push("skins and morph targets are not applied".to_owned());
        }
        let textured = |material: &Material| material.pbr_metallic_roughness.base_color_texture.is_some();
        let textured = self.document.root.materials.iter().any(textured);
        let some_uvs =
            |uvs: &Vec<[f64; 2]>| self.without_uvs == 0 && !uvs.is_empty() || textured && self.without_uvs < uvs.len();
        let n = mesh.positions.len();
        match self.uvs.take() {
            Some(uvs) if some_uvs(&uvs) => mesh.uvs = Some(CornerUvs::new(uvs, mesh.faces.vertices().to_vec())),
            _ if self.without_uvs < n => {
                let without = self.without_uvs;
                mesh.notes.push(format!("texture coordinates are left out: {without} of {n} vertices have none"));
            }
            _ => {}
        }
        if let Some(colors) = self.colors.filter(|colors| !colors.is_empty()) {
            let mut values = Vec::with_capacity(colors.len() / 4 * self.color_width);
            values.extend(colors.chunks_exact(4).flat_map(|color| &color[..self.color_width]));
            mesh.channels.push(ChannelInput::of_vertices("color", self.color_width, values));
        } else if self.with_colors > 0 {
            mesh.notes.push(format!("colours are left out: {} of {n} vertices have one", self.with_colors));
        }
        self.unread.finish(&mut mesh);
        self.channels.finish(&mut mesh);
        mesh.groups = self.groups.finish();
        looks::finish(self.document, self.materials, &mut self.room, &mut mesh);
        mesh
    }
}
