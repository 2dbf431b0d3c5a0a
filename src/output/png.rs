//! PNG: a lit picture of a mesh, or a drawing of curves.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, Filter, PixelDimensions, Unit};
use rayon::prelude::*;

use crate::drawing;
use crate::fault::Fault;
use crate::kept::Kept;
use crate::math::parameter::{Default, Parameter, ParameterKind, Value, Values};
use crate::output::color_maps::COLOR_MAP;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Paper, Requirements};
use crate::output::hard_edges::{self, CREASE_ANGLE};
use crate::output::options::{POSITIONS, joined};
use crate::output::picture::coat::{self, CHANNEL, COLOR_BY, COMPONENT};
use crate::output::picture::number_scale::{self, COLOR_BAR, COLOR_RANGE};
use crate::output::picture::options::{
    self, BACKGROUND, CAMERA, COLOR, COMB_SCALE, CONTROL_COLOR, DPI, FILL, GROUNDING, HEIGHT, LINE_WIDTH, Options,
    POINT_COLOR, POINT_SIZE, QUALITY, WIDTH, WIRE_COLOR,
};
use crate::output::picture::plot::{self, LEGEND, TEXT_SIZE, TITLE, X_LABEL, Y_LABEL};
use crate::output::picture::shading::{self, SHADING, STRIPE_DIRECTION, STRIPES};
use crate::output::picture::styles::STYLES;
use crate::output::picture::{self, forecast, framing, lines, look, meanings, mesh};
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::output::surface::NORMALS;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::watch::{Stage, Watch};

/// Bytes per pixel while a surface is drawn: its light and depth (12), its colour (4), and 6 for cells of the map of
/// hollows. These take 3 where a side is longer than 256 pixels; in smaller pictures 12, 0.4 MB more at most.
const SURFACE_PIXEL_BYTES: u128 = 22;
/// Bytes per pixel while lines are drawn: their light (8), and a colour.
const LINE_PIXEL_BYTES: u128 = 12;
/// Bytes per half-edge of a mesh whose edges are drawn: the sides before they are sorted (8), and half of an edge as it
/// is drawn, with its two ends, its bounds and its place among the tiles (measured: 52).
const WIRE_BYTES: u128 = 36;

/// Bytes per vertex for its place over the ground (16), and for whether a triangle has it.
const GROUND_BYTES: u128 = 17;

/// The format "png".
#[derive(Debug, Clone, Copy)]
pub(super) struct Png;

/// All items that pictures can show.
const ITEMS: [&str; 17] =
    joined(&lines::SURFACE_ITEMS, &["curve", "vertices", "comb", "tangents", "axes", "grid", "legend"]);

/// The options of the picture.
pub(super) const PNG_OPTIONS: &[Parameter] = &[
    WIDTH,
    HEIGHT,
    DPI,
    QUALITY,
    BACKGROUND,
    Parameter::optional(
        "show",
        ParameterKind::Choices(&ITEMS),
        "What is drawn: of a mesh its surface, its wireframe, the edges of the input on it (isolines), the \
         control net and its points, and what is tagged of the input as coloured lines and dots: creases (red), \
         latitude (green) and longitude lines (purple), seams of texture coordinates (orange), extraordinary \
         vertices (yellow), and a legend that tells the names of groups or materials and what \
         lines and dots are; of curves the curve, the control polygon and its points, the points of the curve \
         (vertices), a curvature comb, tangents, axes, a grid, a legend. Left out: the surface, or a curve with \
         its control polygon and points.",
    ),
    SHADING,
    STRIPES,
    STRIPE_DIRECTION,
    GROUNDING,
    POSITIONS,
    Parameter {
        default: Default::Text("area"),
        doc: "What a smooth surface is lit by: normals weighted by the area of the faces around a vertex, those of \
              the limit surface, or none but those of its faces, as with flat shading.",
        ..NORMALS
    },
    CREASE_ANGLE,
    COLOR,
    COLOR_BY,
    CHANNEL,
    COMPONENT,
    COLOR_MAP,
    COLOR_RANGE,
    COLOR_BAR,
    LINE_WIDTH,
    WIRE_COLOR,
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
    parameters: PNG_OPTIONS,
    description: Some(DescriptionPlace::Png),
    paper: Some(Paper::Png),
    holds: |kind, _| options::drawable(kind),
    ..FormatFacts::USUAL
};

impl Format for Png {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, values: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let options = Options::new(values, scene.coordinate_system);
        let pixels = pixels(scene, values, stream.watch)?;
        stream.watch.check()?;
        stream.watch.enter(Stage::Encode);
        // an opaque background leaves no pixel transparent
        encode(pixels, options.size, (options.background[3] == 255, options.dpi()), stream.out)
    }
}

impl Requirements for Png {
    fn suits(&self, kind: ShapeKind, carried: &Attachments, options: &Values) -> Result<(), Fault> {
        let fitting: &[&str] = match kind {
            ShapeKind::Mesh => &lines::SHOWN,
            ShapeKind::Curves { .. } => picture::drawing::CURVE_ITEMS,
        };
        framing::check(kind, options)?;
        shading::check(kind, options)?;
        coat::check(kind, carried, options)?;
        plot::check(kind, options)?;
        number_scale::check(options, look::are_numbers(carried, options))?;
        options::shows_only(fitting, kind, options)?;
        meanings::check(kind, carried, options)
    }

