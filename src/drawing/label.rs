//! Labels: text with subscripts, superscripts and Greek letters, and the positions of its glyphs.

use ttf_parser::GlyphId;

use super::font::{FontWeight, UNITS_PER_EM};

/// Size of subscripts and superscripts relative to the text. The customary 0.7; half of it is illegible in print.
const SCRIPT_SIZE: f32 = 0.7;
/// Depth of subscripts below the baseline, relative to the text size; twice of it would leave the line.
const LOWERED: f32 = 0.16;
/// Height of superscripts above the baseline, relative to the text size; half of it would hardly look raised.
const RAISED: f32 = 0.36;

/// Text all of whose characters can be set.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    weight: FontWeight,
    pieces: Vec<LetterRun>,
}

/// Letters of one size at one height.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LetterRun {
    pub(super) text: String,
    pub(super) script: Script,
}

/// The vertical position of letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Script {
    /// On the baseline.
    Normal,
    /// A subscript: small, below the baseline.
    Sub,
    /// A superscript: small, above the baseline.
    Super,
}

impl Script {
    /// Returns the size of the letters and their rise, relative to the text size.
    fn scale_and_rise(self) -> (f32, f32) {
        match self {
            Self::Normal => (1.0, 0.0),
            Self::Sub => (SCRIPT_SIZE, -LOWERED),
            Self::Super => (SCRIPT_SIZE, RAISED),
        }
    }
}

/// A piece with its position relative to the start of the baseline, in pixels, y downwards.
#[derive(Debug, Clone)]
pub(super) struct PlacedPiece<'a> {
    pub(super) text: &'a str,
    /// Size of the letters, pixels.
    pub(super) size_px: f32,
    pub(super) at: [f32; 2],
    pub(super) width_px: f32,
}

impl Label {
    /// Text as it is, white space being one space each.
    ///
    /// # Errors
    /// A sentence that names a character which cannot be set.
    pub fn plain(text: &str, weight: FontWeight) -> Result<Self, String> {
        let mut writer = LabelWriter::new(weight);
        text.chars().try_for_each(|c| writer.put(c, Script::Normal))?;
        Ok(writer.label)
    }

    /// Text with markup: `_x` and `_{...}` for subscripts, `^x` and `^{...}` for superscripts, `\alpha` and so on for
    /// Greek letters (which may also be written as they are), `\le`, `\ge`, `\ne`, `\infty`, `\pm`, `\times`, `\cdot`,
    /// `\to` and `\degree` for signs, and `\_`, `\^`, `\{`, `\}` and `\\` for these characters themselves.
    ///
    /// # Errors
    /// A sentence that names what cannot be set or read, and what could be written instead.
    pub fn parse(text: &str, weight: FontWeight) -> Result<Self, String> {
        let mut writer = LabelWriter::new(weight);
        let mut rest = text;
        while let Some(c) = rest.chars().next() {
            let after = &rest[c.len_utf8()..];
            let script = match c {
                '_' => Script::Sub,
                '^' => Script::Super,
                _ => {
                    rest = writer.one(rest, Script::Normal)?;
                    continue;
                }
            };
            rest = match after.strip_prefix('{') {
                None if after.is_empty() => return Err(format!("nothing follows \"{c}\"; write \"\\{c}\" for itself")),
                None => writer.one(after, script)?,
                Some(inside) => {
                    let mut inside = inside;
                    loop {
                        if let Some(rest) = inside.strip_prefix('}') {
                            break rest;
                        }
                        if inside.is_empty() {
                            return Err(format!("\"{c}{{\" is not closed; end it with \"}}\""));
                        }
                        inside = writer.one(inside, script)?;
                    }
                }
            };
        }
        Ok(writer.label)
    }

    /// Returns whether the label is empty.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Returns the weight of the letters.
    pub fn weight(&self) -> FontWeight {
        self.weight
    }

    /// Returns the letters without their vertical positions.
    pub fn text(&self) -> String {
        self.pieces.iter().map(|piece| piece.text.as_str()).collect()
    }

    /// Returns the width at a font size, both in pixels.
    pub fn width(&self, size_px: f32) -> f32 {
        self.pieces(size_px).last().map_or(0.0, |piece| piece.at[0] + piece.width_px)
    }

