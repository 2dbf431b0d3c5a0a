//! The binary half of glTF: f32 positions, normals and channels, then u16 or u32 indices.

use std::ops::Range;

use crate::kept::Kept;
use crate::math::parameter::Values;
use crate::math::vector::minus;
use crate::output::bounds::CoordinateBounds;
use crate::output::bytes::Bytes;
use crate::output::colors::linear;
use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::gltf_amounts::{Amounts, GltfContents, check_origins, with_normals};
use crate::output::gltf_animation::{self as animation, FRAME_RATE};
use crate::output::gltf_targets::{MorphTarget, normals_of};
use crate::output::hard_edges::HardEdges;
use crate::output::normals;
use crate::output::numbers::{as_written, f32_bytes, index_bytes, rounded};
use crate::output::positions::{Positions, channels_within_f32};
use crate::output::scene::{CoordinateSystem, FaceChunk, MeshSource, Scene, Shape, in_chunks, triangles};
use crate::output::stream::{ROWS_PER_BLOCK, Stream};
use crate::output::vertex_sides::{Sides, SplitSides};
use crate::shape::attachments::Attachments;
use crate::shape::labels::{LabelledFaces, by_labels};
use crate::shape::looks::images;
use crate::watch::{Stopped, Watch};

/// A model is centred on the origin if it is farther away than this many times half its longest side. At this distance
/// f32 loses two of its 24 bits to the place. Half of it moves models that would lose one; twice of it leaves some that
/// lose three.
const FAR_FROM_ORIGIN: f64 = 4.0;

/// The contents of the buffer, and the numbers that describe it.
pub(super) struct Buffer<'a> {
    mesh: Option<&'a dyn MeshSource>,
    /// The mesh before vertices were split, if they were; it determines the normals of `mesh`.
    smooth: Option<&'a dyn MeshSource>,
    /// One entry for the mesh, or one for each polygon.
    pub(super) parts: Vec<PrimitiveVertices<'a>>,
    /// The faces of the mesh by group and material, without parts that have no triangles.
    pub(super) faces: Vec<PrimitiveFaces>,
    /// The frames after the first.
    pub(super) targets: Vec<MorphTarget<'a>>,
    /// The offset subtracted from all positions (model units); each coordinate is an f32 in decimals, so that it can be
    /// added again without loss.
    pub(super) center: [f64; 3],
    /// The unit and the up axis of coordinates.
    pub(super) coordinate_system: CoordinateSystem,
    /// The amounts of all kinds of data.
    pub(super) amounts: Amounts,
}

/// The vertices of one primitive.
pub(super) struct PrimitiveVertices<'a> {
    positions: Positions<'a>,
    /// The bounding box of the positions, model units.
    pub(super) bounds: CoordinateBounds<3>,
    /// Whether a polygon is closed; `None` for a mesh.
    pub(super) closed: Option<bool>,
}

impl PrimitiveVertices<'_> {
    /// Returns the number of vertices.
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }
}

/// The faces of one primitive.
pub(super) struct PrimitiveFaces {
    /// Number of the group, if any.
    pub(super) group: Option<usize>,
    /// Number of the material, if any.
    pub(super) material: Option<usize>,
    /// Number of triangles of the faces.
    pub(super) triangles: u128,
    /// Shown faces, in ascending ranges.
    ranges: Vec<Range<usize>>,
}

