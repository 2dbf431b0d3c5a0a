//! Packs glTF models: a model is written into memory, ordered for graphics processors, rounded to 16 bits and encoded.

use std::borrow::Cow;

use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType};
use gltf::json::buffer::Stride;
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked::Valid;
use gltf::json::{Index, Node, Root};
use meshoptimizer_rs::Workspace;
use serde_json::value::to_raw_value;
use serde_json::{Value, json};

use crate::output::error::FormatError;
use crate::output::gltf_buffer::Buffer;
use crate::output::gltf_codec::EncodedStream;
use crate::output::gltf_document::{buffer_of, model, unwritten};
use crate::output::gltf_grid::{PositionGrid, UNIT_ERROR, quantized_direction, quantized_fraction};
use crate::output::gltf_order::{Aim, TriangleOrder, workspace};
use crate::output::gltf_packing::Packing;
use crate::output::stream::Stream;
use crate::shape::topology::index;
use crate::watch::Watch;

/// The extensions of packed documents.
const QUANTIZATION: &str = "KHR_mesh_quantization";
const MESHOPT: &str = "EXT_meshopt_compression";

/// A packed model.
pub(super) struct Packed {
    root: Root,
    /// The bytes of the first buffer, a multiple of 4.
    pub(super) bytes: Vec<u8>,
    /// The entries of the extension for views, by the numbers of the views.
    encoded: Vec<(usize, Value)>,
    /// The length of the second buffer, which does not exist in any file: the total length of all encoded views.
    decoded: u64,
}

impl Packed {
    /// Packs a model.
    ///
    /// # Errors
    /// A model that cannot be written, or a stopped watch.
    pub(super) fn of(buffer: &Buffer<'_>, packing: Packing, watch: &Watch) -> Result<Self, FormatError> {
        let mut loose = Vec::with_capacity(usize::try_from(buffer.amounts.bytes()).unwrap_or(0));
        buffer.write(&mut Stream::new(&mut loose, watch))?;
        let root = model(buffer)?;
        let mut packer = Packer {
            packing,
            watch,
            roles: roles(&root),
            order: None,
            grid: None,
            is_unit: false,
            workspace: workspace(),
            packed: Self { root, bytes: Vec::new(), encoded: Vec::new(), decoded: 0 },
        };
        if packing.orders {
            packer.order(buffer, &loose)?;
        }
        for view in 0..packer.roles.len() {
            watch.check()?;
            let column = packer.column(buffer, view, &loose)?;
            packer.put(view, column);
        }
        packer.finish()
    }

    /// Returns the document, whose first buffer is at `uri`, or, without a URI, in the container's own chunk.
    pub(super) fn document(&self, uri: Option<&str>) -> Result<Vec<u8>, FormatError> {
        serde_json::to_vec(&self.value(uri)?).map_err(|error| unwritten(&error))
    }

    /// Returns the document as JSON.
    pub(super) fn value(&self, uri: Option<&str>) -> Result<Value, FormatError> {
        let written = self.root.to_vec().map_err(|error| unwritten(&error))?;
        let mut value: Value = serde_json::from_slice(&written).map_err(|error| unwritten(&error))?;
        if let (Some(uri), Some(buffer)) = (uri, value.pointer_mut("/buffers/0")) {
            buffer["uri"] = uri.into();
        }
        if !self.encoded.is_empty() {
            value["buffers"][1]["extensions"] = json!({ MESHOPT: { "fallback": true } });
        }
        for (view, entry) in &self.encoded {
            value["bufferViews"][*view]["extensions"] = json!({ MESHOPT: entry });
        }
        Ok(value)
    }
}

/// The role of the bytes of a view.
#[derive(Debug, Clone, PartialEq)]
enum ViewRole {
    Attribute(Semantic, Index<Accessor>),
    Indices,
    /// A number for each triangle.
    OfTriangles,
    Other,
}

