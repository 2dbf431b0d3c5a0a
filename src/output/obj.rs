//! Wavefront OBJ: text that keeps polygons and every digit.

use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Values};
use crate::output::colors::within;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::hard_edges::HardEdges;
use crate::output::left_out::{Datum, left_out};
use crate::output::mtl::check_file_name;
use crate::output::normals;
use crate::output::numbers::{REAL_BYTES, digits, real, total, whole};
use crate::output::options::{IDS, POSITIONS};
use crate::output::positions::Positions;
use crate::output::scene::{CoordinateSystem, Curve, FaceChunk, MeshSource, Scene, Shape};
use crate::output::size::Size;
use crate::output::split_vertices::SplitVertices;
use crate::output::stream::{Stream, holds_space};
use crate::output::surface::{NORMALS, with_normals};
use crate::output::text::RowStyle;
use crate::shape::attachments::Attachments;
use crate::shape::creases::CreaseTags;
use crate::shape::labels::Labels;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// The option of a library of materials.
const LIBRARY: Parameter = Parameter::optional(
    "mtllib",
    ParameterKind::Name,
    "The name of a file beside this one with the materials, as the format \"mtl\" writes it; left out, none is \
     named.",
);

/// The warning about an OBJ file whose materials have looks, if the file names no library.
pub const WITHOUT_LIBRARY: &str = "how materials look is left out, as no library is named; give \"mtllib\" and ask for \
                                   mtl, too, or ask for glb";

/// Returns the first lines: the program, the unit and up axis of coordinates, and the library of materials.
fn header(coordinate_system: CoordinateSystem, options: &Values) -> String {
    let remarks =
        ["planish".to_owned()].into_iter().chain(coordinate_system.remarks()).map(|remark| format!("# {remark}\n"));
    let library = options.name(LIBRARY.name).map(|name| format!("mtllib {name}\n"));
    remarks.chain(library).collect::<Vec<_>>().concat()
}

/// The lines of vertices, texture coordinates, normals and faces.
const VERTEX_LINE: RowStyle = line(b"v");
const UV_LINE: RowStyle = line(b"vt");
const NORMAL_LINE: RowStyle = line(b"vn");
const FACE_LINE: RowStyle = line(b"f");

const fn line(keyword: &'static [u8]) -> RowStyle {
    RowStyle { start: keyword, open: b' ', between: b' ', end: b"\n" }
}

/// The group and material of faces without one: the format's name for no group.
const UNNAMED: &str = "default";

/// Wavefront OBJ: `v`, `vt` with texture coordinates, `vn` on request, `f` for meshes; `v` and `l` for curves.
///
/// Numbers are the shortest decimals that read back as the same f64. A closed curve repeats its first index; missing
/// coordinates of points are 0. Unit and up axis are comments if they are not the defaults. The channel `color` follows
/// the coordinates (red, green, blue); other channels are left out. Groups and materials are `g` and `usemtl`,
/// "default" for faces without; looks of materials are in a library of their own, the format "mtl". Origins are
/// comments before the first vertex and face of each input cell. If the mesh is written without refinement, tags
/// `t crease` and `t corner` after the faces hold its sharpness.
#[derive(Debug)]
pub(super) struct Obj;

const FACTS: &FormatFacts = &FormatFacts {
    name: "obj",
    extension: "obj",
    media_type: "model/obj",
    content: Content::Text,
    doc: "Wavefront OBJ: polygons as they are, shortest decimals that read back exactly",
    parameters: &[POSITIONS, NORMALS, IDS, LIBRARY],
    description: Some(DescriptionPlace::Lines("#", 1)),
    holds: |kind, _| holds_space("obj", kind),
    ..FormatFacts::USUAL
};