/// Measures a scene, with vertices split where they have several normals or texture coordinates, and calls `write` with
/// the contents of its buffer.
///
/// # Errors
/// Coordinates that f32 cannot hold, more vertices than 32-bit indices reach, a stopped watch, or the error of `write`.
pub(super) fn buffered(
    scene: &Scene<'_>,
    options: &Values,
    watch: &Watch,
    write: impl FnOnce(&Buffer<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let frames = if let Shape::Mesh(mesh) = scene.shape { mesh.frames() } else { Vec::new() };
    let hard = HardEdges::of(scene.shape, options, watch)?;
    let sides = Sides::of(scene.shape);
    let frames: Vec<Sides<'_>> = frames.into_iter().map(|frame| Sides::of(Shape::Mesh(frame))).collect();
    let parts = sides.split_vertices(with_normals(options), &hard, watch)?;
    // all frames are split like the first one, so that their vertices correspond
    let split = |sides| Sides::split_vertices(sides, with_normals(options), &hard, watch);
    let frames = frames.iter().map(split).collect::<Result<Vec<_>, _>>()?;
    let scene = Scene { shape: parts.shape(), ..*scene };
    write(&Buffer::of(&scene, parts.smooth(), &frames, options, watch)?)
}

impl<'a> Buffer<'a> {
    /// Measures a scene and its other frames; `smooth` is the mesh with whole vertices if those of the scene are split.
    fn of(
        scene: &Scene<'a>,
        smooth: Option<&'a dyn MeshSource>,
        frames: &'a [SplitSides<'a>],
        options: &Values,
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let frame_rate = options.number(FRAME_RATE.name).filter(|_| !frames.is_empty());
        let targets = frames.len() as u128;
        let amounts = Amounts { targets, frame_rate, ..Amounts::of_shape(scene.shape, options) };
        let (mesh, sources) = match scene.shape {
            Shape::Mesh(mesh) => {
                let positions = Positions::of_mesh(mesh);
                let held = (amounts.normals && mesh.on_demand().is_none()) || amounts.targets > 0;
                let positions = if held { positions.held(watch)? } else { positions };
                (Some(mesh), vec![(positions, None)])
            }
            Shape::Curves(curves) => {
                let positions = curves.iter().map(|curve| (Positions::of_curve(curve), Some(curve.closed)));
                (None, positions.collect())
            }
        };
        let mut parts = Vec::with_capacity(sources.len());
        for (positions, closed) in sources {
            let bounds = positions.bounds(watch)?;
            parts.push(PrimitiveVertices { positions, bounds, closed });
        }
        let center = center(&parts.iter().fold(CoordinateBounds::EMPTY, |all, part| all.joined(&part.bounds)))?;
        let from = parts.first().map_or(&[][..], |part| part.positions.rows());
        let targets = frames.iter().filter_map(|frame| MorphTarget::of(frame, from, center, watch).transpose());
        let targets = targets.collect::<Result<Vec<_>, _>>()?;
        let faces = match mesh {
            Some(mesh) => {
                channels_within_f32(mesh, watch)?;
                check_origins(mesh.input_cells(), amounts.ids).map_err(FormatError::Unfit)?;
                sections(mesh, watch)?
            }
            None => Vec::new(),
        };
        Ok(Self { mesh, smooth, parts, faces, targets, center, coordinate_system: scene.coordinate_system, amounts })
    }

    /// Returns the attachments of the mesh.
    pub(super) fn attachments(&self) -> &'a Attachments {
        self.mesh.map_or(Attachments::none(), |mesh| mesh.attachments())
    }

    /// Returns the facts that determine the length of the document.
    pub(super) fn contents(&self) -> GltfContents<'a> {
        GltfContents {
            kind: if self.is_mesh() { ShapeKind::Mesh } else { ShapeKind::Curves { dimension: 3 } },
            polygons: self.parts.len() as u128,
            coordinate_system: self.coordinate_system,
            attachments: self.attachments(),
            input_faces: self.mesh.map_or(0, |mesh| mesh.input_cells()[2]),
            ids: self.amounts.ids,
            targets: self.amounts.targets,
        }
    }

    /// Returns whether this is the buffer of a mesh.
    pub(super) fn is_mesh(&self) -> bool {
        self.mesh.is_some()
    }

    /// Returns a position as it is stored.
    pub(super) fn local(&self, position: [f64; 3]) -> [f32; 3] {
        local(position, self.center)
    }

    /// Writes all bytes.
    pub(super) fn write(&self, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        for part in &self.parts {
            stream.positions(&part.positions, |_, rows, out| vectors(rows, out, |row| minus(row, self.center)))?;
        }
        let (Some(mesh), Some(part)) = (self.mesh, self.parts.first()) else { return Ok(()) };
        let mut normals = Kept::default();
        if let (true, Some(source)) = (self.amounts.normals, mesh.on_demand()) {
            let scale = normals::scale_of(&part.bounds);
            stream.vectors(
                part.positions.ranges(ROWS_PER_BLOCK),
                |range, rows| normals::on_demand(source, range, scale, rows),
                |rows, out| vectors(rows, out, normals::or_up),
            )?;
        } else if self.amounts.normals {
            normals = normals_of(mesh, self.smooth, (&part.positions, Some(&part.bounds)), stream.watch)?;
            stream.rows(&normals, |_, rows, out| vectors(rows, out, normals::or_up))?;
            if self.targets.is_empty() {
                normals = Kept::default();
            }
        }
        self.write_carried(mesh, stream)?;
        let short = self.amounts.triangle() == 6;
        for range in self.faces.iter().flat_map(|section| &section.ranges) {
            stream.faces_in(mesh, range.clone(), |_, faces, out| {
                if short { short_indices(faces, out) } else { indices(faces, out) }
            })?;
        }
        let filled = self.amounts.indices() - self.amounts.triangles * self.amounts.triangle();
        stream.bytes(&[0; 4][..usize::try_from(filled).expect("it is less than 4")])?;
        if self.amounts.ids {
            for range in self.faces.iter().flat_map(|section| &section.ranges) {
                stream.faces_in(mesh, range.clone(), |start, faces, out| {
                    let origins = (start..).zip(faces.iter()).flat_map(|(index, face)| {
                        let origin = mesh.face_origin(index).to_le_bytes();
                        triangles(face).map(move |_| origin)
                    });
                    let slots = out.rows(faces.vertices.len() - 2 * faces.len());
                    slots.iter_mut().zip(origins).for_each(|(slot, origin)| *slot = origin);
                })?;
            }
        }
        for target in &self.targets {
            target.write_positions(part.positions.rows(), self.center, stream)?;
            if self.amounts.normals {
                target.write_normals(&normals, stream)?;
            }
        }
        if let Some(rate) = self.amounts.frame_rate {
            stream.bytes(&animation::numbers(self.targets.len(), rate))?;
        }
        self.write_images(stream)
    }

    /// Writes the bytes of all images, each padded to a multiple of 4.
    fn write_images(&self, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let all = if self.amounts.images > 0 { images(&self.attachments().looks) } else { Vec::new() };
        for image in all {
            stream.bytes(image.bytes())?;
            stream.bytes(&[0; 4][..image.bytes().len().wrapping_neg() % 4])?;
        }
        Ok(())
    }

    /// Writes channels, texture coordinates, and the origins of vertices if requested.
    fn write_carried(&self, mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        for (i, channel) in mesh.attachments().channels.iter().enumerate() {
            let bytes = |x: f64| (rounded(x) + 0.0).to_le_bytes();
            stream.channel(mesh, i, |_, numbers, out| {
                let slots = out.rows(numbers.len()).iter_mut().zip(numbers);
                if channel.is_color() {
                    let components = (0..channel.width).cycle();
                    slots.zip(components).for_each(|((slot, &x), k)| *slot = bytes(linear(k, x)));
                } else {
                    slots.for_each(|(slot, &x)| *slot = bytes(x));
                }
            })?;
        }
        stream.uvs(mesh, |_, values, out| {
            for (slot, &[u, v]) in out.rows::<8>(values.len()).iter_mut().zip(values) {
                // glTF counts from the upper edge of the image downwards
                slot.copy_from_slice([u, 1.0 - v].map(|x| (rounded(x) + 0.0).to_le_bytes()).as_flattened());
            }
        })?;
        if self.amounts.ids {
            stream.each(0..mesh.n_vertices(), |vertex, out| {
                let origin = mesh.vertex_origin(vertex);
                let pair = [f64::from(origin.dimension), f64::from(origin.cell)];
                out.extend_from_slice(pair.map(|x| rounded(x).to_le_bytes()).as_flattened());
            })?;
        }
        Ok(())
    }
}

