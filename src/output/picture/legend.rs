//! The legend of a picture: a bar with the colours of numbers, in a strip of its own at the right.

use super::coat;
use super::number_scale::{COLOR_BAR, NumberScale};
use super::options::Options;
use super::shading::{self, Measure};
use crate::drawing::{Color, Drawing, Label, Weight, color_bar, pixels};
use crate::math::parameter::Value;
use crate::output::error::FormatError;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// Width and height from which a picture has a legend unasked, pixels.
/// In half of it the numbers take a third of the picture; twice of it leaves thumbnails of usual size without.
const LEAST_PX: [u32; 2] = [320, 200];
/// Width of the strip, in units of line width: room for the longest number and what the numbers are.
const STRIP: f32 = 132.0;
/// Left end and width of the bar, in units of line width.
const BAR: [f32; 2] = [8.0, 22.0];
/// Share of the height that the bar takes.
const TALL: f32 = 0.62;
/// Size of the font, in units of line width, and least, pixels: below it letters cannot be read.
const FONT: [f32; 2] = [15.0, 9.0];

/// Width of the legend of a picture of a mesh that carries this, pixels; 0 without one.
pub(super) fn width(carried: &Attachments, options: &Options<'_>) -> u32 {
    let are_numbers = shading::measure(options.values).is_some() || coat::numbers_of(carried, options.values).is_some();
    let has_room = options.size.iter().zip(LEAST_PX).all(|(side, least)| *side >= least);
    let is_asked = match options.values.get(COLOR_BAR.name) {
        Value::Flag(asked) => *asked,
        _ => has_room,
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a strip is some hundred pixels wide")]
    let strip = (STRIP / FONT[0] * font_px(options)) as u32;
    if are_numbers && is_asked { strip.min(options.size[0] / 2) } else { 0 }
}

/// The rows of a picture with a strip of `width` pixels at their right, in which the legend of a scale stands.
pub(super) fn beside(
    shown: &[u8],
    scale: &NumberScale,
    width: u32,
    carried: &Attachments,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Vec<u8>, FormatError> {
    let unit = font_px(options) / FONT[0];
    #[expect(clippy::cast_precision_loss, reason = "pictures are bounded")]
    let height = options.size[1] as f32;
    let bar = [BAR[0] * unit, (0.5 * (1.0 - TALL) * height + unit * FONT[0]).floor(), BAR[1] * unit, TALL * height];
    let table = scale.map.bytes();
    let color = |share: f64| -> Color {
        let x = (1.0 - share) * scale.low + share * scale.high;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a table")]
        let place = (f64::from(scale.share(x)) * crate::math::functions::real(table.len() - 1) + 0.5) as usize;
        let [r, g, b] = table[place.min(table.len() - 1)];
        [r, g, b, 255]
    };
    // names of channels may hold what cannot be set
    let label = Label::parse(&title(carried, options), Weight::Regular).ok();
    let items = color_bar(bar, [scale.low, scale.high], color, label, unit * FONT[0]);
    let size = [width, options.size[1]];
    let strip = pixels(&Drawing { size, background: options.background, title: String::new(), items }, watch)?;
    let [left, right] = [options.size[0] - width, width].map(|width| 4 * width as usize);
    let mut all = Vec::with_capacity(shown.len() + strip.len());
    for (shown, strip) in shown.chunks_exact(left).zip(strip.chunks_exact(right)) {
        all.extend_from_slice(shown);
        all.extend_from_slice(strip);
    }
    Ok(all)
}

/// Size of the font, pixels.
fn font_px(options: &Options<'_>) -> f32 {
    (FONT[0] * options.unit_px()).max(FONT[1])
}

/// What the numbers are, with their unit.
fn title(carried: &Attachments, options: &Options<'_>) -> String {
    let unit = options.frame.unit.name();
    match shading::measure(options.values) {
        Some(Measure::Gaussian) => format!("Gaussian, 1/{unit}^2"),
        Some(Measure::Mean) => format!("mean, 1/{unit}"),
        Some(Measure::Distance) => format!("distance, {unit}"),
        None => {
            let name = coat::numbers_of(carried, options.values).unwrap_or_default();
            ['\\', '_', '^', '{', '}'].iter().fold(name.to_owned(), |name, c| name.replace(*c, &format!("\\{c}")))
        }
    }
}
