//! Composes pictures into a figure.

use std::io::Write;

use super::grid::{PanelRect, Sheet};
use crate::drawing::{self, Drawing, DrawingItem, FontWeight, Label, Mark, pdf, svg};
use crate::fault::Fault;
use crate::kept::Kept;
use crate::math::parameter::Values;
use crate::output::error::FormatError;
use crate::output::format::Paper;
use crate::output::picture::vector;
use crate::output::png;
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::watch::{Stage, Watch};

/// Bytes per pixel of a figure while it is composed: the figure itself, twice more while it is painted and encoded, and
/// the picture of the panel.
const FIGURE_PIXEL_BYTES: u128 = 16;
/// Bytes per point in a drawing: a place in a line and one of a disc.
const FIGURE_POINT_BYTES: u128 = 64;
/// Maximum number of bytes of texts: each letter as an outline.
const FIGURE_TEXT_BYTES: u128 = 1 << 20;
/// Options of a format that a figure accepts; all others belong to its panels.
const FIGURE_OPTIONS: [&str; 4] = ["width", "background", "dpi", "text"];

/// The picture in a panel.
#[derive(Debug)]
pub enum PanelPicture {
    /// Rows of pixels from the top, with red, green, blue and straight alpha.
    Pixels(Kept<u8>),
    /// Lines.
    Lines(Drawing),
}

/// Refuses options that a figure does not accept.
///
/// # Errors
/// The fault, with a pointer below the output.
pub fn suits(options: &Values) -> Result<(), Fault> {
    let Some((name, _)) = options.unusual().find(|(name, _)| !FIGURE_OPTIONS.contains(name)) else { return Ok(()) };
    let detail = format!("a figure takes \"width\", \"background\" and \"dpi\"; say \"{name}\" in its panels");
    Err(Fault::new(format!("/{name}"), detail))
}

/// Returns the size of a figure, and the memory in bytes while it is composed. Its pictures take `bytes` bytes as
/// separate outputs and have `points` points.
pub fn size(paper: Paper, sheet: &Sheet, bytes: u128, points: u128) -> (Size, u128) {
    let pixels = sheet.size.map(u128::from).iter().product::<u128>();
    let size = match paper {
        Paper::Png => png::bytes(sheet.size),
        // SVG and PDF hold pictures in pixels as text, which is longer
        Paper::Svg | Paper::Pdf => Size::AtMost(bytes.saturating_mul(2).saturating_add(FIGURE_TEXT_BYTES)),
    };
    (
        size,
        (pixels * FIGURE_PIXEL_BYTES)
            .saturating_add(points.saturating_mul(FIGURE_POINT_BYTES))
            .saturating_add(FIGURE_TEXT_BYTES),
    )
}

/// Renders the picture of a scene in a panel on `paper`; `drawn` is the paper of its own format.
///
/// # Errors
/// Errors of the format of the picture.
pub fn picture(
    (paper, drawn): (Paper, Paper),
    scene: &Scene<'_>,
    values: &Values,
    watch: &Watch,
) -> Result<PanelPicture, FormatError> {
    match (paper, drawn, scene.shape) {
        (Paper::Png, Paper::Png, _) | (_, Paper::Png, Shape::Mesh(_)) => {
            png::pixels(scene, values, watch).map(PanelPicture::Pixels)
        }
        _ => vector::draw(scene, values, watch).map(PanelPicture::Lines),
    }
}

/// Writes a figure of these pictures.
///
/// # Errors
/// When the writer fails, or the watch says stop.
pub fn write(
    paper: Paper,
    (sheet, pictures, title): (&Sheet, Vec<PanelPicture>, &str),
    options: &Values,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<(), FormatError> {
    watch.enter(Stage::Render);
    let mut items: Vec<DrawingItem> =
        sheet.pictures.iter().zip(pictures).map(|(place, picture)| placed(*place, picture)).collect();
    items.extend(sheet.texts.iter().cloned());
    let background = options.color("background").unwrap_or([255; 4]);
    let title = Label::parse(title, FontWeight::Bold).map_err(FormatError::Unfit)?.text();
    let drawing = Drawing { size: sheet.size, background, title, items };
    match paper {
        Paper::Png => {
            let pixels = drawing::pixels(&drawing, watch)?;
            watch.check()?;
            watch.enter(Stage::Encode);
            let is_opaque = pixels.chunks_exact(4).all(|pixel| pixel[3] == 255);
            png::encode(pixels, sheet.size, (is_opaque, options.number("dpi")), out)
        }
        Paper::Svg => Ok(svg(&drawing, vector::lettering(options), out, watch)?),
        Paper::Pdf => Ok(pdf(&drawing, vector::lettering(options), out, watch)?),
    }
}

/// Returns a picture as an item of the figure.
#[expect(clippy::cast_precision_loss, reason = "figures have some thousand pixels")]
fn placed(PanelRect { at, size }: PanelRect, picture: PanelPicture) -> DrawingItem {
    let [[x, y], extent] = [at, size].map(|pair| pair.map(|n| n as f32));
    match picture {
        PanelPicture::Pixels(pixels) => {
            DrawingItem::new("panel", Mark::Picture(drawing::Picture { size, pixels, at: [x, y], extent }))
        }
        PanelPicture::Lines(drawing) => drawing.into_group([x, y, extent[0], extent[1]]),
    }
}