/// Returns the roles of all views. Numbers of triangles come after their indices.
fn roles(root: &Root) -> Vec<ViewRole> {
    let mut roles = vec![ViewRole::Other; root.buffer_views.len()];
    let view = |accessor: Index<Accessor>| root.accessors[accessor.value()].buffer_view.map(|view| view.value());
    for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        for (semantic, &accessor) in &primitive.attributes {
            if let (Valid(semantic), Some(view)) = (semantic, view(accessor)) {
                roles[view] = ViewRole::Attribute(semantic.clone(), accessor);
            }
        }
        if let Some(view) = primitive.indices.and_then(view) {
            roles[view] = ViewRole::Indices;
        }
        if let Some(view) = told_faces(primitive).and_then(view) {
            roles[view] = ViewRole::OfTriangles;
        }
    }
    roles
}

/// Returns the accessor with the input faces of the triangles of a primitive.
fn told_faces(primitive: &gltf::json::mesh::Primitive) -> Option<Index<Accessor>> {
    let extras: Value = serde_json::from_str(primitive.extras.as_ref()?.get()).ok()?;
    extras["faces"].as_u64().and_then(|faces| u32::try_from(faces).ok()).map(Index::new)
}

/// The new bytes of a view.
struct Column<'a> {
    bytes: Cow<'a, [u8]>,
    /// Bytes per row of an attribute.
    stride: Option<usize>,
    encoded: Option<EncodedStream>,
}

struct Packer<'a> {
    packing: Packing,
    watch: &'a Watch,
    roles: Vec<ViewRole>,
    order: Option<TriangleOrder>,
    grid: Option<PositionGrid>,
    /// Whether texture coordinates are stored in 16 bits.
    is_unit: bool,
    workspace: Workspace,
    packed: Packed,
}

