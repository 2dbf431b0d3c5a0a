//! Parser of the header of a PLY file, which is text in every encoding.

use std::collections::BTreeMap;

use crate::input::text::{at_line, count, quoted};

/// Maximum number of header lines.
const MAX_HEADER_LINES: usize = 10_000;
/// Maximum number of elements.
const MAX_ELEMENTS: usize = 64;
/// Maximum number of properties of all elements together.
const MAX_PROPERTIES: usize = 512;

/// Face properties whose numbers stand for names.
pub(super) const NAMED_PROPERTIES: [&str; 2] = ["group", "material"];

/// The encoding of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyEncoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn read(word: &str) -> Result<Self, String> {
        match word {
            "char" | "int8" => Ok(Self::I8),
            "uchar" | "uint8" => Ok(Self::U8),
            "short" | "int16" => Ok(Self::I16),
            "ushort" | "uint16" => Ok(Self::U16),
            "int" | "int32" => Ok(Self::I32),
            "uint" | "uint32" => Ok(Self::U32),
            "float" | "float32" => Ok(Self::F32),
            "double" | "float64" => Ok(Self::F64),
            _ => Err(format!(
                "{} is no type; known are char, uchar, short, ushort, int, uint, float, double",
                quoted(word)
            )),
        }
    }

    /// Returns the size of a value in bytes.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether the type is an integer type.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// A property of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PlyProperty {
    pub(super) name: String,
    pub(super) kind: Scalar,
    /// The type of the length field if the property is a list.
    pub(super) list: Option<Scalar>,
}

impl PlyProperty {
    /// Whether the property is the list of the vertices of a face.
    pub(super) fn holds_corners(&self) -> bool {
        self.list.is_some() && (self.name == "vertex_indices" || self.name == "vertex_index")
    }
}

/// An element: its name, its number of rows and the properties of each row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<PlyProperty>,
}

/// The parsed header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: BodyEncoding,
    pub(super) elements: Vec<Element>,
    /// Names of groups and materials by property and number, from comments such as `comment group 0 top`.
    pub(super) names: BTreeMap<(String, u64), String>,
    /// Whether a comment says that planish wrote the file.
    pub(super) is_own: bool,
    /// The length of the header in bytes, including the last line break, and its number of lines.
    pub(super) length: usize,
    pub(super) lines: usize,
}

/// The comment that marks files written by planish.
const PLANISH_COMMENT: &str = "comment planish";

/// Reads a header.
pub(super) fn read(bytes: &[u8]) -> Result<Header, String> {
    let mut length = 0;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut names, mut is_own) = (BTreeMap::new(), false);
    for (i, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        length += line.len();
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default();
        let wrong = |detail: String| at_line(i + 1, detail);
        if i == 0 {
            if keyword != "ply" {
                return Err(wrong(format!("{} stands where \"ply\" should", quoted(keyword))));
            }
            continue;
        }
        match keyword {
            "format" => encoding = Some(self::encoding(words).map_err(wrong)?),
            "comment" if text.trim_end() == PLANISH_COMMENT => is_own = true,
            "comment" => names.extend(name(words)),
            "obj_info" => {}
            "element" if elements.len() < MAX_ELEMENTS => elements.push(element(words).map_err(wrong)?),
            "property" => {
                let all = elements.iter().map(|element| element.properties.len()).sum::<usize>();
                let Some(element) = elements.last_mut().filter(|_| all < MAX_PROPERTIES) else {
                    let detail = format!("a property belongs to an element, and there are at most {MAX_PROPERTIES}");
                    return Err(wrong(detail));
                };
                let property = property(words).map_err(wrong)?;
                if element.properties.iter().any(|known| known.name == property.name) {
                    return Err(wrong(format!("the element has two properties {}", quoted(&property.name))));
                }
                element.properties.push(property);
            }
            "end_header" => {
                let encoding = encoding.ok_or_else(|| wrong("the header names no format before its end".to_owned()))?;
                let empty = elements.iter().find(|element| element.properties.is_empty() && element.count > 0);
                if let Some(element) = empty {
                    return Err(wrong(format!("the element {} has no properties", quoted(&element.name))));
                }
                return Ok(Header { encoding, elements, names, is_own, length, lines: i + 1 });
            }
            other => {
                return Err(wrong(format!(
                    "{} belongs in no header; known are format, comment, obj_info, element (at most {MAX_ELEMENTS}), \
                     property, end_header",
                    quoted(other)
                )));
            }
        }
        if i == MAX_HEADER_LINES {
            return Err(wrong(format!("the header has more than {MAX_HEADER_LINES} lines")));
        }
    }
    Err("the file ends within its header, which ends with a line \"end_header\"".to_owned())
}

/// Parses a comment that names a group or material.
fn name<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<((String, u64), String)> {
    let kind = words.next().filter(|kind| NAMED_PROPERTIES.contains(kind))?;
    let number = words.next()?.parse().ok()?;
    let name = words.collect::<Vec<_>>().join(" ");
    (!name.is_empty()).then(|| ((kind.to_owned(), number), name))
}

fn encoding<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<BodyEncoding, String> {
    let found = match words.next() {
        Some("ascii") => BodyEncoding::Ascii,
        Some("binary_little_endian") => BodyEncoding::LittleEndian,
        Some("binary_big_endian") => BodyEncoding::BigEndian,
        other => {
            return Err(format!(
                "the format {}; known are ascii, binary_little_endian, binary_big_endian",
                quoted(other.unwrap_or_default())
            ));
        }
    };
    match words.next() {
        Some("1.0") => Ok(found),
        other => Err(format!("version {} of the format; 1.0 is read", quoted(other.unwrap_or_default()))),
    }
}

fn element<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Element, String> {
    match (words.next(), words.next(), words.next()) {
        (Some(name), Some(n), None) => Ok(Element { name: name.to_owned(), count: count(n)?, properties: Vec::new() }),
        _ => Err("an element has a name and a number of rows".to_owned()),
    }
}

fn property<'a>(words: impl Iterator<Item = &'a str>) -> Result<PlyProperty, String> {
    let words: Vec<&str> = words.take(5).collect();
    match *words.as_slice() {
        ["list", sizes, kind, name] => {
            let list = Scalar::read(sizes)?;
            if !list.is_whole() {
                return Err(format!("the length of a list is {}; it has to be a whole number", quoted(sizes)));
            }
            Ok(PlyProperty { name: name.to_owned(), kind: Scalar::read(kind)?, list: Some(list) })
        }
        [kind, name] if kind != "list" => {
            Ok(PlyProperty { name: name.to_owned(), kind: Scalar::read(kind)?, list: None })
        }
        _ => Err("a property has a type and a name, a list two types and a name".to_owned()),
    }
}