impl Format for Obj {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, _mesh: &Mesh, options: &Values) -> &'static [Tile] {
        if with_normals(options) { &[] } else { &[Tile::Quad, Tile::Triangle] }
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        stream.bytes(header(scene.coordinate_system, options).as_bytes())?;
        match scene.shape {
            Shape::Curves(curves) => write_curves(curves, stream),
            Shape::Mesh(mesh) => {
                let obj_mesh = ObjMesh { mesh, ids: options.flag("ids") };
                if with_normals(options) {
                    write_with_normals(&obj_mesh, stream)?;
                    return write_tags(&mesh.tags(), stream);
                }
                obj_mesh.vertices(&Positions::of_mesh(mesh), stream)?;
                obj_mesh.uvs(stream)?;
                if mesh.uvs().is_none() && !obj_mesh.tells_of_faces() {
                    stream.faces(mesh, |_, faces, out| FACE_LINE.faces(faces, 1, out))?;
                } else {
                    stream.faces_and_uvs(mesh, |start, chunks, out| {
                        out.append(|out| {
                            obj_mesh.faces(start, chunks, out, |vertex, place, out| {
                                number(b' ', vertex, out);
                                place.into_iter().for_each(|place| number(b'/', place, out));
                            });
                        });
                    })?;
                }
                write_tags(&mesh.tags(), stream)
            }
        }
    }
}

impl Requirements for Obj {
    fn suits(&self, _: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        check_file_name(&LIBRARY, options)
    }

    fn leaves_out(&self, carried: &Attachments, options: &Values) -> Vec<String> {
        let kinds = [Datum::ColorSeams, Datum::ColorAlpha, Datum::OtherChannels];
        let mut sentences = left_out("obj", "glb or json", carried, &kinds);
        if options.name(LIBRARY.name).is_none() && carried.looks.iter().any(|look| !look.is_silent()) {
            sentences.push(WITHOUT_LIBRARY.to_owned());
        }
        sentences
    }
}

impl Costs for Obj {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let index = digits(counts.vertices);
        let row = 3 * (1 + REAL_BYTES);
        let header = header(counts.coordinate_system, options).len() as u128;
        Size::AtMost(match counts.kind {
            ShapeKind::Curves { .. } => total(&[
                (1, header),
                (counts.vertices, 2 + row),
                (counts.vertices.saturating_add(counts.polygons), 1 + index),
                (counts.polygons, 2),
            ]),
            ShapeKind::Mesh => {
                let n_normals = counts.vertices.saturating_add(counts.split_vertices);
                let (n_normals, corner) =
                    if with_normals(options) { (n_normals, 3 + index + digits(n_normals)) } else { (0, 1 + index) };
                let attachment_bytes = attachment_bytes(counts, options.flag("ids"));
                let color = if counts.attachments.color().is_some() { row } else { 0 };
                let vertex = 2 + row + color;
                let place = if counts.uvs > 0 { 1 + digits(counts.uvs) } else { 0 };
                let rows = [(counts.vertices, vertex), (counts.faces, 2), (counts.half_edges, corner + place)];
                let uvs = (counts.uvs, 3 + 2 * (1 + REAL_BYTES));
                let tags = (counts.tags as u128, "t corner 1/1/0\n".len() as u128 + 2 * (1 + index) + 1 + REAL_BYTES);
                total(&[(1, header), (1, attachment_bytes), tags, uvs, rows[0], (n_normals, 3 + row), rows[1], rows[2]])
            }
        })
    }
}

/// Writes the sharp edges and vertices; in tags vertices are counted from 0.
fn write_tags(tags: &CreaseTags, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.each(0..tags.creases.len(), |i, out| {
        let (ends, sharpness) = tags.creases[i];
        tag("crease 2/1/0", &ends, sharpness, out);
    })?;
    stream.each(0..tags.corners.len(), |i, out| {
        let (vertex, sharpness) = tags.corners[i];
        tag("corner 1/1/0", &[vertex], sharpness, out);
    })
}

