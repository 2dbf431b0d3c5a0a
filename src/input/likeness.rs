//! How far a file resembles those of a format, for requests that do not name the format.

/// Maximum number of bytes of a text that are searched for the words of a format: some thousand lines. Half of it
/// misses files with long licences before their first vertex; twice of it searches more of other files in vain.
const MAX_SEARCHED_BYTES: usize = 256 << 10;

/// How far a file resembles those of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Likeness {
    /// The file does not begin like them.
    Unlike,
    /// The file begins like them, as others do, too.
    Begins,
    /// The file is one of them.
    Is,
}

impl From<bool> for Likeness {
    fn from(is: bool) -> Self {
        if is { Self::Is } else { Self::Unlike }
    }
}

/// A file as it is looked at to recognise its format.
#[derive(Debug, Clone, Copy)]
pub struct FileStart<'a> {
    /// All bytes of the file.
    pub bytes: &'a [u8],
    /// The start of the file as text, without leading whitespace.
    pub text: &'a [u8],
}

impl<'a> FileStart<'a> {
    /// Looks at a file.
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, text: bytes[..bytes.len().min(MAX_SEARCHED_BYTES)].trim_ascii_start() }
    }

    /// Returns the text up to the first whitespace.
    pub(super) fn first_word(&self) -> &'a [u8] {
        self.text.split(u8::is_ascii_whitespace).next().unwrap_or_default()
    }
}
