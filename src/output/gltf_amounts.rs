//! The lengths of the halves of glTF, known before either is written.

use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::gltf_animation::{self, FRAME_RATE};
use crate::output::gltf_looks;
use crate::output::gltf_packing::Packing;
use crate::output::gltf_views::CHANNEL_NUMBER_BYTES;
use crate::output::hard_edges;
use crate::output::numbers::total;
use crate::output::options::IDS;
use crate::output::scene::{CoordinateSystem, Shape};
use crate::shape::attachments::Attachments;
use crate::shape::labels::by_labels;

/// Bytes of a position or a normal.
pub(super) const FLOAT_VECTOR_BYTES: u128 = 12;

/// Bytes of a position and of a normal in whole numbers, padded to a multiple of 4.
const PACKED_PLACE_BYTES: u128 = 8;
const PACKED_DIRECTION_BYTES: u128 = 4;

/// Maximum number of vertices with 16-bit indices: the largest 16-bit number starts a new strip in some programs.
const SHORT_INDICES: u128 = 65_535;

/// Bytes of the origin of a vertex: dimension and number of the input cell.
pub(super) const ORIGIN_BYTES: u128 = 8;

/// Maximum number of bytes of a morph target in a document: two accessors, one with its bounds, two views, a weight, a
/// name, and the target of the first primitive.
const TARGET_BYTES: u128 = 1_024;

/// Maximum number of bytes that packing adds to a document once: the names of extensions and a second buffer.
const PACKED_DOCUMENT_BYTES: u128 = 512;
/// Maximum number of bytes that packing adds to a document per view: the entry of its encoding.
const PACKED_VIEW: u128 = 256;
/// Maximum number of bytes that packing adds to a document per mesh: its errors and the transform of its node.
const PACKED_MESH: u128 = 384;

/// Maximum number of bytes of an animation: two accessors, two views, a sampler and its channel.
const ANIMATION_BYTES: u128 = 1_024;

/// Maximum number of bytes of the mesh and the node of a group besides its name, and of its channel in an animation.
const GROUP_ENTRY_BYTES: u128 = 256;

/// Maximum number of bytes of a target in each further primitive: the numbers of two accessors, a weight and a name.
const TARGET_OF_PART: u128 = 64;

/// Bytes of memory per vertex while it is packed, besides those of the buffer: its numbers in the new order, as
/// vectors, and as the codec reads them, 61 when the sizes of these are added, and a quarter more.
const PACKED_VERTEX_BYTES: u128 = 80;

/// Bytes of memory per triangle while it is packed: its corners before and after, the triangles of its vertices, and
/// its place among all. These add up to 73; a third is spare.
const PACKED_TRIANGLE_BYTES: u128 = 96;

/// Number of input cells whose numbers f32 holds exactly.
const EXACT_CELLS: usize = 1 << 24;

/// Refuses origins if f32 cannot hold the numbers of all vertices, edges and faces of the input exactly.
pub(super) fn check_origins(cells: [usize; 3], ids: bool) -> Result<(), String> {
    match cells.iter().max() {
        Some(&most) if ids && most > EXACT_CELLS => Err(format!(
            "the input has {most} vertices, edges or faces, glTF tells the origin of vertices for at most \
             {EXACT_CELLS} of each; ask for json or ply"
        )),
        _ => Ok(()),
    }
}

/// Refuses results whose counts are beyond the limits of glTF.
pub(super) fn fits(counts: &Counts, options: &Values) -> Result<(), Fault> {
    let vertices = usize::try_from(counts.control).unwrap_or(usize::MAX);
    let ids = counts.kind == ShapeKind::Mesh && options.flag(IDS.name);
    if counts.frames == 0 && options.number(FRAME_RATE.name).is_some() {
        let detail = "there is one frame, which makes no animation; leave it out, or give \"frames\"";
        return Err(Fault::new(format!("/{}", FRAME_RATE.name), detail));
    }
    check_origins([vertices, counts.input_edges, counts.input_faces], ids).map_err(|detail| Fault::new("/ids", detail))
}

/// Returns the memory of splitting vertices and of packing, besides the memory of the result, bytes.
pub(super) fn memory(counts: &Counts, options: &Values) -> u128 {
    let splitting = hard_edges::memory(counts, options);
    if Packing::of(options).is_none() {
        return splitting;
    }
    let amounts = Amounts::of(counts, options);
    let loose = amounts.bytes();
    total(&[
        (splitting, 1),
        (loose, 2),
        (amounts.vertices, PACKED_VERTEX_BYTES),
        (amounts.triangles, PACKED_TRIANGLE_BYTES),
    ])
}

