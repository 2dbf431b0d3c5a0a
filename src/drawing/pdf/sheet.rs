//! The content of the page: its drawing operators, and the resources that they refer to.

use std::collections::BTreeSet;

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Name, Str};
use ttf_parser::OutlineBuilder;

use super::fonts::PdfFont;
use crate::drawing::error::DrawError;
use crate::drawing::scene::{
    Cap, Color, Discs, Drawing, DrawingItem, Group, Lettering, Mark, Picture, Point, Stroke, Text,
};
use crate::watch::Watch;

/// Points per pixel: 96 pixels and 72 points are an inch.
pub(super) const POINTS_A_PIXEL: f32 = 0.75;

/// The content of the page, with the resources that it needs.
pub(super) struct PdfPage<'a> {
    /// The drawing operators.
    pub(super) content: Content,
    /// The pictures, by index.
    pub(super) pictures: Vec<&'a Picture>,
    /// The opacities other than fully opaque.
    pub(super) alphas: BTreeSet<u8>,
    /// The weights of the font.
    pub(super) fonts: [PdfFont; 2],
    lettering: Lettering,
    watch: &'a Watch,
}

/// Returns the name of a picture within the page.
pub(super) fn picture_name(i: usize) -> String {
    format!("I{i}")
}

/// Returns the name of an opacity within the page.
pub(super) fn alpha_name(alpha: u8) -> String {
    format!("A{alpha}")
}

impl<'a> PdfPage<'a> {
    /// Draws all items.
    pub(super) fn of(drawing: &'a Drawing, lettering: Lettering, watch: &'a Watch) -> Result<Self, DrawError> {
        let mut page = Self {
            content: Content::new(),
            pictures: Vec::new(),
            alphas: BTreeSet::new(),
            fonts: PdfFont::all(),
            lettering,
            watch,
        };
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
        let [width, height] = drawing.size.map(|side| side as f32);
        page.content.transform([POINTS_A_PIXEL, 0.0, 0.0, -POINTS_A_PIXEL, 0.0, POINTS_A_PIXEL * height]);
        page.content.set_line_join(LineJoinStyle::RoundJoin);
        if drawing.background[3] > 0 {
            page.filled(drawing.background, |content| {
                content.rect(0.0, 0.0, width, height);
            });
        }
        page.items(&drawing.items)?;
        Ok(page)
    }
}

/// Rounds a length to hundredths of a pixel, to keep the file short.
fn short(x: f32) -> f32 {
    (x * 100.0).round() / 100.0
}

impl<'a> PdfPage<'a> {
    fn items(&mut self, items: &'a [DrawingItem]) -> Result<(), DrawError> {
        for item in items {
            self.watch.check()?;
            self.content.save_state();
            match &item.mark {
                Mark::Lines(runs, stroke) => self.lines(runs, stroke)?,
                Mark::Areas(outlines, color) => self.areas(outlines, *color)?,
                Mark::Discs(discs) => self.discs(discs)?,
                Mark::Text(text) => self.text(text),
                Mark::Picture(picture) => self.picture(picture),
                Mark::Group(group) => self.group(group)?,
            }
            self.content.restore_state();
        }
        Ok(())
    }

    fn alpha(&mut self, alpha: u8) {
        if alpha < 255 {
            self.alphas.insert(alpha);
            self.content.set_parameters(Name(alpha_name(alpha).as_bytes()));
        }
    }

    fn fill_color(&mut self, [r, g, b, a]: Color) {
        let [r, g, b] = [r, g, b].map(share);
        self.content.set_fill_rgb(r, g, b);
        self.alpha(a);
    }

    fn stroke_color(&mut self, [r, g, b, a]: Color) {
        let [r, g, b] = [r, g, b].map(share);
        self.content.set_stroke_rgb(r, g, b);
        self.alpha(a);
    }

    /// Fills the path that `trace` traces.
    fn filled(&mut self, color: Color, trace: impl FnOnce(&mut Content)) {
        self.content.save_state();
        self.fill_color(color);
        trace(&mut self.content);
        self.content.fill_nonzero().restore_state();
    }