/// Returns the faces of a mesh by group and material, in the order in which these first appear.
fn sections(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<PrimitiveFaces>, FormatError> {
    let attachments = mesh.attachments();
    let parts = if attachments.names_faces() {
        by_labels(&attachments.groups, &attachments.materials, mesh.input_cells()[2])
    } else {
        let triangles = mesh.n_half_edges() as u128 - 2 * mesh.n_faces() as u128;
        let ranges = std::iter::once(0..mesh.n_faces()).collect();
        return Ok(if triangles > 0 {
            vec![PrimitiveFaces { group: None, material: None, triangles, ranges }]
        } else {
            vec![]
        });
    };
    let section = |LabelledFaces { group, material, runs }: LabelledFaces| {
        let shown = |f: u32| mesh.faces_of(f as usize);
        let ranges = runs.iter().map(|run| shown(run.start).start..shown(run.end - 1).end);
        let ranges: Vec<_> = ranges.filter(|range| !range.is_empty()).collect();
        let mut triangles = 0;
        for range in &ranges {
            triangles += n_triangles(mesh, range, watch)?;
        }
        Ok(PrimitiveFaces { group, material, triangles, ranges })
    };
    let sections: Result<Vec<_>, FormatError> = parts.into_iter().map(section).collect();
    Ok(sections?.into_iter().filter(|section| section.triangles > 0).collect())
}

/// Returns the number of triangles of consecutive faces.
fn n_triangles(mesh: &dyn MeshSource, some: &Range<usize>, watch: &Watch) -> Result<u128, Stopped> {
    let mut chunk = FaceChunk::default();
    let mut n = 0;
    in_chunks(some.len(), |range| {
        watch.check()?;
        mesh.faces(some.start + range.start..some.start + range.end, &mut chunk);
        n += chunk.vertices.len() as u128 - 2 * chunk.len() as u128;
        Ok(())
    })?;
    Ok(n)
}

/// Returns the offset to subtract from all positions: the centre of the bounding box, rounded to f32, if it is far from
/// the origin. It is the number that the node's translation has in decimals, so that readers who parse it as f64
/// restore every digit.
fn center(bounds: &CoordinateBounds<3>) -> Result<[f64; 3], FormatError> {
    let middle = bounds.center();
    let distance = middle.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let center =
        if distance > FAR_FROM_ORIGIN * bounds.half_side() { middle.map(|x| as_written(rounded(x))) } else { [0.0; 3] };
    let corners = [bounds.min, bounds.max].map(|corner| local(corner, center));
    if !bounds.is_empty() && !(corners.as_flattened().iter().all(|x| x.is_finite())) {
        let (min, max, most) = (bounds.min, bounds.max, f32::MAX);
        let detail = format!("the model reaches from {min:?} to {max:?}, glTF holds at most {most:e}; ask for obj");
        return Err(FormatError::Unfit(detail));
    }
    Ok(center)
}

fn local(position: [f64; 3], center: [f64; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| rounded(position[k] - center[k]))
}

fn vectors(rows: &[[f64; 3]], out: &mut Bytes, changed: impl Fn([f64; 3]) -> [f64; 3]) {
    out.rows(rows.len()).iter_mut().zip(rows).for_each(|(slot, &row)| *slot = f32_bytes(changed(row)));
}

/// Makes the indices of the triangles of faces.
fn indices(faces: &FaceChunk, out: &mut Bytes) {
    if let Some(quads) = faces.rows() {
        let slots = out.rows::<24>(quads.len()).iter_mut().zip(quads);
        slots.for_each(|(slot, &[a, b, c, d])| *slot = index_bytes([a, b, c, a, c, d]));
    } else {
        let slots = out.rows::<12>(faces.vertices.len() - 2 * faces.len()).iter_mut();
        slots.zip(faces.iter().flat_map(triangles)).for_each(|(slot, triangle)| *slot = index_bytes(triangle));
    }
}

/// Makes the indices of the triangles of faces of meshes with 16-bit vertex numbers.
fn short_indices(faces: &FaceChunk, out: &mut Bytes) {
    let short = |v: u32| u16::try_from(v).expect("there are at most 65,535 vertices").to_le_bytes();
    let slots = out.rows::<6>(faces.vertices.len() - 2 * faces.len()).iter_mut();
    for (slot, triangle) in slots.zip(faces.iter().flat_map(triangles)) {
        slot.copy_from_slice(triangle.map(short).as_flattened());
    }
}
