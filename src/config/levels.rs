//! The setting `log`: the levels of log messages.

use std::fmt;
use std::str::FromStr;

use crate::fault::{did_you_mean, shortened};

/// The log levels, from the fewest messages to the most.
const LOG_LEVELS: [&str; 6] = ["off", "error", "warn", "info", "debug", "trace"];

/// A log level for everything, or several with those of single parts of the program, as in `warn,planish=debug`.
#[derive(Clone, PartialEq, Eq)]
pub struct LogLevels(String);

impl LogLevels {
    /// Returns the levels, separated by commas.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for LogLevels {
    fn default() -> Self {
        Self("warn".to_owned())
    }
}

impl FromStr for LogLevels {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let level = |entry: &str| {
            let (part, level) = entry.split_once('=').map_or(("", entry), |(part, level)| (part, level));
            let names_part = |c: char| c.is_ascii_alphanumeric() || "_:-".contains(c);
            if LOG_LEVELS.iter().any(|known| known.eq_ignore_ascii_case(level)) && part.chars().all(names_part) {
                return Ok(entry.to_ascii_lowercase());
            }
            let near = did_you_mean(level, LOG_LEVELS);
            let (level, known) = (shortened(level), LOG_LEVELS.join(", "));
            Err(format!(
                "there is no level \"{level}\"; {near}known are {known}; write it like info or warn,planish=debug"
            ))
        };
        let entries: Vec<String> = text.split(',').map(|entry| level(entry.trim())).collect::<Result<_, _>>()?;
        Ok(Self(entries.join(",")))
    }
}

/// Writes the levels as in the setting.
impl fmt::Debug for LogLevels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
