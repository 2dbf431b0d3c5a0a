//! The tokens of USD as text. Source: Pixar, `OpenUSD` 26.11, `pxr/usd/sdf/usda.peg`, as far as its grammar goes.

use crate::input::text::{at_line, quoted};

/// A token; marks are single characters such as brackets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum UsdaToken<'a> {
    /// An identifier with its namespaces, or a keyword.
    Word(&'a str),
    /// A number, which may be infinite or NaN.
    Number(f64),
    /// A quoted string, with its escapes unresolved.
    Text(&'a str),
    /// A path, from between `<` and `>`.
    Path(&'a str),
    /// A reference to a file, between `@`.
    Asset,
    Mark(u8),
    End,
}

/// The tokens of a text, in order.
#[derive(Debug, Clone)]
pub(super) struct Tokens<'a> {
    text: &'a str,
    /// Number of bytes read.
    at: usize,
    /// The byte offset of the last token.
    start: usize,
    peeked: Option<UsdaToken<'a>>,
}

impl<'a> Tokens<'a> {
    /// Creates the tokens of a text.
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, at: 0, start: 0, peeked: None }
    }

    /// Formats a fault at the last token.
    pub(super) fn fault(&self, detail: impl std::fmt::Display) -> String {
        let lines = self.text[..self.start].matches('\n').count();
        at_line(lines + 1, detail)
    }

    /// Returns the next token without consuming it.
    ///
    /// # Errors
    /// The errors of [`next`](Self::next).
    pub(super) fn peek(&mut self) -> Result<UsdaToken<'a>, String> {
        if self.peeked.is_none() {
            self.peeked = Some(self.read()?);
        }
        Ok(self.peeked.unwrap_or(UsdaToken::End))
    }

    /// Returns the next token.
    ///
    /// # Errors
    /// A character begins no token, or a token does not end.
    pub(super) fn next(&mut self) -> Result<UsdaToken<'a>, String> {
        match self.peeked.take() {
            Some(token) => Ok(token),
            None => self.read(),
        }
    }

    /// Consumes a mark if it is the next token.
    ///
    /// # Errors
    /// The errors of [`next`](Self::next).
    pub(super) fn takes(&mut self, mark: u8) -> Result<bool, String> {
        let is_next = self.peek()? == UsdaToken::Mark(mark);
        if is_next {
            self.peeked = None;
        }
        Ok(is_next)
    }

    /// Consumes a mark.
    ///
    /// # Errors
    /// The next token is another one.
    pub(super) fn expect(&mut self, mark: u8) -> Result<(), String> {
        if self.takes(mark)? { Ok(()) } else { Err(self.unexpected(char::from(mark))) }
    }

    /// Formats a fault that names what was expected in place of the last token.
    pub(super) fn unexpected(&self, expected: impl std::fmt::Display) -> String {
        let found = self.text[self.start..].lines().next().unwrap_or_default();
        let found = if found.is_empty() { "the end".to_owned() } else { quoted(found) };
        self.fault(format!("{found} stands where {expected} should"))
    }

    fn read(&mut self) -> Result<UsdaToken<'a>, String> {
        self.pass_blanks()?;
        self.start = self.at;
        let rest = &self.text[self.at..];
        let Some(first) = rest.chars().next() else { return Ok(UsdaToken::End) };
        match first {
            '"' | '\'' => self.quoted(if first == '"' { ["\"\"\"", "\""] } else { ["'''", "'"] }),
            '<' => self.between("<", ">").map(UsdaToken::Path),
            '@' => self.between(if rest.starts_with("@@@") { "@@@" } else { "@" }, "").map(|_| UsdaToken::Asset),
            '0'..='9' | '-' | '+' | '.' => self.number(rest),
            _ if first == '_' || first == '!' || first.is_alphabetic() => Ok(self.word(rest)),
            _ if first.is_ascii_punctuation() => {
                self.at += 1;
                Ok(UsdaToken::Mark(rest.as_bytes()[0]))
            }
            _ => Err(self.fault(format!("{} has no place in USD", quoted(&rest[..first.len_utf8()])))),
        }
    }

    /// Skips blanks and comments in the styles of Python, C and C++.
    fn pass_blanks(&mut self) -> Result<(), String> {
        loop {
            let rest = self.text[self.at..].trim_start();
            self.at = self.text.len() - rest.len();
            let block = rest.strip_prefix("/*");
            if rest.starts_with('#') || rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if let Some(block) = block {
                self.start = self.at;
                self.at += 4 + block.find("*/").ok_or_else(|| self.fault("a comment without an end"))?;
            } else {
                return Ok(());
            }
        }
    }

    fn quoted(&mut self, [long, short]: [&str; 2]) -> Result<UsdaToken<'a>, String> {
        let rest = &self.text[self.at..];
        let quote = if rest.starts_with(long) { long } else { short };
        let inside = &rest[quote.len()..];
        let mut is_escaped = false;
        for (i, byte) in inside.bytes().enumerate() {
            match byte {
                _ if is_escaped => is_escaped = false,
                b'\\' => is_escaped = true,
                b'\n' if quote == short => break,
                _ if inside.as_bytes()[i..].starts_with(quote.as_bytes()) => {
                    self.at += i + 2 * quote.len();
                    return Ok(UsdaToken::Text(&inside[..i]));
                }
                _ => {}
            }
        }
        Err(self.fault("a text without its closing quotes"))
    }

    /// Returns the text between two marks; an empty `last` means the same mark as `first`.
    fn between(&mut self, first: &str, last: &str) -> Result<&'a str, String> {
        let last = if last.is_empty() { first } else { last };
        let rest = &self.text[self.at + first.len()..];
        let length = rest.find(last).ok_or_else(|| self.fault(format!("{first} without {last} behind it")))?;
        self.at += first.len() + length + last.len();
        Ok(&rest[..length])
    }

    fn number(&mut self, rest: &'a str) -> Result<UsdaToken<'a>, String> {
        let is_of_number = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-');
        let word = &rest[..rest.find(|c| !is_of_number(c)).unwrap_or(rest.len())];
        self.at += word.len();
        word.parse().map(UsdaToken::Number).map_err(|_| self.fault(format!("{} is no number", quoted(word))))
    }

    fn word(&mut self, rest: &'a str) -> UsdaToken<'a> {
        let is_of_word = |c: char| c == '_' || c == ':' || c == '.' || c == '!' || c.is_alphanumeric();
        let word = &rest[..rest.find(|c| !is_of_word(c)).unwrap_or(rest.len())];
        self.at += word.len();
        match word {
            "inf" => UsdaToken::Number(f64::INFINITY),
            "nan" => UsdaToken::Number(f64::NAN),
            word => UsdaToken::Word(word),
        }
    }
}

/// Resolves the escapes of a string, which are those of C without `\u`: `\n` and the like, and bytes of UTF-8 in up to
/// two hexadecimal or three octal digits. Before any other character the backslash is dropped. Source: Pixar, `OpenUSD`
/// 26.11, `TfEscapeString`.
pub(super) fn unescaped(literal: &str) -> String {
    let mut rest = literal.as_bytes();
    let mut text = Vec::with_capacity(rest.len());
    while let Some((&first, after)) = rest.split_first() {
        rest = after;
        if first != b'\\' {
            text.push(first);
            continue;
        }
        let Some((&letter, after)) = rest.split_first() else { break };
        let (byte, after) = match letter {
            b'a' => (0x07, after),
            b'b' => (0x08, after),
            b't' => (b'\t', after),
            b'n' => (b'\n', after),
            b'v' => (0x0b, after),
            b'f' => (0x0c, after),
            b'r' => (b'\r', after),
            b'x' => of_digits(after, 16, 2),
            b'0'..=b'7' => of_digits(rest, 8, 3),
            other => (other, after),
        };
        text.push(byte);
        rest = after;
    }
    String::from_utf8_lossy(&text).into_owned()
}

/// Returns the lowest byte of the number that up to `most` digits spell, 0 without digits, and what follows them.
fn of_digits(text: &[u8], radix: u32, most: usize) -> (u8, &[u8]) {
    let digits = text.iter().take(most).map_while(|&byte| char::from(byte).to_digit(radix));
    let (number, n) = digits.fold((0, 0), |(number, n), digit| (number * radix + digit, n + 1));
    (number.to_le_bytes()[0], &text[n..])
}
