//! XML as far as models have it: tags and their attributes, one after the other, from a stream of bytes.
//!
//! Text between tags, comments and processing instructions are passed over. Document types, which could define
//! entities that grow without bound, are refused.

use std::collections::VecDeque;
use std::io::Read;

use crate::input::text::quoted;

/// Bytes that are read at once.
const PIECE: usize = 64 << 10;
/// Most bytes of one tag. Half of it refuses long lists of numbers of other extensions; twice of it holds twice as much.
const MAX_TAG: usize = 1 << 20;

/// A tag without its namespace prefix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Tag {
    /// The name behind the prefix.
    pub(super) name: String,
    /// Names, without prefixes, and values.
    attributes: Vec<(String, String)>,
    /// Whether it opens an element.
    pub(super) opens: bool,
    /// Whether it closes one; both where an element is empty.
    pub(super) closes: bool,
}

impl Tag {
    /// The value of an attribute.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(found, _)| found == name).map(|(_, value)| value.as_str())
    }
}

/// The tags of a document.
pub(super) struct Tags<R> {
    source: R,
    piece: Vec<u8>,
    at: usize,
    /// The line of the last tag, counted from 1.
    pub(super) line: usize,
    /// Bytes read so far.
    pub(super) read: u64,
    most: u64,
    open: VecDeque<String>,
}

/// How deep elements may lie in each other.
const MAX_DEPTH: usize = 64;

impl<R: Read> Tags<R> {
    /// The tags of a document of at most so many bytes.
    pub(super) fn new(source: R, most: u64) -> Self {
        Self { source, piece: Vec::new(), at: 0, line: 1, read: 0, most, open: VecDeque::new() }
    }

    /// The next byte.
    fn byte(&mut self) -> Result<Option<u8>, String> {
        if self.at == self.piece.len() {
            self.piece.resize(PIECE, 0);
            let n = self.source.read(&mut self.piece).map_err(|error| format!("it cannot be inflated: {error}"))?;
            self.piece.truncate(n);
            self.at = 0;
            self.read += n as u64;
            if self.read > self.most {
                return Err(format!(
                    "it inflates to more than {} bytes, {} times what the file has; send a smaller model",
                    self.most,
                    super::MOST_INFLATED
                ));
            }
        }
        let byte = self.piece.get(self.at).copied();
        self.at += 1;
        if byte.is_none() {
            self.at = 0;
            self.piece.clear();
        }
        self.line += usize::from(byte == Some(b'\n'));
        Ok(byte)
    }

    /// The next tag; none at the end.
    ///
    /// # Errors
    /// What is no XML, or more of it than is read.
    pub(super) fn next(&mut self) -> Result<Option<Tag>, String> {
        loop {
            loop {
                match self.byte()? {
                    Some(b'<') => break,
                    Some(_) => {}
                    None if self.open.is_empty() => return Ok(None),
                    None => return Err("the document ends before its elements do".to_owned()),
                }
            }
            let text = self.inside()?;
            match text.as_bytes().first() {
                Some(b'?') => {}
                Some(b'!') if text.starts_with("!--") => {}
                Some(b'!') => return Err("it has a document type or raw characters, which are not read".to_owned()),
                _ => return self.tag(&text).map(Some),
            }
        }
    }

    /// What stands between `<` and the `>` that ends it.
    fn inside(&mut self) -> Result<String, String> {
        let (mut text, mut quote) = (Vec::new(), None);
        loop {
            let Some(byte) = self.byte()? else { return Err("the document ends within a tag".to_owned()) };
            let is_comment = text.starts_with(b"!--");
            let is_end = if is_comment { text.len() >= 5 && text.ends_with(b"--") } else { quote.is_none() };
            if byte == b'>' && is_end {
                return String::from_utf8(text).map_err(|_| "a tag is not in UTF-8".to_owned());
            }
            if !is_comment && (byte == b'"' || byte == b'\'') {
                quote = match quote {
                    None => Some(byte),
                    Some(open) if open == byte => None,
                    open => open,
                };
            }
            // of a comment the end alone matters
            if is_comment && text.len() > 64 {
                text.drain(3..text.len() - 2);
            }
            if text.len() >= MAX_TAG {
                return Err(format!("a tag has more than {MAX_TAG} bytes; leave out what is no model"));
            }
            text.push(byte);
        }
    }

    fn tag(&mut self, text: &str) -> Result<Tag, String> {
        if let Some(name) = text.strip_prefix('/') {
            let name = local(name.trim_end());
            let open = self.open.pop_back();
            if open.as_deref() != Some(name) {
                let open = open.map_or("nothing".to_owned(), |open| quoted(&open));
                return Err(format!("{} is closed where {open} is open", quoted(name)));
            }
            return Ok(Tag { name: name.to_owned(), attributes: Vec::new(), opens: false, closes: true });
        }
        let (text, closes) = text.strip_suffix('/').map_or((text, false), |text| (text, true));
        let end = text.find(|c: char| c.is_ascii_whitespace()).unwrap_or(text.len());
        let (name, rest) = text.split_at(end);
        let name = local(name).to_owned();
        if name.is_empty() {
            return Err("a tag has no name".to_owned());
        }
        if !closes {
            if self.open.len() >= MAX_DEPTH {
                return Err(format!("elements lie deeper in each other than {MAX_DEPTH}"));
            }
            self.open.push_back(name.clone());
        }
        Ok(Tag { attributes: attributes(rest)?, name, opens: true, closes })
    }
}

/// A name without its prefix.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// The attributes behind the name of a tag.
fn attributes(text: &str) -> Result<Vec<(String, String)>, String> {
    let (mut rest, mut found) = (text.trim_start(), Vec::new());
    while !rest.is_empty() {
        let wrong = || format!("{} is no attribute", quoted(rest));
        let (name, after) = rest.split_once('=').ok_or_else(wrong)?;
        let after = after.trim_start();
        let quote = after.chars().next().filter(|c| *c == '"' || *c == '\'').ok_or_else(wrong)?;
        let (value, after) = after[1..].split_once(quote).ok_or_else(wrong)?;
        found.push((local(name.trim()).to_owned(), plain(value)?));
        rest = after.trim_start();
    }
    Ok(found)
}

/// A value with its entities replaced.
fn plain(value: &str) -> Result<String, String> {
    if !value.contains('&') {
        return Ok(value.to_owned());
    }
    let (mut text, mut rest) = (String::new(), value);
    while let Some((before, after)) = rest.split_once('&') {
        let (name, after) = after.split_once(';').ok_or_else(|| format!("{} has an open entity", quoted(value)))?;
        text.push_str(before);
        text.push(entity(name).ok_or_else(|| format!("there is no entity {}", quoted(name)))?);
        rest = after;
    }
    text.push_str(rest);
    Ok(text)
}

fn entity(name: &str) -> Option<char> {
    let number = |digits: &str, radix| char::from_u32(u32::from_str_radix(digits, radix).ok()?);
    match name {
        "amp" => Some('&'),
        "lt" => Some('<'),
        "gt" => Some('>'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => match (name.strip_prefix("#x"), name.strip_prefix('#')) {
            (Some(digits), _) => number(digits, 16),
            (None, Some(digits)) => number(digits, 10),
            (None, None) => None,
        },
    }
}
