//! The command line: the same jobs as over HTTP give the same bytes.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod batch;
mod compare;
mod evaluate;
mod figures;
mod flags;
mod keys;
mod mcp;
mod reproduce;
mod server;

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use planish::config::{Setting, Settings};
use planish::output::FORMATS;
use serde_json::{Value, json};

use crate::http::jobs::{endless, formats, mesh, polygon, with};
use crate::http::server::Folder;
use crate::support::render;

/// Exit codes of the commands, see `planish --help`.
const OTHER: i32 = 1;
const USAGE: i32 = 2;
const REFUSED: i32 = 3;
const LIMIT: i32 = 4;
const FILES: i32 = 5;

/// Returns the program, without the settings in the environment of the tests.
pub(crate) fn planish() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_planish"));
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("PLANISH_")) {
        command.env_remove(name);
    }
    command.stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Output {
    planish().args(arguments).output().unwrap()
}

/// Runs the program with a job on standard input.
fn piped(arguments: &[&str], input: &Value) -> Output {
    fed(arguments, input.to_string().as_bytes())
}

/// Runs the program with bytes on standard input.
fn fed(arguments: &[&str], input: &[u8]) -> Output {
    let mut child =
        planish().args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn saved(folder: &Folder, job: &Value) -> String {
    let path = folder.path().join("job.json");
    std::fs::write(&path, job.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Checks that the program failed with an exit code and a message that contains these parts.
fn fails(code: i32, output: &Output, parts: &[&str]) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(output.stdout.is_empty(), "nothing but an answer goes to standard output");
    for part in parts {
        assert!(said.contains(part), "{part:?} in {said}");
    }
}

#[test]
fn the_extension_chooses_the_format_and_the_bytes_are_those_of_the_library() {
    let folder = Folder::new();
    for (is_mesh, job) in [(true, mesh(2)), (false, polygon(2))] {
        let path = saved(&folder, &job);
        for format in formats(is_mesh).into_iter().filter(|format| format.name() == format.extension()) {
            let target = folder.path().join(format!("out.{}", format.extension()));
            let output = run(&["render", &path, "-o", target.to_str().unwrap()]);
            assert!(output.status.success(), "{}", text(&output.stderr));
            let (expected, _) = render(&with(job.clone(), format.name())).unwrap();
            assert_eq!(std::fs::read(&target).unwrap(), expected, "{}", format.name());
        }
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().contains("part")), "{left:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_small_job_starts_no_threads() {
    let mut child = planish()
        .args(["render", "-", "-o", "-", "--format", "obj"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(mesh(4).to_string().as_bytes()).unwrap();
    let mut out = child.stdout.take().unwrap();
    out.read_exact(&mut [0]).unwrap();
    // the rest is more than a pipe holds, so that the program waits for its reader
    let computing = || -> Vec<String> {
        let threads = std::fs::read_dir(format!("/proc/{}/task", child.id())).unwrap();
        let names = threads.map(|thread| std::fs::read_to_string(thread.unwrap().path().join("comm")).unwrap());
        names.filter(|name| !name.starts_with("jemalloc")).collect()
    };
    // the allocator has a thread of its own, which gets its name only after its start; other threads would remain
    let tries = std::iter::repeat_with(|| {
        std::thread::sleep(Duration::from_millis(10));
        computing()
    });
    let last = tries.take(200).enumerate().find(|(at, names)| names.len() == 1 || *at == 199);
    let (_, computing) = last.unwrap();
    let mut rest = Vec::new();
    out.read_to_end(&mut rest).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(rest.len() > 1 << 16, "{}", rest.len());
    assert_eq!(computing, ["planish\n"]);
}

#[test]
fn a_dash_is_a_standard_stream() {
    let held = |name| formats(true).iter().any(|held| held.name() == name);
    // a warning states how exact solids are
    for format in FORMATS.iter().filter(|format| held(format.name()) && !format.is_of_limit()) {
        let output = piped(&["render", "-", "-o", "-", "--format", format.name()], &mesh(1));
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(output.stderr.is_empty(), "no bar without a terminal");
        let (expected, _) = render(&with(mesh(1), format.name())).unwrap();
        assert_eq!(output.stdout, expected, "{}", format.name());
    }
    let one = piped(&["render", "-", "-o", "-"], &with(mesh(1), "obj"));
    assert_eq!(one.stdout, render(&with(mesh(1), "obj")).unwrap().0, "the job's only output");
    fails(USAGE, &piped(&["render", "-", "-o", "-"], &mesh(1)), &["--format"]);
}

#[test]
fn the_options_of_the_output_that_fits_are_used() {
    let folder = Folder::new();
    let mut job = mesh(1);
    job["outputs"] = json!([{ "format": "obj" }, { "format": "png", "width": 60, "height": 40 }]);
    let target = folder.path().join("picture.png");
    let output = run(&["render", &saved(&folder, &job), "-o", target.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let picture = image::load_from_memory(&std::fs::read(&target).unwrap()).unwrap();
    assert_eq!((picture.width(), picture.height()), (60, 40));
}

#[test]
fn mistakes_are_named_with_their_place_and_end_with_the_code_of_their_kind() {
    let folder = Folder::new();
    let target = folder.path().join("out.glb");
    let render = |job: &Value| run(&["render", &saved(&folder, job), "-o", target.to_str().unwrap()]);
    let mut typo = mesh(2);
    typo["level"] = json!(2);
    fails(REFUSED, &render(&typo), &["job.json: /level", "unknown field", "levels"]);
    let mut index = mesh(2);
    index["input"]["mesh"]["faces"][2][0] = json!(80);
    fails(REFUSED, &render(&index), &["/input/mesh/faces/2/0", "80"]);
    fails(LIMIT, &render(&mesh(40)), &["at most"]);
    let drawing = folder.path().join("out.stl");
    let output = run(&["render", &saved(&folder, &polygon(1)), "-o", drawing.to_str().unwrap()]);
    fails(REFUSED, &output, &["job.json: --output: "]);
    assert!(!target.exists() && !drawing.exists(), "a job that fails leaves no file");
    let mut far = mesh(1);
    far["input"]["mesh"]["positions"][0] = json!([1e300, 0, 0]);
    far["outputs"] = json!([{ "format": "obj" }, { "format": "stl" }]);
    let file = folder.path().join("out.stl");
    fails(REFUSED, &run(&["render", &saved(&folder, &far), "-o", file.to_str().unwrap()]), &["/outputs/1: "]);
    fails(FILES, &run(&["render", "/nowhere/job.json", "-o", "out.glb"]), &["/nowhere/job.json"]);
    let half = folder.path().join("half.json");
    std::fs::write(&half, "{\"input\": ").unwrap();
    fails(REFUSED, &run(&["render", half.to_str().unwrap(), "-o", "x.glb"]), &["it is not JSON", "line 1"]);
    fails(USAGE, &run(&["render", &saved(&folder, &mesh(1)), "-o", "x.fbx"]), &[".fbx", "--format"]);
    fails(FILES, &run(&["render", &saved(&folder, &mesh(1)), "-o", "/nowhere/x.glb"]), &["/nowhere/x.glb"]);
    let small = run(&["render", &saved(&folder, &mesh(4)), "-o", "x.glb", "--max-faces", "100"]);
    fails(LIMIT, &small, &["100 faces", "--max-faces allows more"]);
    assert_eq!(run(&["rendre"]).status.code(), Some(USAGE), "a wrong command line is no failed job");
}

#[test]
fn an_estimate_is_that_of_the_service() {
    let output = piped(&["estimate", "-"], &mesh(3));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let estimate: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(estimate["levels"][3]["faces"], 384);
    let settings = crate::http::server::settings();
    let answered =
        crate::http::server::story(settings, async |server| server.post("/v1/estimate", &mesh(3)).await.json());
    assert_eq!(estimate, answered);
    fails(REFUSED, &piped(&["estimate", "-"], &json!({ "input": {} })), &["/input"]);
}

#[test]
fn an_analysis_takes_the_place_of_a_file_only_when_it_is_whole() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("found.json"), "before").unwrap();
    // A second name of the same file tells whether the file is written over or another one takes its place.
    std::fs::hard_link(path("found.json"), path("kept.json")).unwrap();
    let output = run(&["analyse", "--preset", "chaikin", "-o", path("found.json").to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found: Value = serde_json::from_slice(&std::fs::read(path("found.json")).unwrap()).unwrap();
    assert!(found.is_object());
    assert_eq!(std::fs::read(path("kept.json")).unwrap(), b"before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing unfinished is left");
    let nowhere = path("none/found.json");
    let output = run(&["analyse", "--preset", "chaikin", "-o", nowhere.to_str().unwrap()]);
    fails(FILES, &output, &["cannot write", "found.json"]);
}

#[test]
fn presets_are_listed_and_explained() {
    let list = text(&run(&["presets"]).stdout);
    for preset in planish::scheme::presets::PRESETS {
        assert!(list.lines().any(|line| line.starts_with(preset.name)), "{}", preset.name);
        let one = text(&run(&["presets", preset.name]).stdout);
        for parameter in preset.parameters {
            assert!(one.contains(parameter.name), "{} of {}", parameter.name, preset.name);
        }
        assert!(one.contains(preset.source), "{one}");
    }
    fails(USAGE, &run(&["presets", "nurbs"]), &["nurbs", "planish presets"]);
}

#[test]
fn help_lists_every_setting_with_its_variable_and_default() {
    let output = planish().args(["serve", "--help"]).output().unwrap();
    assert!(output.status.success());
    let help = text(&output.stdout);
    for Setting { name, .. } in Settings::default().list() {
        assert!(help.contains(&format!("--{}", name.replace('_', "-"))), "--{name}");
        assert!(help.contains(&format!("PLANISH_{}", name.to_uppercase())), "PLANISH_{name}");
    }
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.matches("[default: ").count() >= Settings::default().list().len(), "{help}");
    for (command, word) in [("render", "--output"), ("estimate", "INPUT"), ("presets", "NAME"), ("health", "--url")] {
        assert!(text(&run(&[command, "--help"]).stdout).contains(word), "{command}");
    }
}

#[test]
fn settings_come_from_flags_then_variables_then_the_file() {
    let folder = Folder::new();
    let file = folder.path().join("planish.toml");
    std::fs::write(&file, "max-faces = 1\nmax-queue = 2\nmax-wait = 3\n").unwrap();
    let with_file = |file: &Path| {
        let mut command = planish();
        command.args(["serve", "--listen", "127.0.0.1:0", "--cache-bytes", "0", "--config"]).arg(file);
        command
    };
    fails(USAGE, &with_file(&file).output().unwrap(), &["max-wait"]);
    fails(USAGE, &with_file(&folder.path().join("none.toml")).output().unwrap(), &["none.toml"]);
    std::fs::write(&file, "max-faces = 1\nmax-queue = 2\nmax-vertices = 3\ndata-dir = \"\"\n").unwrap();
    let mut command = with_file(&file);
    command.args(["--max-faces", "100"]).env("PLANISH_MAX_FACES", "10").env("PLANISH_MAX_QUEUE", "20");
    let (service, url) = started(&mut command);
    let limits: Value = serde_json::from_str(&get(&url, "/v1/limits")).unwrap();
    let value =
        |name: &str| limits.as_array().unwrap().iter().find(|limit| limit["name"] == name).unwrap()["value"].clone();
    assert_eq!((value("max_faces"), value("max_queue"), value("max_vertices")), (100.into(), 20.into(), 3.into()));
    assert_eq!(ended(service), Some(0));
}

#[test]
fn a_service_serves_until_it_is_told_to_end_and_ends_well() {
    let folder = Folder::new();
    let mut command = planish();
    command.args(["serve", "--listen", "127.0.0.1:0", "--data-dir"]).arg(folder.path());
    let (service, url) = started(&mut command);
    assert_eq!(get(&url, "/livez"), "alive\n");
    let made = post(&url, &mesh(2), "");
    assert!(made.starts_with("HTTP/1.1 200"), "{made}");
    assert_eq!(ended(service), Some(0));

    let (service, url) = started(&mut command);
    let kept = post(&url, &mesh(2), "");
    assert!(kept.contains("planish; hit"), "{kept}");
    assert_eq!(ended(service), Some(0));
}

#[test]
fn a_service_with_an_endless_job_ends_in_time_too() {
    let mut command = planish();
    command.args(["serve", "--listen", "localhost:0", "--cache-bytes", "0kB", "--shutdown-timeout-s", "1s"]);
    let (service, url) = started(&mut command);
    let later = post(&url, &with(endless(), "stats"), "prefer: wait=0\r\n");
    assert!(later.starts_with("HTTP/1.1 202"), "{later}");
    assert_eq!(ended(service), Some(0));
}

#[test]
fn health_tells_by_its_code_whether_a_service_is_ready() {
    let mut command = planish();
    command.args(["serve", "--listen", "127.0.0.1:0", "--cache-bytes", "0"]);
    let (service, url) = started(&mut command);
    let start = std::time::Instant::now();
    while !run(&["health", "--url", &format!("http://{url}")]).status.success() {
        assert!(start.elapsed() < crate::http::server::PATIENCE, "never ready");
    }
    assert_eq!(ended(service), Some(0));
    fails(OTHER, &run(&["health", "--url", &format!("http://{url}")]), &["no answer"]);
    for wrong in ["nonsense", "ftp://127.0.0.1", "http://", "http://127.0.0.1:port"] {
        fails(USAGE, &run(&["health", "--url", wrong]), &["--url: ", wrong, "is no address; write http://HOST:PORT"]);
    }
}

#[test]
fn a_service_that_cannot_start_says_why() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    fails(FILES, &run(&["serve", "--listen", &address, "--cache-bytes", "0"]), &[&address, "--listen"]);
    fails(FILES, &run(&["serve", "--listen", "127.0.0.1:0", "--data-dir", "/dev/null/x"]), &["--data-dir"]);
    fails(USAGE, &run(&["serve", "--max-queue", "0"]), &["max_queue"]);
    fails(USAGE, &run(&["serve", "--cache-bytes", "lots"]), &["--cache-bytes", "64MiB"]);
    fails(USAGE, &run(&["serve", "--listen", "8080"]), &["--listen", "localhost:8080"]);
    fails(USAGE, &run(&["serve", "--log", "wran"]), &["did you mean \"warn\"?"]);
    let with = |name: &str, value: &str| planish().arg("serve").env(name, value).output().unwrap();
    fails(USAGE, &with("PLANISH_LISTN", ":0"), &["PLANISH_LISTN", "did you mean PLANISH_LISTEN?"]);
    fails(USAGE, &with("PLANISH_LOG", "inof"), &["PLANISH_LOG", "did you mean \"info\"?"]);
}

#[test]
fn settings_that_cannot_be_or_do_nothing_are_told() {
    fails(USAGE, &run(&["serve", "--threads", "-1"]), &["--threads", "\"-1\" is no whole number"]);
    fails(USAGE, &run(&["serve", "--cache-bytes", "-3"]), &["--cache-bytes", "\"-3\" is no size"]);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let serve = ["serve", "--listen", &address, "--data-dir", ""];
    let said = |more: &[&str]| text(&run(&[&serve[..], more].concat()).stderr);
    let idle = "s3-bucket is without effect";
    assert!(said(&["--s3-bucket", "farm"]).contains(idle));
    assert!(!said(&[]).contains(idle));
}

/// Starts the service under a limit on open files, which a shell sets.
#[cfg(target_os = "linux")]
fn with_files(limit: &str) -> (Service, String) {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_planish"), "serve"]);
    command.args(["--listen", "127.0.0.1:0", "--data-dir", "", "--log", "error"]);
    started(&mut command)
}

#[test]
#[cfg(target_os = "linux")]
fn the_limit_on_open_files_is_raised_or_else_bounds_connections_so_that_newcomers_are_answered() {
    let (service, url) = with_files("-Sn 100");
    let limits: Value = serde_json::from_str(&get(&url, "/v1/limits")).unwrap();
    let most = limits.as_array().unwrap().iter().find(|limit| limit["name"] == "max_connections").unwrap();
    assert_eq!(most["value"], 1024, "the system grants more when asked");
    assert_eq!(ended(service), Some(0));

    let (service, url) = with_files("-n 64");
    let idle: Vec<_> = (0..100).map(|_| std::net::TcpStream::connect(&url).unwrap()).collect();
    assert_eq!(get(&url, "/livez"), "alive\n", "beside {} idle connections", idle.len());
    assert_eq!(ended(service), Some(0));
}

/// A process of the service, killed when the value is dropped.
pub(crate) struct Service(pub(crate) Child);

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts a service and returns it with its host and port.
fn started(command: &mut Command) -> (Service, String) {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let url = line.trim().rsplit("http://").next().unwrap().to_owned();
    assert!(line.contains("listening"), "{line}");
    // the rest of its messages is read, so that the service never waits for a reader
    std::thread::spawn(move || std::io::copy(&mut said, &mut std::io::sink()));
    (Service(child), url)
}

/// Terminates a service and returns its exit code.
pub(crate) fn ended(mut service: Service) -> Option<i32> {
    let told = Command::new("kill").args(["-TERM", &service.0.id().to_string()]).status().unwrap();
    assert!(told.success());
    let start = std::time::Instant::now();
    loop {
        if let Some(status) = service.0.try_wait().unwrap() {
            return status.code();
        }
        assert!(start.elapsed() < crate::http::server::PATIENCE, "it does not end");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

pub(crate) fn exchanged(host: &str, request: &str) -> String {
    let mut stream = std::net::TcpStream::connect(host).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    text(&answer)
}

pub(crate) fn get(host: &str, path: &str) -> String {
    let answer = exchanged(host, &format!("GET {path} HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n"));
    answer.split_once("\r\n\r\n").unwrap().1.to_owned()
}

fn post(host: &str, job: &Value, headers: &str) -> String {
    let job = job.to_string();
    let length = job.len();
    exchanged(
        host,
        &format!(
            "POST /v1/render HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\ncontent-type: application/json\r\n\
             content-length: {length}\r\n{headers}\r\n{job}"
        ),
    )
}

#[test]
fn mesh_files_are_converted_drawn_and_refined() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let job = saved(&folder, &json!({ "input": mesh(0)["input"] }));
    for from in ["obj", "ply", "stl", "glb", "gltf", "json"] {
        let file = path(&format!("cube.{from}"));
        assert!(run(&["render", &job, "-o", &file]).status.success(), "{from}");
        let output = run(&["render", &file, "-o", &path("cube.png")]);
        assert!(output.status.success() && output.stderr.is_empty(), "{from}: {}", text(&output.stderr));
        let output =
            run(&["render", &file, "--pair-quads", "--weld", "0", "--orient", "repair", "-o", &path("out.json")]);
        assert!(output.status.success(), "{from}: {}", text(&output.stderr));
        let found: Value = serde_json::from_slice(&std::fs::read(path("out.json")).unwrap()).unwrap();
        assert_eq!((found["positions"].as_array().unwrap().len(), found["faces"].as_array().unwrap().len()), (8, 6));
    }
    let refined = run(&["render", &path("cube.OBJ"), "-o", "-", "--format", "json"]);
    fails(FILES, &refined, &["cannot be read"]);
    let options = ["--preset", "catmull-clark", "--levels", "2", "--format", "json", "-o", "-"];
    let refined = run(&[&["render", path("cube.obj").as_str()][..], &options].concat());
    assert_eq!(refined.stdout, render(&with(mesh(2), "json")).unwrap().0);
    let estimate = run(&["estimate", &path("cube.ply"), "--preset", "catmull-clark", "--levels", "3"]);
    let estimate: Value = serde_json::from_slice(&estimate.stdout).unwrap();
    assert_eq!(estimate["levels"][3]["faces"], 384);
}

#[test]
fn broken_mesh_files_are_told_by_line() {
    let folder = Folder::new();
    let path = folder.path().join("broken.off");
    std::fs::write(&path, "OFF\n1 1 0\n0 0 zero\n3 0 0 0\n").unwrap();
    let output = run(&["render", path.to_str().unwrap(), "-o", "-", "--format", "glb"]);
    fails(REFUSED, &output, &["broken.off: line 3: vertex 0: \"zero\" is no number"]);
}
