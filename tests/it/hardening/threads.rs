//! The threads of a service: the name of each states its purpose, and their number does not grow with the requests.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

use serde_json::json;

use crate::cli::{Service, exchanged, get, planish};
use crate::http::jobs::{mesh, with};

/// Returns the number of threads of a process by name, without the numbers in the names.
fn threads(process: u32) -> BTreeMap<String, usize> {
    let mut names = BTreeMap::new();
    for task in std::fs::read_dir(format!("/proc/{process}/task")).unwrap() {
        // a thread may end in the meantime
        let Ok(name) = std::fs::read_to_string(task.unwrap().path().join("comm")) else { continue };
        let name = name.trim().trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('-');
        *names.entry(name.to_owned()).or_default() += 1;
    }
    names
}

#[test]
fn the_service_computes_on_its_own_threads_and_never_on_a_pool_of_the_process() {
    let mut command = planish();
    command.args(["serve", "--listen", "127.0.0.1:0", "--cache-bytes", "0", "--threads", "3"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    let url = line.trim().rsplit("http://").next().unwrap().to_owned();
    let service = Service(child);
    let ask = |path: &str, job: &serde_json::Value| {
        let (body, host) = (job.to_string(), &url);
        let head =
            format!("POST {path} HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\ncontent-type: application/json\r\n");
        exchanged(&url, &format!("{head}content-length: {}\r\n\r\n{body}", body.len()))
    };
    let mut tolerance = with(mesh(1), "stats");
    tolerance["levels"] = json!({ "tolerance": 0.2 });
    for job in [with(mesh(5), "png"), with(mesh(6), "glb"), tolerance] {
        for path in ["/v1/estimate", "/v1/render"] {
            assert!(ask(path, &job).starts_with("HTTP/1.1 200"), "{path}: {job}");
        }
    }
    assert!(ask("/v1/validate", &json!({ "input": mesh(1)["input"] })).starts_with("HTTP/1.1 200"));
    assert_eq!(get(&url, "/livez"), "alive\n");
    let threads = threads(service.0.id());
    for lane in ["reading", "short", "long"] {
        assert_eq!(threads.get(lane), Some(&3), "{threads:?}");
    }
    // unnamed threads, such as those of a global pool, would have the name of the process
    assert_eq!(threads.get("planish"), Some(&1), "{threads:?}");
}
