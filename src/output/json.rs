//! JSON in the notation of requests: the fallback of every format, with everything at full precision.

mod carried;
mod looks;
mod row;
mod sections;

use std::borrow::Cow;

use serde_json::Value;

use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::output::control_source::ControlSource;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::curvature;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::normals;
use crate::output::numbers::{REAL_BYTES, digits, real, reals, total};
use crate::output::options::{CAGE, IDS, ISOLINES, POSITIONS, TANGENTS};
use crate::output::positions::{Positions, unfit};
use crate::output::scene::{Curve, MeshSource, Scene, Shape};
use crate::output::sections::{SECTIONS, asked};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::output::surface::{NORMALS, with_normals};
use crate::shape::attachments::Attachments;
use row::{comma, faces, row, vectors};

/// The option of discrete curvature.
const DISCRETE_CURVATURE: Parameter = Parameter::flag(
    "discrete_curvature",
    "Whether the curvature of the circle through each point and its neighbours is written, signed in the plane; \
     null at ends and at repeated points. Curves in the plane and in space only.",
);

/// The option of the edges of the input.
const EDGES: Parameter = Parameter::flag(
    ISOLINES,
    "For each edge of the input mesh the vertices along it, from its start to its end. Meshes only.",
);

/// The option of the control mesh.
const CONTROL: Parameter = Parameter::flag(
    CAGE,
    "The control mesh in place of what is made of it: all its faces, with the numbers of hidden ones as `holes`, \
     its creases and corners, and what it carries. It goes with no other option. Meshes only.",
);

/// Maximum number of bytes of the entry of the warnings, and of its parts besides the warnings.
const WARNINGS_ENTRY_BYTES: usize = 8_192;
const WARNINGS_FRAME: usize = 64;

/// `{"positions":[...],"faces":[...]}` for meshes, with `"normals":[...]` (zero where undefined) on request,
/// `{"points":[...],"closed":...}` for one polygon, `{"polygons":[...]}` with such objects for any other number of
/// polygons.
///
/// The attachments of a mesh follow in the notation of requests: `"corners":[...]` and `"creases":[...]` of meshes that
/// are written without refinement, `"channels":{...}`, `"uvs":{...}`, `"groups":[...]` and `"materials":[...]` of
/// output faces. With `ids` an entry `"ids":{"faces":[...],"vertices":[[dimension,cell],...]}` follows: the input face
/// of each face, and for each vertex the input cell (dimension 0 a vertex, 1 an edge, 2 a face). With `isolines` an
/// entry `"isolines":[[...],...]` follows, the vertices along each edge of the input. With `sections` an entry
/// `"sections":[[{"points":[...],"closed":...},...],...]` follows, a list of polylines for each plane.
///
/// With `cage` the control mesh is written, with `"holes":[...]` after its faces.
///
/// With warnings, an entry `"warnings":[...]` follows. Numbers are the shortest decimals that read back as the same
/// f64; whole ones have no point, -0 is 0.
#[derive(Debug)]
pub(super) struct Json;

const FACTS: &FormatFacts = &FormatFacts {
    name: "json",
    extension: "json",
    media_type: "application/json",
    content: Content::Json,
    doc: "JSON as in requests: all coordinates at full precision, polygons as they are",
    parameters: &[POSITIONS, NORMALS, TANGENTS, DISCRETE_CURVATURE, IDS, EDGES, SECTIONS, CONTROL],
    ..FormatFacts::USUAL
};

impl Format for Json {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        stream.bytes(b"{")?;
        match scene.shape {
            Shape::Mesh(_) if options.flag(CAGE) => {
                let Some(mesh) = scene.control.mesh() else {
                    return Err(FormatError::Unfit("there is no control mesh; leave \"cage\" out".into()));
                };
                write_cage(ControlSource(mesh), options, stream)?;
            }
            Shape::Mesh(mesh) => {
                write_mesh(mesh, stream)?;
                if with_normals(options) {
                    write_normals(mesh, stream)?;
                }
                carried::write(mesh, options, stream)?;
                sections::write(mesh, options, stream)?;
            }
            Shape::Curves([curve]) => write_curve(curve, options, stream)?,
            Shape::Curves(curves) => write_curves(curves, options, stream)?,
        }
        stream.bytes(&warnings(scene.warnings))?;
        stream.bytes(b"}")
    }
}

