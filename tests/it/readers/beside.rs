//! Files beside a mesh file on the command line: they are read from its folder only.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;

use serde_json::json;

use super::gltf::{floats, square};
use crate::cli::planish;
use crate::http::server::Folder;

/// Returns a square whose numbers are in a file of this name.
fn square_with(uri: &str) -> String {
    let mut document = square(4, &[0, 1, 2, 2, 1, 3]);
    document["buffers"] = json!([{ "byteLength": 54, "uri": uri }]);
    document.to_string()
}

/// Returns the bytes of that file.
fn numbers() -> Vec<u8> {
    [floats(&super::gltf::SQUARE), vec![0, 1, 2, 2, 1, 3]].concat()
}

/// Renders a model; returns the output, or the message.
fn rendered(folder: &Folder, model: &str) -> Result<String, String> {
    let path = folder.path().join("in").join(model);
    let output = planish().arg("render").arg(path).args(["-o", "-", "--format", "obj"]).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
}

fn prepared() -> Folder {
    let folder = Folder::new();
    fs::create_dir_all(folder.path().join("in/parts of it")).unwrap();
    fs::write(folder.path().join("in/parts of it/a b.bin"), numbers()).unwrap();
    fs::write(folder.path().join("in/100%+1.bin"), numbers()).unwrap();
    fs::write(folder.path().join("outside.bin"), numbers()).unwrap();
    folder
}

#[test]
fn numbers_are_read_from_the_folder_of_the_model_and_below() {
    let folder = prepared();
    let spellings = [
        "parts%20of%20it/a%20b.bin",
        "./parts of it/a b.bin",
        "parts of it\\a b.bin",
        // %+1 is no escape
        "100%+1.bin",
    ];
    for (i, uri) in spellings.iter().enumerate() {
        let model = format!("{i}.gltf");
        fs::write(folder.path().join("in").join(&model), square_with(uri)).unwrap();
        let obj = rendered(&folder, &model).unwrap();
        assert_eq!(obj.lines().filter(|line| line.starts_with("f ")).count(), 2, "{obj}");
    }
}

#[test]
fn nothing_outside_of_the_folder_is_read() {
    let folder = prepared();
    let inside = folder.path().join("in");
    let absolute = folder.path().join("outside.bin");
    let absolute = absolute.to_str().unwrap();
    let only = "only files in the folder of the first one and below are read";
    let refused = |uri: &str, sentence: &str| {
        fs::write(inside.join("model.gltf"), square_with(uri)).unwrap();
        let said = rendered(&folder, "model.gltf").expect_err("it is refused");
        assert!(said.contains(sentence) && said.contains("buffer 0"), "{uri}: {said}");
    };
    refused("../outside.bin", only);
    refused("%2e%2e/outside.bin", only);
    refused("parts of it/../../outside.bin", only);
    refused("..\\outside.bin", only);
    refused(absolute, only);
    refused(&format!("file://{absolute}"), only);
    refused("", only);
    refused("missing.bin", "No such file");
    refused("parts of it", "it is no file");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(absolute, inside.join("link.bin")).unwrap();
        std::os::unix::fs::symlink(folder.path(), inside.join("up")).unwrap();
        refused("link.bin", "it is a link that leads out of the folder");
        refused("up/outside.bin", "it is a link that leads out of the folder");
        std::os::unix::fs::symlink("parts of it/a b.bin", inside.join("near.bin")).unwrap();
        fs::write(inside.join("model.gltf"), square_with("near.bin")).unwrap();
        rendered(&folder, "model.gltf").unwrap();
    }
    fs::write(inside.join("short.bin"), &numbers()[..50]).unwrap();
    refused("short.bin", "buffer 0 says it has 54 bytes, and has 50; send it whole");
    // a file larger than the limit is not read at all
    fs::File::create(inside.join("large.bin")).unwrap().set_len(3 << 30).unwrap();
    refused("large.bin", "it has 3.0 GiB; 2.0 GiB may be read");
}

/// A scene with one mesh in many places takes more memory than its length: HTTP refuses it, the command line has room
/// for it.
#[test]
fn a_mesh_may_stand_in_many_places() {
    let folder = prepared();
    let mut document = square(4, &[0, 1, 2, 2, 1, 3].repeat(100));
    document["nodes"] = json!(vec![json!({ "mesh": 0 }); 400]);
    document["scenes"] = json!([{ "nodes": (0..400).collect::<Vec<_>>() }]);
    let said = super::sentences("gltf", document.to_string().as_bytes());
    assert!(said[0].contains(" to read; a file of "), "{said:?}");
    fs::write(folder.path().join("in/many.gltf"), document.to_string()).unwrap();
    let obj = rendered(&folder, "many.gltf").unwrap();
    assert_eq!(obj.lines().filter(|line| line.starts_with("f ")).count(), 80_000);
}

/// On the command line, the remedy names its flag.
#[test]
fn remedies_are_flags_on_the_command_line() {
    let folder = prepared();
    let path = folder.path().join("in/wings.obj");
    fs::write(&path, "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n").unwrap();
    let run = |flags: &[&str]| {
        let output =
            planish().arg("render").arg(&path).args(["-o", "-", "--format", "obj"]).args(flags).output().unwrap();
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let plan = ["--preset", "catmull-clark", "--levels", "1"];
    let (done, said) = run(&plan);
    assert!(!done && said.contains("--non-manifold split cuts the mesh there"), "{said}");
    let (done, said) = run(&[&plan[..], &["--non-manifold", "split"]].concat());
    assert!(done && said.contains("note: 1 edge has more than two faces"), "{said}");
}
