//! The legend of a picture: a bar with the colours of numbers, in a strip of its own at the right.

use super::coat;
use super::drawing::{Drawing, Item};
use super::number_scale::NumberScale;
use super::options::Options;
use super::paint;
use super::shading;
use crate::math::parameter::{Default, Kind, Parameter, Value};
use crate::output::error::FormatError;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// Whether there is a legend.
pub(crate) const LEGEND: Parameter = Parameter {
    name: "legend",
    kind: Kind::Flag,
    unit: "",
    default: Default::Absent,
    doc: "Whether a bar at the right says which colour stands for which number. Left out, it does where colours are \
          numbers and the picture is at least 320 x 200 pixels.",
};

/// Width and height from which a picture has a legend unasked, pixels.
/// In half of it the numbers take a third of the picture; twice of it leaves thumbnails of usual size without.
const LEAST_PX: [u32; 2] = [320, 200];
/// Width of the strip, in units of line width.
const STRIP: f32 = 120.0;
/// Width of the bar, in units of line width.
const BAR: f32 = 20.0;
/// Share of the height that the bar takes.
const TALL: f32 = 0.6;

/// Width of the legend of a picture of a mesh that carries this, pixels; 0 without one.
pub(super) fn width(carried: &Attachments, options: &Options<'_>) -> u32 {
    let are_numbers = shading::measure(options.values).is_some() || coat::numbers_of(carried, options.values).is_some();
    let has_room = options.size.iter().zip(LEAST_PX).all(|(side, least)| *side >= least);
    let is_asked = match options.values.get(LEGEND.name) {
        Value::Flag(asked) => *asked,
        _ => has_room,
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a strip is some hundred pixels wide")]
    let strip = (STRIP * options.unit_px()) as u32;
    if are_numbers && is_asked { strip.min(options.size[0] / 2) } else { 0 }
}

/// The rows of a picture with a strip of `width` pixels at their right, in which the legend of a scale stands.
pub(super) fn beside(
    pixels: &[u8],
    scale: &NumberScale,
    width: u32,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Vec<u8>, FormatError> {
    let strip = paint::paint(&drawing(scale, width, options), watch)?;
    let rows =
        |bytes: &[u8], width: u32| bytes.chunks_exact(4 * width as usize).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let left = rows(pixels, options.size[0] - width);
    Ok(left.into_iter().zip(rows(&strip, width)).flat_map(|(left, right)| [left, right]).flatten().collect())
}

fn drawing(scale: &NumberScale, width: u32, options: &Options<'_>) -> Drawing {
    let unit = options.unit_px();
    #[expect(clippy::cast_precision_loss, reason = "pictures are bounded")]
    let height = options.size[1] as f32;
    let table = scale.map.bytes();
    let (left, right) = (0.1 * STRIP * unit, (0.1 * STRIP + BAR) * unit);
    let (top, rows) = ((0.5 * (1.0 - TALL) * height).floor(), (TALL * height).floor());
    let mut items = Vec::new();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "rows")]
    for row in 0..rows as u32 {
        let down = f64::from(row) + 0.5;
        let x = scale.high + (scale.low - scale.high) * (down / f64::from(rows));
        let place = (scale.share(x) * (table.len() - 1) as f32 + 0.5) as usize;
        let y = top + row as f32 + 0.5;
        let color = table[place.min(table.len() - 1)];
        let run = vec![[left, y], [right, y]];
        items.push(Item::Lines { runs: vec![run], width_px: 1.0, color: [color[0], color[1], color[2], 255] });
    }
    Drawing { size: [width, options.size[1]], background: options.background, items }
}