/// Returns the work of packing, in rows of 100 ns: one per triangle and one per vertex.
pub(super) fn packing_work(counts: &Counts, options: &Values) -> u128 {
    if Packing::of(options).is_none() {
        return 0;
    }
    let amounts = Amounts::of(counts, options);
    amounts.vertices.saturating_add(amounts.triangles)
}

/// Returns whether normals are requested.
pub(super) fn with_normals(options: &Values) -> bool {
    options.choice("normals") != Some("none")
}

/// Returns the maximum number of copies of vertices that have a normal of their own.
pub(super) fn split_vertices(counts: &Counts, options: &Values) -> u128 {
    if with_normals(options) { hard_edges::split_vertices(counts, options) } else { 0 }
}

/// Numbers of rows in the buffer.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Amounts {
    /// Number of positions.
    pub(super) vertices: u128,
    /// Whether each position has a normal.
    pub(super) normals: bool,
    /// Number of components of all channels of a vertex.
    pub(super) numbers: u128,
    /// Whether each vertex has texture coordinates.
    pub(super) uvs: bool,
    /// Whether vertices and triangles have their origins.
    pub(super) ids: bool,
    /// Number of triples of indices.
    pub(super) triangles: u128,
    /// Number of morph targets: frames after the first, each with a position and, if there are normals, a normal per
    /// vertex.
    pub(super) targets: u128,
    /// Frames per second of the animation, if there is one.
    pub(super) frame_rate: Option<f64>,
    /// Bytes of images, a multiple of 4.
    pub(super) images: u128,
}

impl Amounts {
    /// Returns the maximum amounts for these counts; shapes without faces have no normals, curves have no attachments.
    pub(super) fn of(counts: &Counts, options: &Values) -> Self {
        let mesh = counts.kind == ShapeKind::Mesh;
        let faces = if mesh { counts.faces } else { 0 };
        Self {
            vertices: if counts.unfolded > 0 { counts.unfolded } else { counts.vertices }
                .saturating_add(split_vertices(counts, options)),
            normals: with_normals(options) && faces > 0,
            numbers: counts.attachments.width() as u128,
            uvs: counts.uvs > 0,
            ids: mesh && options.flag("ids"),
            triangles: if faces == 0 { 0 } else { counts.half_edges.saturating_sub(faces.saturating_mul(2)) },
            targets: counts.frames as u128,
            frame_rate: options.number(FRAME_RATE.name),
            images: if faces > 0 { gltf_looks::bytes_of_images(&counts.attachments.looks) } else { 0 },
        }
    }

    /// Returns the amounts of a shape.
    pub(super) fn of_shape(shape: Shape<'_>, options: &Values) -> Self {
        match shape {
            Shape::Mesh(mesh) => {
                let faces = mesh.n_faces() as u128;
                Self {
                    vertices: mesh.n_vertices() as u128,
                    normals: with_normals(options) && faces > 0,
                    numbers: mesh.attachments().width() as u128,
                    uvs: mesh.uvs().is_some(),
                    ids: options.flag("ids"),
                    triangles: mesh.n_half_edges() as u128 - 2 * faces,
                    images: if faces > 0 { gltf_looks::bytes_of_images(&mesh.attachments().looks) } else { 0 },
                    ..Self::default()
                }
            }
            Shape::Curves(curves) => {
                Self { vertices: curves.iter().map(|curve| curve.len() as u128).sum(), ..Self::default() }
            }
        }
    }

    /// Returns the bytes of three indices.
    pub(super) fn triangle(&self) -> u128 {
        if self.vertices <= SHORT_INDICES { 6 } else { 12 }
    }

    /// Returns the bytes of all indices, padded to a multiple of 4.
    pub(super) fn indices(&self) -> u128 {
        self.triangles.saturating_mul(self.triangle()).checked_next_multiple_of(4).unwrap_or(u128::MAX)
    }

    /// Returns the length of the buffer in bytes, a multiple of 4.
    pub(super) fn bytes(&self) -> u128 {
        self.bytes_of(FLOAT_VECTOR_BYTES * if self.normals { 2 } else { 1 })
    }

    /// Returns the maximum length of the buffer of a packed model: views are encoded only if that makes them shorter.
    pub(super) fn packed_bytes(&self, packing: Packing) -> u128 {
        if !packing.quantizes {
            return self.bytes();
        }
        self.bytes_of(PACKED_PLACE_BYTES + if self.normals { PACKED_DIRECTION_BYTES } else { 0 })
    }

