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

/// Deepest nesting that [`Item::decode`] follows.
const MAX_DEPTH: usize = 16;

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

    /// Reads one item back; `None` when the bytes are no encoding or something follows.
    pub fn decode(bytes: &[u8]) -> Option<Item<'static>> {
        let mut reader = Reader(bytes);
        let item = reader.item(MAX_DEPTH)?;
        reader.0.is_empty().then_some(item)
    }
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.0.split_at_checked(n)?;
        self.0 = tail;
        Some(head)
    }

    fn eight(&mut self) -> Option<[u8; 8]> {
        self.take(8)?.try_into().ok()
    }

    /// A length, and that many units of `size` bytes.
    fn many(&mut self, size: usize) -> Option<&'a [u8]> {
        let n = usize::try_from(u64::from_le_bytes(self.eight()?)).ok()?;
        self.take(n.checked_mul(size)?)
    }

    fn item(&mut self, depth: usize) -> Option<Item<'static>> {
        Some(match self.take(1)?[0] {
            1 => Item::Integer(u64::from_le_bytes(self.eight()?)),
            2 => Item::Number(f64::from_le_bytes(self.eight()?)),
            3 => Item::Text(String::from_utf8(self.many(1)?.to_vec()).ok()?.into()),
            4 => Item::Numbers(self.many(8)?.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()),
            5 => Item::Indices(self.many(4)?.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect()),
            6 => {
                let n = u64::from_le_bytes(self.eight()?);
                let depth = depth.checked_sub(1)?;
                // an item takes a byte at least, so a lying length ends soon
                Item::List((0..n).map(|_| self.item(depth)).collect::<Option<_>>()?)
            }
            _ => return None,
        })
    }
}
