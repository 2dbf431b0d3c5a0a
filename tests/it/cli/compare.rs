//! `planish compare`.

use serde_json::Value;

use super::{REFUSED, USAGE, fails, run, saved, text};
use crate::http::jobs::{mesh, with};
use crate::http::server::Folder;

/// Renders a job into a file and returns its path.
fn file(folder: &Folder, name: &str, job: &Value) -> String {
    let (job, path) = (saved(folder, job), folder.path().join(name));
    let path = path.to_str().unwrap().to_owned();
    assert!(run(&["render", &job, "-o", &path, "-q"]).status.success());
    path
}

#[test]
fn meshes_that_are_the_same_end_with_0_and_others_with_1() {
    let folder = Folder::new();
    let [coarse, fine] = [2, 3].map(|levels| file(&folder, &format!("{levels}.ply"), &with(mesh(levels), "ply")));
    let job = saved(&folder, &mesh(2));
    let same = run(&["compare", &coarse, &job]);
    assert_eq!(same.status.code(), Some(0), "{}", text(&same.stderr));
    let found: Value = serde_json::from_slice(&same.stdout).unwrap();
    assert_eq!(found["equal"], true);
    assert!(found["hausdorff"]["b_to_a"].as_f64().unwrap() < 1e-14, "but for rounding");
    let other = run(&["compare", &coarse, &fine]);
    assert_eq!((other.status.code(), text(&other.stderr).as_str()), (Some(1), ""), "a difference is no failure");
    let found: Value = serde_json::from_slice(&other.stdout).unwrap();
    let apart = found["hausdorff"]["a_to_b"].as_f64().unwrap();
    assert!((0.001..0.1).contains(&apart), "{apart}");
    let quiet = run(&["compare", &coarse, &fine, "--tolerance", "0.1", "--quiet"]);
    assert_eq!((quiet.status.code(), quiet.stdout.len()), (Some(0), 0));
}

#[test]
fn pictures_are_compared_with_a_picture_of_what_differs() {
    let folder = Folder::new();
    let picture = |levels, name: &str| {
        let mut job = with(mesh(levels), "png");
        job["outputs"][0]["width"] = 64.into();
        job["outputs"][0]["height"] = 64.into();
        (file(&folder, name, &job), job)
    };
    let [(a, job), (b, _)] = [picture(1, "a.png"), picture(2, "b.png")];
    let drawn = folder.path().join("d.png");
    let found = run(&["compare", &a, &b, "-o", drawn.to_str().unwrap()]);
    assert_eq!(found.status.code(), Some(1), "{}", text(&found.stderr));
    let found: Value = serde_json::from_slice(&found.stdout).unwrap();
    let red = image::open(&drawn).unwrap().into_rgb8().pixels().filter(|pixel| pixel.0 == [255, 0, 0]).count();
    assert!(red > 0 && found["pixels"]["different"] == red, "{found}");
    let job = saved(&folder, &job);
    assert_eq!(run(&["compare", &job, &a, "--threshold", "0"]).status.code(), Some(0), "a job is drawn");
}

#[test]
fn what_cannot_be_compared_ends_with_the_code_of_its_failure() {
    let folder = Folder::new();
    let job = saved(&folder, &mesh(1));
    fails(REFUSED, &run(&["compare", &job, &job, "--threshold", "0.1"]), &["--threshold", "--tolerance"]);
    fails(USAGE, &run(&["compare", &job, &job, "--tolerance", "-1"]), &["-1"]);
    fails(USAGE, &run(&["compare", &job, &job, "--threshold", "2"]), &["--threshold"]);
    fails(super::FILES, &run(&["compare", &job, "/nowhere.ply"]), &["/nowhere.ply"]);
    fails(REFUSED, &run(&["compare", &job, &job, "-o", "d.png"]), &["--output"]);
}
