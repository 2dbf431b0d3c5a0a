//! Names of prims, which are identifiers.

use std::collections::BTreeSet;

/// Names that are taken in one scope.
#[derive(Debug, Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// Returns a unique identifier for a name: the name itself if it is an identifier and free, otherwise with `_` for
    /// other characters, and a number at its end if it is taken.
    pub(super) fn identifier(&mut self, name: &str) -> String {
        let letter = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' };
        let mut stem: String = name.chars().map(letter).collect();
        if stem.starts_with(|c: char| c.is_ascii_digit()) {
            stem.insert(0, '_');
        }
        let numbered = (2..).map(|n: u32| format!("{stem}_{n}"));
        let mut all = std::iter::once(stem.clone()).chain(numbered);
        all.find(|name| self.0.insert(name.clone())).unwrap_or(stem)
    }
}

/// Returns the metadata with the original name, if the prim has another.
pub(super) fn display_name(name: &str, identifier: &str) -> Option<String> {
    (name != identifier).then(|| format!("displayName = {}", quoted(name)))
}

/// Returns a text in quotes.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers_of_their_own() {
        let mut names = Names::default();
        let found = ["top", "a.side", "a-side", "2nd", "top", "\u{e9}"].map(|name| names.identifier(name));
        assert_eq!(found, ["top", "a_side", "a_side_2", "_2nd", "top_2", "_"]);
        assert_eq!(display_name("a\"b\\", "a_b_").as_deref(), Some(r#"displayName = "a\"b\\""#));
        assert_eq!(display_name("top", "top"), None);
    }
}
