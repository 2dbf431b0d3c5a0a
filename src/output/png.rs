//! PNG: a lit picture of a mesh, or a drawing of curves.

use std::io::{self, Write};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::drawing;
use crate::fault::Fault;
use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts, Paper};
use crate::output::hard_edges::{self, CREASE_ANGLE};
use crate::output::options::{ISOLINES, POSITIONS};
use crate::output::picture::coat::{self, CHANNEL, COLOR_BY};
use crate::output::picture::options::{
    self, BACKGROUND, CAMERA, COLOR, COMB_SCALE, CONTROL_COLOR, FILL, HEIGHT, LINE_WIDTH, Options, POINT_COLOR,
    POINT_SIZE, WIDTH,
};
use crate::output::picture::plot::{self, LEGEND, TEXT_SIZE, TITLE, X_LABEL, Y_LABEL};
use crate::output::picture::styles::STYLES;
use crate::output::picture::{self, forecast, mesh};
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::watch::{Stage, Watch};

/// Bytes of a pixel while a picture is made: its colour, and the same once more while it is encoded.
const PIXEL_BYTES: u128 = 8;
/// Bytes a corner of a mesh whose edges are drawn: the sides before they are sorted (8), and half of an edge as it is
/// drawn, with its two ends, its bounds and its place among the tiles (measured: 52).
const WIRE_BYTES: u128 = 36;

/// The format "png".
#[derive(Debug, Clone, Copy)]
pub(super) struct Png;

/// The options of the picture.
pub(super) const PARAMETERS: &[Parameter] = &[
    WIDTH,
    HEIGHT,
    BACKGROUND,
    Parameter {
        name: "show",
        kind: Kind::Choices(&[
            "surface",
            "wireframe",
            "isolines",
            "control",
            "points",
            "curve",
            "vertices",
            "comb",
            "tangents",
            "axes",
            "grid",
            "legend",
        ]),
        unit: "",
        default: Default::Absent,
        doc: "What is drawn: of a mesh its surface, its wireframe, the edges of the input on it (isolines), the \
              control net and its points; of curves the curve, the control polygon and its points, the points of \
              the curve (vertices), a curvature comb, tangents, axes, a grid, a legend. Left out: the surface, or a \
              curve with its control polygon and points.",
    },
    Parameter {
        name: "shading",
        kind: Kind::Choice(&["smooth", "flat"]),
        unit: "",
        default: Default::Text("smooth"),
        doc: "Whether light sees a smooth surface or its faces.",
    },
    POSITIONS,
    Parameter {
        name: "normals",
        kind: Kind::Choice(&["none", "area", "limit"]),
        unit: "",
        default: Default::Text("area"),
        doc: "What a smooth surface is lit by: normals weighted by the area of the faces around a vertex, those of \
              the limit surface, or none but those of its faces, as with flat shading.",
    },
    CREASE_ANGLE,
    COLOR,
    COLOR_BY,
    CHANNEL,
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
];

const FACTS: &FormatFacts = &FormatFacts {
    name: "png",
    extension: "png",
    media_type: "image/png",
    content: Content::Packed,
    doc: "A picture in pixels: a lit mesh with hidden lines removed, or curves with their control polygons.",
    parameters: PARAMETERS,
    holds_frames: false,
    holds: |kind, _| options::drawable(kind),
};

impl Format for Png {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn suits(&self, kind: ShapeKind, carried: &Attachments, options: &Values) -> Result<(), Fault> {
        let fitting: &[&str] = match kind {
            ShapeKind::Mesh => &["surface", "wireframe", "isolines", "control", "points"],
            ShapeKind::Curves { .. } => picture::drawing::CURVE_ITEMS,
        };
        coat::check(kind, carried, options)?;
        plot::check(kind, options)?;
        options::shows_only(fitting, kind, options)
    }

    fn size(&self, _: &Counts, options: &Values) -> Size {
        bytes(options::size(options))
    }

    fn paper(&self) -> Option<Paper> {
        Some(Paper::Png)
    }

    fn refers(&self, options: &Values) -> Option<&'static str> {
        let shown = options.has("show", ISOLINES).then_some(ISOLINES);
        shown.or(coat::follows_faces(options).then_some("colours of input faces"))
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        let vertices = counts.vertices.saturating_add(hard_edges::split_vertices(counts, options));
        let colors = coat::memory(options, vertices, counts);
        let pieces = counts.vertices.saturating_add(counts.input_edges as u128);
        let isolines = if options.has("show", ISOLINES) { pieces.saturating_mul(8) } else { 0 };
        let wires = if options.has("show", "wireframe") { counts.half_edges.saturating_mul(WIRE_BYTES) } else { 0 };
        let pixels = options::size(options).map(u128::from).iter().product::<u128>() * PIXEL_BYTES;
        [isolines, wires, pixels, hard_edges::memory(counts, options)]
            .iter()
            .fold(colors, |sum: u128, bytes| sum.saturating_add(*bytes))
    }

    fn work(&self, mesh: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        let drawn = mesh.map_or(0, |mesh| forecast::work(mesh, counts, &Options::new(options, counts.frame)));
        drawn.saturating_add(coat::work(&counts.attachments, options))
    }

    fn write(&self, scene: &Scene<'_>, values: &Values, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        let options = Options::new(values, scene.frame);
        let pixels = pixels(scene, values, watch)?;
        watch.check()?;
        watch.enter(Stage::Encode);
        // an opaque background leaves nothing transparent
        encode(pixels, options.size, options.background[3] == 255, out)
    }
}

/// Bytes of a picture at most: its rows stored without compression, which the encoder never exceeds, and a kilobyte
/// around them.
pub(super) fn bytes(size: [u32; 2]) -> Size {
    let [width, height] = size.map(u128::from);
    let rows = height * (1 + 4 * width);
    let blocks = rows / 32_768 + 1;
    Size::AtMost(rows + 17 * blocks + 1024)
}

/// The picture of a scene: rows of red, green, blue and alpha (straight), from the top.
pub(super) fn pixels(scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Vec<u8>, FormatError> {
    let options = Options::new(values, scene.frame);
    watch.enter(Stage::Render);
    options::check_extent(scene)?;
    match scene.shape {
        Shape::Mesh(shape) => mesh::picture(scene, shape, &options, watch),
        Shape::Curves(curves) => {
            let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
            options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
            Ok(drawing::pixels(&picture::drawing::drawing(scene, &options, watch)?, watch)?)
        }
    }
}

/// Leaves out every fourth byte.
pub(super) fn without_alpha(pixels: &mut Vec<u8>) {
    let n = pixels.len() / 4;
    for i in 0..n {
        pixels.copy_within(4 * i..4 * i + 3, 3 * i);
    }
    pixels.truncate(3 * n);
}

/// Writes pixels (red, green, blue, alpha), without the alpha where all are opaque.
pub(super) fn encode(
    mut pixels: Vec<u8>,
    [width, height]: [u32; 2],
    is_opaque: bool,
    out: &mut dyn Write,
) -> Result<(), FormatError> {
    let color = if is_opaque {
        without_alpha(&mut pixels);
        ExtendedColorType::Rgb8
    } else {
        ExtendedColorType::Rgba8
    };
    PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
        .write_image(&pixels, width, height, color)
        .map_err(|error| FormatError::Io(io::Error::other(error)))
}
