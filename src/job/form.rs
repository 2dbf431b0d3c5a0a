//! The forms in which an analysis is answered.

use super::codec::Item;
use super::key::{Key, hashed};

/// How an analysis is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Every number by its name.
    #[default]
    Json,
    /// A report to read.
    Markdown,
    /// A figure of one page in lines.
    Svg,
    /// The same in pixels.
    Png,
}

impl Form {
    /// All forms, the usual one first.
    pub const ALL: [Self; 4] = [Self::Json, Self::Markdown, Self::Svg, Self::Png];

    /// Its name in commands and keys.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Markdown => "markdown",
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    /// The extension of its files.
    pub const fn extension(self) -> &'static str {
        if matches!(self, Self::Markdown) { "md" } else { self.name() }
    }

    /// The media type of its bytes.
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Markdown => "text/markdown",
            Self::Svg => "image/svg+xml",
            Self::Png => "image/png",
        }
    }

    /// Whether it shows functions, whose values it needs.
    pub const fn is_figure(self) -> bool {
        matches!(self, Self::Svg | Self::Png)
    }

    /// The key of an analysis in the form: that of what it finds for the usual one.
    pub(super) fn key(self, found: Key) -> Key {
        if self == Self::default() {
            return found;
        }
        let items = [Item::text(self.name()), Item::text(&found.to_string())];
        hashed(&Item::List(items.into()))
    }
}
