//! The typed, length-prefixed encoding that keys are hashed over: distinct values have distinct bytes.

use std::borrow::Cow;

/// A value to be encoded. Every item starts with its tag, followed by its length if that varies.
#[derive(Debug, Clone, PartialEq)]
pub enum Item<'a> {
    /// A whole number.
    Integer(u64),
    /// A number; -0 is encoded as 0.
    Number(f64),
    /// A text, UTF-8.
    Text(Cow<'a, str>),
    /// A list of numbers.
    Numbers(Cow<'a, [f64]>),
    /// A list of indices.
    Indices(Cow<'a, [u32]>),
    /// The bytes of a file.
    Bytes(Cow<'a, [u8]>),
    /// A list of items.
    List(Vec<Item<'a>>),
}

impl Item<'_> {
    /// Creates a text item that owns its text.
    pub(super) fn text(text: &str) -> Self {
        Self::Text(text.to_owned().into())
    }

    /// Appends the encoding: tag (1 byte), length (8 bytes little endian) where it varies, content little endian.
    pub fn encode(&self, out: &mut Vec<u8>) {
        let number = |x: &f64| (x + 0.0).to_bits().to_le_bytes();
        let mut start = |tag: u8, head: [u8; 8]| {
            out.push(tag);
            out.extend(head);
        };
        let length = |n: usize| (n as u64).to_le_bytes();
        match self {
            Self::Integer(x) => start(1, x.to_le_bytes()),
            Self::Number(x) => start(2, number(x)),
            Self::Text(text) => {
                start(3, length(text.len()));
                out.extend(text.as_bytes());
            }
            Self::Numbers(xs) => {
                start(4, length(xs.len()));
                xs.iter().for_each(|x| out.extend(number(x)));
            }
            Self::Indices(xs) => {
                start(5, length(xs.len()));
                xs.iter().for_each(|x| out.extend(x.to_le_bytes()));
            }
            Self::Bytes(bytes) => {
                start(7, length(bytes.len()));
                out.extend(&**bytes);
            }
            Self::List(items) => {
                start(6, length(items.len()));
                items.iter().for_each(|item| item.encode(out));
            }
        }
    }
}