    /// Returns the pieces with their positions.
    pub(super) fn pieces(&self, size_px: f32) -> impl Iterator<Item = PlacedPiece<'_>> {
        let mut x = 0.0;
        self.pieces.iter().map(move |piece| {
            let (scale, rise) = piece.script.scale_and_rise();
            let (size, at) = (scale * size_px, [x, -rise * size_px]);
            let width_px = self.width_of(&piece.text, size);
            x += width_px;
            PlacedPiece { text: &piece.text, size_px: size, at, width_px }
        })
    }

    /// Returns the width of some letters at a size, both in pixels.
    pub(super) fn width_of(&self, text: &str, size_px: f32) -> f32 {
        let units: f32 = self.glyphs(text).map(|(_, glyph)| self.weight.advance(glyph)).sum();
        units * size_px / UNITS_PER_EM
    }

    /// Returns the characters of a piece with their glyphs.
    pub(super) fn glyphs(&self, text: &str) -> impl Iterator<Item = (char, GlyphId)> {
        text.chars().filter_map(|c| Some((c, self.weight.glyph(c)?)))
    }
}

/// Signs before and after which a line does not end, so that equations stay whole.
const RELATION_SIGNS: [&str; 20] = [
    "=", "<", ">", "+", "-", "\u{2212}", "\\le", "\\ge", "\\ne", "\\pm", "\\times", "\\cdot", "\\to", "\u{2264}",
    "\u{2265}", "\u{2260}", "\u{b1}", "\u{d7}", "\u{b7}", "\u{2192}",
];

/// Breaks text into lines no wider than `width_px` at a size of the font. A line ends between words; an equation is one
/// word as long as it fits into a line. Each line is markup of its own, so markup that holds a space stays on one line.
///
/// # Errors
/// A sentence that names what cannot be set or read, or the word that is wider than a line, and what could be written
/// instead.
pub fn wrapped(text: &str, weight: FontWeight, size_px: f32, width_px: f32) -> Result<Vec<Label>, String> {
    let mut lines: Vec<Label> = Vec::new();
    let mut line = String::new();
    let fits = |text: &str| Ok::<_, String>(Label::parse(text, weight)?.width(size_px) <= width_px);
    let mut units = Vec::new();
    for unit in equations(text) {
        if fits(&unit)? { units.push(unit) } else { units.extend(words(&unit).map(str::to_owned)) }
    }
    for word in units {
        let longer = if line.is_empty() { word.clone() } else { format!("{line} {word}") };
        if fits(&longer)? {
            line = longer;
            continue;
        }
        if !fits(&word)? {
            let shown: String = word.chars().take(24).collect();
            let detail =
                format!("\"{shown}\" is wider than a line of {width_px} pixels; put spaces into it, or ask for a");
            return Err(format!("{detail} greater width or for fewer columns"));
        }
        lines.push(Label::parse(&line, weight)?);
        line = word;
    }
    if !line.is_empty() {
        lines.push(Label::parse(&line, weight)?);
    }
    Ok(lines)
}

/// Returns the words, those of an equation as one.
fn equations(text: &str) -> Vec<String> {
    let mut units: Vec<String> = Vec::new();
    let mut joins = false;
    for word in words(text) {
        let is_relation = RELATION_SIGNS.contains(&word);
        match units.last_mut() {
            Some(last) if joins || is_relation => {
                last.push(' ');
                last.push_str(word);
            }
            _ => units.push(word.to_owned()),
        }
        joins = is_relation;
    }
    units
}

/// Returns the parts between spaces outside braces.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_usize;
    text.split(move |c: char| {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && c.is_whitespace()
    })
    .filter(|word| !word.is_empty())
}

/// Appends letters to a label.
struct LabelWriter {
    label: Label,
}

impl LabelWriter {
    fn new(weight: FontWeight) -> Self {
        Self { label: Label { weight, pieces: Vec::new() } }
    }

    /// Appends the character or command at the start of `text`, which is not empty, and returns the rest.
    fn one<'a>(&mut self, text: &'a str, script: Script) -> Result<&'a str, String> {
        let Some(command) = text.strip_prefix('\\') else {
            let c = text.chars().next().unwrap_or(' ');
            self.put(c, script)?;
            return Ok(&text[c.len_utf8()..]);
        };
        let end = command.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(command.len());
        if end == 0 {
            let c = command.chars().next().filter(|c| "_^{}\\".contains(*c));
            let c = c.ok_or("a lone \"\\\"; write \"\\\\\" for the character itself")?;
            self.put(c, script)?;
            return Ok(&command[1..]);
        }
        let (name, rest) = command.split_at(end);
        let c = sign(name).ok_or_else(|| {
            let name: String = name.chars().take(24).collect();
            let signs = "le, ge, ne, infty, pm, times, cdot, to, degree";
            format!("\"\\{name}\" is unknown; known are the Greek letters and {signs}")
        })?;
        self.put(c, script)?;
        Ok(rest)
    }

    fn put(&mut self, c: char, script: Script) -> Result<(), String> {
        let c = if c.is_whitespace() && c != '\u{a0}' { ' ' } else { c };
        let Label { weight, pieces } = &mut self.label;
        if weight.glyph(c).is_none() {
            let (shown, number) = (c.escape_debug(), u32::from(c));
            let known = "the font has Latin, Greek, Cyrillic and mathematical signs";
            return Err(format!("the character \"{shown}\" (U+{number:04X}) cannot be set; {known}"));
        }
        match pieces.last_mut().filter(|last| last.script == script) {
            Some(last) if c == ' ' && last.text.ends_with(' ') => {}
            Some(last) => last.text.push(c),
            None => pieces.push(LetterRun { text: c.into(), script }),
        }
        Ok(())
    }
}

