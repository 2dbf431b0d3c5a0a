//! What the formats that hold drawings in lines have in common.

use super::drawing::CURVE_ITEMS;
use super::options::{
    self, BACKGROUND, CAMERA, COLOR, COMB_SCALE, CONTROL_COLOR, FILL, HEIGHT, LINE_WIDTH, Options, POINT_COLOR,
    POINT_SIZE, WIDTH,
};
use super::plot::{self, LEGEND, TEXT_SIZE, TITLE, X_LABEL, Y_LABEL};
use super::styles::STYLES;
use super::{drawing, sections};
use crate::drawing::{Drawing, Lettering};
use crate::fault::Fault;
use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::options::POSITIONS;
use crate::output::scene::{Scene, Shape};
use crate::output::sections::{SECTIONS, asked, planes};
use crate::output::size::Size;
use crate::output::surface::NORMALS;
use crate::watch::Watch;

/// How letters are written.
const TEXT: Parameter = Parameter::choice(
    "text",
    &["text", "outlines"],
    "Whether letters are text, which can be searched and copied, or outlines, which look the same without the font.",
);

/// Their options.
pub(crate) const PARAMETERS: &[Parameter] = &[
    WIDTH,
    HEIGHT,
    BACKGROUND,
    Parameter {
        name: "show",
        kind: Kind::Choices(CURVE_ITEMS),
        unit: "",
        default: Default::Texts(&["curve", "control", "points"]),
        doc: "What is drawn: the refined curve, the control polygon, the control points, the points of the refined \
              curve (vertices), a curvature comb, tangents, axes, a grid, a legend. Of a mesh only its sections are.",
    },
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
    TEXT,
    SECTIONS,
    POSITIONS,
    Parameter {
        doc: "Known as by all outputs of meshes; lines have no normals, and the drawing is the same.",
        ..NORMALS
    },
];

/// Whether the drawing of a shape of this kind can be made.
pub(crate) fn holds(kind: ShapeKind, options: &Values) -> Result<(), String> {
    match kind {
        ShapeKind::Mesh if asked(options) => Ok(()),
        ShapeKind::Mesh => {
            let reason = "svg and pdf draw curves, and of a mesh only sections; name planes in \"sections\", or ask \
                          for \"png\" to see the mesh";
            Err(reason.into())
        }
        ShapeKind::Curves { .. } => options::drawable(kind),
    }
}

/// Whether the options make sense for a shape of this kind.
pub(crate) fn suits(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    plot::check(kind, options)?;
    match kind {
        ShapeKind::Mesh if options.unusual().any(|(name, _)| name == "show") => {
            Err(Fault::new("/show", "of a mesh only its sections are drawn; leave it out"))
        }
        ShapeKind::Mesh => options::opaque(options),
        ShapeKind::Curves { .. } if asked(options) => {
            Err(Fault::new("/sections", "planes cut meshes, curves have no sections; leave it out"))
        }
        ShapeKind::Curves { .. } => options::shows_only(CURVE_ITEMS, kind, options),
    }
}

/// Most bytes of a drawing in lines.
///
/// A point costs at most 51 bytes in the curve (when each segment is a path of its own), 51 in the control polygon,
/// 20 in a filled area, twice 51 in a comb, and 49 as a disc (230 in PDF, which is packed afterwards); where dashes
/// and letters of no more than 70 labels stand, a font of at most a megabyte and some kilobytes stand beside them. A
/// curve with a look of its own costs 200 bytes more. Each triangle gives a segment of a section at most, two points.
pub(crate) fn size(counts: &Counts, options: &Values) -> Size {
    let (points, curves) = match counts.kind {
        ShapeKind::Mesh => {
            let planes = options.groups(SECTIONS.name).len() as u128;
            (planes.saturating_mul(counts.triangles().saturating_mul(2).saturating_add(1)), planes)
        }
        ShapeKind::Curves { .. } => {
            (counts.vertices.saturating_add(counts.control).saturating_add(counts.polygons), counts.polygons)
        }
    };
    let plain =
        ["vertices", "comb", "tangents", "axes", "grid", "legend"].iter().all(|item| !options.has("show", item));
    let around = if plain && options.name(TITLE.name).is_none() { 4096 } else { 2 << 20 };
    Size::AtMost(points.saturating_mul(560).saturating_add(curves.saturating_mul(512)).saturating_add(around))
}

/// Draws a scene.
pub(crate) fn draw(scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Drawing, FormatError> {
    if let Shape::Curves(curves) = scene.shape {
        let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
        options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
    }
    options::check_extent(scene)?;
    let options = Options::new(values, scene.frame);
    match scene.shape {
        Shape::Mesh(mesh) => sections::drawing(mesh, &planes(values), &options, watch),
        Shape::Curves(_) => drawing::drawing(scene, &options, watch),
    }
}

/// How its letters are written.
pub(crate) fn lettering(values: &Values) -> Lettering {
    if values.choice(TEXT.name) == Some("outlines") { Lettering::Outlines } else { Lettering::Text }
}
