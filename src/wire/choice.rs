//! Choices: enumerations that are written as texts. Plain serde would also accept `{"y": null}` for `"y"`, and would
//! report a number in place of a text as invalid JSON.

use std::fmt;

use serde::de::{Error, Visitor};

use crate::fault::{did_you_mean, shortened};

/// Declares a choice: an enumeration, the text of each value, and its deserializer; with `means`, also the conversion
/// into another enumeration with variants of the same names.
macro_rules! choice {
    (
        $(#[doc = $about:literal])+
        pub enum $name:ident { $($(#[doc = $doc:literal])+ $variant:ident = $text:literal,)+ }
    ) => {
        $(#[doc = $about])+
        #[derive(Debug, Clone, Copy, PartialEq, Eq, utoipa::ToSchema)]
        pub enum $name {
            $($(#[doc = $doc])+ #[schema(rename = $text)] $variant,)+
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_str($crate::wire::choice::OneOf(&[$(($text, Self::$variant)),+]))
            }
        }
    };
    (
        $(#[doc = $about:literal])+
        pub enum $name:ident means $meaning:ty { $($(#[doc = $doc:literal])+ $variant:ident = $text:literal,)+ }
    ) => {
        choice! { $(#[doc = $about])+ pub enum $name { $($(#[doc = $doc])+ $variant = $text,)+ } }

        impl From<$name> for $meaning {
            fn from(choice: $name) -> Self {
                match choice { $($name::$variant => Self::$variant,)+ }
            }
        }
    };
}
pub(super) use choice;

/// Reads one of the given texts and returns the value paired with it.
pub(super) struct OneOf<T: 'static>(pub(super) &'static [(&'static str, T)]);

impl<T: Copy> Visitor<'_> for OneOf<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(|(text, _)| format!("\"{text}\"")).collect();
        write!(f, "one of {}", texts.join(", "))
    }

    fn visit_str<E: Error>(self, given: &str) -> Result<T, E> {
        let found = self.0.iter().find(|(text, _)| *text == given);
        let expected: &dyn serde::de::Expected = &self;
        let meant = || did_you_mean(given, self.0.iter().map(|(text, _)| *text));
        found.map(|(_, value)| *value).ok_or_else(|| {
            E::custom(format!("unknown choice \"{}\"; {}expected {expected}", shortened(given), meant()))
        })
    }
}
