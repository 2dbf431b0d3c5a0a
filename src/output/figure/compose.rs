//! Pictures put together.

use std::io::Write;

use super::grid::{Place, Sheet};
use crate::drawing::{self, Drawing, Item, Mark, pdf, svg};
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::error::FormatError;
use crate::output::format::Paper;
use crate::output::picture::vector;
use crate::output::png;
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::watch::{Stage, Watch};

/// Bytes of a pixel of a figure while it is made: of the figure itself, twice more while it is painted and encoded, and
/// of the picture that it comes from.
const PIXEL_BYTES: u128 = 16;
/// Bytes of a point in a drawing: a place in a line and one of a disc.
const POINT_BYTES: u128 = 64;
/// Bytes of what is written at most: each of its letters as an outline.
const TEXT_BYTES: u128 = 1 << 20;
/// Options of a format that a figure takes; all others are said by its panels.
const OPTIONS: [&str; 4] = ["width", "background", "dpi", "text"];

/// What is to be seen of a panel.
#[derive(Debug)]
pub enum Picture {
    /// Rows of red, green, blue and alpha (straight), from the top.
    Pixels(Vec<u8>),
    /// Lines.
    Lines(Drawing),
}

/// Refuses options that a figure does not take.
///
/// # Errors
/// The fault, with a pointer below the output.
pub fn suits(options: &Values) -> Result<(), Fault> {
    let Some((name, _)) = options.unusual().find(|(name, _)| !OPTIONS.contains(name)) else { return Ok(()) };
    let detail = format!("a figure takes \"width\", \"background\" and \"dpi\"; say \"{name}\" in its panels");
    Err(Fault::new(format!("/{name}"), detail))
}

/// Bytes that a figure will take, and bytes of memory while it is put together: its pictures take so many bytes by
/// themselves, and have so many points.
pub fn size(paper: Paper, sheet: &Sheet, bytes: u128, points: u128) -> (Size, u128) {
    let pixels = sheet.size.map(u128::from).iter().product::<u128>();
    let size = match paper {
        Paper::Png => png::bytes(sheet.size),
        // pictures in pixels are written in letters
        Paper::Svg | Paper::Pdf => Size::AtMost(bytes.saturating_mul(2).saturating_add(TEXT_BYTES)),
    };
    (size, (pixels * PIXEL_BYTES).saturating_add(points.saturating_mul(POINT_BYTES)).saturating_add(TEXT_BYTES))
}

/// What a panel that is `drawn` as a picture of its own on such paper shows of a scene.
///
/// # Errors
/// As those of the format of the picture.
pub fn picture(
    (paper, drawn): (Paper, Paper),
    scene: &Scene<'_>,
    values: &Values,
    watch: &Watch,
) -> Result<Picture, FormatError> {
    match (paper, drawn, scene.shape) {
        (Paper::Png, Paper::Png, _) | (_, Paper::Png, Shape::Mesh(_)) => {
            png::pixels(scene, values, watch).map(Picture::Pixels)
        }
        _ => vector::draw(scene, values, watch).map(Picture::Lines),
    }
}

/// Writes a figure of these pictures.
///
/// # Errors
/// When the writer fails, or the watch says stop.
pub fn write(
    paper: Paper,
    (sheet, pictures, title): (&Sheet, Vec<Picture>, &str),
    options: &Values,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<(), FormatError> {
    watch.enter(Stage::Render);
    let mut items: Vec<Item> =
        sheet.pictures.iter().zip(pictures).map(|(place, picture)| placed(*place, picture)).collect();
    items.extend(sheet.texts.iter().cloned());
    let background = options.color("background").unwrap_or([255; 4]);
    let drawing = Drawing { size: sheet.size, background, title: title.to_owned(), items };
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

/// A picture as an item of the figure.
#[expect(clippy::cast_precision_loss, reason = "figures have some thousand pixels")]
fn placed(Place { at, size }: Place, picture: Picture) -> Item {
    let [[x, y], extent] = [at, size].map(|pair| pair.map(|n| n as f32));
    match picture {
        Picture::Pixels(pixels) => {
            Item::new("panel", Mark::Picture(drawing::Picture { size, pixels, at: [x, y], extent }))
        }
        Picture::Lines(drawing) => drawing.into_group([x, y, extent[0], extent[1]]),
    }
}
