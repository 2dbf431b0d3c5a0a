//! Writes a drawing as SVG.

mod page;

use std::io::{self, Write};

use base64::prelude::{BASE64_STANDARD, Engine};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use ttf_parser::OutlineBuilder;

use super::error::DrawError;
use super::font::{FONT_FAMILIES, FontWeight};
use super::scene::{
    Cap, Discs, Drawing, DrawingItem, Group, HorizontalAlign, Lettering, Mark, Picture, PolylinePoints, Stroke, Text,
};
use crate::watch::Watch;
use page::SvgPage;

/// Writes a drawing as an SVG file. Lengths are rounded to hundredths of a pixel.
///
/// Every text of the drawing is escaped, so that the file holds the elements that are written here and no others.
///
/// # Errors
/// When the watch says stop, the bytes cannot be taken, or a picture is none.
pub fn svg(drawing: &Drawing, lettering: Lettering, out: &mut dyn Write, watch: &Watch) -> Result<(), DrawError> {
    let mut page = SvgPage::new(out);
    let [width, height] = drawing.size;
    page.text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n"
    );
    page.title(&drawing.title);
    if drawing.background[3] > 0 {
        page.text += "<rect width=\"100%\" height=\"100%\"";
        page.color("fill", drawing.background);
        page.text += "/>\n";
    }
    SvgWriter { page: &mut page, lettering, watch, n_clips: 0 }.items(&drawing.items)?;
    page.text += "</svg>\n";
    page.flush()?;
    Ok(())
}

/// Writes the items.
struct SvgWriter<'a, 'b> {
    page: &'a mut SvgPage<'b>,
    lettering: Lettering,
    watch: &'a Watch,
    /// Number of clips written so far; each clip is named by its index.
    n_clips: usize,
}

impl SvgWriter<'_, '_> {
    fn items(&mut self, items: &[DrawingItem]) -> Result<(), DrawError> {
        for item in items {
            self.watch.check()?;
            self.page.text += "<g";
            if !item.class.is_empty() {
                self.page.text += " class=\"";
                self.page.escaped(item.class);
                self.page.text += "\"";
            }
            match &item.mark {
                Mark::Lines(runs, stroke) => {
                    self.stroke(stroke);
                    self.head(item);
                    self.paths(runs)?;
                }
                Mark::Areas(outlines, color) => {
                    self.page.color("fill", *color);
                    self.head(item);
                    self.page.text += "<path fill-rule=\"evenodd\" d=\"";
                    for outline in outlines {
                        self.watch.check()?;
                        self.page.run(outline);
                        self.page.text += "Z";
                        self.page.flush()?;
                    }
                    self.page.text += "\"/>\n";
                }
                Mark::Discs(discs) => self.discs(discs, item)?,
                Mark::Text(text) => {
                    self.page.color("fill", text.color);
                    self.head(item);
                    self.text(text);
                }
                Mark::Picture(picture) => {
                    self.head(item);
                    self.picture(picture)?;
                }
                Mark::Group(group) => self.group(group, item)?,
            }
            self.page.text += "</g>\n";
            self.page.flush()?;
        }
        Ok(())
    }

    /// Ends the head of an item and says what it is.
    fn head(&mut self, item: &DrawingItem) {
        self.page.text += ">\n";
        self.page.title(&item.title);
    }

    fn stroke(&mut self, stroke: &Stroke) {
        let page = &mut *self.page;
        page.text += " fill=\"none\" stroke-linejoin=\"round\"";
        if stroke.cap == Cap::Round {
            page.text += " stroke-linecap=\"round\"";
        }
        page.color("stroke", stroke.color);
        page.number(" stroke-width=\"", stroke.width_px);
        for (i, length) in stroke.dash.iter().enumerate() {
            page.number(if i == 0 { "\" stroke-dasharray=\"" } else { " " }, *length);
        }
        page.text += "\"";
    }

    fn paths(&mut self, runs: &[PolylinePoints]) -> Result<(), DrawError> {
        for run in runs {
            self.watch.check()?;
            self.page.text += "<path d=\"";
            self.page.run(run);
            self.page.text += "\"/>\n";
            self.page.flush()?;
        }
        Ok(())
    }

    fn discs(&mut self, discs: &Discs, item: &DrawingItem) -> Result<(), DrawError> {
        self.page.color("fill", discs.color);
        if discs.ring_px > 0.0 {
            self.page.color("stroke", discs.ring);
            self.page.number(" stroke-width=\"", discs.ring_px);
            self.page.text += "\"";
        }
        self.head(item);
        for [x, y] in &discs.centres {
            self.page.number("<circle cx=\"", *x);
            self.page.number("\" cy=\"", *y);
            self.page.number("\" r=\"", discs.radius_px - 0.5 * discs.ring_px);
            self.page.text += "\"/>\n";
            if self.page.is_long() {
                self.watch.check()?;
                self.page.flush()?;
            }
        }
        Ok(())
    }