impl Packer<'_> {
    /// Returns the bytes of a view as they were written.
    fn view<'b>(&self, view: usize, loose: &'b [u8]) -> &'b [u8] {
        let view = &self.packed.root.buffer_views[view];
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let [start, length] = [start, view.byte_length.0].map(|n| usize::try_from(n).expect("it is in memory"));
        &loose[start..start + length]
    }

    /// Orders triangles and vertices.
    fn order(&mut self, buffer: &Buffer<'_>, loose: &[u8]) -> Result<(), FormatError> {
        let Some(view) = self.roles.iter().position(|role| *role == ViewRole::Indices) else { return Ok(()) };
        let triangles = triangles(self.view(view, loose), buffer);
        let parts = buffer.faces.iter().map(|section| usize::try_from(section.triangles).expect("they are in memory"));
        let n = usize::try_from(buffer.amounts.vertices).expect("they are in memory");
        let aim = if self.packing.encodes { Aim::Bytes } else { Aim::Cache };
        self.order = Some(TriangleOrder::of(&triangles, &parts.collect::<Vec<_>>(), n, aim, self.watch)?);
        Ok(())
    }

    /// Returns the packed bytes of a view.
    fn column<'b>(&mut self, buffer: &Buffer<'_>, view: usize, loose: &'b [u8]) -> Result<Column<'b>, FormatError> {
        let bytes = self.view(view, loose);
        match self.roles[view].clone() {
            ViewRole::Attribute(semantic, accessor) => self.attribute(buffer, view, (semantic, accessor), bytes),
            ViewRole::Indices => {
                let stride = usize::try_from(buffer.amounts.triangle() / 3).expect("2 or 4");
                let Some(TriangleOrder { triangles, .. }) = &self.order else {
                    return Ok(Column { bytes: bytes.into(), stride: None, encoded: None });
                };
                let encode = || EncodedStream::triangles(triangles, stride, &mut self.workspace);
                let encoded = self.packing.encodes.then(encode).transpose()?;
                let corners = triangles.as_flattened().iter();
                let bytes: Vec<u8> = corners.flat_map(|v| v.to_le_bytes().into_iter().take(stride)).collect();
                Ok(Column { bytes: bytes.into(), stride: None, encoded })
            }
            ViewRole::OfTriangles => {
                let former = self.order.as_ref().map(|order| &order.former);
                let bytes = permuted(bytes, 4, former);
                let encode = || EncodedStream::rows(&bytes, 4, &mut self.workspace);
                let encoded = self.packing.encodes.then(encode).transpose()?;
                Ok(Column { bytes, stride: None, encoded })
            }
            ViewRole::Other => Ok(Column { bytes: bytes.into(), stride: None, encoded: None }),
        }
    }

    /// Returns the packed bytes of an attribute of vertices.
    fn attribute<'b>(
        &mut self,
        buffer: &Buffer<'_>,
        view: usize,
        (semantic, accessor): (Semantic, Index<Accessor>),
        bytes: &'b [u8],
    ) -> Result<Column<'b>, FormatError> {
        let stride = self.packed.root.buffer_views[view].byte_stride.map_or(4, |stride| stride.0);
        let rows = permuted(bytes, stride, self.order.as_ref().map(|order| &order.vertices));
        let numbers = || rows.as_chunks().0.iter().map(|&x| f32::from_le_bytes(x));
        let mut stored: Option<(ComponentType, usize, Vec<u8>)> = None;
        let mut encoded = None;
        match semantic {
            _ if !self.packing.quantizes => {}
            Semantic::Positions => {
                stored = Some((ComponentType::U16, 8, self.places(buffer, accessor, &vectors(numbers()))?));
            }
            Semantic::Normals => {
                let vectors = vectors(numbers());
                let encode = || EncodedStream::directions(&vectors, &mut self.workspace);
                encoded = self.packing.encodes.then(encode).transpose()?;
                let small = vectors.iter().flat_map(|&[x, y, z]| [x, y, z, 0.0].map(quantized_direction));
                stored = Some((ComponentType::I8, 4, small.flat_map(i8::to_le_bytes).collect()));
            }
            Semantic::TexCoords(_) | Semantic::Colors(_) if numbers().all(|x| (0.0..=1.0).contains(&x)) => {
                self.is_unit |= matches!(semantic, Semantic::TexCoords(_));
                let padded = (stride / 4).next_multiple_of(2);
                let numbers: Vec<u16> = numbers().map(quantized_fraction).collect();
                let row = |row: &[u16]| (0..padded).map(|k| row.get(k).copied().unwrap_or(0)).collect::<Vec<_>>();
                let small = numbers.chunks_exact(stride / 4).flat_map(row).flat_map(u16::to_le_bytes).collect();
                stored = Some((ComponentType::U16, 2 * padded, small));
            }
            _ => {}
        }
        let (stride, rows) = match stored {
            None => (stride, rows),
            Some((component, stride, small)) => {
                let accessor = &mut self.packed.root.accessors[accessor.value()];
                accessor.component_type = Valid(GenericComponentType(component));
                accessor.normalized = !matches!(semantic, Semantic::Positions);
                (stride, small.into())
            }
        };
        if self.packing.encodes && encoded.is_none() {
            encoded = Some(EncodedStream::rows(&rows, stride, &mut self.workspace)?);
        }
        Ok(Column { bytes: rows, stride: Some(stride), encoded })
    }

    /// Returns positions on a grid, each followed by two bytes of padding.
    fn places(
        &mut self,
        buffer: &Buffer<'_>,
        accessor: Index<Accessor>,
        positions: &[[f32; 3]],
    ) -> Result<Vec<u8>, FormatError> {
        let grid = PositionGrid::over(positions, buffer.center)?;
        let (mut min, mut max) = ([u16::MAX; 3], [0; 3]);
        let mut bytes = Vec::with_capacity(8 * positions.len());
        for &position in positions {
            let place = grid.place(position);
            for (k, &x) in place.iter().enumerate() {
                (min[k], max[k]) = (min[k].min(x), max[k].max(x));
            }
            bytes.extend_from_slice(place.map(u16::to_le_bytes).as_flattened());
            bytes.extend_from_slice(&[0; 2]);
        }
        let accessor = &mut self.packed.root.accessors[accessor.value()];
        (accessor.min, accessor.max) = (Some(json!(min)), Some(json!(max)));
        self.grid = Some(grid);
        Ok(bytes)
    }

    /// Appends a view: encoded if that is shorter.
    fn put(&mut self, view: usize, Column { bytes, stride, encoded }: Column<'_>) {
        let Packed { root, bytes: all, encoded: views, decoded } = &mut self.packed;
        all.resize(all.len().next_multiple_of(4), 0);
        let buffer_view = &mut root.buffer_views[view];
        buffer_view.byte_length = (bytes.len() as u64).into();
        buffer_view.byte_stride = stride.map(Stride);
        let shorter = encoded.filter(|encoded| encoded.bytes.len().next_multiple_of(4) < bytes.len());
        let offset = if let Some(encoded) = shorter {
            views.push((view, encoded.extension_entry(all.len())));
            all.extend_from_slice(&encoded.bytes);
            let offset = decoded.next_multiple_of(4);
            *decoded = offset + bytes.len() as u64;
            buffer_view.buffer = Index::new(1);
            offset
        } else {
            let offset = all.len() as u64;
            all.extend_from_slice(&bytes);
            offset
        };
        buffer_view.byte_offset = (offset > 0).then(|| offset.into());
    }

    /// Completes the document.
    fn finish(self) -> Result<Packed, FormatError> {
        let Self { mut packed, grid, is_unit, .. } = self;
        packed.bytes.resize(packed.bytes.len().next_multiple_of(4), 0);
        if packed.root.buffers.is_empty() {
            return Ok(packed);
        }
        packed.root.buffers = vec![buffer_of(packed.bytes.len() as u128)];
        if !packed.encoded.is_empty() {
            packed.root.buffers.push(buffer_of(u128::from(packed.decoded.next_multiple_of(4))));
        }
        let of_grid = grid.map(|_| QUANTIZATION);
        let of_codec = (!packed.encoded.is_empty()).then_some(MESHOPT);
        let used: Vec<String> = of_grid.into_iter().chain(of_codec).map(Into::into).collect();
        packed.root.extensions_used.extend(used.iter().cloned());
        packed.root.extensions_required.extend(used);
        if let Some(grid) = grid {
            let mut extras = json!({ "position_error": grid.error });
            if is_unit {
                extras["texcoord_error"] = UNIT_ERROR.into();
            }
            let extras = to_raw_value(&extras).map_err(|error| unwritten(&error))?;
            packed.root.meshes.iter_mut().for_each(|mesh| mesh.extras = Some(extras.clone()));
            place(&mut packed.root.nodes, &grid);
        }
        Ok(packed)
    }
}

