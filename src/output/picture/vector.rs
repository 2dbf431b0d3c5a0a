//! The common parts of the output formats that hold drawings in lines.

use super::drawing::CURVE_ITEMS;
use super::hidden_lines::{self, MESH_ITEMS};
use super::options::{
    self, BACKGROUND, CAMERA, COLOR, COMB_SCALE, CONTROL_COLOR, FILL, HEIGHT, LINE_WIDTH, Options, POINT_COLOR,
    POINT_SIZE, WIDTH,
};
use super::plot::{LEGEND, TEXT_SIZE, TITLE, X_LABEL, Y_LABEL};
use super::styles::STYLES;
use super::{drawing, sections};
use crate::drawing::{Drawing, Lettering};
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};
use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::hard_edges::CREASE_ANGLE;
use crate::output::options::{POSITIONS, joined};
use crate::output::scene::{Scene, Shape};
use crate::output::sections::{SECTIONS, asked, planes};
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
        ParameterKind::Choices(&ITEMS),
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
const ITEMS: [&str; CURVE_ITEMS.len() + MESH_ITEMS.len()] = joined(CURVE_ITEMS, MESH_ITEMS);

/// Draws a scene.
pub(crate) fn draw(scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Drawing, FormatError> {
    if let Shape::Curves(curves) = scene.shape {
        let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
        options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
    }
    options::check_extent(scene, watch)?;
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