impl Requirements for Json {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        let (curves, bends) = match kind {
            ShapeKind::Curves { dimension } => (true, dimension == 2 || dimension == 3),
            ShapeKind::Mesh => (false, false),
        };
        let is_beside = options.unusual().any(|(name, _)| name != CAGE);
        let faults = [
            (TANGENTS.name, !curves, "a mesh has no tangents; ask for \"normals\" where a format knows them"),
            (
                DISCRETE_CURVATURE.name,
                !bends,
                "discrete curvature is defined for curves in the plane and in space; leave it out",
            ),
            (ISOLINES, curves, "isolines are edges of meshes; leave it out"),
            (CAGE, curves, "polygons have no control mesh; leave it out"),
            (CAGE, is_beside, "the control mesh is written as it was given; leave out what is beside it"),
        ];
        if let Some((name, _, detail)) = faults.into_iter().find(|(name, is_wrong, _)| *is_wrong && options.flag(name))
        {
            return Err(Fault::new(format!("/{name}"), detail));
        }
        if asked(options) && curves {
            return Err(Fault::new("/sections", "planes cut meshes, curves have no sections; leave it out"));
        }
        Ok(())
    }

    fn refers(&self, options: &Values) -> Option<&'static str> {
        [IDS.name, ISOLINES].into_iter().find(|name| options.flag(name))
    }
}

impl Costs for Json {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let counts = &of_shown(counts, options);
        let row = |dimension: u128| 2 + dimension * (REAL_BYTES + 1);
        let asked = |name: &str| u128::from(options.flag(name));
        let content = match counts.kind {
            ShapeKind::Curves { dimension } => {
                let braces = br#"{"polygons":[]}"#.len() as u128;
                let polygon = br#"{"points":[],"closed":false},"#.len() as u128;
                let arrays = br#","tangents":[],"discrete_curvature":[]"#.len() as u128;
                let row = row(dimension as u128);
                total(&[
                    (1, braces),
                    (counts.polygons, polygon + arrays),
                    (counts.vertices, row),
                    (counts.vertices * asked(TANGENTS.name), row.max(5)),
                    (counts.vertices * asked(DISCRETE_CURVATURE.name), REAL_BYTES + 1),
                ])
            }
            ShapeKind::Mesh => {
                let braces = br#"{"positions":[],"faces":[],"normals":[]}"#.len() as u128;
                let corner = digits(counts.vertices) + 1;
                let vectors = if with_normals(options) { 2 } else { 1 };
                let rows = [(counts.vertices, vectors * row(3)), (counts.faces, 2), (counts.half_edges, corner)];
                let carried = carried::size(counts, options);
                let sections = sections::size(counts, options);
                let holes = (asked(CAGE) * counts.faces, digits(counts.faces) + 1);
                let braces = braces + asked(CAGE) * br#","holes":[]"#.len() as u128;
                total(&[(1, braces), rows[0], rows[1], rows[2], holes, (1, carried), (1, sections)])
            }
        };
        Size::AtMost(content.saturating_add(WARNINGS_ENTRY_BYTES as u128))
    }
}

/// Returns upper bounds of the counts of what is written; for a control mesh, whose corners may all have values of
/// their own, those of the input.
fn of_shown<'a>(counts: &'a Counts, options: &Values) -> Cow<'a, Counts> {
    if !options.flag(CAGE) {
        return Cow::Borrowed(counts);
    }
    let corners = 2 * counts.input_edges as u128;
    let places = |n: u128| if n > 0 { corners } else { 0 };
    Cow::Owned(Counts {
        vertices: counts.control,
        faces: counts.input_faces as u128,
        half_edges: corners,
        uvs: places(counts.uvs),
        seamed: places(counts.seamed),
        ..counts.clone()
    })
}

