//! Readers of the values in the body of a PLY file, as text or binary.

use super::header::{Element, PlyProperty, Scalar};
use crate::input::collect::whole;
use crate::input::text::{Words, at_line, count, quoted};

/// A source of the values of a PLY body in file order.
pub(super) trait Body {
    /// Returns the position of the next or the last value, for messages.
    fn place(&self) -> String;
    /// Reads the next value. Every PLY type fits into f64.
    ///
    /// # Errors
    /// The file ends, or the next value is not of this type.
    fn scalar(&mut self, kind: Scalar) -> Result<f64, String>;
    /// Reads the next value as a non-negative whole number.
    ///
    /// # Errors
    /// The value is not a non-negative whole number.
    fn index(&mut self, kind: Scalar) -> Result<u64, String>;
    /// Returns an upper bound of the number of values of type `kind` that may still follow.
    fn room(&self, kind: Scalar) -> u64;
    /// Checks that nothing follows the last element.
    ///
    /// # Errors
    /// Something follows the last element.
    fn end(&mut self) -> Result<(), String>;

    /// Reads the length of a list and checks that the rest of the file can hold the list.
    ///
    /// # Errors
    /// The list is longer than the rest of the file.
    fn size(&mut self, sizes: Scalar, kind: Scalar) -> Result<u64, String> {
        let n = self.index(sizes)?;
        let room = self.room(kind);
        if n > room {
            return Err(format!("{}: a list of {n} numbers; the file has room for {room} more", self.place()));
        }
        Ok(n)
    }

    /// Skips the value or list of a property.
    ///
    /// # Errors
    /// The errors of reading the property.
    fn pass(&mut self, property: &PlyProperty) -> Result<(), String> {
        let n = property.list.map_or(Ok(1), |sizes| self.size(sizes, property.kind))?;
        (0..n).try_for_each(|_| self.scalar(property.kind).map(|_| ()))
    }

    /// Checks that the rest of the file can hold all rows of an element.
    ///
    /// # Errors
    /// The element has more rows than the rest of the file can hold.
    fn holds(&self, element: &Element) -> Result<(), String> {
        // an empty list still takes its length field
        let kinds = element.properties.iter().map(|property| property.list.unwrap_or(property.kind));
        let rows = kinds.map(|kind| self.room(kind)).min().unwrap_or(u64::MAX);
        if element.count > rows {
            let (name, n) = (quoted(&element.name), element.count);
            return Err(format!("{}: {n} rows of {name}; the file has room for {rows} at most", self.place()));
        }
        Ok(())
    }
}

/// The body of an ASCII file.
#[derive(Debug)]
pub(super) struct Ascii<'a> {
    words: Words<'a>,
    /// Bytes of the text that are not read yet.
    left: usize,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(text: &'a str, line: usize) -> Self {
        Self { words: Words::new(text, line, None), left: text.len() }
    }

    fn word(&mut self) -> Result<&'a str, String> {
        let word = self.words.expect("a number")?;
        self.left = self.left.saturating_sub(word.len() + 1);
        Ok(word)
    }
}

impl Body for Ascii<'_> {
    fn place(&self) -> String {
        format!("line {}", self.words.line)
    }

    fn scalar(&mut self, kind: Scalar) -> Result<f64, String> {
        let word = self.word()?;
        let found = match kind {
            Scalar::F64 => word.parse::<f64>().ok(),
            Scalar::F32 => word.parse::<f32>().ok().map(f64::from),
            _ => word.parse::<i32>().map(f64::from).or_else(|_| word.parse::<u32>().map(f64::from)).ok(),
        };
        let name = if kind.is_whole() { "no whole number of 32 bits" } else { "no number" };
        found.ok_or_else(|| at_line(self.words.line, format!("{} is {name}", quoted(word))))
    }

    fn index(&mut self, _kind: Scalar) -> Result<u64, String> {
        let word = self.word()?;
        count(word).map_err(|detail| at_line(self.words.line, detail))
    }

    fn room(&self, _kind: Scalar) -> u64 {
        // the shortest number takes a digit and a space
        self.left as u64 / 2 + 1
    }

    fn end(&mut self) -> Result<(), String> {
        match self.words.next() {
            None => Ok(()),
            Some(word) => Err(at_line(self.words.line, format!("{} follows the last element", quoted(word)))),
        }
    }
}

/// The body of a binary file.
#[derive(Debug)]
pub(super) struct Binary<'a> {
    rest: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Binary<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize, big_endian: bool) -> Self {
        Self { rest: bytes, at, big_endian }
    }

    /// Reads the next `N` bytes and returns them in little-endian order.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let Some((bytes, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(format!("byte {}: the file ends where {N} more bytes should follow", self.at));
        };
        (self.rest, self.at) = (rest, self.at + N);
        let mut bytes = *bytes;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Body for Binary<'_> {
    fn place(&self) -> String {
        format!("byte {}", self.at)
    }

    fn scalar(&mut self, kind: Scalar) -> Result<f64, String> {
        Ok(match kind {
            Scalar::I8 => i8::from_le_bytes(self.bytes()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.bytes()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.bytes()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.bytes()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.bytes()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.bytes()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.bytes()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    fn index(&mut self, kind: Scalar) -> Result<u64, String> {
        let at = self.at;
        let found = self.scalar(kind)?;
        whole(found).map(u64::from).ok_or_else(|| format!("byte {at}: {found} is no whole number of at least 0"))
    }

    fn room(&self, kind: Scalar) -> u64 {
        (self.rest.len() / kind.bytes()) as u64
    }

    fn end(&mut self) -> Result<(), String> {
        if self.rest.iter().all(u8::is_ascii_whitespace) {
            return Ok(());
        }
        Err(format!("byte {}: {} bytes follow the last element", self.at, self.rest.len()))
    }
}
