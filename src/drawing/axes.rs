//! The border of a plot: axes with ticks, their labels and a grid.

use super::label::Label;
use super::scene::{Cap, Color, DrawingItem, HorizontalAlign, Mark, Point, Stroke, Text, VerticalAlign};
use super::ticks::{Tick, ticks};

/// Colour of borders and of their labels.
pub(super) const BORDER_INK: Color = [51, 65, 85, 255];
/// Colour of the grid; it must not be mistaken for a line of the plot.
const GRID_COLOR: Color = [226, 232, 240, 255];
/// Maximum number of ticks of an axis; twice as many would be a ruler, half as many too few to read values.
const MAX_TICKS: usize = 9;

/// A range of numbers along a side of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The value at the left or at the bottom.
    pub low: f64,
    /// The value at the right or at the top; greater than `low`.
    pub high: f64,
    /// The label that tells what the values are.
    pub label: Option<Label>,
}

/// A plot's axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes {
    /// Left, top, width and height of the area inside the border, in pixels.
    pub border: [f32; 4],
    /// The horizontal axis, from left to right.
    pub x: Axis,
    /// The vertical axis, from bottom to top.
    pub y: Axis,
    /// Whether thin lines cross the plot at the ticks.
    pub grid: bool,
    /// Font size, in pixels.
    pub size_px: f32,
}

impl Axis {
    /// Returns the position of a value as a fraction of the way from the low end to the high end.
    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

impl Axes {
    /// Returns the room that ticks and labels need outside the border at a font size: left, top, right, bottom, in
    /// pixels.
    pub fn margins(x: &Axis, y: &Axis, size_px: f32) -> [f32; 4] {
        let line = 1.8 * size_px;
        let labelled = |axis: &Axis| if axis.label.is_some() { line } else { 0.0 };
        let widest = ticks(y.low, y.high, MAX_TICKS).iter().map(|tick| tick.label.width(size_px)).fold(0.0, f32::max);
        [widest + size_px + labelled(y), 0.7 * size_px, 1.2 * size_px, 2.0 * size_px + labelled(x)]
    }

    /// Returns the position of a point of the plot, in pixels.
    pub fn place(&self, [x, y]: [f64; 2]) -> Point {
        let [left, top, width, height] = self.border.map(f64::from);
        #[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
        [left + self.x.share(x) * width, top + (1.0 - self.y.share(y)) * height].map(|pixel| pixel as f32)
    }

    /// Returns the grid, which must be drawn before the plot.
    pub fn grid(&self) -> DrawingItem {
        let [left, top, width, height] = self.border;
        let mut runs = Vec::new();
        if self.grid {
            for tick in self.x_ticks() {
                let [x, _] = self.place([tick.value, self.y.low]);
                runs.push(vec![[x, top], [x, top + height]]);
            }
            for tick in self.y_ticks() {
                let [_, y] = self.place([self.x.low, tick.value]);
                runs.push(vec![[left, y], [left + width, y]]);
            }
        }
        let width_px = 0.07 * self.size_px;
        DrawingItem::lines("grid", runs, Stroke { cap: Cap::Butt, ..Stroke::solid(width_px, GRID_COLOR) })
    }

    /// Returns the border with ticks and labels, which must be drawn after the plot.
    pub fn items(&self) -> Vec<DrawingItem> {
        let [left, top, width, height] = self.border;
        let [right, bottom] = [left + width, top + height];
        let size = self.size_px;
        let reach = 0.4 * size;
        let mut runs = vec![vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]]];
        let mut texts = Vec::new();
        let mut widest: f32 = 0.0;
        for Tick { value, label } in self.x_ticks() {
            let [x, _] = self.place([value, self.y.low]);
            runs.push(vec![[x, bottom], [x, bottom + reach]]);
            texts.push(self.text(
                label,
                [x, bottom + reach + 0.35 * size],
                HorizontalAlign::Middle,
                VerticalAlign::Top,
            ));
        }
        for Tick { value, label } in self.y_ticks() {
            let [_, y] = self.place([self.x.low, value]);
            widest = widest.max(label.width(size));
            runs.push(vec![[left - reach, y], [left, y]]);
            texts.push(self.text(label, [left - reach - 0.3 * size, y], HorizontalAlign::End, VerticalAlign::Middle));
        }
        if let Some(label) = self.x.label.clone() {
            let at = [left + 0.5 * width, bottom + reach + 1.7 * size];
            texts.push(self.text(label, at, HorizontalAlign::Middle, VerticalAlign::Top));
        }
        if let Some(label) = self.y.label.clone() {
            let at = [left - reach - 0.9 * size - widest, top + 0.5 * height];
            texts.push(Text {
                turn_deg: -90.0,
                ..self.text(label, at, HorizontalAlign::Middle, VerticalAlign::Baseline)
            });
        }
        let border =
            DrawingItem::lines("axis", runs, Stroke { cap: Cap::Butt, ..Stroke::solid(0.08 * size, BORDER_INK) });
        let texts = texts.into_iter().map(|text| DrawingItem::new("label", Mark::Text(text)));
        std::iter::once(border).chain(texts).collect()
    }

    fn text(&self, label: Label, at: Point, anchor: HorizontalAlign, level: VerticalAlign) -> Text {
        Text { label, at, size_px: self.size_px, anchor, level, turn_deg: 0.0, color: BORDER_INK }
    }

    /// Returns as many ticks as there is room for: one per five letters of width, fewer where labels would meet.
    fn x_ticks(&self) -> Vec<Tick> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few ticks")]
        let room = (self.border[2] / (5.0 * self.size_px)) as usize;
        let fits = |found: &[Tick]| {
            found.windows(2).all(|pair| {
                let [a, b] = [&pair[0], &pair[1]].map(|tick| self.place([tick.value, self.y.low])[0]);
                let [left, right] = [&pair[0], &pair[1]].map(|tick| tick.label.width(self.size_px));
                b - a >= 0.5 * (left + right + self.size_px)
            })
        };
        let found = (2..=room.clamp(2, MAX_TICKS)).rev().map(|most| ticks(self.x.low, self.x.high, most));
        let alone = || ticks(self.x.low, self.x.high, 2).into_iter().take(1).collect();
        found.into_iter().find(|found| fits(found)).unwrap_or_else(alone)
    }

    /// Returns one tick per two and a half lines of height.
    fn y_ticks(&self) -> Vec<Tick> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few ticks")]
        let room = (self.border[3] / (2.5 * self.size_px)) as usize;
        ticks(self.y.low, self.y.high, room.clamp(2, MAX_TICKS))
    }
}
