//! Stanford PLY: polygons and f64 coordinates in few bytes.

mod bulk;
mod carried;
mod layout;

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::fault::Fault;
use crate::kept::Kept;
use crate::math::parameter::{Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::hard_edges::HardEdges;
use crate::output::left_out::{Datum, left_out};
use crate::output::normals;
use crate::output::numbers::{digits, total};
use crate::output::options::{IDS, POSITIONS};
use crate::output::positions::{Positions, channels_within_f32};
use crate::output::scene::{CoordinateSystem, Curve, MeshSource, Scene, Shape};
use crate::output::size::Size;
use crate::output::stream::{Stream, holds_space};
use crate::output::surface::NORMALS;
use crate::output::vertex_sides::Sides;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;
use carried::VertexProperties;
use layout::{PlyEncoding, PlyLayout};

/// PLY, binary little endian unless `ascii`: elements `vertex` and `face` for meshes, `vertex` and `edge` for curves.
///
/// Unit and up axis are comments if they are not the defaults. The channel `color` becomes `red`, `green`, `blue` and
/// perhaps `alpha` of one byte; other channels become properties of their names. Groups and materials become `int`
/// properties of faces, -1 for none; their names are comments. Origins are a `uint` of faces, for vertices with the
/// dimension of the cell.
///
/// With texture coordinates a vertex on a seam has a copy for each of its places, and every vertex has `s` and `t`:
/// more programs read these than lists `texcoord` of faces, which would keep vertices whole. Vertices without faces are
/// left out then. OBJ keeps both.
///
/// Indices are `int`, or `uint` if there are more than 2^31 vertices. The size of a face is one byte, or four with
/// `"face_sizes": "uint"`.
#[derive(Debug)]
pub(super) struct Ply;

const FACTS: &FormatFacts = &FormatFacts {
    name: "ply",
    extension: "ply",
    media_type: "model/ply",
    content: Content::Binary,
    doc: "Stanford PLY: polygons as they are, f64 or f32 coordinates, binary little endian or text",
    parameters: PLY_OPTIONS,
    description: Some(DescriptionPlace::Lines("comment", 3)),
    holds: |kind, _| holds_space("ply", kind),
    has_no_tags: true,
    ..FormatFacts::USUAL
};

impl Format for Ply {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, _mesh: &Mesh, options: &Values) -> &'static [Tile] {
        if PlyLayout::of(options).normals { &[] } else { &[Tile::Quad, Tile::Triangle] }
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        match scene.shape {
            Shape::Mesh(mesh) => write_mesh(mesh, scene.coordinate_system, PlyLayout::of(options), stream),
            Shape::Curves(curves) => {
                write_curves(curves, scene.coordinate_system, PlyLayout::of_curves(options), stream)
            }
        }
    }
}

impl Requirements for Ply {
    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        check_face(counts.largest_face, PlyLayout::of(options)).map_err(|detail| Fault::new("/face_sizes", detail))
    }

    fn leaves_out(&self, carried: &Attachments, _: &Values) -> Vec<String> {
        left_out("ply", "glb", carried, &[Datum::Looks])
    }
}

impl Costs for Ply {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        match counts.kind {
            ShapeKind::Mesh => mesh_size(counts, PlyLayout::of(options)),
            // The number of edges depends on which polygons are closed.
            ShapeKind::Curves { .. } => Size::AtMost(curves_size(counts, PlyLayout::of_curves(options))),
        }
    }
}

const PLY_OPTIONS: &[Parameter] = &[
    Parameter::flag("ascii", "Text instead of binary little endian"),
    Parameter::choice("precision", &["f64", "f32"], "Coordinates as double, or rounded once to float"),
    NORMALS,
    POSITIONS,
    Parameter::choice(
        "face_sizes",
        &["uchar", "uint"],
        "Type of the number of corners of a face: uchar, which every program reads, or uint for more than 255",
    ),
    IDS,
];

