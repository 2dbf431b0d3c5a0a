//! Libraries of materials (MTL): beside OBJ files, in jobs, and written.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;

use serde_json::{Value, json};

use super::looks::{jpeg, png, uri};
use super::{refusal, text, told};
use crate::cli::planish;
use crate::http::server::Folder;
use crate::support::{nets, render};

const OBJ: &str = "mtllib some name.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n\
                   vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\nusemtl of glass\nf 2/1 5/2 6/3 3/4\n";

const MTL: &str = "# by hand\nnewmtl red\n\tKd 0.75 0.25 0\nKs 0.000 0 0\nNs 50\nillum 2\nPr 0.5\nPm 0.25\nd 1\n\
                   newmtl of glass\nKd 1 1 1\nKa 1 1 1\nNi 1.5\nillum 4\nTr 0.75\nbump -bm 0.5 bumps.png\nKe 0 0.5 0\n\
                   newmtl unused\nKd 2 x 0\n";

/// Returns a job on the file above with this library.
fn with(mtl: &str) -> Value {
    json!({ "input": { "text": { "format": "obj", "data": OBJ, "mtl": mtl } } })
}

#[test]
fn jobs_bring_the_library_of_an_obj_file_along() {
    let result = told(with(MTL));
    let materials = json!([
        { "name": "red", "faces": [0], "color": [0.75, 0.25, 0, 1], "metallic": 0.25, "roughness": 0.5 },
        { "name": "of_glass", "faces": [1], "color": [1, 1, 1, 0.25] },
    ]);
    assert_eq!(result["materials"], materials);
    let mut job = with(MTL);
    job["outputs"] = json!([{ "format": "json" }]);
    let (_, report) = render(&job).unwrap();
    let left_out = "what libraries say of materials beyond this is left out: \"Ke\" (1), \"Ni\" (1), \"Ns\" (1), \
                    \"bump\" (1), \"illum\" (1), Kd without three numbers (1)";
    assert_eq!(report.warnings, [left_out]);
    // glass is transparent
    let gltf: Value = serde_json::from_str(&text(&with(MTL), &json!({ "format": "gltf" }))).unwrap();
    let modes: Vec<&Value> = gltf["materials"].as_array().unwrap().iter().map(|one| &one["alphaMode"]).collect();
    assert_eq!(modes, ["OPAQUE", "BLEND"], "{gltf}");
    let other = json!({ "input": { "text": { "format": "off", "data": "", "mtl": "" } } });
    assert_eq!(refusal(&other)[0].0, "/input/text/mtl");
}

#[test]
fn values_of_a_library_that_cannot_be_read_are_named() {
    let mut job = with("newmtl red\nKd 1 0 0\nd half\nPm\nPr 0.5\nPr nan\nnewmtl of glass\nd -halo 0.5\nTr 1,5\n");
    let materials = json!([
        { "name": "red", "faces": [0], "color": [1, 0, 0, 1], "roughness": 0.5 },
        { "name": "of_glass", "faces": [1], "color": [1, 1, 1, 0.5] },
    ]);
    assert_eq!(told(job.clone())["materials"], materials);
    job["outputs"] = json!([{ "format": "json" }]);
    let left_out = "what libraries say of materials beyond this is left out: Pm without a number (1), \
                    Pr without a number (1), Tr without a number (1), d without a number (1)";
    assert_eq!(render(&job).unwrap().1.warnings, [left_out]);
}

#[test]
fn a_library_that_is_not_there_is_named() {
    let job = json!({ "input": { "text": { "format": "obj", "data": OBJ } }, "outputs": [{ "format": "json" }] });
    let (_, report) = render(&job).unwrap();
    assert!(report.warnings[0].starts_with("how materials look is left out: \"some name.mtl\""), "{report:?}");
}

#[test]
fn the_command_line_reads_libraries_and_pictures_beside_an_obj_file() {
    let folder = Folder::new();
    let inside = folder.path().join("in");
    fs::create_dir_all(inside.join("pictures")).unwrap();
    fs::write(inside.join("model.obj"), OBJ.replace("some name.mtl", "pictures/some name.mtl")).unwrap();
    let picture = png(1, &[[10, 20, 30]]);
    fs::write(inside.join("pictures/a b.png"), &picture).unwrap();
    fs::write(inside.join("pictures/c.jpg"), jpeg()).unwrap();
    let library = "newmtl red\nmap_Kd -s 1 1 -clamp on a b.png\nnewmtl of glass\nKd 0 1 0\nmap_Kd .\\c.jpg\n";
    fs::write(inside.join("pictures/some name.mtl"), library).unwrap();
    let rendered = |format: &str| {
        let path = inside.join("model.obj");
        let output = planish().arg("render").arg(path).args(["-o", "-", "--format", format]).output().unwrap();
        let notes = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{notes}");
        (output.stdout, notes)
    };
    let (result, notes) = rendered("json");
    let materials = serde_json::from_slice::<Value>(&result).unwrap()["materials"].clone();
    assert_eq!(materials[0]["texture"]["image"], uri("png", &picture));
    assert_eq!(materials[0]["texture"]["wrap_s"], "clamp-to-edge");
    assert_eq!(materials[1]["texture"]["image"], uri("jpeg", &jpeg()));
    assert_eq!(materials[1]["color"], json!([0, 1, 0, 1]));
    assert!(notes.contains("\"-s\" of map_Kd (1)"), "{notes}");
    let (glb, _) = rendered("glb");
    assert!(glb.windows(picture.len()).any(|part| part == picture), "its bytes are unchanged");
    // a picture outside the folder is named in a note, and not read
    fs::write(folder.path().join("outside.png"), &picture).unwrap();
    fs::write(inside.join("pictures/some name.mtl"), "newmtl red\nmap_Kd ../../outside.png\n").unwrap();
    let (result, notes) = rendered("json");
    assert!(serde_json::from_slice::<Value>(&result).unwrap()["materials"][0].get("texture").is_none());
    assert!(notes.contains("the texture \"pictures/../../outside.png\" is left out"), "{notes}");
}

