//! Lines and words of text files.

use std::borrow::Cow;

/// Decodes the text of a file: UTF-16 if it has a byte order mark, otherwise UTF-8. Invalid sequences, as in names in
/// other encodings, are replaced. Lines may end in carriage returns alone if all do.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => Cow::Owned(of_units(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => Cow::Owned(of_units(rest, u16::from_be_bytes)),
        _ => String::from_utf8_lossy(bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes)),
    };
    if text.contains('\r') && !text.contains('\n') { Cow::Owned(text.replace('\r', "\n")) } else { text }
}

/// Decodes UTF-16, with the byte order that `unit` has.
fn of_units(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.as_chunks().0.iter().map(|&bytes| unit(bytes));
    char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

/// Returns the line without its comment; a `#` within a word is part of a name.
pub(super) fn without_comment(line: &str) -> &str {
    let starts = |(at, _): &(usize, &str)| line[..*at].chars().next_back().is_none_or(char::is_whitespace);
    line.match_indices('#').find(starts).map_or(line, |(at, _)| &line[..at])
}

/// Formats a fault in a line, counted from 1.
pub(super) fn at_line(line: usize, detail: impl std::fmt::Display) -> String {
    format!("line {line}: {detail}")
}

/// Maximum number of names that a note lists.
pub(super) const MAX_NOTED_NAMES: usize = 8;

/// Lists the first names for a note, and says whether there are more.
pub(super) fn first_names(names: impl ExactSizeIterator<Item = String>) -> String {
    let more = if names.len() > MAX_NOTED_NAMES { ", ..." } else { "" };
    names.take(MAX_NOTED_NAMES).collect::<Vec<_>>().join(", ") + more
}

/// Quotes a word for a message and shortens it.
pub(super) fn quoted(word: &str) -> String {
    let short: String = word.chars().take(40).collect();
    let more = if short.len() < word.len() { "..." } else { "" };
    format!("{short:?}{more}")
}

/// Parses a finite number.
///
/// # Errors
/// The word is not a finite number.
pub(super) fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(format!("{} is not finite; coordinates are at most about 1.8e308", quoted(word))),
        Err(_) => Err(format!("{} is no number", quoted(word))),
    }
}

/// Parses a non-negative whole number.
///
/// # Errors
/// The word is not a non-negative whole number.
pub(super) fn count(word: &str) -> Result<u64, String> {
    word.parse().map_err(|_| format!("{} is no whole number of at least 0", quoted(word)))
}

/// Parses `N` finite numbers from words.
///
/// # Errors
/// A word is not a finite number, or there are too few words; `what` names the numbers in the message.
pub(super) fn numbers<'a, const N: usize>(
    words: &mut impl Iterator<Item = &'a str>,
    what: &str,
) -> Result<[f64; N], String> {
    let mut found = [0.0; N];
    for (i, slot) in found.iter_mut().enumerate() {
        *slot = number(words.next().ok_or_else(|| format!("{what} has {i} numbers; it needs {N}"))?)?;
    }
    Ok(found)
}

/// The words of a text with their line numbers, without comments.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    left: std::str::SplitAsciiWhitespace<'a>,
    comment: Option<char>,
    /// Line of the last word, counted from 1.
    pub(super) line: usize,
}

impl<'a> Words<'a> {
    /// Creates an iterator over the words of `text`, whose first line has the number `line`; `comment` and the rest of
    /// its line are skipped.
    pub(super) fn new(text: &'a str, line: usize, comment: Option<char>) -> Self {
        Self { lines: text.lines().enumerate(), left: "".split_ascii_whitespace(), comment, line: line - 1 }
    }

    /// Returns the next word.
    ///
    /// # Errors
    /// The text has ended; `what` names the missing word in the message.
    pub(super) fn expect(&mut self, what: &str) -> Result<&'a str, String> {
        self.next().ok_or_else(|| self.ends(what))
    }

    fn ends(&self, what: &str) -> String {
        at_line(self.line.max(1), format!("the file ends where {what} should follow"))
    }

    /// Returns the words of the next line that is not empty.
    ///
    /// # Errors
    /// The text has ended; `what` names the missing words in the message.
    pub(super) fn expect_line(&mut self, what: &str) -> Result<std::str::SplitAsciiWhitespace<'a>, String> {
        loop {
            let line = self.next_line().ok_or_else(|| self.ends(what))?;
            if line.clone().next().is_some() {
                return Ok(line);
            }
        }
    }

    /// Returns the remaining words of the current line.
    pub(super) fn rest_of_line(&self) -> std::str::SplitAsciiWhitespace<'a> {
        self.left.clone()
    }

    /// Skips `n` words of the current line.
    pub(super) fn pass(&mut self, n: usize) {
        self.left.by_ref().take(n).for_each(drop);
    }

    fn next_line(&mut self) -> Option<std::str::SplitAsciiWhitespace<'a>> {
        let (_, line) = self.lines.next()?;
        self.line += 1;
        let line = self.comment.and_then(|mark| line.split(mark).next()).unwrap_or(line);
        Some(line.split_ascii_whitespace())
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.left.next() {
                return Some(word);
            }
            self.left = self.next_line()?;
        }
    }
}