/// Returns the character of a command.
fn sign(name: &str) -> Option<char> {
    SIGNS.iter().find(|(known, _)| *known == name).map(|(_, c)| *c)
}

const SIGNS: &[(&str, char)] = &[
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("omicron", 'ο'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
    ("le", '≤'),
    ("ge", '≥'),
    ("ne", '≠'),
    ("infty", '∞'),
    ("pm", '±'),
    ("times", '×'),
    ("cdot", '·'),
    ("to", '→'),
    ("degree", '°'),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<(String, Script)>, String> {
        let label = Label::parse(text, FontWeight::Regular)?;
        Ok(label.pieces.into_iter().map(|piece| (piece.text, piece.script)).collect())
    }

    #[test]
    fn markup_raises_lowers_and_names_letters() {
        let piece = |text: &str, script| (text.to_owned(), script);
        let expected = [
            piece("α", Script::Normal),
            piece("i+1", Script::Sub),
            piece(" = x", Script::Normal),
            piece("2", Script::Super),
        ];
        assert_eq!(parse(r"\alpha_{i+1} = x^2"), Ok(expected.to_vec()));
        assert_eq!(parse(r"a\_b\^c\\"), Ok(vec![piece(r"a_b^c\", Script::Normal)]));
        assert_eq!(parse("a  \n b"), Ok(vec![piece("a b", Script::Normal)]));
    }

    #[test]
    fn what_cannot_be_set_is_named() {
        for (text, part) in [
            ("a_", "nothing follows \"_\""),
            ("a^{2", "is not closed"),
            (r"\alfa", r"\alfa"),
            ("日", "U+65E5"),
            ("a\u{301}", "U+0301"),
            ("\u{202e}", "U+202E"),
            ("\u{0}", "U+0000"),
            ("שלום", "U+05E9"),
        ] {
            let error = parse(text).expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "at this size advances are whole numbers")]
    fn widths_are_sums_of_advances() {
        let width = |text: &str| Label::parse(text, FontWeight::Regular).expect("it can be set").width(2048.0);
        assert_eq!(width("M"), 1767.0);
        assert_eq!(width("MM"), 3534.0);
        assert_eq!(width("M^M"), 1767.0 + SCRIPT_SIZE * 1767.0);
        assert_eq!(width(""), 0.0);
    }

    #[test]
    fn lines_are_broken_between_words_that_do_not_fit() {
        let lines = wrapped("aa bb  x^{1 2} dd", FontWeight::Regular, 10.0, 32.0).expect("it can be set");
        let lines: Vec<String> = lines.iter().map(Label::text).collect();
        assert_eq!(lines, ["aa bb", "x1 2", "dd"]);
        assert!(wrapped("", FontWeight::Bold, 10.0, 1.0).expect("nothing can be set").is_empty());
    }

    #[test]
    fn equations_stay_whole_where_they_fit_and_words_never_leave_a_line() {
        let lines = |width| {
            let lines = wrapped(r"f, \alpha = 2, b", FontWeight::Regular, 10.0, width)?;
            Ok::<_, String>(lines.iter().map(Label::text).collect::<Vec<_>>())
        };
        assert_eq!(lines(50.0), Ok(vec!["f, α = 2,".to_owned(), "b".to_owned()]));
        assert_eq!(lines(36.0), Ok(vec!["f,".to_owned(), "α = 2,".to_owned(), "b".to_owned()]));
        assert_eq!(lines(24.0), Ok(vec!["f, α".to_owned(), "= 2,".to_owned(), "b".to_owned()]));
        let error = wrapped("aaaaaaaa", FontWeight::Regular, 10.0, 20.0).expect_err("it is too wide");
        assert!(error.contains("\"aaaaaaaa\" is wider than a line"), "{error}");
    }
}
