//! One request and its full answer for every route, in `api/examples/http`: written by a running server, and verified
//! here.

use std::path::{Path, PathBuf};

use axum::http::HeaderMap;
use base64::Engine;
use serde_json::Value;

use super::jobs::{mesh, polygon, with};
use super::server::{Answer, Server, settings, story};

/// A request, as in a file.
struct Asked {
    method: &'static str,
    path: String,
    headers: Vec<(&'static str, String)>,
    body: String,
}

impl Asked {
    fn get(path: impl Into<String>) -> Self {
        Self { method: "GET", path: path.into(), headers: Vec::new(), body: String::new() }
    }

    fn post(path: &str, body: &Value) -> Self {
        let body = body.to_string();
        Self { method: "POST", path: path.into(), headers: vec![("content-type", "application/json".into())], body }
    }

    fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.headers.push((name, value.into()));
        self
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("api/examples/http")
}

#[test]
fn the_committed_requests_have_the_committed_answers() {
    let told = story(settings(), async |server| {
        let mut told = Vec::new();
        told.extend(results(server).await);
        told.extend(questions(server).await);
        told.extend(refusals(server).await);
        told
    });
    // jobs of a batch are read in parallel, and readyz shows the maximum memory
    let told = [told, story(settings(), batches)].concat();
    if std::env::var_os("BLESS").is_some() {
        let _ = std::fs::remove_dir_all(folder());
        std::fs::create_dir_all(folder()).unwrap();
        told.iter().for_each(|(name, text)| std::fs::write(folder().join(format!("{name}.http")), text).unwrap());
    }
    for (name, text) in &told {
        let committed = std::fs::read_to_string(folder().join(format!("{name}.http"))).unwrap_or_default();
        assert_eq!(&committed, text, "{name}.http is out of date; BLESS=1 cargo test examples rewrites it");
    }
    let n_files = std::fs::read_dir(folder()).unwrap().count();
    assert_eq!(n_files, told.len(), "every file is told by the server");
}

/// Renders and artifacts.
async fn results(server: &Server) -> Vec<(&'static str, String)> {
    let mut told = Vec::new();
    let render = || Asked::post("/v1/render", &mesh(1)).with("accept", "model/gltf-binary");
    told.push(("render-miss", exchange(server, render()).await));
    told.push(("render-hit", exchange(server, render()).await));
    let made = server.render(&mesh(1)).await.ok();
    let (etag, place) = (made.header("etag").to_owned(), made.header("content-location").to_owned());
    told.push(("render-not-modified", exchange(server, render().with("if-none-match", etag.clone())).await));
    told.push(("render-svg", exchange(server, Asked::post("/v1/render", &with(polygon(2), "svg"))).await));
    told.push(("artifact", exchange(server, Asked::get(place.clone())).await));
    told.push(("artifact-head", exchange(server, Asked { method: "HEAD", ..Asked::get(place.clone()) }).await));
    told.push(("artifact-range", exchange(server, Asked::get(place.clone()).with("range", "bytes=0-11")).await));
    told.push((
        "artifact-range-beyond",
        exchange(server, Asked::get(place.clone()).with("range", "bytes=9999999-")).await,
    ));
    told.push(("artifact-not-modified", exchange(server, Asked::get(place.clone()).with("if-none-match", etag)).await));

    let place = made.header("content-location");
    let coded = || Asked::get(place).with("accept-encoding", "zstd, br, gzip");
    told.push(("artifact-coded", exchange(server, coded()).await));
    told.extend(ways(server).await);

    let held = server.hold().await;
    let later = || Asked::post("/v1/render", &with(mesh(2), "obj")).with("prefer", "wait=0");
    told.push(("render-later", exchange(server, later()).await));
    let location = server.post_with("/v1/render", &with(mesh(2), "obj"), &[("prefer", "wait=0")]).await;
    let location = location.header("location").to_owned();
    told.push(("job-queued", exchange(server, Asked::get(location.clone())).await));
    drop(held);
    server.settled(&location).await;
    told.push(("job-done", exchange(server, Asked::get(location)).await));
    told.extend(jobs(server).await);
    told
}

/// Jobs that are posted, followed, listed, cancelled and forgotten; files that are uploaded before.
async fn jobs(server: &Server) -> Vec<(&'static str, String)> {
    let mut job = mesh(2);
    job["outputs"] = serde_json::json!([{ "format": "stats" }, { "name": "model", "format": "stl" }]);
    let held = server.hold().await;
    let mut told = vec![(
        "jobs-post",
        exchange(server, Asked::post("/v1/jobs?priority=batch", &job).with("prefer", "wait=1")).await,
    )];
    let location = server.post("/v1/jobs", &job).await.header("location").to_owned();
    let cancel = Asked { method: "POST", ..Asked::get(format!("{location}/cancel")) };
    told.push(("job-cancel", exchange(server, cancel).await));
    drop(held);
    let wait = || Asked::post("/v1/jobs", &job).with("prefer", "wait=60");
    told.push(("jobs-wait", exchange(server, wait()).await));
    told.push(("jobs-list", exchange(server, Asked::get("/v1/jobs?limit=1")).await));
    told.push(("job-events", exchange(server, Asked::get(format!("{location}/events"))).await));
    let forget = Asked { method: "DELETE", ..Asked::get(location.clone()) };
    told.push(("job-forget", exchange(server, forget).await));
    told.push(("refused-404-no-such-job", exchange(server, Asked::get(location)).await));
    let mut file = Asked::post("/v1/blobs", &Value::Null);
    file.headers[0].1 = "model/obj".into();
    file.body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n".into();
    let id = format!("b3-{}", blake3::hash(file.body.as_bytes()));
    told.push(("blob-post", exchange(server, file).await));
    told.push(("blob", exchange(server, Asked::get(format!("/v1/blobs/{id}"))).await));
    told.push(("blob-head", exchange(server, Asked { method: "HEAD", ..Asked::get(format!("/v1/blobs/{id}")) }).await));
    let job = serde_json::json!({ "input": { "blob": id }, "plan": { "preset": "loop" }, "levels": 1 });
    told.push(("render-blob", exchange(server, Asked::post("/v1/render", &with(job, "stats"))).await));
    told
}

/// Batches: a grid, a list, and their results.
async fn batches(server: &Server) -> Vec<(&'static str, String)> {
    let grid = serde_json::json!({ "template": with(polygon(1), "svg"), "grid": [
        { "pointer": "/levels", "values": [1, 2] },
        { "pointer": "/plan/preset", "values": ["chaikin", "four-point"] },
    ] });
    let mut wrong = grid.clone();
    wrong["grid"][1]["values"][1] = "five-point".into();
    let wait = Asked::post("/v1/batches", &grid).with("prefer", "wait=60");
    let mut told = vec![("batches-wait", exchange(server, wait).await)];
    let location = server.post("/v1/batches", &grid).await.header("location").to_owned();
    told.push(("batches-list", exchange(server, Asked::get("/v1/batches?limit=1")).await));
    told.push(("batch-events", exchange(server, Asked::get(format!("{location}/events"))).await));
    let archive = Asked { method: "HEAD", ..Asked::get(format!("{location}/archive.zip")) };
    told.push(("batch-archive-head", exchange(server, archive).await));
    let cancel = Asked { method: "POST", ..Asked::get(format!("{location}/cancel")) };
    told.push(("batch-cancel", exchange(server, cancel).await));
    let forget = Asked { method: "DELETE", ..Asked::get(location) };
    told.push(("batch-forget", exchange(server, forget).await));
    told.push(("refused-422-batch", exchange(server, Asked::post("/v1/batches", &wrong)).await));
    told
}

/// Other notations of a job: a mesh file with a query, an address.
async fn ways(server: &Server) -> Vec<(&'static str, String)> {
    let mut file = Asked::post("/v1/render?preset=loop&levels=2&format=stl", &Value::Null);
    file.headers[0].1 = "model/obj".into();
    file.body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n".into();
    let mut told = vec![("render-file", exchange(server, file).await)];
    let base64url = |job: &Value| base64::engine::general_purpose::URL_SAFE_NO_PAD.encode(job.to_string());
    let link = format!("/v1/render?job={}", base64url(&with(polygon(2), "svg")));
    told.push(("render-link", exchange(server, Asked::get(link)).await));
    let kroki = format!("/kroki/svg/{}", base64url(&polygon(2)));
    told.push(("kroki", exchange(server, Asked::get(kroki)).await));
    told
}

/// Estimate, validate, the catalogue, operations.
async fn questions(server: &Server) -> Vec<(&'static str, String)> {
    super::server::until("the canary has sung", || server.app.canary.last_success().is_some()).await;
    let input = serde_json::json!({ "input": mesh(1)["input"] });
    let mut wrong = input.clone();
    wrong["input"]["mesh"]["faces"][2][1] = 77.into();
    let mut told = Vec::new();
    for (name, asked) in [
        ("estimate", Asked::post("/v1/estimate", &mesh(3))),
        ("validate", Asked::post("/v1/validate", &input)),
        ("validate-faults", Asked::post("/v1/validate", &wrong)),
        ("analyses", Asked::post("/v1/analyses", &serde_json::json!({ "plan": { "preset": "chaikin" } }))),
        ("compare", Asked::post("/v1/compare", &serde_json::json!({ "a": polygon(2), "b": polygon(6) }))),
        (
            "evaluate",
            Asked::post(
                "/v1/evaluate",
                &serde_json::json!({ "input": mesh(1)["input"], "plan": { "preset": "catmull-clark" },
                    "at": [[0, 0, 0], [0, 0.5, 0.25]], "values": ["position", "normal", "curvatures"] }),
            ),
        ),
        ("preset", Asked::get("/v1/presets/four-point")),
        ("operator", Asked::get("/v1/operators/U")),
        ("presets", Asked::get("/v1/presets")),
        ("operators", Asked::get("/v1/operators")),
        ("formats", Asked::get("/v1/formats")),
        ("readers", Asked::get("/v1/readers")),
        ("limits", Asked::get("/v1/limits")),
        ("livez", Asked::get("/livez")),
        ("readyz", Asked::get("/readyz")),
        ("metrics", Asked::get("/metrics")),
        ("openapi", Asked::get("/openapi.json")),
        ("index", Asked::get("/")),
        ("docs", Asked::get("/docs")),
        ("problem-page", Asked::get("/docs/problems/too-large")),
    ] {
        told.push((name, exchange(server, asked).await));
    }
    told
}

/// One error of each class that a single request can meet.
async fn refusals(server: &Server) -> Vec<(&'static str, String)> {
    let mut typo = polygon(2);
    typo["level"] = 2.into();
    let mut text = Asked::post("/v1/render", &polygon(2));
    text.headers[0].1 = "text/plain".into();
    let mut half = Asked::post("/v1/render", &polygon(2));
    half.body.truncate(40);
    let mut told = Vec::new();
    for (name, asked) in [
        ("refused-400-half-a-json", half),
        ("refused-404-no-such-page", Asked::get("/v2")),
        ("refused-405-get-on-estimate", Asked::get("/v1/estimate")),
        ("refused-406-audio", Asked::post("/v1/render", &mesh(1)).with("accept", "audio/flac")),
        ("refused-415-text", text),
        ("refused-422-typo", Asked::post("/v1/render", &typo)),
        ("refused-422-too-large", Asked::post("/v1/render", &mesh(40))),
    ] {
        told.push((name, exchange(server, asked).await));
    }
    told
}

/// Sends a request, and formats the request and the answer.
async fn exchange(server: &Server, asked: Asked) -> String {
    let headers: Vec<_> = asked.headers.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let answer =
        server.ask(asked.method.parse().unwrap(), &asked.path, &headers, asked.body.clone().into_bytes()).await;
    let mut lines = vec![format!("{} {} HTTP/1.1\nhost: localhost:8080\n", asked.method, asked.path)];
    lines.extend(headers.iter().map(|(name, value)| format!("{name}: {value}\n")));
    if !asked.body.is_empty() {
        lines.push(format!("content-length: {}\n\n{}", asked.body.len(), ended(&asked.body)));
    }
    let status = axum::http::StatusCode::from_u16(answer.status).unwrap();
    let (body, steady) = told_body(&answer);
    let headers = told_headers(&answer.headers, steady);
    lines.push(format!("\nHTTP/1.1 {status}\n{headers}\n{body}"));
    lines.concat()
}

/// Formats the headers in the order of their names, so that a server may send them in any; the length only if the body
/// is steady.
fn told_headers(headers: &HeaderMap, steady: bool) -> String {
    let told = |(name, value): (&axum::http::HeaderName, &axum::http::HeaderValue)| match name.as_str() {
        "content-length" if !steady => "content-length: {length}\n".to_owned(),
        name => told_header(name, value.to_str().unwrap()),
    };
    let mut lines: Vec<String> = headers.iter().map(told).collect();
    lines.sort();
    lines.concat()
}

fn told_header(name: &str, value: &str) -> String {
    let told = match name {
        "date" => "{date}".to_owned(),
        "server-timing" => {
            let stages = value.split(", ").map(|entry| format!("{};dur={{ms}}", entry.split(';').next().unwrap()));
            stages.collect::<Vec<_>>().join(", ")
        }
        _ => value.to_owned(),
    };
    format!("{name}: {told}\n")
}

/// Formats the body, and tells whether its length is the same in every run and with every growth of the catalogue.
///
/// Of lists only the first entry is shown; of long or binary bodies, length and hash.
fn told_body(answer: &Answer) -> (String, bool) {
    let kind = answer.header("content-type");
    if answer.body.is_empty() {
        return (String::new(), true);
    }
    if kind == "application/json" && answer.json().is_array() {
        return (format!("[{}, {{more}}]\n", answer.json()[0]), false);
    }
    if kind.contains("version=0.0.4") {
        return ("{metrics, one a line}\n".to_owned(), false);
    }
    let is_text = ["text/", "application/", "image/svg"].iter().any(|start| kind.starts_with(start));
    match is_text {
        true if answer.body.len() < 4096 => measured(&answer.text()),
        true => ("{as in api/openapi.json}\n".to_owned(), false),
        false => (format!("{{{} bytes, BLAKE3 {}}}\n", answer.body.len(), blake3::hash(&answer.body)), true),
    }
}

/// Replaces measured or counted values in JSON by placeholders, and tells whether the length is steady; other text is
/// returned as it is.
fn measured(text: &str) -> (String, bool) {
    if text.starts_with("id: ") {
        return (events(text), false);
    }
    let Ok(mut value) = serde_json::from_str::<Value>(text) else { return (ended(text), true) };
    let (mut changed, mut steady) = (false, true);
    for (pointer, told) in [
        ("/actual/time_ms", "{ms}"),
        ("/jobs/0/actual/time_ms", "{ms}"),
        ("/jobs/0/timings_ms/queue", "{ms}"),
        ("/jobs/0/timings_ms/refine", "{ms}"),
        ("/jobs/0/timings_ms/render", "{ms}"),
        ("/jobs/0/timings_ms/encode", "{ms}"),
        ("/trace_id", "0123456789abcdef"),
        ("/canary_age_s", "{s}"),
        ("/canary_ms", "{ms}"),
        ("/timings_ms/queue", "{ms}"),
        ("/timings_ms/refine", "{ms}"),
        ("/timings_ms/render", "{ms}"),
        ("/timings_ms/encode", "{ms}"),
    ] {
        if let Some(place) = value.pointer_mut(pointer) {
            *place = told.into();
            changed = true;
            steady &= pointer == "/trace_id";
        }
    }
    // the maximum memory depends on the coincidence of requests
    for share in value.pointer_mut("/memory").and_then(Value::as_array_mut).into_iter().flatten() {
        share["most"] = "{bytes}".into();
    }
    let text = if changed { value.to_string() } else { text.to_owned() };
    (ended(&text.replace("\"{ms}\"", "{ms}").replace("\"{s}\"", "{s}").replace("\"{bytes}\"", "{bytes}")), steady)
}

/// Replaces measured values in the data of each server-sent event.
fn events(text: &str) -> String {
    let told = |line: &str| match line.strip_prefix("data: ") {
        Some(data) => format!("data: {}", measured(data).0),
        None => format!("{line}\n"),
    };
    text.lines().map(told).collect()
}

fn ended(text: &str) -> String {
    if text.is_empty() || text.ends_with('\n') { text.to_owned() } else { format!("{text}\n") }
}
