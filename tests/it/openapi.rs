//! The OpenAPI document: committed, correct, and suitable for a client generator.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeSet;
use std::path::Path;

use planish::http::document_text;
use planish::output::FORMATS;
use serde_json::Value;

fn document() -> Value {
    serde_json::from_str(&document_text()).unwrap()
}

/// Returns every operation: method, path, and its entry in the document.
fn operations(document: &Value) -> Vec<(String, String, &Value)> {
    let mut found = Vec::new();
    for (path, methods) in document["paths"].as_object().unwrap() {
        for (method, operation) in methods.as_object().unwrap() {
            found.push((method.clone(), path.clone(), operation));
        }
    }
    found
}

#[test]
fn the_committed_document_is_what_the_code_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("api/openapi.json");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, document_text()).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == document_text(), "api/openapi.json is out of date; BLESS=1 cargo test openapi:: rewrites it");
}

/// openapi-python-client knows few media types; the settings file declares the others as bytes.
#[test]
fn the_settings_of_the_python_client_name_every_media_type_of_bytes() {
    let document = document();
    let bodies = operations(&document).into_iter().flat_map(|(_, _, operation)| {
        let responses = operation["responses"].as_object().into_iter().flat_map(|all| all.values());
        responses.chain(operation.get("requestBody")).filter_map(|body| body["content"].as_object())
    });
    let is_written =
        |kind: &str| kind.starts_with("text/") || kind.starts_with("application/") && kind.ends_with("json");
    let kinds: BTreeSet<&String> = bodies.flat_map(|content| content.keys()).filter(|kind| !is_written(kind)).collect();
    let overrides: serde_json::Map<String, Value> =
        kinds.into_iter().map(|kind| (kind.clone(), "application/octet-stream".into())).collect();
    let settings = serde_json::json!({ "content_type_overrides": overrides, "post_hooks": [] });
    let text = serde_json::to_string_pretty(&settings).unwrap() + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("api/clients/openapi-python-client.json");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == text, "{} is out of date; BLESS=1 cargo test openapi:: rewrites it", path.display());
}

#[test]
fn it_is_openapi_3_1_and_every_reference_leads_somewhere() {
    let document = document();
    assert!(document["openapi"].as_str().unwrap().starts_with("3.1."));
    let text = document_text();
    for reference in text.split("\"$ref\": \"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(document.pointer(reference).is_some(), "{reference} leads nowhere");
    }
    for name in document["components"]["schemas"].as_object().unwrap().keys() {
        assert!(text.contains(&format!("#/components/schemas/{name}\"")), "{name} is used nowhere");
    }
}

