//! The glyphs of a font that are embedded in a PDF file.

use std::collections::BTreeMap;

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::{GlyphRemapper, subset};
use ttf_parser::GlyphId;

use super::pack::packed;
use crate::drawing::error::DrawError;
use crate::drawing::font::{FONT_WEIGHTS, FontWeight, UNITS_PER_EM};

/// The used glyphs of one weight.
pub(super) struct PdfFont {
    weight: FontWeight,
    /// The indices of glyphs in the file.
    numbers: GlyphRemapper,
    /// The character of each glyph, and its advance width in thousandths of the font size.
    glyphs: BTreeMap<u16, (char, f32)>,
}

const SYSTEM: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

impl PdfFont {
    /// Creates a font of each weight without glyphs.
    pub(super) fn all() -> [Self; 2] {
        FONT_WEIGHTS.map(|weight| Self { weight, numbers: GlyphRemapper::new(), glyphs: BTreeMap::new() })
    }

    pub(super) fn is_used(&self) -> bool {
        !self.glyphs.is_empty()
    }

    /// Returns the name within the page.
    pub(super) fn name(&self) -> &'static [u8] {
        match self.weight {
            FontWeight::Regular => b"F0",
            FontWeight::Bold => b"F1",
        }
    }

    /// Returns the index of a glyph in the file, which embeds it from now on.
    pub(super) fn number(&mut self, c: char, glyph: GlyphId) -> u16 {
        let number = self.numbers.remap(glyph.0);
        let width = self.weight.advance(glyph) * 1000.0 / UNITS_PER_EM;
        self.glyphs.entry(number).or_insert((c, width));
        number
    }

    /// Writes the font as object `id`, with further objects whose ids `next` returns.
    pub(super) fn write(&self, pdf: &mut Pdf, id: Ref, next: &mut dyn FnMut() -> Ref) -> Result<(), DrawError> {
        let [cid, descriptor, file, meanings] = [next(), next(), next(), next()];
        let full = format!("{}+{}", self.tag(), self.weight.postscript_name());
        let name = Name(full.as_bytes());
        pdf.type0_font(id)
            .base_font(name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(meanings);
        let mut font = pdf.cid_font(cid);
        font.subtype(CidFontType::Type2).base_font(name).system_info(SYSTEM).font_descriptor(descriptor);
        font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let mut widths = font.widths();
        for (number, (_, width)) in &self.glyphs {
            widths.consecutive(*number, [*width]);
        }
        widths.finish();
        font.finish();
        self.describe(pdf, [descriptor, file], name);
        let bytes = subset(self.weight.bytes(), 0, &self.numbers)
            .map_err(|error| DrawError::Unfit(format!("the letters of the font cannot be written: {error}")))?;
        pdf.stream(file, &packed(&bytes)?).filter(Filter::FlateDecode);
        let mut map = UnicodeCmap::<u16>::new(Name(b"Adobe-Identity-UCS"), SYSTEM);
        for (number, (c, _)) in &self.glyphs {
            map.pair(*number, *c);
        }
        pdf.cmap(meanings, &packed(&map.finish())?).filter(Filter::FlateDecode);
        Ok(())
    }

    fn describe(&self, pdf: &mut Pdf, [id, file]: [Ref; 2], name: Name<'_>) {
        let face = self.weight.face();
        let thousandths = |units: i16| f32::from(units) * 1000.0 / UNITS_PER_EM;
        let frame = face.global_bounding_box();
        let [left, bottom, right, top] = [frame.x_min, frame.y_min, frame.x_max, frame.y_max].map(thousandths);
        pdf.font_descriptor(id)
            .name(name)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(left, bottom, right, top))
            .italic_angle(0.0)
            .ascent(thousandths(face.ascender()))
            .descent(thousandths(face.descender()))
            .cap_height(thousandths(1493))
            // what viewers take for the width of an upright where they have another font; they have this one
            .stem_v(80.0)
            .font_file2(file);
    }

    /// Returns six letters that distinguish subsets of the font.
    fn tag(&self) -> String {
        let mut rest = self
            .numbers
            .remapped_gids()
            .fold(7_u32, |sum, glyph| sum.wrapping_mul(16_777_619).wrapping_add(u32::from(glyph)));
        let mut letter = || {
            let c = char::from(b'A' + u8::try_from(rest % 26).expect("a letter"));
            rest /= 26;
            c
        };
        (0..6).map(|_| letter()).collect()
    }
}