fn tag(kind: &str, vertices: &[u32], sharpness: f64, out: &mut Vec<u8>) {
    out.extend_from_slice(b"t ");
    out.extend_from_slice(kind.as_bytes());
    for &vertex in vertices {
        out.push(b' ');
        whole(out, vertex.into());
    }
    out.push(b' ');
    real(out, sharpness);
    out.push(b'\n');
}

fn write_with_normals(obj_mesh: &ObjMesh<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let watch = stream.watch;
    let mesh = obj_mesh.mesh;
    let positions = Positions::of_mesh(mesh).held(watch)?;
    obj_mesh.vertices(&positions, stream)?;
    obj_mesh.uvs(stream)?;
    let split_vertices = SplitVertices::of(Shape::Mesh(mesh), &HardEdges::default(), watch)?;
    let sides = split_vertices.as_ref().map_or(mesh, |split_vertices| split_vertices);
    let positions = if split_vertices.is_some() { Positions::of_mesh(sides).held(watch)? } else { positions };
    let normals = normals::of(sides, positions.rows(), watch)?;
    drop(positions);
    let origin = |v: u32| split_vertices.as_ref().map_or(v, |split_vertices| split_vertices.origin(v));
    stream.rows(&normals, |_, rows, out| {
        NORMAL_LINE.vectors(rows.iter().copied().map(normals::or_up), out);
    })?;
    stream.faces_and_uvs(sides, |start, chunks, out| {
        out.append(|out| {
            obj_mesh.faces(start, chunks, out, |vertex, place, out| {
                number(b' ', origin(vertex), out);
                match place {
                    Some(place) => number(b'/', place, out),
                    None => out.push(b'/'),
                }
                number(b'/', vertex, out);
            });
        });
    })
}

fn write_curves(curves: &[Curve], stream: &mut Stream<'_>) -> Result<(), FormatError> {
    for curve in curves {
        vertices(&Positions::of_curve(curve), stream)?;
    }
    let mut start = 1;
    for curve in curves {
        let first = start;
        start += curve.len();
        match curve.len() {
            0 => continue,
            1 => stream.bytes(b"p")?,
            _ => stream.bytes(b"l")?,
        }
        stream.each(first..start, |index, out| {
            out.push(b' ');
            whole(out, index as u64);
        })?;
        if curve.closed && curve.len() > 1 {
            stream.bytes(format!(" {first}").as_bytes())?;
        }
        stream.bytes(b"\n")?;
    }
    Ok(())
}

fn vertices(positions: &Positions<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.positions(positions, |_, rows, out| VERTEX_LINE.vectors(rows.iter(), out))
}

/// Appends the number of a vertex or a place, counted from 1, after a byte.
fn number(before: u8, index: u32, out: &mut Vec<u8>) {
    out.push(before);
    whole(out, u64::from(index) + 1);
}

/// The attachments and origins of a mesh.
struct ObjMesh<'a> {
    mesh: &'a dyn MeshSource,
    /// Whether origins are written.
    ids: bool,
}

