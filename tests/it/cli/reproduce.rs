//! `planish reproduce`.

use std::fs;

use super::{REFUSED, fails, run, saved, text};
use crate::http::jobs::{mesh, with};
use crate::http::server::Folder;

#[test]
fn a_file_that_says_of_its_job_is_made_again_and_a_changed_one_is_found() {
    let folder = Folder::new();
    let job = saved(&folder, &mesh(2));
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for name in ["a.png", "a.svg", "a.glb", "a.gltf", "a.ply", "a.obj"] {
        let path = path(name);
        let made = run(&["render", &job, "-o", &path, "-q", "--describe"]);
        assert!(made.status.success(), "{name}: {}", text(&made.stderr));
        let again = run(&["reproduce", &path]);
        assert_eq!((again.status.code(), text(&again.stderr).as_str()), (Some(0), ""), "{name}");
        assert!(text(&again.stdout).ends_with("the same bytes\n"), "{}", text(&again.stdout));
        let mut bytes = fs::read(&path).unwrap();
        // a glTF file ends with its JSON, so a byte in the middle is changed
        let changed = if name == "a.gltf" { bytes.len() / 2 } else { bytes.len() - 2 };
        bytes[changed] ^= 1;
        fs::write(&path, bytes).unwrap();
        let other = run(&["reproduce", &path]);
        assert_eq!(other.status.code(), Some(1), "{name}: {}", text(&other.stderr));
        assert!(text(&other.stdout).contains(&format!("differs from byte {changed}")), "{}", text(&other.stdout));
    }
}

#[test]
fn a_mesh_file_and_its_flags_are_told_as_a_job() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("in.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").unwrap();
    let out = path("out.ply");
    let made =
        run(&["render", &path("in.obj"), "-o", &out, "--preset", "loop", "--levels", "2", "--ascii", "--describe"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    fs::remove_file(path("in.obj")).unwrap();
    let again = run(&["reproduce", &out, "-q"]);
    assert_eq!((again.status.code(), again.stdout.len()), (Some(0), 0), "{}", text(&again.stderr));
}

#[test]
fn a_file_that_says_nothing_is_refused() {
    let folder = Folder::new();
    let out = folder.path().join("a.ply").to_str().unwrap().to_owned();
    let job = saved(&folder, &with(mesh(1), "ply"));
    assert!(run(&["render", &job, "-o", &out, "-q"]).status.success());
    fails(REFUSED, &run(&["reproduce", &out]), &["--describe"]);
}
