//! The typed, length-prefixed encoding that keys are hashed over: distinct values have distinct bytes.

use std::borrow::Cow;

/// A value to be encoded. Every item starts with its tag and, where its length varies, that length.
#[derive(Debug, Clone, PartialEq)]
pub enum Item<'a> {
    /// A whole number.
    Integer(u64),
    /// A number; -0 is written as 0.
    Number(f64),
    /// A text, UTF-8.
    Text(Cow<'a, str>),
    /// Many numbers.
    Numbers(Cow<'a, [f64]>),
    /// Many indices.
    Indices(Cow<'a, [u32]>),
    /// Several items.
    List(Vec<Item<'a>>),
}

impl Item<'_> {
    /// Appends the encoding: tag (1 byte), length (8 bytes little endian) where it varies, content little endian.
    pub fn encode(&self, out: &mut Vec<u8>) {
        let number = |x: &f64| (x + 0.0).to_bits().to_le_bytes();
        match self {
            Self::Integer(x) => {
                out.push(1);
                out.extend(x.to_le_bytes());
            }
            Self::Number(x) => {
                out.push(2);
                out.extend(number(x));
            }
            Self::Text(text) => {
                out.push(3);
                out.extend((text.len() as u64).to_le_bytes());
                out.extend(text.as_bytes());
            }
            Self::Numbers(xs) => {
                out.push(4);
                out.extend((xs.len() as u64).to_le_bytes());
                xs.iter().for_each(|x| out.extend(number(x)));
            }
            Self::Indices(xs) => {
                out.push(5);
                out.extend((xs.len() as u64).to_le_bytes());
                xs.iter().for_each(|x| out.extend(x.to_le_bytes()));
            }
            Self::List(items) => {
                out.push(6);
                out.extend((items.len() as u64).to_le_bytes());
                items.iter().for_each(|item| item.encode(out));
            }
        }
    }
}
