//! Faults of requests: what is wrong, and where. This module depends on no other.

use std::borrow::Cow;
use std::fmt;

/// One fault of a request: a JSON pointer to the place, and a sentence that names value, bound and remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// JSON pointer (RFC 6901) into the request, or `?` and the name of a query parameter; empty for the whole request.
    pub pointer: String,
    /// What is wrong there and what would be right.
    pub detail: String,
    /// Byte position in the detail at which a pointer to another place of the request begins, if there is one.
    pub other: Option<usize>,
}

impl Fault {
    /// Creates a fault at `pointer`.
    pub fn new(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), detail: detail.into(), other: None }
    }

    /// Creates a fault at `pointer` whose detail names another place, too: the text before that place, its pointer, and
    /// the text after.
    pub fn with_other(pointer: impl Into<String>, [before, other, after]: [&str; 3]) -> Self {
        Self { other: Some(before.len()), ..Self::new(pointer, [before, other, after].concat()) }
    }

    /// Returns the fault as seen from the enclosing value: `prefix` is put before its pointers.
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

/// Puts `prefix` before the pointers of every fault.
pub fn under(prefix: &str, faults: Vec<Fault>) -> Vec<Fault> {
    faults.into_iter().map(|fault| fault.under(prefix)).collect()
}

/// Maximum number of characters of a name in a pointer: every valid name is shorter.
const MAX_POINTER_NAME: usize = 128;

/// Escapes one reference token of a JSON pointer (`~` and `/`). Names that are too long to be valid are cut.
pub fn token(name: &str) -> String {
    cut(name, MAX_POINTER_NAME).replace('~', "~0").replace('/', "~1")
}

/// Returns at most 40 characters of a client's text, for messages.
pub fn shortened(text: &str) -> String {
    cut(text, 40).into_owned()
}

/// Returns a text of at most `most` characters, followed by an ellipsis if there were more.
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// Returns the known name that `given` was probably meant to be: the most similar one of which at most a third of the
/// letters differ, or else one that begins with `given`. A limit of a quarter would find no `png` for `pn`; one of a
/// half would find `loop` for `lot`.
pub fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // a text too long to be a name is not compared
    let given = given.char_indices().nth(MAX_POINTER_NAME).is_none().then(|| given.to_lowercase())?;
    let letters = given.chars().count();
    let distance = |name: &'a str| {
        let apart = strsim::osa_distance(&given, &name.to_lowercase());
        let is_begun = letters >= 3 && name.starts_with(&given);
        let is_near = 3 * apart <= letters.max(name.chars().count());
        (is_near || is_begun).then_some((!is_near, apart, name))
    };
    known.into_iter().filter_map(distance).min().map(|(.., name)| name)
}

/// Returns `did you mean "x"? ` for an unknown name, or an empty text if no known name is near.
pub fn did_you_mean<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(given, known).map_or_else(String::new, |name| format!("did you mean \"{name}\"? "))
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn the_nearest_name_is_found_where_one_is_near() {
        let known = ["catmull-clark", "loop", "obj", "stl", "png", "delta", "w"];
        for (given, meant) in [
            ("catmul-clark", Some("catmull-clark")),
            ("Catmull_Clark", Some("catmull-clark")),
            ("catmull", Some("catmull-clark")),
            ("lop", Some("loop")),
            ("dleta", Some("delta")),
            ("PNG", Some("png")),
            ("pn", Some("png")),
            ("otl", Some("stl")),
            ("k", None),
            ("", None),
            ("butterfly", None),
            (&"catmull-clark".repeat(1000), None),
        ] {
            assert_eq!(nearest(given, known), meant, "{given}");
        }
    }
}
