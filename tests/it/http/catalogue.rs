//! The catalogue of presets, operators, formats and readers.

use planish::input::READERS;
use planish::output::FORMATS;
use planish::scheme::ops::OPERATORS;
use planish::scheme::presets::PRESETS;

use super::server::{settings, story};

#[test]
fn every_preset_is_listed_and_has_a_page() {
    story(settings(), async |server| {
        let list = server.get("/v1/presets").await.ok().json();
        let names: Vec<&str> = list.as_array().unwrap().iter().map(|preset| preset["name"].as_str().unwrap()).collect();
        assert_eq!(names, PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>());
        for (entry, name) in list.as_array().unwrap().iter().zip(names) {
            assert_eq!(&server.get(&format!("/v1/presets/{name}")).await.ok().json(), entry);
            for field in ["doc", "source"] {
                assert!(!entry[field].as_str().unwrap().is_empty(), "{field} of {name}");
            }
            for parameter in entry["parameters"].as_array().unwrap() {
                for field in ["name", "expects", "kind", "doc"] {
                    assert!(!parameter[field].as_str().unwrap().is_empty(), "{field} of {parameter}");
                }
            }
        }
    });
}

#[test]
fn every_operator_is_listed_and_has_a_page() {
    story(settings(), async |server| {
        let list = server.get("/v1/operators").await.ok().json();
        let letters: Vec<String> =
            list.as_array().unwrap().iter().map(|entry| entry["letter"].as_str().unwrap().to_owned()).collect();
        let known: Vec<String> =
            OPERATORS.iter().filter_map(|operator| operator.facts().letter).map(String::from).collect();
        assert_eq!(letters, known);
        for letter in ["U", "D", "C", "P"] {
            assert_eq!(server.get(&format!("/v1/operators/{letter}")).await.ok().json()["letter"], letter);
        }
    });
}

#[test]
fn every_format_is_listed_with_what_it_holds() {
    story(settings(), async |server| {
        let list = server.get("/v1/formats").await.ok().json();
        for (entry, format) in list.as_array().unwrap().iter().zip(FORMATS) {
            assert_eq!(entry["name"], format.name());
            assert_eq!(entry["media_type"], format.facts().media_type);
            assert_eq!(entry["extension"], format.facts().extension);
            assert!(!entry["holds"].as_array().unwrap().is_empty());
        }
        assert_eq!(list.as_array().unwrap().len(), FORMATS.len());
    });
}

#[test]
fn limits_are_those_of_this_server() {
    let settings = planish::config::Settings { max_faces: 12_345, max_queue: 7, ..settings() };
    story(settings, async |server| {
        let list = server.get("/v1/limits").await.ok().json();
        let value = |name: &str| {
            let entry = list.as_array().unwrap().iter().find(|entry| entry["name"] == name);
            entry.unwrap_or_else(|| panic!("no limit {name} in {list}"))["value"].as_u64().unwrap()
        };
        assert_eq!((value("max_faces"), value("max_queue"), value("max_levels")), (12_345, 7, 64));
        for name in [
            "max_vertices",
            "max_output_bytes",
            "max_job_bytes",
            "max_memory_bytes",
            "max_body_bytes",
            "max_connections",
            "memory_cache_bytes",
            "cache_bytes",
            "keep_at_most_bytes",
            "run_timeout_s",
            "header_timeout_s",
            "body_timeout_s",
            "shutdown_timeout_s",
            "max_word_letters",
            "max_expression_bytes",
            "max_outputs",
            "max_polygons",
            "max_wait_s",
        ] {
            assert!(value(name) > 0, "{name}");
        }
        for entry in list.as_array().unwrap() {
            assert!(!entry["doc"].as_str().unwrap().is_empty(), "{entry}");
        }
    });
}

#[test]
fn every_reader_is_listed_and_json_after_them() {
    story(settings(), async |server| {
        let list = server.get("/v1/readers").await.ok().json();
        let names: Vec<&str> = list.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect();
        assert_eq!(names, READERS.iter().map(|reader| reader.name).chain(["json"]).collect::<Vec<_>>());
        for entry in list.as_array().unwrap() {
            for field in ["media_type", "extension", "doc"] {
                assert!(!entry[field].as_str().unwrap().is_empty(), "{field} of {entry}");
            }
        }
    });
}
