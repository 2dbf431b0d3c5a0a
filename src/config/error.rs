//! Why there are no settings.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use super::written::shown;

/// Why there are no settings.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file could not be read.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The file is not what it should be.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Where and why.
        error: Box<toml::de::Error>,
    },
    /// Something that is named as a setting and is none.
    #[error(
        "{place} is no setting{}; `planish serve --help` lists them",
        .near.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    Unknown {
        /// What is named, and where.
        place: String,
        /// The setting that is named most like it.
        near: Option<String>,
    },
    /// A value that a setting cannot have.
    #[error("{place}: {detail}")]
    Wrong {
        /// The setting, and where it stands.
        place: String,
        /// What is wrong with the value, and what would be right.
        detail: String,
    },
    /// A value outside its range.
    #[error(
        "{name} is {value}, and may be {least} to {most}{unit}; change the flag --{flag}, the variable {variable} or \
         the key {flag} of the settings file",
        value = shown(*.value, .unit), least = shown(*.range.start(), .unit), most = shown(*.range.end(), .unit),
        unit = after(.unit), flag = .name.replace('_', "-")
    )]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// The value of the setting.
        value: u64,
        /// The smallest and the largest value.
        range: RangeInclusive<u64>,
        /// What the setting counts; empty where it counts nothing.
        unit: &'static str,
        /// The environment variable of the setting.
        variable: &'static str,
    },
}

/// The unit after a number that is shown, where that does not have it already.
fn after(unit: &str) -> String {
    match unit {
        "" | "bytes" => String::new(),
        "bytes a second" => " a second".to_owned(),
        unit => format!(" {unit}"),
    }
}
