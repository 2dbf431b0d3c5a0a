//! The bundled font: `DejaVu` Sans, which has Latin, Greek, Cyrillic and mathematical signs.
//!
//! It is free to use, to embed and to pass on (licences of Bitstream Vera and Arev). The font of the machine is never
//! looked at, so that a drawing is the same everywhere.

use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId};

/// The weight of letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FontWeight {
    /// For everything else.
    Regular,
    /// For titles and the letters of panels.
    Bold,
}

/// All weights.
pub(super) const FONT_WEIGHTS: [FontWeight; 2] = [FontWeight::Regular, FontWeight::Bold];

/// Families for viewers of SVG: the font itself, then those with letters of much the same widths.
pub(super) const FONT_FAMILIES: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

/// Units of the design of both weights along the side of the square that holds an M.
pub(super) const UNITS_PER_EM: f32 = 2048.0;
/// Height of a capital letter relative to the font size; 1493 units in both weights.
pub(super) const CAPITAL: f32 = 1493.0 / UNITS_PER_EM;
/// Height of letters above the baseline, relative to the font size.
pub const ASCENT: f32 = 0.93;
/// Depth of letters below the baseline, relative to the font size.
pub const DESCENT: f32 = 0.24;

impl FontWeight {
    /// Returns the bytes of the font file.
    pub(super) fn bytes(self) -> &'static [u8] {
        match self {
            Self::Regular => dejavu::sans::regular(),
            Self::Bold => dejavu::sans::bold(),
        }
    }

    /// Returns the font, which is parsed once.
    pub(super) fn face(self) -> &'static Face<'static> {
        static FACES: [OnceLock<Face<'static>>; 2] = [OnceLock::new(), OnceLock::new()];
        FACES[self as usize].get_or_init(|| Face::parse(self.bytes(), 0).expect("the bundled font is a font"))
    }

    /// Returns the glyph of a character that can be set. Letters that their script joins, reverses or stacks, and
    /// combining marks, cannot be set.
    pub(super) fn glyph(self, c: char) -> Option<GlyphId> {
        let plain = SETTABLE.iter().any(|range| range.contains(&c));
        self.face().glyph_index(c).filter(|_| plain)
    }

    /// Returns the advance width of a glyph, in design units.
    pub(super) fn advance(self, glyph: GlyphId) -> f32 {
        f32::from(self.face().glyph_hor_advance(glyph).unwrap_or(0))
    }

    /// Returns the name in PDF.
    pub(super) fn postscript_name(self) -> &'static str {
        match self {
            Self::Regular => "DejaVuSans",
            Self::Bold => "DejaVuSans-Bold",
        }
    }
}

/// Characters that are set one after another from left to right: Latin, Greek, Cyrillic, punctuation, signs.
const SETTABLE: &[std::ops::RangeInclusive<char>] = &[
    ' '..='~',
    '\u{a0}'..='\u{ac}',
    '\u{ae}'..='\u{2ff}',
    '\u{370}'..='\u{482}',
    '\u{48a}'..='\u{52f}',
    '\u{1d00}'..='\u{1dbf}',
    '\u{1e00}'..='\u{200a}',
    '\u{2010}'..='\u{2027}',
    '\u{2030}'..='\u{205e}',
    '\u{2070}'..='\u{20bf}',
    '\u{2100}'..='\u{2bff}',
];
