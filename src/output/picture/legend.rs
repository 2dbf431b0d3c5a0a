//! The legend of a picture of a mesh: a colour bar for numbers, and the names of other colours, in a strip of its own
//! at the right.

use super::coat;
use super::look;
use super::meanings;
use super::number_scale::{COLOR_BAR, NumberScale};
use super::options::Options;
use super::shading::{self, ShadedQuantity};
use crate::drawing::{Color, Drawing, DrawingItem, FontWeight, Label, Legend, color_bar, pixels};
use crate::kept::Kept;
use crate::math::parameter::Value;
use crate::output::error::FormatError;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// Minimum width and height of a picture that has a legend by default, pixels. In half of it the numbers would take a
/// third of the picture; twice of it leaves thumbnails of usual size without a legend.
const LEAST_LEGEND_PX: [u32; 2] = [320, 200];
/// Width of the strip, in units of line width: room for the longest number and for the title of the bar. Half of it has
/// no room for these; twice of it takes more of the picture for nothing.
const STRIP_WIDTH: f32 = 132.0;
/// Left end and width of the bar, in units of line width.
const BAR_EXTENT: [f32; 2] = [8.0, 22.0];
/// Distance of text from the edge of the picture, in units of line width. Half of it looks cut off; twice of it wastes
/// the strip.
const EDGE_DISTANCE: f32 = 3.0;
/// Height of the bar as a share of the height of the picture. A matter of taste: half of it has room for few numbers;
/// twice of it does not fit.
const BAR_HEIGHT: f32 = 0.62;
/// Size of the font in units of line width, and its minimum in pixels, below which letters cannot be read.
const FONT_SIZES: [f32; 2] = [15.0, 9.0];

/// Margin around names, in sizes of the font. Half of it lets names touch the edge; twice of it takes more of the
/// picture.
const NAME_MARGIN: f32 = 0.6;

/// Returns the width in pixels of the legend of a picture of a mesh with the attachments `carried`, or of what is left
/// free for it; 0 without both. Numbers colour the surface: there is a bar only if `has_surface`.
pub(crate) fn width(carried: &Attachments, options: &Options<'_>, has_surface: bool) -> u32 {
    let are_numbers = look::are_numbers(carried, options.values);
    let has_room = options.size.iter().zip(LEAST_LEGEND_PX).all(|(side, least)| *side >= least);
    let is_asked = match options.values.get(COLOR_BAR.name) {
        Value::Flag(asked) => *asked,
        _ => has_room,
    };
    let font = font_px(options);
    let bar = if has_surface && are_numbers && is_asked { STRIP_WIDTH / FONT_SIZES[0] * font } else { 0.0 };
    let names = names(carried, options).map_or(0.0, |names| names.extent()[0] + 2.0 * NAME_MARGIN * font);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a strip is some hundred pixels wide")]
    let strip = bar.max(names) as u32;
    options.size[0] - options.size_beside(strip)[0]
}

/// Returns the names of colours that are not numbers, if the legend shows them: as many as fit one above the other.
fn names(carried: &Attachments, options: &Options<'_>) -> Option<Legend> {
    let mut entries = meanings::entries(carried, options);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some lines")]
    #[expect(clippy::cast_precision_loss, reason = "pictures are bounded")]
    let room = (options.size[1] as f32 / font_px(options) - 2.0 * NAME_MARGIN - 0.7).max(0.0) as usize * 2 / 3;
    entries.truncate(room.max(1));
    (!entries.is_empty()).then(|| Legend { entries, size_px: font_px(options) })
}

/// Appends to the rows of a picture a strip `width` pixels wide at the right, with the names of colours and below them
/// the colour bar of `scale`.
pub(super) fn beside(
    shown: &[u8],
    scale: Option<NumberScale>,
    width: u32,
    carried: &Attachments,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Kept<u8>, FormatError> {
    let (mut items, mut top) = (Vec::new(), 0.0);
    if let Some(names) = names(carried, options) {
        let margin = NAME_MARGIN * font_px(options);
        top = names.extent()[1] + 2.0 * margin;
        items.extend(names.items([margin, margin]));
    }
    #[expect(clippy::cast_precision_loss, reason = "pictures are bounded")]
    let room = [top, width as f32];
    items.extend(scale.into_iter().flat_map(|scale| bar(scale, room, carried, options)));
    let size = [width, options.size[1]];
    let strip = pixels(&Drawing { size, background: options.background, title: String::new(), items }, watch)?;
    let [left, right] = [options.size[0] - width, width].map(|width| 4 * width as usize);
    let mut all = Kept::to_overwrite(shown.len() + strip.len());
    let parts = shown.chunks_exact(left).zip(strip.chunks_exact(right));
    for (row, (shown, strip)) in all.chunks_exact_mut(left + right).zip(parts) {
        row[..left].copy_from_slice(shown);
        row[left..].copy_from_slice(strip);
    }
    Ok(all)
}

/// Returns the colour bar of a scale in a strip of `width` pixels, below the uppermost `taken` pixels.
fn bar(scale: NumberScale, [taken, width]: [f32; 2], carried: &Attachments, options: &Options<'_>) -> Vec<DrawingItem> {
    let unit = font_px(options) / FONT_SIZES[0];
    #[expect(clippy::cast_precision_loss, reason = "pictures are bounded")]
    let height = options.size[1] as f32;
    let usual = (0.5 * (1.0 - BAR_HEIGHT) * height + unit * FONT_SIZES[0]).floor();
    let top = usual.max(taken + 2.0 * unit * FONT_SIZES[0]);
    let tall = (BAR_HEIGHT * height).min(height - top - unit * FONT_SIZES[0]).max(unit);
    let table = scale.map.bytes();
    let color = |share: f64| -> Color {
        let x = (1.0 - share) * scale.low + share * scale.high;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a table")]
        let place = (f64::from(scale.share(x)) * crate::math::functions::real(table.len() - 1) + 0.5) as usize;
        let [r, g, b] = table[place.min(table.len() - 1)];
        [r, g, b, 255]
    };
    // names of channels may contain characters that cannot be typeset
    let label = title(carried, options).ok();
    let (place, end) = ([BAR_EXTENT[0] * unit, top, BAR_EXTENT[1] * unit, tall], width - EDGE_DISTANCE * unit);
    color_bar(place, ([scale.low, scale.high], scale.beyond), color, label, unit * FONT_SIZES[0], end)
}

/// Returns the size of the font, pixels.
fn font_px(options: &Options<'_>) -> f32 {
    (FONT_SIZES[0] * options.unit_px()).max(FONT_SIZES[1])
}

/// Returns the title of the bar: the quantity, with its unit.
fn title(carried: &Attachments, options: &Options<'_>) -> Result<Label, String> {
    let unit = options.coordinate_system.unit.name();
    let text = match shading::measure(options.values) {
        Some(ShadedQuantity::Gaussian) => format!("Gaussian, 1/{unit}^2"),
        Some(ShadedQuantity::Mean) => format!("mean, 1/{unit}"),
        Some(ShadedQuantity::Distance) => format!("distance, {unit}"),
        None => {
            let name = coat::numbers_of(carried, options.values).unwrap_or_default();
            return Label::plain(name, FontWeight::Regular);
        }
    };
    Label::parse(&text, FontWeight::Regular)
}