    fn trace(&mut self, run: &[Point]) {
        for (i, [x, y]) in run.iter().map(|p| p.map(short)).enumerate() {
            if i == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn lines(&mut self, runs: &[Vec<Point>], stroke: &Stroke) -> Result<(), DrawError> {
        self.stroke_color(stroke.color);
        self.content.set_line_width(short(stroke.width_px));
        if stroke.cap == Cap::Round {
            self.content.set_line_cap(LineCapStyle::RoundCap);
        }
        if !stroke.dash.is_empty() {
            self.content.set_dash_pattern(stroke.dash.iter().map(|x| short(*x)), 0.0);
        }
        for run in runs {
            self.watch.check()?;
            self.trace(run);
            self.content.stroke();
        }
        Ok(())
    }

    fn areas(&mut self, outlines: &[Vec<Point>], color: Color) -> Result<(), DrawError> {
        self.fill_color(color);
        for outline in outlines {
            self.watch.check()?;
            self.trace(outline);
            self.content.close_path();
        }
        // a path without points ends here as well
        if outlines.iter().any(|outline| !outline.is_empty()) {
            self.content.fill_even_odd();
        }
        Ok(())
    }

    /// Draws discs; a translucent ring is drawn around the disc, since it would show the disc below it.
    fn discs(&mut self, discs: &Discs) -> Result<(), DrawError> {
        self.fill_color(discs.color);
        self.stroke_color(discs.ring);
        self.content.set_line_width(short(discs.ring_px));
        for (i, centre) in discs.centres.iter().enumerate() {
            if i % 1024 == 0 {
                self.watch.check()?;
            }
            circle(&mut self.content, *centre, discs.radius_px - 0.5 * discs.ring_px);
            if discs.ring_px > 0.0 {
                self.content.fill_nonzero_and_stroke();
            } else {
                self.content.fill_nonzero();
            }
        }
        Ok(())
    }

    fn text(&mut self, text: &Text) {
        self.fill_color(text.color);
        let frame = text.frame();
        if self.lettering == Lettering::Outlines {
            self.content.transform(frame);
            text.outline(&mut PdfContours { content: &mut self.content, at: [0.0; 2] });
            self.content.fill_nonzero();
            return;
        }
        let [a, b, c, d, e, f] = frame;
        let font = &mut self.fonts[text.label.weight() as usize];
        self.content.begin_text();
        for piece in text.label.pieces(text.size_px) {
            let [x, y] = piece.at;
            let bytes: Vec<u8> =
                text.label.glyphs(piece.text).flat_map(|(c, glyph)| font.number(c, glyph).to_be_bytes()).collect();
            self.content
                .set_font(Name(font.name()), piece.size_px)
                // the letters of fonts stand upright where y points upwards
                .set_text_matrix([a, b, -c, -d, a * x + c * y + e, b * x + d * y + f])
                .show(Str(&bytes));
        }
        self.content.end_text();
    }

    fn picture(&mut self, picture: &'a Picture) {
        let ([x, y], [width, height]) = (picture.at, picture.extent);
        let name = picture_name(self.pictures.len());
        self.content.transform([width, 0.0, 0.0, -height, x, y + height]).x_object(Name(name.as_bytes()));
        self.pictures.push(picture);
    }

    fn group(&mut self, group: &'a Group) -> Result<(), DrawError> {
        let [x, y] = group.shift;
        self.content.transform([group.scale, 0.0, 0.0, group.scale, x, y]);
        if let Some([x, y, width, height]) = group.clip {
            self.content.rect(x, y, width, height).clip_nonzero().end_path();
        }
        self.items(&group.items)
    }
}

/// Returns a colour byte as a fraction with few digits.
fn share(byte: u8) -> f32 {
    (f32::from(byte) / 255.0 * 10_000.0).round() / 10_000.0
}

/// Distance of the inner control points of a cubic quarter circle from its ends, in radii: `4 (sqrt 2 - 1) / 3`.
const QUARTER: f32 = 0.552_284_8;

fn circle(content: &mut Content, [x, y]: Point, radius: f32) {
    let k = QUARTER * radius;
    let at = |dx: f32, dy: f32| [short(x + dx), short(y + dy)];
    let right = at(radius, 0.0);
    content.move_to(right[0], right[1]);
    let quarters = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]];
    for pair in quarters.windows(2) {
        let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
        let [x1, y1] = at(radius * ax + k * bx, radius * ay + k * by);
        let [x2, y2] = at(radius * bx + k * ax, radius * by + k * ay);
        let [x3, y3] = at(radius * bx, radius * by);
        content.cubic_to(x1, y1, x2, y2, x3, y3);
    }
    content.close_path();
}

/// Writes the outlines of letters as operators; PDF has cubic curves only.
struct PdfContours<'a> {
    content: &'a mut Content,
    at: Point,
}

impl OutlineBuilder for PdfContours<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.at = [x, y].map(short);
        self.content.move_to(self.at[0], self.at[1]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.at = [x, y].map(short);
        self.content.line_to(self.at[0], self.at[1]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let third = |end: f32, inner: f32| short((end + 2.0 * inner) / 3.0);
        let [x0, y0] = self.at;
        self.at = [x, y].map(short);
        self.content.cubic_to(third(x0, x1), third(y0, y1), third(x, x1), third(y, y1), self.at[0], self.at[1]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let [x1, y1, x2, y2, x, y] = [x1, y1, x2, y2, x, y].map(short);
        self.at = [x, y];
        self.content.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.content.close_path();
    }
}
