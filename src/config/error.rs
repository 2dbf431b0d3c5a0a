//! Why there are no settings.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use crate::job::amounts::thousands;

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
    /// A value outside its range.
    #[error(
        "{name} is {value}, and may be {least} to {most}{unit}; change the flag --{flag}, the variable {variable} or \
         the key {flag} of the settings file",
        value = thousands((*.value).into()), least = thousands((*.range.start()).into()),
        most = thousands((*.range.end()).into()), unit = .unit, flag = .name.replace('_', "-")
    )]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// The value of the setting.
        value: u64,
        /// The smallest and the largest value.
        range: RangeInclusive<u64>,
        /// What the setting counts, after a blank; empty where it counts nothing.
        unit: String,
        /// The environment variable of the setting.
        variable: &'static str,
    },
}
