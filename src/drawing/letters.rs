//! The positions and the outlines of the letters of a text.

use ttf_parser::OutlineBuilder;

use super::font::{CAPITAL, UNITS_PER_EM};
use super::scene::{HorizontalAlign, Text, VerticalAlign};
use crate::math::functions::{cos, sin};

impl Text {
    /// Returns the width, in pixels.
    pub fn width_px(&self) -> f32 {
        self.label.width(self.size_px)
    }

    /// Returns the offset from the anchor to the start of the baseline before rotation, in pixels.
    pub(super) fn offset(&self) -> [f32; 2] {
        let capital = CAPITAL * self.size_px;
        let x = match self.anchor {
            HorizontalAlign::Start => 0.0,
            HorizontalAlign::Middle => -0.5 * self.width_px(),
            HorizontalAlign::End => -self.width_px(),
        };
        let y = match self.level {
            VerticalAlign::Baseline => 0.0,
            VerticalAlign::Middle => 0.5 * capital,
            VerticalAlign::Top => capital,
        };
        [x, y]
    }

    /// Returns cosine and sine of the rotation.
    pub(super) fn cos_sin(&self) -> [f32; 2] {
        let angle = f64::from(self.turn_deg) * (std::f64::consts::PI / 180.0);
        #[expect(clippy::cast_possible_truncation, reason = "a direction needs no last digit")]
        [cos(angle), sin(angle)].map(|x| x as f32)
    }

    /// Returns the transform from the frame of the text, whose baseline starts at the origin, to its place:
    /// `[a, b, c, d, e, f]` maps `(x, y)` to `(a x + c y + e, b x + d y + f)`.
    pub(super) fn frame(&self) -> [f32; 6] {
        let ([x, y], [left, down], [c, s]) = (self.at, self.offset(), self.cos_sin());
        [c, s, -s, c, x + c * left - s * down, y + s * left + c * down]
    }

    /// Traces the outlines of the letters in the frame of the text.
    pub(super) fn outline(&self, to: &mut dyn OutlineBuilder) {
        let weight = self.label.weight();
        for piece in self.label.pieces(self.size_px) {
            let scale = piece.size_px / UNITS_PER_EM;
            let [mut x, y] = piece.at;
            for (_, glyph) in self.label.glyphs(piece.text) {
                let mut placed = PlacedGlyph { to: &mut *to, at: [x, y], scale };
                // letters without ink have no outline
                weight.face().outline_glyph(glyph, &mut placed);
                x += weight.advance(glyph) * scale;
            }
        }
    }
}

/// Transforms the outline of a glyph, in design units with y upwards, to its place.
struct PlacedGlyph<'a> {
    to: &'a mut dyn OutlineBuilder,
    at: [f32; 2],
    scale: f32,
}

impl PlacedGlyph<'_> {
    fn place(&self, x: f32, y: f32) -> [f32; 2] {
        [self.at[0] + self.scale * x, self.at[1] - self.scale * y]
    }
}

impl OutlineBuilder for PlacedGlyph<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.place(x, y);
        self.to.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.place(x, y);
        self.to.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ([x1, y1], [x, y]) = (self.place(x1, y1), self.place(x, y));
        self.to.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ([x1, y1], [x2, y2], [x, y]) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.to.curve_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.to.close();
    }
}
