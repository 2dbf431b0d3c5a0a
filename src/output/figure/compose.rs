//! Pictures put together.

use std::io::Write;

use super::grid::Sheet;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::error::FormatError;
use crate::output::format::Paper;
use crate::output::png;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::watch::{Stage, Watch};

/// Bytes of a pixel of a figure while it is made: of the figure itself, once more while it is encoded, and of the
/// picture that it comes from.
const PIXEL_BYTES: u128 = 12;
/// Options of a format that a figure takes; all others are said by its panels.
const OPTIONS: [&str; 2] = ["width", "background"];

/// What is to be seen of a panel.
#[derive(Debug)]
pub enum Picture {
    /// Rows of red, green, blue and alpha (straight), from the top.
    Pixels(Vec<u8>),
}

/// Refuses options that a figure does not take.
///
/// # Errors
/// The fault, with a pointer below the output.
pub fn suits(options: &Values) -> Result<(), Fault> {
    let Some((name, _)) = options.unusual().find(|(name, _)| !OPTIONS.contains(name)) else { return Ok(()) };
    let detail = format!("a figure takes {}; say \"{name}\" in its panels", OPTIONS.join(" and "));
    Err(Fault::new(format!("/{name}"), detail))
}

/// Bytes that a figure will take, and bytes of memory while it is put together.
pub fn size(sheet: &Sheet) -> (Size, u128) {
    let pixels = sheet.size.map(u128::from).iter().product::<u128>();
    (png::bytes(sheet.size), pixels * PIXEL_BYTES)
}

/// What a panel shows of a scene.
///
/// # Errors
/// As those of the format of the picture.
pub fn picture(paper: Paper, scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<Picture, FormatError> {
    match paper {
        Paper::Png => png::pixels(scene, values, watch).map(Picture::Pixels),
    }
}

/// Writes a figure of these pictures.
///
/// # Errors
/// When the writer fails, or the watch says stop.
pub fn write(
    (sheet, pictures): (&Sheet, &[Picture]),
    options: &Values,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<(), FormatError> {
    watch.enter(Stage::Render);
    let background = options.color("background").unwrap_or([255; 4]);
    let [width, height] = sheet.size.map(|side| side as usize);
    let mut pixels = background.repeat(width * height);
    for (place, Picture::Pixels(picture)) in sheet.pictures.iter().zip(pictures) {
        watch.check()?;
        let [x, y] = place.at.map(|at| at as usize);
        let row = 4 * place.size[0] as usize;
        for (i, from) in picture.chunks_exact(row).enumerate() {
            let at = 4 * ((y + i) * width + x);
            pixels[at..at + row].copy_from_slice(from);
        }
    }
    watch.check()?;
    watch.enter(Stage::Encode);
    let is_opaque = pixels.chunks_exact(4).all(|pixel| pixel[3] == 255);
    png::encode(pixels, sheet.size, is_opaque, out)
}
