//! The common parts of the output formats that hold drawings in lines.

use super::drawing::CURVE_ITEMS;
use super::hidden_lines::{self, MESH_ITEMS};
use super::options::{
    self, BACKGROUND, CAMERA, COLOR, COMB_SCALE, CONTROL_COLOR, FILL, HEIGHT, LINE_WIDTH, Options, POINT_COLOR,
    POINT_SIZE, WIDTH,
};
use super::plot::{self, LEGEND, TEXT_SIZE, TITLE, X_LABEL, Y_LABEL};
use super::styles::STYLES;
use super::{drawing, sections};
use crate::drawing::{Drawing, Lettering};
use crate::fault::Fault;
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::hard_edges::{self, CREASE_ANGLE};
use crate::output::options::{ISOLINES, POSITIONS};
use crate::output::scene::{Scene, Shape};
use crate::output::sections::{SECTIONS, asked, planes};
use crate::output::size::Size;
use crate::output::surface::NORMALS;
use crate::watch::Watch;

/// How letters are written.
const LETTERS: Parameter = Parameter::choice(
    "text",
    &["text", "outlines"],
    "Whether letters are text, which can be searched and copied, or outlines, which look the same without the font.",
);

/// The options of these formats.
pub(crate) const VECTOR_OPTIONS: &[Parameter] = &[
    WIDTH,
    HEIGHT,
    BACKGROUND,
    Parameter::optional(
        "show",
        ParameterKind::Choices(ITEMS),
        "What is drawn. Of curves: the refined curve, the control polygon, the control points, the points of the \
         refined curve (vertices), a curvature comb, tangents, axes, a grid, a legend; left out, the first \
         three. Of a mesh the lines that its faces do not hide: its outline (silhouettes), its boundary, its \
         creases, the edges of the input (isolines), all edges of its faces (wireframe), as dashes the hidden \
         parts of the first three (hidden), and strokes that are the closer the less light falls there \
         (hatching); left out, the first four. Of sections only these are.",
    ),
    COLOR,
    LINE_WIDTH,
    CONTROL_COLOR,
    POINT_COLOR,
    POINT_SIZE,
    STYLES,
    FILL,
    COMB_SCALE,
    TITLE,
    X_LABEL,
    Y_LABEL,
    LEGEND,
    TEXT_SIZE,
    CAMERA,
    LETTERS,
    SECTIONS,
    POSITIONS,
    CREASE_ANGLE,
    Parameter {
        default: Default::Text("area"),
        doc: "Known as by all outputs of meshes; lines have no normals, and the drawing is the same. Where there are \
              none, no edge is a crease because of the angle between its faces.",
        ..NORMALS
    },
];

/// All items that drawings can show.
const ITEMS: &[&str] = &[
    "curve",
    "control",
    "points",
    "vertices",
    "comb",
    "tangents",
    "axes",
    "grid",
    "legend",
    "silhouettes",
    "boundary",
    "creases",
    "isolines",
    "wireframe",
    "hidden",
    "hatching",
];

/// Refuses shapes that cannot be drawn.
pub(crate) fn holds(kind: ShapeKind, _: &Values) -> Result<(), String> {
    options::drawable(kind)
}

/// Refuses options that make no sense for a shape of this kind.
pub(crate) fn suits(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    plot::check(kind, options)?;
    match kind {
        ShapeKind::Mesh if asked(options) && options.unusual().any(|(name, _)| name == "show") => {
            Err(Fault::new("/show", "only the sections are drawn; leave it out, or the sections"))
        }
        ShapeKind::Mesh => options::shows_only(MESH_ITEMS, kind, options),
        ShapeKind::Curves { .. } if asked(options) => {
            Err(Fault::new("/sections", "planes cut meshes, curves have no sections; leave it out"))
        }
        ShapeKind::Curves { .. } => options::shows_only(CURVE_ITEMS, kind, options),
    }
}

/// Returns whether a mesh is drawn in lines without those hidden by its faces.
fn is_lines(counts: &Counts, options: &Values) -> bool {
    counts.kind == ShapeKind::Mesh && !asked(options)
}

/// Refuses meshes with too many faces to draw.
pub(crate) fn fits(counts: &Counts, options: &Values) -> Result<(), Fault> {
    if is_lines(counts, options) { hidden_lines::fits(counts) } else { Ok(()) }
}

/// Returns the option that refers to single edges of the input, if any.
pub(crate) fn refers(options: &Values) -> Option<&'static str> {
    options.has("show", ISOLINES).then_some(ISOLINES)
}

/// Returns the memory that the drawing takes, bytes.
pub(crate) fn memory(counts: &Counts, options: &Values) -> u128 {
    let lines = if is_lines(counts, options) { hidden_lines::memory(counts, options) } else { 0 };
    lines.saturating_add(hard_edges::memory(counts, options))
}

/// Returns the work of the drawing, in rows of a table.
pub(crate) fn work(counts: &Counts, options: &Values) -> u128 {
    if is_lines(counts, options) { hidden_lines::work(counts) } else { 0 }
}

/// Returns the maximum number of bytes of a drawing in lines.
///
/// A point costs at most 51 bytes in the curve (when each segment is a path of its own), 51 in the control polygon, 20
/// in a filled area, twice 51 in a comb, and 49 as a disc (230 in PDF, which is packed afterwards). Drawings with
/// letters (at most 70 labels) hold a font of at most a megabyte and some kilobytes besides. A curve with a style of
/// its own costs 200 bytes more. Each triangle gives at most one segment of a section, which is two points and is drawn
/// in lines only: 160 bytes are three times as much as a point takes.
pub(crate) fn size(counts: &Counts, options: &Values) -> Size {
    if is_lines(counts, options) {
        return hidden_lines::size(counts, options);
    }
    let (points, point, curves) = match counts.kind {
        ShapeKind::Mesh => {
            let planes = options.groups(SECTIONS.name).len() as u128;
            (planes.saturating_mul(counts.triangles().saturating_mul(2).saturating_add(1)), 160, planes)
        }
        ShapeKind::Curves { .. } => {
            let points = counts.vertices.saturating_add(counts.control).saturating_add(counts.polygons);
            (points, 560, counts.polygons)
        }
    };
    let plain =
        ["vertices", "comb", "tangents", "axes", "grid", "legend"].iter().all(|item| !options.has("show", item));
    let around = if plain && options.name(TITLE.name).is_none() { 4096 } else { 2 << 20 };
    Size::AtMost(points.saturating_mul(point).saturating_add(curves.saturating_mul(512)).saturating_add(around))
}

/// Draws a scene.
pub(crate) fn draw(scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Drawing, FormatError> {
    if let Shape::Curves(curves) = scene.shape {
        let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
        options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
    }
    options::check_extent(scene)?;
    let options = Options::new(values, scene.coordinate_system);
    match scene.shape {
        Shape::Mesh(mesh) if !asked(values) => hidden_lines::drawing(scene, mesh, &options, watch),
        Shape::Mesh(mesh) => sections::drawing(mesh, &planes(values), &options, watch),
        Shape::Curves(_) => drawing::drawing(scene, &options, watch),
    }
}

/// Returns how the letters of the drawing are written.
pub(crate) fn lettering(values: &Values) -> Lettering {
    if values.choice(LETTERS.name) == Some("outlines") { Lettering::Outlines } else { Lettering::Text }
}
