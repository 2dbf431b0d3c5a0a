//! A buffer for the text of an SVG file.

use std::io::{self, Write};

use crate::drawing::scene::{Color, Point};

/// Number of characters buffered before they are written; twice as many take memory, half as many more calls.
const BUFFERED_CHARS: usize = 65_536;

/// Text to be written.
pub(super) struct SvgPage<'a> {
    pub(super) text: String,
    out: &'a mut dyn Write,
}

impl<'a> SvgPage<'a> {
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self { text: String::new(), out }
    }

    /// Returns whether the buffer should be written.
    pub(super) fn is_long(&self) -> bool {
        self.text.len() > BUFFERED_CHARS
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(self.text.as_bytes())?;
        self.text.clear();
        Ok(())
    }

    /// Appends text between tags or in an attribute, escaped. Characters that XML cannot hold become U+FFFD.
    pub(super) fn escaped(&mut self, text: &str) {
        for c in text.chars() {
            match c {
                '<' => self.text += "&lt;",
                '>' => self.text += "&gt;",
                '&' => self.text += "&amp;",
                '"' => self.text += "&quot;",
                '\'' => self.text += "&#39;",
                '\t' | '\n' | '\r' => self.text.push(' '),
                '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => self.text.push('\u{fffd}'),
                c => self.text.push(c),
            }
        }
    }

    pub(super) fn title(&mut self, title: &str) {
        if !title.is_empty() {
            self.text += "<title>";
            self.escaped(title);
            self.text += "</title>\n";
        }
    }

    pub(super) fn run(&mut self, run: &[Point]) {
        for (i, point) in run.iter().enumerate() {
            let before = match i {
                0 => "M",
                1 => "L",
                _ => " ",
            };
            self.point(before, *point);
        }
    }

    pub(super) fn color(&mut self, name: &str, [r, g, b, a]: Color) {
        for part in [" ", name, "=\"#"] {
            self.text.push_str(part);
        }
        for digit in [r >> 4, r & 15, g >> 4, g & 15, b >> 4, b & 15] {
            self.text.push(char::from(b"0123456789abcdef"[usize::from(digit)]));
        }
        self.text.push('"');
        if a < 255 {
            self.number(&format!(" {name}-opacity=\""), f32::from(a) / 255.0);
            self.text.push('"');
        }
    }

    /// Appends `before`, then the two coordinates, rounded to hundredths.
    pub(super) fn point(&mut self, before: &str, [x, y]: Point) {
        self.number(before, x);
        self.number(" ", y);
    }

    /// Appends `before`, then the value rounded to hundredths, without trailing zeros.
    pub(super) fn number(&mut self, before: &str, value: f32) {
        self.digits(before, value, 2);
    }

    /// Appends `before`, then the value rounded to millionths, without trailing zeros.
    pub(super) fn precise(&mut self, before: &str, value: f32) {
        self.digits(before, value, 6);
    }

    fn digits(&mut self, before: &str, value: f32, n_digits: u32) {
        self.text.push_str(before);
        let unit = 10_u64.pow(n_digits);
        #[expect(clippy::cast_precision_loss, reason = "a small power of ten")]
        let scaled = f64::from(value) * unit as f64;
        #[expect(clippy::cast_possible_truncation, reason = "places lie within some thousand pixels")]
        let rounded = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i64;
        if rounded < 0 {
            self.text.push('-');
        }
        let (whole, mut rest) = (rounded.unsigned_abs() / unit, rounded.unsigned_abs() % unit);
        self.text.push_str(itoa::Buffer::new().format(whole));
        let mut place = unit / 10;
        if rest > 0 {
            self.text.push('.');
        }
        while rest > 0 {
            self.text.push(char::from(b'0' + u8::try_from(rest / place).expect("a digit")));
            rest %= place;
            place /= 10;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl Fn(&mut SvgPage<'_>)) -> String {
        let mut out = Vec::new();
        let mut page = SvgPage::new(&mut out);
        write(&mut page);
        page.text
    }

    #[test]
    fn numbers_have_hundredths_and_no_needless_digits() {
        let text = written(|page| {
            for value in [0.0, 0.004, 1.5, -0.25, 10.05, -2048.996, 8192.0] {
                page.number(" ", value);
            }
            page.precise(" ", 1.0 / 3.0);
        });
        assert_eq!(text, " 0 0 1.5 -0.25 10.05 -2049 8192 0.333333");
    }

    #[test]
    fn texts_cannot_leave_their_element() {
        let text = written(|page| page.escaped("</text><script>'\"&\u{1}\n"));
        assert_eq!(text, "&lt;/text&gt;&lt;script&gt;&#39;&quot;&amp;\u{fffd} ");
    }
}
