//! Wavefront OBJ: text that keeps polygons and every digit.

use std::io::Write;

use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::output::numbers::{REAL, digits, reals, total, whole};
use crate::output::scene::{Curve, MeshSource, Scene, Shape};
use crate::output::stream::{Positions, Stream, holds_space};
use crate::output::{Counts, Format, FormatError, ShapeKind, Size, normals};
use crate::watch::Watch;

const HEADER: &[u8] = b"# planish\n";

/// Wavefront OBJ: `v`, `vn` on request, `f` for meshes; `v` and `l` for curves.
///
/// Numbers are the shortest decimals that read back as the same f64. A closed curve repeats its first index; missing
/// coordinates of points are 0.
#[derive(Debug)]
pub(super) struct Obj;

impl Format for Obj {
    fn name(&self) -> &'static str {
        "obj"
    }

    fn media_type(&self) -> &'static str {
        "model/obj"
    }

    fn doc(&self) -> &'static str {
        "Wavefront OBJ: polygons as they are, shortest decimals that read back exactly"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter {
            name: "normals",
            kind: Kind::Choice(&["none", "area"]),
            unit: "",
            default: Default::Text("none"),
            doc: "Vertex normals of a mesh: none, or weighted by the area of the faces around the vertex",
        }]
    }

    fn holds(&self, kind: ShapeKind) -> Result<(), String> {
        holds_space(self.name(), kind)
    }

    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let index = digits(counts.vertices);
        let row = 3 * (1 + REAL);
        let header = HEADER.len() as u128;
        Size::AtMost(match counts.kind {
            ShapeKind::Curves { .. } => total(&[
                (1, header),
                (counts.vertices, 2 + row),
                (counts.vertices.saturating_add(counts.polygons), 1 + index),
                (counts.polygons, 2),
            ]),
            ShapeKind::Mesh => {
                let (normal, corner) = if with_normals(options) { (3 + row, 3 + 2 * index) } else { (0, 1 + index) };
                total(&[(1, header), (counts.vertices, 2 + row + normal), (counts.faces, 2), (counts.corners, corner)])
            }
        })
    }

    fn write(
        &self,
        scene: &Scene<'_>,
        options: &Values,
        out: &mut dyn Write,
        watch: &Watch,
    ) -> Result<(), FormatError> {
        let mut stream = Stream::new(out, watch);
        stream.bytes(HEADER)?;
        match scene.shape {
            Shape::Curves(curves) => write_curves(curves, &mut stream),
            Shape::Mesh(mesh) if with_normals(options) => write_with_normals(mesh, &mut stream, watch),
            Shape::Mesh(mesh) => {
                vertices(&Positions::of_mesh(mesh), &mut stream)?;
                stream.faces(mesh, |_, face, out| {
                    out.push(b'f');
                    for &vertex in face {
                        corner(vertex, out);
                    }
                    out.push(b'\n');
                })
            }
        }
    }
}

fn with_normals(options: &Values) -> bool {
    options.choice("normals") == Some("area")
}

fn write_with_normals(mesh: &dyn MeshSource, stream: &mut Stream<'_>, watch: &Watch) -> Result<(), FormatError> {
    let positions = Positions::of_mesh(mesh).held(watch)?;
    vertices(&positions, stream)?;
    let normals = normals::area(mesh, positions.rows(), watch)?;
    drop(positions);
    stream.rows(0, &normals, |_, rows, out| {
        for &normal in rows {
            out.extend_from_slice(b"vn ");
            reals(out, &normals::or_up(normal), b' ');
            out.push(b'\n');
        }
    })?;
    stream.faces(mesh, |_, face, out| {
        out.push(b'f');
        for &vertex in face {
            corner(vertex, out);
            out.extend_from_slice(b"//");
            whole(out, u64::from(vertex) + 1);
        }
        out.push(b'\n');
    })
}

fn write_curves(curves: &[Curve], stream: &mut Stream<'_>) -> Result<(), FormatError> {
    for curve in curves {
        vertices(&Positions::of_curve(curve), stream)?;
    }
    let mut start = 1;
    for curve in curves {
        let indices: Vec<u64> = (start..).take(curve.len()).collect();
        let first = start;
        start += indices.len() as u64;
        match indices.len() {
            0 => continue,
            1 => stream.bytes(b"p")?,
            _ => stream.bytes(b"l")?,
        }
        stream.rows(0, &indices, |_, rows, out| {
            for &index in rows {
                out.push(b' ');
                whole(out, index);
            }
        })?;
        if curve.closed && indices.len() > 1 {
            stream.bytes(format!(" {first}").as_bytes())?;
        }
        stream.bytes(b"\n")?;
    }
    Ok(())
}

fn vertices(positions: &Positions<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.positions(positions, |_, rows, out| {
        for position in rows {
            out.extend_from_slice(b"v ");
            reals(out, position, b' ');
            out.push(b'\n');
        }
    })
}

fn corner(vertex: u32, out: &mut Vec<u8>) {
    out.push(b' ');
    whole(out, u64::from(vertex) + 1);
}