/// Returns the entry of the warnings, empty if there are none; warnings that do not fit are only counted.
fn warnings(warnings: &[String]) -> Vec<u8> {
    if warnings.is_empty() {
        return Vec::new();
    }
    let mut texts = Vec::new();
    let mut room = WARNINGS_ENTRY_BYTES - WARNINGS_FRAME;
    for (i, warning) in warnings.iter().enumerate() {
        let text = Value::from(warning.as_str()).to_string();
        if text.len() >= room {
            texts.push(format!(r#""and {} more""#, warnings.len() - i));
            break;
        }
        room -= text.len() + 1;
        texts.push(text);
    }
    format!(r#","warnings":[{}]"#, texts.join(",")).into_bytes()
}

fn write_mesh(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#""positions":["#)?;
    stream.positions(&Positions::of_mesh(mesh), vectors)?;
    stream.bytes(br#"],"faces":["#)?;
    stream.faces(mesh, faces)?;
    stream.bytes(b"]")
}

/// Writes a control mesh, hidden faces included, with the numbers of the hidden faces.
fn write_cage(cage: ControlSource<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    write_mesh(&cage, stream)?;
    let holes = cage.holes();
    if !holes.is_empty() {
        stream.bytes(br#","holes":["#)?;
        stream.each(0..holes.len(), |i, out| carried::listed(holes[i].into(), i == 0, out))?;
        stream.bytes(b"]")?;
    }
    carried::write(&cage, options, stream)
}

fn write_normals(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let positions = Positions::of_mesh(mesh).held(stream.watch)?;
    let normals = normals::of(mesh, positions.rows(), stream.watch)?;
    drop(positions);
    stream.bytes(br#","normals":["#)?;
    stream.rows(&normals, vectors)?;
    stream.bytes(b"]")
}

fn write_curves(curves: &[Curve], options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#""polygons":["#)?;
    for (i, curve) in curves.iter().enumerate() {
        stream.bytes(if i > 0 { b",{" } else { b"{" })?;
        write_curve(curve, options, stream)?;
        stream.bytes(b"}")?;
    }
    stream.bytes(b"]")
}

fn write_curve(curve: &Curve, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    if let Some(i) = curve.points.iter().position(|x| !x.is_finite()) {
        return Err(unfit(i / curve.dimension, curve.points[i]));
    }
    stream.bytes(br#""points":["#)?;
    let points: Vec<&[f64]> = curve.points.chunks_exact(curve.dimension).collect();
    stream.rows(&points, vectors)?;
    stream.bytes(format!(r#"],"closed":{}"#, curve.closed).as_bytes())?;
    if let Some(tangents) = curve.tangents.as_ref().filter(|_| options.flag(TANGENTS.name)) {
        write_tangents(tangents, curve.dimension, stream)?;
    }
    if options.flag(DISCRETE_CURVATURE.name) { write_curvatures(curve, points.len(), stream) } else { Ok(()) }
}

fn write_tangents(tangents: &[f64], dimension: usize, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#","tangents":["#)?;
    let tangents: Vec<&[f64]> = tangents.chunks_exact(dimension).collect();
    stream.each(0..tangents.len(), |i, out| {
        if tangents[i].iter().any(|x| *x != 0.0) {
            row(i, out, |out| reals(out, tangents[i], b','));
        } else {
            out.extend_from_slice(if i > 0 { b",null" } else { b"null" });
        }
    })?;
    stream.bytes(b"]")
}

fn write_curvatures(curve: &Curve, n: usize, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#","discrete_curvature":["#)?;
    stream.each(0..n, |i, out| {
        comma(i, out);
        match curvature::discrete(curve, i) {
            Some(value) => real(out, value),
            None => out.extend_from_slice(b"null"),
        }
    })?;
    stream.bytes(b"]")
}
