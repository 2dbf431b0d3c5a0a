//! Many inputs in one command: patterns, folders, failures by kind, signals.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{FILES, LIMIT, OTHER, REFUSED, USAGE, fails, fed, planish, run, text};
use crate::http::jobs::{mesh, with};
use crate::http::server::{Folder, PATIENCE};
use crate::support::render;

/// A triangle as OBJ.
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Returns a folder with these files; a file with empty content is a triangle.
fn folder(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    for (name, content) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, if content.is_empty() { TRIANGLE } else { content }).unwrap();
    }
    folder
}

/// Runs the program in a folder.
fn within(folder: &Folder, arguments: &[&str]) -> Output {
    planish().args(arguments).current_dir(folder.path()).output().unwrap()
}

/// Returns the names of all files below a subfolder.
fn files(folder: &Folder, below: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut waiting = vec![folder.path().join(below)];
    while let Some(path) = waiting.pop() {
        let entries: Vec<PathBuf> =
            std::fs::read_dir(path).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
        let (folders, files): (Vec<_>, Vec<_>) = entries.into_iter().partition(|path| path.is_dir());
        waiting.extend(folders);
        let name = |path: &PathBuf| path.strip_prefix(folder.path().join(below)).unwrap().to_str().unwrap().to_owned();
        found.extend(files.iter().map(name));
    }
    found.sort();
    found
}

