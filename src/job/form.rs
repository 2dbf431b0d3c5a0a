//! The forms of the answer to an analysis.

use super::codec::Item;
use super::key::{Key, hashed};

/// The form of the answer to an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Every value with its name.
    #[default]
    Json,
    /// A report for people.
    Markdown,
    /// A figure of one page as vector graphics.
    Svg,
    /// A figure of one page in pixels, the same as under `Svg`.
    Png,
}

impl Form {
    /// All forms; the first is the default.
    pub const ALL: [Self; 4] = [Self::Json, Self::Markdown, Self::Svg, Self::Png];

    /// Returns the name of the form in commands and keys.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Markdown => "markdown",
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    /// Returns the extension of its files.
    pub const fn extension(self) -> &'static str {
        if matches!(self, Self::Markdown) { "md" } else { self.name() }
    }

    /// Returns the media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Markdown => "text/markdown",
            Self::Svg => "image/svg+xml",
            Self::Png => "image/png",
        }
    }

    /// Returns whether the form plots functions and thus needs their values.
    pub const fn is_figure(self) -> bool {
        matches!(self, Self::Svg | Self::Png)
    }

    /// Returns the key of an analysis in the form; for the default form, that of the result itself.
    pub(super) fn key(self, found: Key) -> Key {
        if self == Self::default() {
            return found;
        }
        let items = [Item::text(self.name()), Item::text(&found.to_string())];
        hashed(&Item::List(items.into()))
    }
}
