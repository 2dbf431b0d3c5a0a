//! Settings: each number has a range, and the length of the settings file is bounded.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::path::Path;

use planish::config::{ConfigError, PartialSettings, Setting, Settings};

use crate::http::server::Folder;

/// Reads the settings from a file that sets one of them.
fn of_file(name: &str, value: u64) -> Result<Settings, ConfigError> {
    let folder = Folder::new();
    let path = folder.path().join("planish.toml");
    std::fs::write(&path, format!("{} = {value}\n", name.replace('_', "-"))).unwrap();
    Settings::read(PartialSettings::default(), Some(&path))
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
    let given = PartialSettings { max_connections: Some(1 << 61), ..PartialSettings::default() };
    let said = Settings::read(given, None).unwrap_err().to_string();
    assert_eq!(
        said,
        "max_connections is 2,305,843,009,213,693,952, and may be 1 to 65,536 connections; change the flag \
         --max-connections, the variable PLANISH_MAX_CONNECTIONS or the key max-connections of the settings file"
    );
    let given = PartialSettings { header_timeout_s: Some(u64::MAX), ..PartialSettings::default() };
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
        let said = Settings::read(PartialSettings::default(), Some(path)).unwrap_err().to_string();
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
    assert_eq!(Settings::read(PartialSettings::default(), Some(&path)).unwrap().max_queue, 7);
}

/// Reads the settings from a file with this text.
fn written(text: &str) -> Result<Settings, ConfigError> {
    let folder = Folder::new();
    let path = folder.path().join("planish.toml");
    std::fs::write(&path, text).unwrap();
    Settings::read(PartialSettings::default(), Some(&path))
}

/// Reads the settings from an environment variable.
fn of_variable(name: &str, value: &str) -> Result<Settings, ConfigError> {
    Settings::read(PartialSettings::of_variables([(name.into(), value.into())].into_iter())?, None)
}

#[test]
fn sizes_and_times_are_written_with_units_in_files_and_variables() {
    for (text, bytes) in [
        ("1GiB", 1 << 30),
        ("64MiB", 64 << 20),
        ("64 mib", 64 << 20),
        ("500kB", 500_000),
        ("1.5GB", 1_500_000_000),
        ("0.5KiB", 512),
        ("12B", 12),
        ("1_000_000", 1_000_000),
    ] {
        assert_eq!(written(&format!("cache-bytes = \"{text}\"")).unwrap().cache_bytes, bytes, "{text}");
        assert_eq!(of_variable("PLANISH_CACHE_BYTES", text).unwrap().cache_bytes, bytes, "{text}");
    }
    for (text, seconds) in [("90s", 90), ("5min", 300), ("2h", 7200), ("1d", 86_400), ("20", 20)] {
        assert_eq!(of_variable("PLANISH_RUN_TIMEOUT_S", text).unwrap().run_timeout_s, seconds, "{text}");
    }
    assert_eq!(written("cache-bytes = 5\nlog-json = true").unwrap().cache_bytes, 5);
    assert_eq!(of_variable("PLANISH_MAX_FACES", "2_000").unwrap().max_faces, 2000);
}

#[test]
fn addresses_are_written_as_people_write_them() {
    for (text, address) in [
        ("localhost:8080", "127.0.0.1:8080"),
        (":8080", "127.0.0.1:8080"),
        ("[::1]:8080", "[::1]:8080"),
        ("0.0.0.0:80", "0.0.0.0:80"),
    ] {
        assert_eq!(of_variable("PLANISH_LISTEN", text).unwrap().listen, address.parse().unwrap(), "{text}");
    }
}

#[test]
fn what_is_no_value_is_refused_with_an_example() {
    for (name, values, example) in [
        ("PLANISH_LISTEN", &["8080", "localhost", ":", "host:8080", "127.0.0.1:99999", ""][..], "localhost:8080"),
        (
            "PLANISH_CACHE_BYTES",
            &["", "x", "1XiB", "-1", "1.5", "1.GiB", "GiB", "1e9", "99999999999999999999"],
            "64MiB",
        ),
        ("PLANISH_LEAST_RATE_BYTES_S", &["fast"], "64MiB"),
        ("PLANISH_RUN_TIMEOUT_S", &["", "soon", "5 m", "0.5", "10ms"], "5min"),
        ("PLANISH_MAX_FACES", &["", "many", "1GiB", "1.5"], "20_000_000"),
        ("PLANISH_MAX_QUEUE", &["-3"], "20_000_000"),
        ("PLANISH_LOG_JSON", &["yes", ""], "true"),
        ("PLANISH_LOG", &["loud", "", "planish=loud", "a b=info"], "warn,planish=debug"),
        ("PLANISH_CORS_ORIGINS", &["example.org"], "https://example.org"),
    ] {
        for value in values {
            let said = of_variable(name, value).unwrap_err().to_string();
            assert!(said.starts_with(&format!("the variable {name}: ")) && said.contains(example), "{value}: {said}");
        }
    }
    let said = written("max-faces = 1\ncache-bytes = \"much\"").unwrap_err().to_string();
    assert!(said.contains("the key cache-bytes of the settings file") && said.contains("64MiB"), "{said}");
    let said = of_variable("PLANISH_MAX_BODY_BYTES", "2GiB").unwrap_err().to_string();
    assert!(said.starts_with("max_body_bytes is 2 GiB, and may be 1 byte to 1 GiB; change"), "{said}");
}

#[test]
fn what_is_no_setting_is_refused_with_the_nearest_one() {
    let said = of_variable("PLANISH_MAX_FACE", "1").unwrap_err().to_string();
    assert!(said.starts_with("the variable PLANISH_MAX_FACE is no setting; did you mean PLANISH_MAX_FACES?"), "{said}");
    let said = written("max-que = 1").unwrap_err().to_string();
    assert!(
        said.contains("the key max-que of the settings file") && said.contains("did you mean max-queue?"),
        "{said}"
    );
    let said = of_variable("PLANISH_LOG", "inof").unwrap_err().to_string();
    assert!(said.contains("there is no level \"inof\"; did you mean \"info\"?"), "{said}");
    for other in ["PLANISH_SERVICE_HOST", "PLANISH_PORT_8080_TCP", "PLANISH_CONFIG", "PLANISHED", "PATH"] {
        assert_eq!(of_variable(other, "x").unwrap(), Settings::default(), "{other}");
    }
}

#[test]
fn levels_of_the_log_are_taken_in_any_case_and_for_parts() {
    for (text, levels) in [("INFO", "info"), ("warn, planish=Debug", "warn,planish=debug"), ("off", "off")] {
        assert_eq!(of_variable("PLANISH_LOG", text).unwrap().log.as_str(), levels);
    }
}