    fn refers(&self, options: &Values) -> Option<&'static str> {
        lines::refers(options).or(coat::follows_faces(options).then_some("colours of input faces"))
    }
}

impl Costs for Png {
    fn size(&self, _: &Counts, options: &Values) -> Size {
        bytes(options::size(options))
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        let vertices = counts.vertices.saturating_add(hard_edges::split_vertices(counts, options));
        let colors = coat::memory(options, vertices, counts);
        let pieces = counts.vertices.saturating_add(counts.input_edges as u128);
        let isolines = if lines::refers(options).is_some() { pieces.saturating_mul(5 * 8) } else { 0 };
        let wires = if options.has("show", "wireframe") || options.has("show", "seams") {
            counts.half_edges.saturating_mul(WIRE_BYTES)
        } else {
            0
        };
        let n_pixels = options::size(options).map(u128::from).iter().product::<u128>();
        let shown = *options.get("show") != Value::Absent;
        let has_surface = counts.kind == ShapeKind::Mesh && (!shown || options.has("show", "surface"));
        let surface = if has_surface { SURFACE_PIXEL_BYTES } else { 0 };
        let lines = if shown || !has_surface { LINE_PIXEL_BYTES } else { 0 };
        let pixels = n_pixels * (surface + lines);
        let numbers = look::memory(options, vertices, n_pixels, counts);
        let ground = vertices.saturating_mul(GROUND_BYTES);
        [isolines, wires, numbers, pixels, ground, hard_edges::memory(counts, options)]
            .iter()
            .fold(colors, |sum: u128, bytes| sum.saturating_add(*bytes))
    }

    fn work(&self, mesh: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        let drawn =
            mesh.map_or(0, |mesh| forecast::work(mesh, counts, &Options::new(options, counts.coordinate_system)));
        let [width, height] = options::size(options).map(u128::from);
        let looks = look::work(options, counts, width * height);
        drawn.saturating_add(looks).saturating_add(coat::work(&counts.attachments, options))
    }
}

/// Returns the maximum number of bytes of a picture: its rows stored without compression, which the encoder never
/// exceeds, and a kilobyte around them.
pub(super) fn bytes(size: [u32; 2]) -> Size {
    let [width, height] = size.map(u128::from);
    let rows = height * (1 + 4 * width);
    let blocks = rows / 32_768 + 1;
    Size::AtMost(rows + 17 * blocks + 1024)
}

/// Renders a scene. Returns the rows of pixels from the top, with red, green, blue and straight alpha.
pub(super) fn pixels(scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Kept<u8>, FormatError> {
    let options = Options::new(values, scene.coordinate_system);
    watch.enter(Stage::Render);
    options::check_extent(scene, watch)?;
    match scene.shape {
        Shape::Mesh(shape) => mesh::picture(scene, shape, &options, watch),
        Shape::Curves(curves) => {
            let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
            options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
            Ok(drawing::pixels(&picture::drawing::drawing(scene, &options, watch)?, watch)?)
        }
    }
}

/// Returns an encoder of pictures, or of the frames of a moving one, with this resolution in pixels per inch.
pub(super) fn encoder(
    [width, height]: [u32; 2],
    (is_opaque, dpi): (bool, Option<f64>),
    out: &mut dyn Write,
) -> Encoder<'static, &mut dyn Write> {
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    encoder.set_pixel_dims(dpi.map(pixel_dims));
    encoder
}

/// Returns the size of a pixel at a resolution in pixels per inch.
fn pixel_dims(dpi: f64) -> PixelDimensions {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "there are 1 to 10,000 an inch")]
    let a_metre = (dpi / 0.0254 + 0.5) as u32;
    PixelDimensions { xppu: a_metre, yppu: a_metre, unit: Unit::Meter }
}

/// Returns pixels (red, green, blue, alpha) without their alpha.
pub(super) fn without_alpha(pixels: Kept<u8>) -> Kept<u8> {
    /// Pixels that a thread copies at a time. Half of it makes tasks of few microseconds; twice of it leaves threads
    /// idle where pictures are small.
    const PIXELS_A_TASK: usize = 1 << 16;
    let chunks = pixels.as_chunks().0;
    let mut opaque = Kept::to_overwrite(3 * chunks.len());
    let tasks = opaque.par_chunks_mut(3 * PIXELS_A_TASK).zip(chunks.par_chunks(PIXELS_A_TASK));
    tasks.for_each(|(opaque, pixels)| {
        for (opaque, [red, green, blue, _]) in opaque.as_chunks_mut().0.iter_mut().zip(pixels) {
            *opaque = [*red, *green, *blue];
        }
    });
    drop(pixels);
    opaque
}

/// Writes pixels (red, green, blue, alpha), without the alpha if all are opaque.
pub(super) fn encode(
    pixels: Kept<u8>,
    size: [u32; 2],
    (is_opaque, dpi): (bool, Option<f64>),
    out: &mut dyn Write,
) -> Result<(), FormatError> {
    let failed = |error| FormatError::Io(io::Error::other(error));
    let mut writer = encoder(size, (is_opaque, dpi), out).write_header().map_err(failed)?;
    if is_opaque { writer.write_image_data(&without_alpha(pixels)) } else { writer.write_image_data(&pixels) }
        .map_err(failed)?;
    writer.finish().map_err(failed)
}