#[test]
fn many_inputs_and_patterns_that_no_shell_expanded_go_into_a_folder() {
    let folder = folder(&[("a.obj", ""), ("b.obj", ""), ("deep/c.obj", ""), ("other.txt", "no mesh")]);
    let output = within(&folder, &["render", "*.obj", "deep/c.obj", "a.obj", "-o", "out", "--format", "stl"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(files(&folder, "out"), ["a.stl", "b.stl", "c.stl"]);
    assert!(text(&output.stderr).starts_with("planish: 3 of 3 inputs rendered in "), "{}", text(&output.stderr));
    let alone = within(&folder, &["render", "b.obj", "-o", "-", "--format", "stl"]);
    assert_eq!(std::fs::read(folder.path().join("out/b.stl")).unwrap(), alone.stdout, "the same bytes in company");
    let output = within(&folder, &["render", "**/*.obj", "-o", "tree/{dir}/{stem}.ply", "--quiet"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    assert_eq!(files(&folder, "tree"), ["a.ply", "b.ply", "deep/c.ply"]);
    let output = within(&folder, &["render", "deep/*.obj", "-o", "one", "--format", "stl"]);
    assert!(output.status.success(), "a pattern with one file goes into a folder, too");
    assert_eq!(files(&folder, "one"), ["c.stl"]);
    fails(FILES, &within(&folder, &["render", "*.step", "-o", "out", "--format", "stl"]), &["*.step"]);
}

#[test]
fn outputs_that_would_take_each_others_place_are_refused_before_anything_is_rendered() {
    let folder = folder(&[("a.obj", ""), ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), ("b/a.obj", "")]);
    let refused = |arguments: &[&str], parts: &[&str]| {
        fails(USAGE, &within(&folder, &[&["render"], arguments].concat()), parts);
        assert_eq!(files(&folder, ""), ["a.obj", "a.off", "b/a.obj"], "{arguments:?}");
    };
    refused(&["a.*", "-o", "out/", "--format", "glb"], &["a.obj and a.off would both become out/a.glb", "{name}"]);
    refused(&["**/*.obj", "-o", "x/{stem}.glb"], &["a.obj and b/a.obj", "{dir}"]);
    refused(&["a.obj", "b/a.obj", "-o", "x.glb"], &["cannot go to the one file x.glb", "-o 'out/{stem}.glb'"]);
    refused(&["a.obj", "b/a.obj", "-o", "-"], &["standard output"]);
    refused(&["a.obj", "b/a.obj", "-o", "out"], &["--format"]);
    refused(&["a.*", "-o", "{dir}/{stem}.obj"], &["would both become"]);
    refused(
        &["a.*", "-o", "{dir}/{name}", "--format", "objj"],
        &["there is no format \"objj\"; did you mean \"obj\"?"],
    );
    refused(&["a.obj", "b/a.obj", "-o", "./{dir}/a.obj"], &["would take the place of the input a.obj"]);
    refused(&["a.obj", "-o", "a.obj"], &["would take the place of the input a.obj; give it another place"]);
    refused(&["a.obj", "-o", "{stm}.glb"], &["there is no placeholder {stm}; known are {stem}"]);
    refused(&["a.obj", "-o", "{stem.glb"], &["the placeholder {stem.glb has no closing brace; known are {stem}"]);
    refused(&["a.obj", "-o", "{dir}/{stem"], &["the placeholder {stem has no closing brace"]);
    let named = within(&folder, &["render", "a.*", "-o", "out/{name}.glb"]);
    assert!(named.status.success(), "{}", text(&named.stderr));
    assert_eq!(files(&folder, "out"), ["a.obj.glb", "a.off.glb"]);
}

#[test]
fn one_failure_keeps_no_other_input_from_being_rendered_and_the_code_tells_its_kind() {
    let large = mesh(40).to_string();
    let broken = "v 0 0 0\nf 1 2 3\n";
    let folder = folder(&[("a.obj", ""), ("b.obj", broken), ("c.obj", ""), ("d.json", &large), ("e.obj", broken)]);
    let render = |inputs: &[&str]| within(&folder, &[&["render"], inputs, &["-o", "out", "--format", "ply"]].concat());
    let output = render(&["a.obj", "b.obj", "c.obj", "e.obj"]);
    fails(REFUSED, &output, &["planish: b.obj: ", "planish: e.obj: ", "planish: 2 of 4 inputs rendered in"]);
    assert!(text(&output.stderr).trim_end().ends_with("; 2 refused"), "{}", text(&output.stderr));
    assert_eq!(files(&folder, "out"), ["a.ply", "c.ply"]);
    fails(LIMIT, &render(&["a.obj", "d.json"]), &["1 of 2 inputs", "1 beyond a limit"]);
    fails(FILES, &render(&["a.obj", "nowhere.obj"]), &["nowhere.obj: cannot be read", "1 not read or written"]);
    let output = render(&["b.obj", "d.json", "nowhere.obj", "a.obj"]);
    fails(OTHER, &output, &["1 of 4 inputs", "; 1 refused, 1 beyond a limit, 1 not read or written"]);
}

#[test]
fn a_folder_of_jobs_goes_into_a_folder_as_the_jobs_name_their_outputs() {
    let with = |outputs: Value| {
        let mut job = mesh(1);
        job["outputs"] = outputs;
        job.to_string()
    };
    let two = with(json!([{ "format": "glb" }, { "format": "stats" }, { "format": "json", "ids": true }]));
    let folder = folder(&[
        ("jobs/one.json", &with(json!([{ "format": "ply", "ascii": true }]))),
        ("jobs/two.json", &two),
        ("jobs/none.json", &with(json!([]))),
        ("jobs/broken.json", "{\"input\":"),
        ("jobs/notes.txt", "no job"),
    ]);
    let output = within(&folder, &["render", "jobs", "-o", "out"]);
    fails(
        OTHER,
        &output,
        &["jobs/none.json: nothing tells the format", "jobs/broken.json: ", "4 of 6 outputs rendered"],
    );
    assert_eq!(files(&folder, "out"), ["one.ply", "two-2.json", "two.glb", "two.json"]);
    let made = |name: &str| std::fs::read(folder.path().join("out").join(name)).unwrap();
    assert!(made("one.ply").starts_with(b"ply\nformat ascii"));
    for (name, output) in
        [("two.json", json!({ "format": "stats" })), ("two-2.json", json!({ "format": "json", "ids": true }))]
    {
        let mut job = mesh(1);
        job["outputs"] = json!([output]);
        assert_eq!(made(name), render(&job).unwrap().0, "{name}");
    }
    // one job gives no summary, and no output may replace its input
    let output = within(&folder, &["render", "jobs/one.json", "-o", "alone/"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    assert_eq!(files(&folder, "alone"), ["one.ply"]);
    fails(USAGE, &within(&folder, &["render", "jobs/two.json", "-o", "jobs"]), &["take the place of the input"]);
    fails(FILES, &within(&folder, &["render", "alone", "-o", "out/", "--format", "glb", "empty"]), &["empty: "]);
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    fails(FILES, &within(&folder, &["render", "empty", "-o", "out"]), &["empty: there are no jobs or mesh files"]);
    let output = within(&folder, &["render", "alone", "-o", "out"]);
    fails(USAGE, &output, &["--output: a folder does not tell the format, nor does alone/one.ply; name one"]);
}

#[test]
fn every_reader_reads_standard_input_named_or_known_by_its_first_bytes() {
    let folder = Folder::new();
    let job = folder.path().join("job.json");
    std::fs::write(&job, json!({ "input": mesh(0)["input"] }).to_string()).unwrap();
    for from in ["obj", "ply", "stl", "glb", "gltf", "json"] {
        let file = run(&["render", job.to_str().unwrap(), "-o", "-", "--format", from]).stdout;
        let sniffed = fed(&["render", "-", "-o", "-", "--format", "stats"], &file);
        assert!(sniffed.status.success(), "{from}: {}", text(&sniffed.stderr));
        let named = fed(&["render", "-", "-o", "-", "--format", "stats", "--input-format", from], &file);
        assert_eq!(sniffed.stdout, named.stdout, "{from}");
        let stats: Value = serde_json::from_slice(&named.stdout).unwrap();
        assert_eq!(stats["area"], 24.0, "{from}");
    }
    let off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(fed(&["render", "-", "-o", "-", "--format", "glb"], off).status.success());
    fails(REFUSED, &fed(&["render", "-", "-o", "-", "--format", "glb"], b"once upon a time"), &["--input-format"]);
    let output = fed(&["render", "-", "-o", "-", "--format", "glb", "--input-format", "obk"], off);
    fails(USAGE, &output, &["did you mean \"obj\"?"]);
}

#[cfg(unix)]
#[test]
fn a_signal_removes_what_is_unfinished_and_ends_with_128_and_its_number() {
    let folder = Folder::new();
    let job = folder.path().join("job.json");
    std::fs::write(&job, with(mesh(10), "glb").to_string()).unwrap();
    // programs started by nohup continue when the terminal is closed, and so do these tests
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap_or("0").trim();
    let is_detached = u64::from_str_radix(ignored, 16).unwrap() & 1 == 1;
    let signals = [("INT", 130), ("TERM", 143), ("HUP", 129)];
    for (signal, code) in signals.into_iter().take(if is_detached { 2 } else { 3 }) {
        let mut child = planish();
        child.args(["render", "job.json", "-o", "out.glb"]).current_dir(folder.path()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        let start = Instant::now();
        let is_begun = || {
            files(&folder, "")
                .iter()
                .any(|name| Path::new(name).extension().is_some_and(|extension| extension == "part"))
        };
        while !is_begun() {
            assert!(start.elapsed() < PATIENCE && child.try_wait().unwrap().is_none(), "it never began");
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(
            Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap().success()
        );
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert_eq!(files(&folder, ""), ["job.json"]);
    }
    assert!(render(&with(mesh(1), "glb")).is_ok(), "the job itself is sound");
}

#[cfg(unix)]
#[test]
fn a_pipe_takes_what_is_written_and_stays_a_pipe() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("job.json"), with(mesh(2), "glb").to_string()).unwrap();
    assert!(Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
    let pipe = path("pipe");
    let reader = std::thread::spawn(move || std::fs::read(pipe).unwrap());
    for target in ["out.glb", "pipe"] {
        let output = within(&folder, &["render", "job.json", "-o", target, "--format", "glb"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let kind = std::fs::symlink_metadata(path("pipe")).unwrap().file_type();
    assert!(std::os::unix::fs::FileTypeExt::is_fifo(&kind), "no file has taken its place");
    assert_eq!(reader.join().unwrap(), std::fs::read(path("out.glb")).unwrap());
    assert_eq!(files(&folder, "").len(), 3, "nothing unfinished is left");
}

#[test]
fn levels_of_detail_are_files_beside_the_document() {
    let folder = Folder::new();
    let mut job = with(mesh(2), "gltf");
    job["outputs"][0]["lod"] = json!([0, 2]);
    std::fs::write(folder.path().join("job.json"), job.to_string()).unwrap();
    let output = within(&folder, &["render", "job.json", "-o", "out/{stem}.gltf"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let document: Value = serde_json::from_slice(&std::fs::read(folder.path().join("out/job.gltf")).unwrap()).unwrap();
    for buffer in document["buffers"].as_array().unwrap() {
        let bytes = std::fs::read(folder.path().join("out").join(buffer["uri"].as_str().unwrap())).unwrap();
        assert_eq!(bytes.len() as u64, buffer["byteLength"]);
    }
    assert_eq!(files(&folder, "out").len(), 3);
    fails(USAGE, &within(&folder, &["render", "job.json", "-o", "-"]), &["--output", "levels of detail"]);
}
