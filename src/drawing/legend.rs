//! Legends, which explain the lines, marks and colours of a drawing.

use super::axes::BORDER_INK;
use super::label::Label;
use super::scene::{
    Cap, Color, Discs, DrawingItem, HorizontalAlign, Mark, Picture, Point, Stroke, Text, VerticalAlign,
};
use super::ticks::ticks;

/// Colour of the background, which is slightly translucent.
const PAPER_COLOR: Color = [255, 255, 255, 230];
/// Colour of the border.
const BORDER_COLOR: Color = [203, 213, 225, 255];

/// The sample of an entry, as it looks in the drawing.
#[derive(Debug, Clone, PartialEq)]
pub enum LegendSample {
    /// A line.
    Line(Stroke),
    /// A disc; its centres are ignored.
    Disc(Discs),
    /// A colour.
    Area(Color),
}

/// An entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    /// The sample.
    pub key: LegendSample,
    /// The explanation.
    pub label: Label,
}

/// A legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// The entries, from the top.
    pub entries: Vec<LegendEntry>,
    /// Font size, in pixels.
    pub size_px: f32,
}

impl Legend {
    /// Returns width and height, in pixels.
    pub fn extent(&self) -> [f32; 2] {
        let widest = self.entries.iter().map(|entry| entry.label.width(self.size_px)).fold(0.0, f32::max);
        #[expect(clippy::cast_precision_loss, reason = "a few entries")]
        let n = self.entries.len() as f32;
        [widest + 4.2 * self.size_px, (1.5 * n + 0.7) * self.size_px]
    }

    /// Returns the legend with its background; the upper left corner is at the given point.
    pub fn items(&self, [left, top]: Point) -> Vec<DrawingItem> {
        let [width, height] = self.extent();
        let size = self.size_px;
        let edge = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height], [0.0, 0.0]];
        let edge = edge.map(|[x, y]| [left + x, top + y]).to_vec();
        let mut items = vec![
            DrawingItem::rectangle("legend", [left, top, width, height], PAPER_COLOR),
            DrawingItem::lines("legend", vec![edge], Stroke::solid(0.07 * size, BORDER_COLOR)),
        ];
        let mut y = top + 1.1 * size;
        for LegendEntry { key, label } in &self.entries {
            let from = left + 0.7 * size;
            items.push(key.item([from, y], size));
            items.push(text(label.clone(), [from + 2.8 * size, y], size));
            y += 1.5 * size;
        }
        items
    }
}

impl LegendSample {
    /// Returns a sample, two letters wide, that starts at the given point.
    fn item(&self, [x, y]: Point, size: f32) -> DrawingItem {
        let mark = match self {
            Self::Line(stroke) => Mark::Lines(vec![vec![[x, y], [x + 2.2 * size, y]]], stroke.clone()),
            Self::Disc(discs) => Mark::Discs(Discs { centres: vec![[x + 1.1 * size, y]], ..discs.clone() }),
            Self::Area(color) => {
                let [left, right, top, bottom] = [x + 0.3 * size, x + 1.9 * size, y - 0.4 * size, y + 0.4 * size];
                Mark::Areas(vec![vec![[left, top], [right, top], [right, bottom], [left, bottom]]], *color)
            }
        };
        DrawingItem::new("legend", mark)
    }
}

fn text(label: Label, at: Point, size_px: f32) -> DrawingItem {
    let (anchor, level) = (HorizontalAlign::Start, VerticalAlign::Middle);
    DrawingItem::new("label", Mark::Text(Text { label, at, size_px, anchor, level, turn_deg: 0.0, color: BORDER_INK }))
}

/// Number of colours of a bar: enough that steps are invisible; twice as many would only make the file longer.
const BAR_COLORS: u16 = 256;

/// Height of the tip of a bar, in its widths. At half of it the sides meet at a right angle, which is seen in large
/// pictures only; at twice of it the tip looks like a part of the scale.
const TIP_HEIGHT: f32 = 0.8;

/// Share of the size of the font down to which what is written at a bar becomes smaller; a third cannot be read.
const LEAST_SHARE: f32 = 0.5;

/// A bar of colours with a scale at its right: `low` at the bottom, `high` at the top of a rectangle (left, top, width,
/// height, pixels) that holds the bar alone. `color` is that of a share of the way from one to the other. An end of the
/// bar has a tip if there are numbers `beyond` it, which have its colour. What the numbers are stands above. What is
/// written ends before `end`, smaller where that is needed.
pub fn color_bar(
    [left, top, width, height]: [f32; 4],
    ([low, high], beyond): ([f64; 2], [bool; 2]),
    color: impl Fn(f64) -> Color,
    label: Option<Label>,
    size_px: f32,
    end: f32,
) -> Vec<DrawingItem> {
    let tips = beyond.map(|is_beyond| if is_beyond { (TIP_HEIGHT * width).min(0.25 * height) } else { 0.0 });
    let (tip, top, height) = (top, top + tips[1], height - tips[0] - tips[1]);
    let shares = (0..BAR_COLORS).rev().map(|i| (f64::from(i) + 0.5) / f64::from(BAR_COLORS));
    let pixels = shares.flat_map(&color).collect();
    let bar = Picture { size: [1, u32::from(BAR_COLORS)], pixels, at: [left, top], extent: [width, height] };
    let [right, bottom] = [left + width, top + height];
    let middle = left + 0.5 * width;
    let points = [[middle, bottom + tips[0]], [middle, tip]];
    let corners = [[[left, bottom], [right, bottom]], [[right, top], [left, top]]];
    let area = |k: usize| vec![corners[k][0], points[k], corners[k][1]];
    let areas = [0, 1].into_iter().filter(|k| beyond[*k]).map(|k| {
        let end = if k == 0 { 0.0 } else { 1.0 };
        DrawingItem::new("bar", Mark::Areas(vec![area(k)], color(end)))
    });
    let areas: Vec<DrawingItem> = areas.collect();
    let around = [area(0), area(1), vec![[left, bottom]]].concat();
    let mut runs = vec![around];
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few ticks")]
    let room = (height / (2.5 * size_px)) as usize;
    let mut texts = Vec::new();
    let fitted = |widest: f32, start: f32| size_px * ((end - start) / widest.max(1.0)).clamp(LEAST_SHARE, 1.0);
    let found = ticks(low, high, room.clamp(2, 9));
    let widest = found.iter().map(|tick| tick.label.width(size_px)).fold(0.0, f32::max);
    let small_px = fitted(widest, right + 0.6 * size_px);
    for tick in found {
        #[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
        let y = bottom - ((tick.value - low) / (high - low)) as f32 * height;
        runs.push(vec![[right, y], [right + 0.3 * size_px, y]]);
        texts.push(text(tick.label, [right + 0.6 * size_px, y], small_px));
    }
    if let Some(label) = label {
        let size_px = fitted(label.width(size_px), left);
        texts.push(text(label, [left, tip - 1.1 * size_px], size_px));
    }
    let stroke = Stroke { cap: Cap::Butt, ..Stroke::solid(0.07 * size_px, BORDER_INK) };
    let items = [DrawingItem::new("bar", Mark::Picture(bar)), DrawingItem::lines("axis", runs, stroke)];
    items.into_iter().chain(areas).chain(texts).collect()
}
