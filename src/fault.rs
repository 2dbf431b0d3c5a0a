//! What is wrong, and where: the one shape of every refusal (leaf).

use std::borrow::Cow;
use std::fmt;

/// One fault of a request: a JSON pointer to the place, and a sentence that names value, bound and remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// JSON pointer (RFC 6901) into the request, or `?` and the name of a parameter of its query; empty for the whole.
    pub pointer: String,
    /// What is wrong there and what would be right.
    pub detail: String,
    /// Where in the detail a pointer to another place of the request begins, if there is one.
    pub other: Option<usize>,
}

impl Fault {
    /// A fault at `pointer`.
    pub fn new(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), detail: detail.into(), other: None }
    }

    /// A fault at `pointer` whose sentence names another place, too: what comes before it, its pointer, what comes
    /// after.
    pub fn with_other(pointer: impl Into<String>, [before, other, after]: [&str; 3]) -> Self {
        Self { other: Some(before.len()), ..Self::new(pointer, [before, other, after].concat()) }
    }

    /// The same fault seen from one level further out: `prefix` is put before its pointers.
    #[must_use]
    pub fn under(mut self, prefix: &str) -> Self {
        self.pointer.insert_str(0, prefix);
        if let Some(other) = self.other {
            self.detail.insert_str(other, prefix);
        }
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.pointer.is_empty() { f.write_str(&self.detail) } else { write!(f, "{}: {}", self.pointer, self.detail) }
    }
}

/// Puts `prefix` before the pointer of every fault.
pub fn under(prefix: &str, faults: Vec<Fault>) -> Vec<Fault> {
    faults.into_iter().map(|fault| fault.under(prefix)).collect()
}

/// Most characters of a name in a pointer: every name that can be right is shorter.
const MOST_NAME: usize = 128;

/// Escapes one reference token of a JSON pointer: `~` and `/`. Names that are too long to be right are cut.
pub fn token(name: &str) -> String {
    cut(name, MOST_NAME).replace('~', "~0").replace('/', "~1")
}

/// At most 40 characters of a client's text, for messages.
pub fn shortened(text: &str) -> String {
    cut(text, 40).into_owned()
}

/// A text of at most so many characters, and an ellipsis where there were more.
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}