fn mesh_size(counts: &Counts, layout: PlyLayout) -> Size {
    let vertices = if counts.unfolded > 0 { counts.unfolded } else { counts.vertices };
    let attachments = &counts.attachments;
    let split_vertices = if layout.normals { counts.split_vertices } else { 0 };
    let vertices = vertices.saturating_add(split_vertices);
    let header = mesh_header(vertices, counts.faces, counts.coordinate_system, attachments, layout).len() as u128;
    let (carried, of_face) =
        carried::bytes(attachments, layout, counts.half_edges.max(vertices).max(counts.input_faces as u128));
    let (face, corner) = match layout.encoding {
        PlyEncoding::Ascii => (digits(counts.half_edges) + 1, digits(vertices) + 1),
        PlyEncoding::Uchar => (1, 4),
        PlyEncoding::Uint => (4, 4),
    };
    let (vertex, face) = (layout.vertex_bytes() + carried, face + of_face);
    let bytes = total(&[(1, header), (vertices, vertex), (counts.faces, face), (counts.half_edges, corner)]);
    if layout.encoding == PlyEncoding::Ascii || split_vertices > 0 { Size::AtMost(bytes) } else { Size::Exact(bytes) }
}

fn curves_size(counts: &Counts, layout: PlyLayout) -> u128 {
    let header = curves_header(counts.vertices, counts.vertices, counts.coordinate_system, layout).len() as u128;
    let index = if layout.encoding == PlyEncoding::Ascii { digits(counts.vertices) + 1 } else { 4 };
    total(&[(1, header), (counts.vertices, layout.vertex_bytes()), (counts.vertices, 2 * index)])
}

fn mesh_header(
    vertices: u128,
    faces: u128,
    coordinate_system: CoordinateSystem,
    attachments: &Attachments,
    layout: PlyLayout,
) -> String {
    let size = if layout.encoding == PlyEncoding::Uint { "uint" } else { "uchar" };
    let list = format!("property list {size} {} vertex_indices", index_type(vertices));
    let remarks = remarks(coordinate_system) + &carried::remarks(attachments);
    let of_vertices = vertex_header(vertices, &remarks, layout) + &carried::vertex_properties(attachments, layout);
    let of_faces = carried::face_properties(attachments, layout);
    format!("{of_vertices}element face {faces}\n{list}\n{of_faces}end_header\n")
}

fn curves_header(vertices: u128, edges: u128, coordinate_system: CoordinateSystem, layout: PlyLayout) -> String {
    let index = index_type(vertices);
    let ends = format!("property {index} vertex1\nproperty {index} vertex2");
    let of_vertices = vertex_header(vertices, &remarks(coordinate_system), layout);
    format!("{of_vertices}element edge {edges}\n{ends}\nend_header\n")
}

/// Returns the lines of the header with unit and up axis.
fn remarks(coordinate_system: CoordinateSystem) -> String {
    coordinate_system.remarks().iter().map(|remark| format!("comment {remark}\n")).collect::<Vec<_>>().concat()
}

fn vertex_header(vertices: u128, remarks: &str, layout: PlyLayout) -> String {
    let encoding = if layout.encoding == PlyEncoding::Ascii { "ascii" } else { "binary_little_endian" };
    let number = if layout.float { "float" } else { "double" };
    let names = &["x", "y", "z", "nx", "ny", "nz"][..layout.numbers()];
    let properties: String = names.iter().flat_map(|name| ["property ", number, " ", name, "\n"]).collect();
    format!("ply\nformat {encoding} 1.0\ncomment planish\n{remarks}element vertex {vertices}\n{properties}")
}

fn index_type(vertices: u128) -> &'static str {
    if vertices > 1 << 31 { "uint" } else { "int" }
}