    /// Returns the length of the buffer if a vertex takes `vectors` bytes for position and normal, in each frame.
    fn bytes_of(&self, vectors: u128) -> u128 {
        let (origin, face) = if self.ids { (ORIGIN_BYTES, 4) } else { (0, 0) };
        let uvs = if self.uvs { 2 * CHANNEL_NUMBER_BYTES } else { 0 };
        let vertex = vectors * (1 + self.targets) + self.numbers * CHANNEL_NUMBER_BYTES + uvs + origin;
        let [moments, weights] = self.frame_rate.map_or([0; 2], |_| gltf_animation::lengths(self.targets));
        total(&[
            (self.vertices, vertex),
            (self.indices(), 1),
            (self.triangles, face),
            (moments, 1),
            (weights, 1),
            (self.images, 1),
        ])
    }
}

/// The facts that determine the length of a document.
#[derive(Debug, Clone, Copy)]
pub(super) struct GltfContents<'a> {
    /// Curves or a mesh.
    pub(super) kind: ShapeKind,
    /// Number of polygons.
    pub(super) polygons: u128,
    /// The unit and the up axis of coordinates.
    pub(super) coordinate_system: CoordinateSystem,
    /// The attachments of the mesh.
    pub(super) attachments: &'a Attachments,
    /// Number of faces of the input.
    pub(super) input_faces: usize,
    /// Whether origins are written.
    pub(super) ids: bool,
    /// Number of morph targets.
    pub(super) targets: u128,
}

impl<'a> GltfContents<'a> {
    /// Returns the facts for these counts.
    pub(super) fn of(counts: &'a Counts, options: &Values) -> Self {
        Self {
            kind: counts.kind,
            polygons: counts.polygons,
            coordinate_system: counts.coordinate_system,
            attachments: &counts.attachments,
            input_faces: counts.input_faces,
            ids: counts.kind == ShapeKind::Mesh && options.flag("ids"),
            targets: counts.frames as u128,
        }
    }

    /// Returns the maximum number of bytes of the document of a packed model, in which views may have entries for their
    /// encoding.
    pub(super) fn packed_room(&self) -> u128 {
        let channels = self.attachments.channels.len() as u128;
        let groups = self.attachments.groups.names.len() as u128;
        total(&[(self.room(), 1), (PACKED_DOCUMENT_BYTES, 1), (PACKED_VIEW, 6 + channels), (PACKED_MESH, 1 + groups)])
    }

    /// Returns the maximum number of bytes of the document, a multiple of 4: 1,536 for a mesh, for curves 768 and 384 a
    /// polygon, and more for attachments, origins and frames.
    pub(super) fn room(&self) -> u128 {
        let plain = match self.kind {
            ShapeKind::Mesh => 1_536,
            ShapeKind::Curves { .. } => total(&[(768, 1), (384, self.polygons)]),
        };
        let oriented = if self.coordinate_system.is_default() { 0 } else { 256 };
        let targets = self.targets.saturating_mul(TARGET_BYTES) + if self.targets > 0 { ANIMATION_BYTES } else { 0 };
        let plain = total(&[(plain, 1), (targets, 1)]);
        if self.attachments.is_empty() && !self.ids {
            return plain + oriented;
        }
        let Attachments { channels, groups, materials, looks, uvs, unfolded: _ } = self.attachments;
        let name_bytes: usize = channels.iter().map(|channel| channel.name.len()).sum();
        let (channels, names) = (channels.len() as u128 + u128::from(uvs.is_some()), name_bytes as u128);
        let parts = by_labels(groups, materials, self.input_faces).len() as u128;
        // in names of groups and materials each byte may need a backslash
        let longest = |names: &[String]| names.iter().map(|name| 2 * name.len() as u128).max().unwrap_or(0);
        let labels = longest(&groups.names) + longest(&materials.names);
        let group = if groups.is_empty() { 0 } else { GROUP_ENTRY_BYTES + 2 * longest(&groups.names) };
        let part = 768 + names + 16 * channels + labels + group + self.targets.saturating_mul(TARGET_OF_PART);
        let looks = gltf_looks::room(looks);
        let room = total(&[(plain + oriented, 1), (512, 1), (384, channels), (part, parts), (looks, 1)]);
        room.saturating_add(3) / 4 * 4
    }
}
