//! Errors of reading the settings.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use super::written::shown;

/// The reason why the settings cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The settings file could not be read.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The I/O error.
        error: std::io::Error,
    },
    /// The settings file is not valid TOML.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// The position and the reason.
        error: Box<toml::de::Error>,
    },
    /// A key or variable that is not a setting.
    #[error(
        "{place} is no setting{}; `planish serve --help` lists them",
        .near.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    Unknown {
        /// The key or variable, and where it was found.
        place: String,
        /// The setting with the most similar name.
        near: Option<String>,
    },
    /// An invalid value of a setting.
    #[error("{place}: {detail}")]
    Wrong {
        /// The setting, and where it was found.
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
        /// The unit of the setting; empty if it has none.
        unit: &'static str,
        /// The environment variable of the setting.
        variable: &'static str,
    },
}

/// Returns the unit to write after a number, unless the number is shown with its unit already.
fn after(unit: &str) -> String {
    match unit {
        "" | "bytes" => String::new(),
        "bytes a second" => " a second".to_owned(),
        unit => format!(" {unit}"),
    }
}