    fn text(&mut self, text: &Text) {
        match self.lettering {
            Lettering::Text => self.letters(text),
            Lettering::Outlines => self.outlines(text),
        }
    }

    /// Each piece starts where the bundled font has it start. A label of one piece also keeps its anchor, so that it
    /// stays in the middle with another font.
    #[expect(clippy::float_cmp, reason = "pieces that are not smaller have the very size of the text")]
    fn letters(&mut self, text: &Text) {
        let page = &mut *self.page;
        page.text += "<text font-family=\"";
        page.text += FONT_FAMILIES;
        page.number("\" font-size=\"", text.size_px);
        if text.label.weight() == FontWeight::Bold {
            page.text += "\" font-weight=\"bold";
        }
        let [left, down] = text.offset();
        let single = text.label.pieces(text.size_px).count() == 1;
        let anchor = match text.anchor {
            HorizontalAlign::Middle if single => Some("middle"),
            HorizontalAlign::End if single => Some("end"),
            _ => None,
        };
        if let Some(anchor) = anchor {
            page.text += "\" text-anchor=\"";
            page.text += anchor;
        }
        let left = if anchor.is_some() { 0.0 } else { left };
        let origin = if text.turn_deg == 0.0 { text.at } else { [0.0; 2] };
        if text.turn_deg != 0.0 {
            page.point("\" transform=\"translate(", text.at);
            page.number(") rotate(", text.turn_deg);
            page.text += ")";
        }
        page.text += "\">";
        for piece in text.label.pieces(text.size_px) {
            // white space at the start of a piece is not kept by viewers
            let shown = piece.text.trim_start_matches(' ');
            let skipped = text.label.width_of(&piece.text[..piece.text.len() - shown.len()], piece.size_px);
            page.number("<tspan x=\"", origin[0] + left + piece.at[0] + skipped);
            page.number("\" y=\"", origin[1] + down + piece.at[1]);
            if piece.size_px != text.size_px {
                page.number("\" font-size=\"", piece.size_px);
            }
            page.text += "\">";
            page.escaped(shown);
            page.text += "</tspan>";
        }
        page.text += "</text>\n";
    }

    fn outlines(&mut self, text: &Text) {
        self.page.text += "<path";
        let [a, b, _, _, x, y] = text.frame();
        self.page.point(" transform=\"translate(", [x, y]);
        self.page.text += ")";
        if b != 0.0 || a < 0.0 {
            self.page.number(" rotate(", text.turn_deg);
            self.page.text += ")";
        }
        self.page.text += "\" d=\"";
        text.outline(&mut SvgContours(self.page));
        self.page.text += "\"/>\n";
    }

    fn picture(&mut self, picture: &Picture) -> Result<(), DrawError> {
        let [columns, rows] = picture.size;
        let mut png = Vec::new();
        PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Adaptive)
            .write_image(&picture.pixels, columns, rows, ExtendedColorType::Rgba8)
            .map_err(|error| DrawError::Io(io::Error::other(error)))?;
        let page = &mut *self.page;
        page.number("<image x=\"", picture.at[0]);
        page.number("\" y=\"", picture.at[1]);
        page.number("\" width=\"", picture.extent[0]);
        page.number("\" height=\"", picture.extent[1]);
        page.text += "\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,";
        BASE64_STANDARD.encode_string(&png, &mut page.text);
        page.text += "\"/>\n";
        Ok(())
    }

    fn group(&mut self, group: &Group, item: &DrawingItem) -> Result<(), DrawError> {
        let page = &mut *self.page;
        page.point(" transform=\"translate(", group.shift);
        page.text += ")";
        #[expect(clippy::float_cmp, reason = "any other scale is written")]
        let scaled = group.scale != 1.0;
        if scaled {
            page.precise(" scale(", group.scale);
            page.text += ")";
        }
        page.text += "\"";
        if let Some([x, y, width, height]) = group.clip {
            let name = format!("clip{}", self.n_clips);
            self.n_clips += 1;
            for part in [" clip-path=\"url(#", &name, ")\"><clipPath id=\"", &name, "\""] {
                page.text += part;
            }
            page.number("><rect x=\"", x);
            page.number("\" y=\"", y);
            page.number("\" width=\"", width);
            page.number("\" height=\"", height);
            page.text += "\"/></clipPath";
        }
        self.head(item);
        self.items(&group.items)
    }
}

/// Writes the outlines of letters as path commands.
struct SvgContours<'a, 'b>(&'a mut SvgPage<'b>);

impl OutlineBuilder for SvgContours<'_, '_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.point("M", [x, y]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.point("L", [x, y]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.point("Q", [x1, y1]);
        self.0.point(" ", [x, y]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.point("C", [x1, y1]);
        self.0.point(" ", [x2, y2]);
        self.0.point(" ", [x, y]);
    }

    fn close(&mut self) {
        self.0.text += "Z";
    }
}