fn write_mesh(
    whole: &dyn MeshSource,
    coordinate_system: CoordinateSystem,
    layout: PlyLayout,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let watch = stream.watch;
    let sides = Sides::of(Shape::Mesh(whole));
    let parts = sides.split_vertices(layout.normals, &HardEdges::default(), watch)?;
    let mesh = if let Shape::Mesh(mesh) = parts.shape() { mesh } else { whole };
    if layout.float {
        channels_within_f32(mesh, watch)?;
    }
    let (vertices, faces) = (mesh.n_vertices() as u128, mesh.n_faces() as u128);
    stream.bytes(mesh_header(vertices, faces, coordinate_system, mesh.attachments(), layout).as_bytes())?;
    let positions = within(Positions::of_mesh(mesh), layout);
    let (positions, normals) = if layout.normals {
        let positions = positions.held(watch)?;
        let normals = match parts.smooth() {
            None => normals::of(mesh, positions.rows(), watch)?,
            Some(smooth) => {
                normals::split_vertices(mesh, smooth, Positions::of_mesh(smooth).held(watch)?.rows(), watch)?
            }
        };
        (positions, normals)
    } else {
        (positions, Kept::default())
    };
    stream.positions(&positions, |start, rows, out| {
        let normals = if layout.normals { &normals[start..start + rows.len()] } else { &[] };
        if layout.encoding != PlyEncoding::Ascii && !carried::any_of_vertices(mesh, layout) {
            return bulk::vertices(rows, normals, layout, out);
        }
        let carried = VertexProperties::of(mesh, layout, start, rows.len());
        out.append(|out| {
            for (i, position) in rows.iter().enumerate() {
                layout.vertex(position, out);
                if let Some(&normal) = normals.get(i) {
                    layout.separate(out);
                    layout.vertex(&normals::or_up(normal), out);
                }
                carried.vertex(i, out);
                layout.end_row(out);
            }
        });
    })?;
    write_faces(mesh, layout, stream)
}

fn write_faces(mesh: &dyn MeshSource, layout: PlyLayout, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let largest = AtomicUsize::new(0);
    stream.faces(mesh, |start, faces, out| {
        largest.fetch_max(faces.largest(), Ordering::Relaxed);
        if !carried::any_of_faces(mesh, layout) && bulk::faces(faces, layout, out) {
            return;
        }
        out.append(|out| {
            for (index, face) in (start..).zip(faces.iter()) {
                layout.face(face, out);
                carried::face(mesh, layout, index, out);
                layout.end_row(out);
            }
        });
    })?;
    check_face(largest.into_inner() as u128, layout).map_err(FormatError::Unfit)
}

/// Refuses faces with more corners than the type of their size can count.
fn check_face(size: u128, layout: PlyLayout) -> Result<(), String> {
    if layout.encoding != PlyEncoding::Uchar || size <= u8::MAX.into() {
        return Ok(());
    }
    Err(format!(
        "a face of the result has {size} corners, one byte counts at most 255; ask for \"face_sizes\": \"uint\" or \
         for obj"
    ))
}

fn write_curves(
    curves: &[Curve],
    coordinate_system: CoordinateSystem,
    layout: PlyLayout,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let n_vertices: usize = curves.iter().map(Curve::len).sum();
    let n_edges: usize = curves.iter().map(edges_of).sum();
    if u32::try_from(n_vertices).is_err() {
        return Err(FormatError::Unfit(format!("{n_vertices} points, ply numbers at most {}; ask for json", u32::MAX)));
    }
    stream.bytes(curves_header(n_vertices as u128, n_edges as u128, coordinate_system, layout).as_bytes())?;
    for curve in curves {
        let positions = within(Positions::of_curve(curve), layout);
        stream.positions(&positions, |_, rows, out| {
            out.append(|out| {
                for point in rows {
                    layout.vertex(point, out);
                    layout.end_row(out);
                }
            });
        })?;
    }
    let mut start = 0;
    for curve in curves {
        let end = start + u32::try_from(curve.len()).expect("fewer points than all together");
        let edges: Vec<[u32; 2]> =
            (start..end).map(|a| [a, if a + 1 < end { a + 1 } else { start }]).take(edges_of(curve)).collect();
        stream.each(0..edges.len(), |i, out| layout.edge(edges[i], out))?;
        start = end;
    }
    Ok(())
}

fn edges_of(curve: &Curve) -> usize {
    if curve.closed && curve.len() > 1 { curve.len() } else { curve.len().saturating_sub(1) }
}

fn within(positions: Positions<'_>, layout: PlyLayout) -> Positions<'_> {
    if layout.float { positions.within_f32() } else { positions }
}