/// Adds to nodes the transform from places of a grid to model coordinates: to nodes with meshes if they have neither a
/// transform nor children, otherwise to new nodes below them.
fn place(nodes: &mut Vec<Node>, grid: &PositionGrid) {
    for i in 0..nodes.len() {
        let next = index(nodes.len());
        let node = &mut nodes[i];
        let Some(mesh) = node.mesh else { continue };
        let (translation, scale) = (Some(grid.corner), Some([grid.step; 3]));
        let is_bare = (node.matrix, node.scale, node.translation) == (None, None, None) && node.children.is_none();
        if is_bare {
            (node.translation, node.scale) = (translation, scale);
        } else {
            node.mesh = None;
            node.children.get_or_insert_default().insert(0, Index::new(next));
            nodes.push(Node { mesh: Some(mesh), translation, scale, ..Node::default() });
        }
    }
}

/// Returns rows of `stride` bytes in another order: `former` has the old index of each new row.
fn permuted<'a>(bytes: &'a [u8], stride: usize, former: Option<&Vec<u32>>) -> Cow<'a, [u8]> {
    let Some(former) = former else { return bytes.into() };
    let row = |&row: &u32| &bytes[row as usize * stride..][..stride];
    let mut permuted = Vec::with_capacity(bytes.len());
    former.iter().for_each(|former| permuted.extend_from_slice(row(former)));
    permuted.into()
}

fn vectors(numbers: impl Iterator<Item = f32>) -> Vec<[f32; 3]> {
    numbers.collect::<Vec<_>>().as_chunks().0.to_vec()
}

/// Returns the triangles of a view of indices.
fn triangles(bytes: &[u8], buffer: &Buffer<'_>) -> Vec<[u32; 3]> {
    let corners: Vec<u32> = if buffer.amounts.triangle() == 6 {
        bytes.as_chunks().0.iter().map(|&v| u16::from_le_bytes(v).into()).collect()
    } else {
        bytes.as_chunks().0.iter().map(|&v| u32::from_le_bytes(v)).collect()
    };
    corners.as_chunks().0.to_vec()
}
