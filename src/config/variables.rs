//! Settings from the variables of the environment.

use std::ffi::OsString;

use super::error::ConfigError;
use crate::fault::{nearest, shortened};

/// How the variables of settings begin.
const PREFIX: &str = "PLANISH_";
/// What Kubernetes and Docker set by themselves where a service is called planish.
const OF_OTHERS: [&str; 2] = ["PLANISH_SERVICE_", "PLANISH_PORT"];
/// The variables that name the settings file, and the key that commands show to a service.
const BESIDE: [&str; 2] = ["PLANISH_CONFIG", "PLANISH_KEY"];

/// The variables among these that are settings, each with the place of its setting in the list of `known` ones.
///
/// # Errors
/// A variable that begins as one of a setting and is none.
pub(super) fn settings(
    variables: impl Iterator<Item = (OsString, OsString)>,
    known: &[&'static str],
) -> Result<Vec<(usize, String)>, ConfigError> {
    let mut found = Vec::new();
    for (name, value) in variables {
        let name = name.to_string_lossy();
        if !name.starts_with(PREFIX)
            || BESIDE.contains(&&*name)
            || OF_OTHERS.iter().any(|other| name.starts_with(other))
        {
            continue;
        }
        let Some(at) = known.iter().position(|known| name == *known) else {
            let near = nearest(&name, known.iter().copied().chain(BESIDE)).map(str::to_owned);
            return Err(ConfigError::Unknown { place: format!("the variable {}", shortened(&name)), near });
        };
        found.push((at, value.to_string_lossy().into_owned()));
    }
    Ok(found)
}