/// The list of routes is read from the source, so that a route without a description is found and no second list is
/// needed.
#[test]
fn every_route_of_the_service_is_described() {
    let document = document();
    let described: BTreeSet<&str> =
        operations(&document).iter().map(|(_, _, operation)| operation["operationId"].as_str().unwrap()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/http/routes.rs");
    let list = std::fs::read_to_string(path).unwrap();
    let lists = list.split("routes!(").skip(1).map(|rest| rest.split(')').next().unwrap());
    let handlers = lists.flat_map(|handlers| handlers.split(',')).map(|name| name.rsplit("::").next().unwrap().trim());
    // the handler of GET also answers HEAD
    let routes: BTreeSet<&str> = handlers
        .chain([
            "archive_head",
            "artifact_head",
            "blob_head",
            "kroki_head",
            "link_head",
            "signed_head",
            "signed_artifact_head",
            "signed_model_head",
        ])
        .collect();
    assert_eq!(described, routes);
}

#[test]
fn every_operation_says_what_it_takes_and_answers() {
    let document = document();
    let mut ids = BTreeSet::new();
    for (method, path, operation) in operations(&document) {
        let place = format!("{method} {path}");
        assert!(ids.insert(operation["operationId"].as_str().unwrap().to_owned()), "{place}: the id is taken");
        assert!(!operation["summary"].as_str().unwrap_or("").is_empty(), "{place} has a summary");
        let inside = path.split('{').skip(1).map(|rest| rest.split('}').next().unwrap());
        for name in inside {
            let parameters = operation["parameters"].as_array().unwrap();
            assert!(
                parameters.iter().any(|known| known["name"] == name && known["required"] == true),
                "{place}: {name}"
            );
        }
        let responses = operation["responses"].as_object().unwrap();
        for (status, response) in responses {
            assert!(!response["description"].as_str().unwrap_or("").is_empty(), "{place} {status} has a description");
            if status.starts_with(['4', '5', 'd']) && method != "head" {
                let schema = &response["content"]["application/problem+json"]["schema"]["$ref"];
                assert_eq!(schema, "#/components/schemas/ProblemAnswer", "{place} {status}");
            }
            if matches!(status.as_str(), "200" | "202" | "206") && method != "head" {
                assert!(response["content"].as_object().is_some_and(|content| !content.is_empty()), "{place} {status}");
            }
        }
        for status in ["400", "403", "414", "431", "500", "503"] {
            assert!(responses.contains_key(status), "{place} may be refused with {status}");
        }
        assert!(method == "head" || has_example(operation), "{place} has an example");
    }
}

/// Whether an operation has an example of a parameter, a body, or an answer.
fn has_example(operation: &Value) -> bool {
    let parameters = operation["parameters"].as_array().into_iter().flatten();
    let contents = [&operation["requestBody"], &operation["responses"]["200"]];
    let contents = contents.into_iter().filter_map(|body| body["content"].as_object()).flat_map(|all| all.values());
    parameters.chain(contents).any(|shown| shown.get("example").is_some() || shown.get("examples").is_some())
}

#[test]
fn results_come_in_every_format_of_the_registry() {
    let document = document();
    for (path, method, status) in
        [("/v1/render", "post", "200"), ("/v1/artifacts/{file}", "get", "200"), ("/v1/artifacts/{file}", "get", "206")]
    {
        let response = &document["paths"][path][method]["responses"][status];
        for format in FORMATS {
            assert!(response["content"].get(format.media_type()).is_some(), "{path}: {}", format.name());
        }
        let first = response["content"].as_object().unwrap().keys().next().unwrap();
        assert!(!first.contains("json"), "{path}: generators take the first for what comes, {first}");
        for header in ["ETag", "Cache-Status", "Server-Timing", "Content-Location"] {
            assert!(response["headers"].get(header).is_some(), "{path}: {header}");
        }
    }
    let variants = document["components"]["schemas"]["OutputRequest"]["discriminator"]["mapping"].as_object().unwrap();
    let names: BTreeSet<&str> = FORMATS.iter().map(|format| format.name()).collect();
    assert_eq!(variants.keys().map(String::as_str).collect::<BTreeSet<_>>(), names);
}

#[test]
fn every_field_of_a_job_is_described_and_no_other_is_allowed() {
    let document = document();
    let schemas = &document["components"]["schemas"];
    for (name, fields) in [
        ("JobRequest", &["spec", "input", "plan", "levels", "outputs"][..]),
        ("MeshInput", &["mesh", "unit", "up", "orient", "weld", "pair_quads"]),
        ("TextInput", &["text", "orient"]),
        ("PolygonInput", &["polygon", "unit", "up"]),
        ("MeshRequest", &["positions", "faces", "corners", "holes"]),
        ("PolygonRequest", &["points", "closed", "corners"]),
        ("CatmullClarkPlan", &["preset", "parameters", "boundary", "ends", "seed"]),
        ("WordPlan", &["word", "parameters", "boundary", "ends", "seed"]),
        ("GlbOutput", &["format", "name", "frame", "positions"]),
    ] {
        assert_eq!(schemas[name]["additionalProperties"], false, "{name}");
        for field in fields {
            let described = schemas[name]["properties"][field].to_string();
            assert!(described.contains("description"), "{name}.{field}: {described}");
        }
    }
}

#[test]
fn the_query_beside_a_mesh_file_is_described_as_it_is_read() {
    let document = document();
    let parameters = document["paths"]["/v1/render"]["post"]["parameters"].as_array().unwrap();
    let queries: Vec<&Value> = parameters.iter().filter(|parameter| parameter["in"] == "query").collect();
    let names: Vec<&str> = queries.iter().map(|query| query["name"].as_str().unwrap()).collect();
    for name in
        ["preset", "levels", "levels.tolerance", "format", "parameters.delta", "output.camera.zoom", "input.weld"]
    {
        assert!(names.contains(&name), "{name} is missing among {names:?}");
    }
    assert_eq!(names.len(), names.iter().collect::<BTreeSet<_>>().len(), "each once");
    for query in queries {
        let name = query["name"].as_str().unwrap();
        let mut schema = &query["schema"];
        while let Some(either) = schema["anyOf"].get(0).or_else(|| schema["oneOf"].get(0)) {
            schema = either;
        }
        let first_type = if schema["type"].is_array() { &schema["type"][0] } else { &schema["type"] };
        let value = match (&schema["enum"][0], first_type.as_str().unwrap()) {
            (Value::String(choice), _) => choice.clone(),
            (_, "integer") => "1".to_owned(),
            (_, "number") => "0.5".to_owned(),
            (_, "boolean") => "true".to_owned(),
            (_, kind) => {
                assert_eq!(kind, "string", "{name}");
                "a,b".to_owned()
            }
        };
        let read = planish::wire::query::job(&format!("{name}={value}"));
        assert!(read.is_ok(), "{name}={value}: {read:?}");
    }
}
