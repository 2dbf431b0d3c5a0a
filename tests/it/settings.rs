//! Settings: each number has a range, and the settings file is a file of bounded length.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::path::Path;

use planish::config::{ConfigError, Given, Setting, Settings};

use crate::http::server::Folder;

/// The settings of a file that sets one of them.
fn of_file(name: &str, value: u64) -> Result<Settings, ConfigError> {
    let folder = Folder::new();
    let path = folder.path().join("planish.toml");
    std::fs::write(&path, format!("{} = {value}\n", name.replace('_', "-"))).unwrap();
    Settings::read(Given::default(), Some(&path))
}

#[test]
fn l_every_number_has_a_range_that_holds_its_default_and_nothing_outside_it_is_taken() {
    let defaults = Settings::default().list();
    let numbers = defaults.iter().filter_map(|setting| Some((setting, setting.value.parse::<u64>().ok()?)));
    for (Setting { name, range, .. }, default) in numbers {
        let range = range.as_ref().unwrap_or_else(|| panic!("{name} has no range"));
        assert!(range.contains(&default), "{name}: {default} in {range:?}");
        for value in [*range.start(), *range.end()] {
            let settings = of_file(name, value).unwrap_or_else(|error| panic!("{error}"));
            let listed = settings.list().into_iter().find(|setting| setting.name == *name).unwrap();
            assert_eq!(listed.value, value.to_string(), "{name}");
        }
        for value in [range.start().checked_sub(1), Some(range.end() + 1)].into_iter().flatten() {
            let error = of_file(name, value).unwrap_err();
            assert!(matches!(&error, ConfigError::OutOfRange { name: found, .. } if found == name), "{error}");
        }
    }
}

#[test]
fn l_a_number_out_of_range_is_told_with_setting_value_bound_and_remedy() {
    let given = Given { max_connections: Some(1 << 61), ..Given::default() };
    let said = Settings::read(given, None).unwrap_err().to_string();
    assert_eq!(
        said,
        "max_connections is 2,305,843,009,213,693,952, and may be 1 to 65,536 connections; change the flag \
         --max-connections, the variable PLANISH_MAX_CONNECTIONS or the key max-connections of the settings file"
    );
    let given = Given { header_timeout_s: Some(u64::MAX), ..Given::default() };
    let said = Settings::read(given, None).unwrap_err().to_string();
    assert!(
        said.starts_with("header_timeout_s is 18,446,744,073,709,551,615, and may be 1 to 86,400 seconds;"),
        "{said}"
    );
}

#[test]
fn l_a_settings_file_is_a_regular_file_of_at_most_a_mebibyte() {
    let folder = Folder::new();
    let refused = |path: &Path, part: &str| {
        let said = Settings::read(Given::default(), Some(path)).unwrap_err().to_string();
        assert!(said.contains(path.to_str().unwrap()) && said.contains(part), "{said}");
    };
    refused(folder.path(), "no regular file");
    if cfg!(unix) {
        refused(Path::new("/dev/zero"), "no regular file");
    }
    let path = folder.path().join("planish.toml");
    let of_length = |n: usize| std::fs::write(&path, format!("max-queue = 7\n#{}", "x".repeat(n - 15))).unwrap();
    of_length((1 << 20) + 1);
    refused(&path, "1 MiB");
    of_length(1 << 20);
    assert_eq!(Settings::read(Given::default(), Some(&path)).unwrap().max_queue, 7);
}
