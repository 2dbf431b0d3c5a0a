//! A streaming reader of the tags of an XML document with their attributes.
//!
//! Text between tags, comments and processing instructions are skipped. Document types are refused, because they could
//! define entities that grow without bound.

use std::fmt::Display;
use std::io::{self, BufRead, BufReader, Read};

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Error, Reader, XmlVersion};

use crate::input::text::quoted;

/// Size of the read buffer in bytes.
const XML_BUFFER_BYTES: usize = 64 << 10;
/// Maximum number of bytes of one tag, and of one text between tags. Half of it refuses long lists of numbers of other
/// extensions; twice of it holds twice as much in memory.
const MAX_TAG: usize = 1 << 20;
/// Maximum depth to which elements may be nested.
const MAX_ELEMENT_DEPTH: usize = 64;

/// A tag without its namespace prefix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Tag {
    /// The name without the namespace prefix.
    pub(super) name: String,
    /// Names, without prefixes, and values of the attributes.
    attributes: Vec<(String, String)>,
    /// Whether the tag opens an element.
    pub(super) opens: bool,
    /// Whether the tag closes an element; an empty-element tag both opens and closes it.
    pub(super) closes: bool,
}

impl Tag {
    /// Returns the value of an attribute.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(found, _)| found == name).map(|(_, value)| value.as_str())
    }
}

/// The tags of a document, in order.
pub(super) struct XmlTags<R> {
    reader: Reader<Bounded<R>>,
    event: Vec<u8>,
    /// The line of the last tag, counted from 1.
    pub(super) line: usize,
    depth: usize,
}

/// A reader that fails after `left` more bytes; `left` is reset before each tag.
struct Bounded<R> {
    source: BufReader<R>,
    left: usize,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(bytes)?;
        self.consume(n);
        Ok(n)
    }
}

impl<R: Read> BufRead for Bounded<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let found = self.source.fill_buf()?;
        if self.left == 0 && !found.is_empty() {
            let detail = format!("a tag or text has more than {MAX_TAG} bytes; leave out what is no model");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, detail));
        }
        Ok(&found[..found.len().min(self.left)])
    }

    fn consume(&mut self, n: usize) {
        self.source.consume(n);
        self.left -= n;
    }
}

impl<R: Read> XmlTags<R> {
    /// Creates the tags of a document.
    pub(super) fn new(source: R) -> Self {
        let source = Bounded { source: BufReader::with_capacity(XML_BUFFER_BYTES, source), left: MAX_TAG };
        Self { reader: Reader::from_reader(source), event: Vec::new(), line: 1, depth: 0 }
    }

    /// Returns the next tag, or `None` at the end of the document.
    ///
    /// # Errors
    /// The document is not well-formed XML, or exceeds one of the limits.
    pub(super) fn next(&mut self) -> Result<Option<Tag>, String> {
        loop {
            self.event.clear();
            self.reader.get_mut().left = MAX_TAG;
            let event = self.reader.read_event_into(&mut self.event).map_err(unread)?;
            self.line += event.split(|byte| *byte == b'\n').count() - 1;
            match event {
                Event::Start(_) if self.depth == MAX_ELEMENT_DEPTH => {
                    return Err(format!("elements lie deeper in each other than {MAX_ELEMENT_DEPTH}"));
                }
                Event::Start(start) => {
                    self.depth += 1;
                    return opening(&start, false).map(Some);
                }
                Event::Empty(start) => return opening(&start, true).map(Some),
                Event::End(end) => {
                    self.depth -= 1;
                    let name = text(end.local_name().as_ref())?;
                    return Ok(Some(Tag { name, attributes: Vec::new(), opens: false, closes: true }));
                }
                Event::Eof if self.depth == 0 => return Ok(None),
                Event::Eof => return Err("the document ends before its elements do".to_owned()),
                Event::DocType(_) => return Err("it has a document type, which is not read".to_owned()),
                Event::Text(_)
                | Event::CData(_)
                | Event::Comment(_)
                | Event::Decl(_)
                | Event::PI(_)
                | Event::GeneralRef(_) => {}
            }
        }
    }
}

fn opening(start: &BytesStart<'_>, closes: bool) -> Result<Tag, String> {
    let wrong = |error: &dyn Display| format!("{}: {error}", quoted(&String::from_utf8_lossy(start.name().as_ref())));
    let mut attributes = Vec::new();
    // checks for duplicate names would take time quadratic in their number
    for attribute in start.attributes().with_checks(false) {
        let attribute = attribute.map_err(|error| wrong(&error))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| wrong(&error))?;
        attributes.push((text(attribute.key.local_name().as_ref())?, value.into_owned()));
    }
    Ok(Tag { name: text(start.local_name().as_ref())?, attributes, opens: true, closes })
}

fn text(bytes: &[u8]) -> Result<String, String> {
    std::str::from_utf8(bytes).map(str::to_owned).map_err(|_| "a tag is not in UTF-8".to_owned())
}

fn unread(error: Error) -> String {
    match error {
        Error::Io(error) if error.kind() == io::ErrorKind::FileTooLarge => error.to_string(),
        Error::Io(error) => format!("it cannot be inflated: {error}"),
        other => format!("it is no XML: {other}"),
    }
}