impl ObjMesh<'_> {
    /// Writes the vertices with their colours and origins.
    fn vertices(&self, positions: &Positions<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let color = self.mesh.attachments().color().filter(|(_, color)| color.seams.is_none());
        let Some((channel, color)) = color.map(|(i, color)| (i, color.width)) else {
            if !self.ids {
                return vertices(positions, stream);
            }
            return stream.positions(positions, |start, rows, out| {
                out.append(|out| {
                    for (vertex, position) in (start..).zip(rows) {
                        self.before_vertex(vertex, out);
                        VERTEX_LINE.reals(position, out);
                    }
                });
            });
        };
        stream.positions(positions, |start, rows, out| {
            let mut colors = Vec::new();
            self.mesh.channel(channel, start..start + rows.len(), &mut colors);
            out.append(|out| {
                for ((vertex, &[x, y, z]), color) in (start..).zip(rows).zip(colors.chunks_exact(color)) {
                    self.before_vertex(vertex, out);
                    VERTEX_LINE.reals(&[x, y, z, within(color[0]), within(color[1]), within(color[2])], out);
                }
            });
        })
    }

    /// Appends consecutive faces, the first of which has the index `start`, given with their places of texture
    /// coordinates if there are any; `corner` appends one corner with its vertex and its place.
    fn faces(
        &self,
        start: usize,
        [faces, places]: [&FaceChunk; 2],
        out: &mut Vec<u8>,
        corner: impl Fn(u32, Option<u32>, &mut Vec<u8>),
    ) {
        let mut places = places.iter();
        for (index, face) in (start..).zip(faces.iter()) {
            self.before_face(index, out);
            out.push(b'f');
            let places = places.next().unwrap_or_default();
            for (j, &vertex) in face.iter().enumerate() {
                corner(vertex, places.get(j).copied(), out);
            }
            out.push(b'\n');
        }
    }

    /// Writes the texture coordinates.
    fn uvs(&self, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        stream.uvs(self.mesh, |_, values, out| UV_LINE.vectors(values.iter(), out))
    }

    /// Appends the origin of a vertex if it differs from that of the vertex before.
    fn before_vertex(&self, vertex: usize, out: &mut Vec<u8>) {
        if !self.ids {
            return;
        }
        let origin = self.mesh.vertex_origin(vertex);
        if vertex.checked_sub(1).map(|before| self.mesh.vertex_origin(before)) != Some(origin) {
            let cell = ["vertex", "edge", "face"][usize::from(origin.dimension.min(2))];
            comment(cell, origin.cell, out);
        }
    }

    /// Returns whether faces may have lines before them.
    fn tells_of_faces(&self) -> bool {
        self.ids || self.mesh.attachments().names_faces()
    }

    /// Appends origin, group and material of a face if they differ from those of the face before.
    fn before_face(&self, face: usize, out: &mut Vec<u8>) {
        let attachments = self.mesh.attachments();
        if !self.tells_of_faces() {
            return;
        }
        let origin = self.mesh.face_origin(face);
        let before = face.checked_sub(1).map(|before| self.mesh.face_origin(before));
        if before == Some(origin) {
            return;
        }
        if self.ids {
            comment("face", origin, out);
        }
        for (keyword, labels) in [("g ", &attachments.groups), ("usemtl ", &attachments.materials)] {
            if !labels.is_empty() && before.map(|before| labels.number(before)) != Some(labels.number(origin)) {
                out.extend_from_slice(keyword.as_bytes());
                out.extend_from_slice(labels.name(origin).unwrap_or(UNNAMED).as_bytes());
                out.push(b'\n');
            }
        }
    }
}

fn comment(cell: &str, number: u32, out: &mut Vec<u8>) {
    out.extend_from_slice(b"# from ");
    out.extend_from_slice(cell.as_bytes());
    out.push(b' ');
    whole(out, number.into());
    out.push(b'\n');
}

/// Returns the maximum number of bytes of the lines with origins, groups and materials.
fn attachment_bytes(counts: &Counts, ids: bool) -> u128 {
    let cells = counts.half_edges.max(counts.vertices).max(counts.input_faces as u128);
    let remark = if ids { "# from vertex \n".len() as u128 + digits(cells) } else { 0 };
    let line = |keyword: &str, labels: &Labels| {
        let longest = labels.names.iter().map(String::len).max().map_or(0, |longest| longest.max(UNNAMED.len()));
        if labels.is_empty() { 0 } else { keyword.len() + longest + 1 }
    };
    let names = line("g ", &counts.attachments.groups) + line("usemtl ", &counts.attachments.materials);
    let changes = counts.faces.min(counts.input_faces as u128);
    let vertices = if ids { counts.vertices } else { 0 };
    total(&[(vertices, remark), (changes, remark + names as u128)])
}
