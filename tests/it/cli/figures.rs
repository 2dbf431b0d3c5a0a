//! A folder of jobs rendered together, and compared with its earlier results.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::{Value, json};

use super::{FILES, OTHER, REFUSED, USAGE, fails, planish, text};
use crate::http::jobs::{mesh, polygon, with};
use crate::http::server::Folder;
use crate::support::render;

fn within(folder: &Folder, arguments: &[&str]) -> Output {
    planish().args(arguments).current_dir(folder.path()).output().unwrap()
}

fn png(mut job: Value, width: u32) -> Value {
    job["outputs"] = json!([{ "format": "png", "width": width, "height": 48 }]);
    job
}

/// Returns a folder with the jobs of a cube and of a polygon in `jobs`, rendered into `out`.
fn rendered() -> Folder {
    let folder = Folder::new();
    fs::create_dir(folder.path().join("jobs")).unwrap();
    put(&folder, "jobs/cube.json", &png(mesh(2), 64));
    put(&folder, "jobs/star.json", &png(polygon(3), 64));
    let made = within(&folder, &["figures", "jobs", "-o", "out"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    folder
}

fn put(folder: &Folder, name: &str, job: &Value) {
    fs::write(folder.path().join(name), job.to_string()).unwrap();
}

fn manifest(folder: &Folder) -> Value {
    serde_json::from_slice(&fs::read(folder.path().join("out/manifest.json")).unwrap()).unwrap()
}

fn check(folder: &Folder, more: &[&str]) -> (Option<i32>, String) {
    let checked = within(folder, &[&["figures", "jobs", "-o", "out", "--check"], more].concat());
    (checked.status.code(), text(&checked.stderr))
}

fn holds(path: &Path, parts: &[&str]) {
    let found = fs::read_to_string(path).unwrap();
    for part in parts {
        assert!(found.contains(part), "{part:?} in {}", path.display());
    }
}

#[test]
fn a_folder_of_jobs_becomes_pictures_with_a_manifest() {
    let folder = rendered();
    let (cube, _) = render(&png(mesh(2), 64)).unwrap();
    assert_eq!(fs::read(folder.path().join("out/cube.png")).unwrap(), cube);
    let manifest = manifest(&folder);
    let names: Vec<&String> = manifest["figures"].as_object().unwrap().keys().collect();
    assert_eq!(names, ["cube.png", "star.png"]);
    let entry = &manifest["figures"]["cube.png"];
    assert_eq!((&entry["job"], &entry["bytes"]), (&json!("cube.json"), &json!(cube.len())));
    assert_eq!(entry["hash"], planish::job::key::content(&cube).to_string());
    assert!(entry["numbers"]["vertices"].is_u64(), "{entry}");
    assert_eq!(check(&folder, &[]).0, Some(0));
    assert!(!folder.path().join("out.report").exists(), "where nothing differs there is nothing to report");
}

#[test]
fn what_has_its_key_is_not_made_again() {
    let folder = rendered();
    let before = fs::metadata(folder.path().join("out/cube.png")).unwrap().modified().unwrap();
    put(&folder, "jobs/star.json", &png(polygon(4), 64));
    let again = within(&folder, &["figures", "jobs", "-o", "out"]);
    assert!(text(&again.stderr).contains("1 of 2 pictures were made"), "{}", text(&again.stderr));
    assert_eq!(fs::metadata(folder.path().join("out/cube.png")).unwrap().modified().unwrap(), before);
    fs::write(folder.path().join("out/cube.png"), "damaged").unwrap();
    let again = within(&folder, &["figures", "jobs", "-o", "out"]);
    assert!(text(&again.stderr).contains("1 of 2 pictures were made"), "{}", text(&again.stderr));
    assert_eq!(fs::read(folder.path().join("out/cube.png")).unwrap(), render(&png(mesh(2), 64)).unwrap().0);
}

#[test]
fn a_changed_job_is_told_with_before_after_difference_and_numbers() {
    let folder = rendered();
    fs::create_dir(folder.path().join("old")).unwrap();
    fs::copy(folder.path().join("jobs/cube.json"), folder.path().join("old/cube.json")).unwrap();
    put(&folder, "jobs/cube.json", &png(mesh(1), 64));
    let kept = fs::read(folder.path().join("out/cube.png")).unwrap();
    let (code, said) = check(&folder, &["--before", "old", "--report", "told"]);
    assert_eq!(code, Some(OTHER), "{said}");
    assert!(said.contains("cube.png: ") && said.contains("1 picture differs, 1 is as it was"), "{said}");
    assert_eq!(fs::read(folder.path().join("out/cube.png")).unwrap(), kept, "a check writes no picture");
    let told = folder.path().join("told");
    for picture in ["before/cube.png", "after/cube.png", "difference/cube.png.png", "both/cube.png.png"] {
        assert!(image::open(told.join(picture)).is_ok(), "{picture}");
    }
    holds(&told.join("report.md"), &["## cube.png", "](before/cube.png)", "| vertices | 98 | 26 |"]);
    holds(&told.join("report.html"), &["data:image/png;base64,", "<td>vertices</td><td>98</td><td>26</td>"]);
    assert!(!fs::read_to_string(told.join("report.html")).unwrap().contains("src=\"both"), "it holds all pictures");
}

#[test]
fn a_picture_that_the_program_renders_otherwise_than_before_differs() {
    let folder = rendered();
    // the result of an earlier version for the same job, under the same key
    let before = render(&png(mesh(1), 64)).unwrap().0;
    fs::write(folder.path().join("out/cube.png"), &before).unwrap();
    let mut known = manifest(&folder);
    known["figures"]["cube.png"]["hash"] = json!(planish::job::key::content(&before).to_string());
    put(&folder, "out/manifest.json", &known);
    let (code, said) = check(&folder, &[]);
    assert_eq!(code, Some(OTHER), "{said}");
    assert!(said.contains("cube.png: ") && said.contains("1 picture differs, 1 is as it was"), "{said}");
    let report = folder.path().join("out.report");
    assert_eq!(fs::read(report.join("before/cube.png")).unwrap(), before);
    assert_eq!(fs::read(report.join("after/cube.png")).unwrap(), render(&png(mesh(2), 64)).unwrap().0);
}

#[test]
fn new_gone_and_damaged_pictures_differ() {
    let folder = rendered();
    put(&folder, "jobs/new.json", &png(mesh(0), 64));
    fs::remove_file(folder.path().join("jobs/star.json")).unwrap();
    fs::write(folder.path().join("out/cube.png"), "damaged").unwrap();
    let (code, said) = check(&folder, &[]);
    assert_eq!(code, Some(OTHER), "{said}");
    for part in
        ["new.png: new", "star.png: no job makes it", "cube.png: other bytes", "3 pictures differ, 0 are as they were"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(folder.path().join("out.report/report.html").exists());
}

#[test]
fn jobs_with_pictures_of_one_name_are_refused_before_anything_is_written() {
    let folder = rendered();
    let kept = fs::read(folder.path().join("out/cube.png")).unwrap();
    let mut two = png(mesh(1), 64);
    two["outputs"] = json!([{ "format": "png", "name": "top" }, { "format": "svg" }, { "format": "obj" }]);
    put(&folder, "jobs/cube.json", &two);
    put(&folder, "jobs/cube-svg.json", &json!({ "input": mesh(1)["input"], "outputs": [{ "format": "svg" }] }));
    let call = |more: &[&str]| within(&folder, &[&["figures", "jobs", "-o", "out"], more].concat());
    for more in [&[][..], &["--check"]] {
        fails(USAGE, &call(more), &["cube-svg.json and cube.json both make cube-svg.svg", "nothing was rendered"]);
    }
    let names: Vec<_> =
        fs::read_dir(folder.path().join("out")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names.len(), 3, "{names:?}");
    assert_eq!(fs::read(folder.path().join("out/cube.png")).unwrap(), kept);
}

#[test]
fn jobs_that_fail_do_not_keep_the_others_from_being_rendered() {
    let folder = rendered();
    put(&folder, "jobs/bad.json", &json!({ "input": {}, "outputs": [{ "format": "png" }] }));
    put(&folder, "jobs/numbers.json", &with(mesh(1), "obj"));
    put(&folder, "jobs/other.json", &png(mesh(0), 64));
    let made = within(&folder, &["figures", "jobs", "-o", "out"]);
    assert_eq!(made.status.code(), Some(REFUSED), "{}", text(&made.stderr));
    assert!(text(&made.stderr).contains("it asks for no picture"), "{}", text(&made.stderr));
    assert_eq!(manifest(&folder)["figures"].as_object().unwrap().len(), 3);
}

#[test]
fn without_a_manifest_there_is_nothing_to_check() {
    let folder = rendered();
    fs::remove_file(folder.path().join("out/manifest.json")).unwrap();
    assert_eq!(check(&folder, &[]).0, Some(FILES));
    let empty = within(&folder, &["figures", "out", "-o", "none"]);
    assert_eq!(empty.status.code(), Some(FILES), "{}", text(&empty.stderr));
}

#[test]
fn what_an_output_no_longer_makes_is_gone_though_its_job_is_there() {
    let folder = rendered();
    let mut two = png(mesh(1), 64);
    two["outputs"] =
        json!([{ "format": "png", "name": "a", "width": 64, "height": 48 }, { "format": "svg", "name": "b" }]);
    put(&folder, "jobs/cube.json", &two);
    assert!(within(&folder, &["figures", "jobs", "-o", "out"]).status.success());
    put(&folder, "jobs/cube.json", &png(mesh(1), 64));
    let (code, said) = check(&folder, &[]);
    assert_eq!(code, Some(OTHER), "{said}");
    for part in ["cube.png: new", "cube-a.png: no job makes it", "cube-b.svg: no job makes it"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let again = within(&folder, &["figures", "jobs", "-o", "out"]);
    assert!(text(&again.stderr).contains("cube-b.svg: no job makes it any more; remove it"), "{}", text(&again.stderr));
}

#[test]
fn a_job_that_fails_does_not_keep_changes_of_the_others_from_being_told() {
    let folder = rendered();
    put(&folder, "jobs/star.json", &json!({ "input": {} }));
    put(&folder, "jobs/cube.json", &png(mesh(1), 64));
    let (code, said) = check(&folder, &[]);
    assert_eq!(code, Some(REFUSED), "{said}");
    assert!(said.contains("1 picture differs") && !said.contains("star.png: "), "{said}");
    assert!(folder.path().join("out.report/difference/cube.png.png").exists());
}

#[test]
fn moving_pictures_are_compared_frame_by_frame() {
    let folder = rendered();
    let film = |to: f64| {
        let mut job = polygon(3);
        job["plan"] = json!({ "preset": "four-point" });
        let sweep = json!({ "pointer": "/plan/parameters/w", "from": 0, "to": to });
        let camera = json!({ "box": { "min": [-9, -9, 0], "max": [9, 9, 0] } });
        job["outputs"] =
            json!([{ "format": "apng", "width": 64, "height": 48, "frames": 3, "sweep": sweep, "camera": camera }]);
        job
    };
    put(&folder, "jobs/star.json", &film(0.05));
    assert!(within(&folder, &["figures", "jobs", "-o", "out"]).status.success());
    put(&folder, "jobs/star.json", &film(0.2));
    let (_, said) = check(&folder, &[]);
    assert!(said.contains("2 of 3 frames differ; in the one that differs most "), "{said}");
    assert!(folder.path().join("out.report/difference").is_dir(), "{said}");
}
