//! Settings from environment variables.

use std::ffi::OsString;

use super::error::ConfigError;
use crate::fault::{nearest, shortened};

/// The prefix of the variables of settings.
const SETTING_PREFIX: &str = "PLANISH_";
/// Prefixes of variables that Kubernetes and Docker set for a service called planish.
const FOREIGN_PREFIXES: [&str; 2] = ["PLANISH_SERVICE_", "PLANISH_PORT"];
/// Variables that are not settings: the path of the settings file, and the key that commands show to a service.
const OTHER_VARIABLES: [&str; 2] = ["PLANISH_CONFIG", "PLANISH_KEY"];

/// Returns the variables that are settings, each as the index of its setting in `known` and the value.
///
/// # Errors
/// A variable with the prefix that is not a setting.
pub(super) fn settings(
    variables: impl Iterator<Item = (OsString, OsString)>,
    known: &[&'static str],
) -> Result<Vec<(usize, String)>, ConfigError> {
    let mut found = Vec::new();
    for (name, value) in variables {
        let name = name.to_string_lossy();
        if !name.starts_with(SETTING_PREFIX)
            || OTHER_VARIABLES.contains(&&*name)
            || FOREIGN_PREFIXES.iter().any(|other| name.starts_with(other))
        {
            continue;
        }
        let Some(at) = known.iter().position(|known| name == *known) else {
            let near = nearest(&name, known.iter().copied().chain(OTHER_VARIABLES)).map(str::to_owned);
            return Err(ConfigError::Unknown { place: format!("the variable {}", shortened(&name)), near });
        };
        found.push((at, value.to_string_lossy().into_owned()));
    }
    Ok(found)
}