/// Returns a cube with two materials.
fn painted() -> Value {
    let mut mesh = nets::cube().to_json();
    mesh["materials"] = json!([
        { "name": "red", "faces": [0, 1, 2], "color": [0.1, 0.25, 1, 0.5], "metallic": 0.75, "roughness": 0.3 },
        { "name": "plain", "faces": [3] },
    ]);
    json!({ "input": { "mesh": mesh }, "plan": { "preset": "catmull-clark" }, "levels": 1 })
}

#[test]
fn obj_and_mtl_together_tell_of_materials_what_json_does() {
    let obj = text(&painted(), &json!({ "format": "obj", "mtllib": "cube.mtl" }));
    let mtl = text(&painted(), &json!({ "format": "mtl" }));
    assert_eq!(obj.lines().filter(|line| *line == "mtllib cube.mtl").count(), 1);
    assert_eq!(mtl, "# planish\nnewmtl red\nKd 0.1 0.25 1\nd 0.5\nPm 0.75\nPr 0.3\nnewmtl plain\n");
    let back = json!({ "input": { "text": { "format": "obj", "data": obj, "mtl": mtl } } });
    assert_eq!(told(back)["materials"], told(painted())["materials"]);
    assert!(!text(&painted(), &json!({ "format": "obj" })).contains("mtllib"));
    let mut job = painted();
    job["outputs"] = json!([{ "format": "obj", "mtllib": "a\nb" }]);
    assert_eq!(render(&job).unwrap_err()[0].pointer, "/outputs/0/mtllib");
    job["input"]["mesh"]["materials"] = json!([]);
    assert_eq!(text(&job, &json!({ "format": "mtl" })), "# planish\n");
    for (format, what) in [("ply", "how materials look is left out"), ("stl", "materials are left out")] {
        let (_, report) = render(&painted_as(format)).unwrap();
        assert!(report.warnings[0].starts_with(what), "{report:?}");
    }
    super::files::check_size(&painted_as("mtl"));
    super::files::check_size(&painted_as("obj"));
}

fn painted_as(format: &str) -> Value {
    let mut job = painted();
    job["outputs"] = json!([{ "format": format }]);
    job
}

#[test]
fn the_command_line_writes_the_library_and_the_textures_beside_an_obj_file() {
    let folder = Folder::new();
    fs::create_dir_all(folder.path()).unwrap();
    let picture = png(2, &[[1, 2, 3], [4, 5, 6]]);
    let mut job = painted();
    job["input"]["mesh"]["uvs"] = json!({ "values": [[0, 0], [1, 0], [1, 1]], "faces": vec![[0, 1, 2, 1]; 6] });
    job["input"]["mesh"]["materials"][1]["texture"] =
        json!({ "image": uri("png", &picture), "wrap_s": "clamp-to-edge", "wrap_t": "clamp-to-edge" });
    fs::write(folder.path().join("job.json"), job.to_string()).unwrap();
    let render = |from: &str, to: &str| {
        let [from, to] = [from, to].map(|name| folder.path().join(name));
        let output = planish().arg("render").arg(from).arg("-o").arg(to).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    render("job.json", "a cube.obj");
    let obj = fs::read_to_string(folder.path().join("a cube.obj")).unwrap();
    assert!(obj.starts_with("mtllib a_cube.mtl\n# planish\n"), "{obj:.100}");
    assert_eq!(fs::read(folder.path().join("a_cube-1.png")).unwrap(), picture);
    let mtl = fs::read_to_string(folder.path().join("a_cube.mtl")).unwrap();
    assert!(mtl.ends_with("newmtl plain\nmap_Kd -clamp on a_cube-1.png\n"), "{mtl}");
    render("a cube.obj", "back.json");
    let back: Value = serde_json::from_slice(&fs::read(folder.path().join("back.json")).unwrap()).unwrap();
    assert_eq!(back["materials"], told(job)["materials"]);
    // without looks, no library is written
    fs::write(folder.path().join("plain.json"), json!({ "input": nets::cube().input() }).to_string()).unwrap();
    render("plain.json", "plain.obj");
    assert!(!folder.path().join("plain.mtl").exists());
}
