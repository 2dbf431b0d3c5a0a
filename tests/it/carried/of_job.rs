//! The material of a job: a look for the faces without a material, for every kind of input.

use serde_json::{Value, json};

use super::{job, refusal, text, told, written};
use crate::support::{nets, parsed, render};

fn red() -> Value {
    json!({ "color": [1, 0.25, 0], "metallic": 0.75, "roughness": 0.125, "double_sided": false })
}

/// Returns a cube with materials, and a look of the job.
fn cube(materials: &Value, look: &Value) -> Value {
    let mut cube = job(&nets::cube(), &json!({ "materials": materials }), &json!({ "preset": "catmull-clark" }), 1);
    cube["input"]["material"] = look.clone();
    cube
}

fn as_one_of_its_materials(look: &Value, name: &str, faces: &Value) -> Value {
    let mut material = look.clone();
    (material["name"], material["faces"]) = (name.into(), faces.clone());
    material
}

#[test]
fn faces_without_a_material_have_that_of_the_job() {
    let glass = json!({ "name": "glass", "faces": [1, 3], "color": [0, 0, 1, 0.5] });
    let given = told(cube(&json!([glass]), &red()));
    let rest = as_one_of_its_materials(&red(), "material", &json!([0, 2, 4, 5]));
    let mut listed = cube(&json!([glass, rest]), &Value::Null);
    assert_eq!(given, told(listed.clone()));
    // they are the same job, so that they have the same key
    let key = |job: &Value| {
        let mut job = job.clone();
        job["outputs"] = json!([{ "format": "glb" }]);
        parsed(job.to_string().as_bytes()).expect("a job").keys().to_vec()
    };
    assert_eq!(key(&listed), key(&cube(&json!([glass]), &red())));
    listed["input"].as_object_mut().expect("an object").remove("material");
    assert_eq!(given, told(listed));
}

#[test]
fn a_material_that_is_but_a_name_looks_like_that_of_the_job() {
    let given = told(cube(&json!([{ "name": "material", "faces": [0] }]), &red()));
    assert_eq!(given["materials"][0]["name"], "material");
    assert_eq!(given["materials"][0]["metallic"], 0.75);
    assert_eq!(given["materials"][1]["name"], "material-2");
    assert_eq!(given["materials"][1]["color"], json!([1, 0.25, 0, 1]));
}

#[test]
fn files_of_every_kind_take_it() {
    let plain = json!({ "input": { "mesh": nets::cube().to_json() } });
    for format in ["obj", "ply", "stl", "glb", "gltf", "off"] {
        let file = if format == "off" {
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec()
        } else {
            written(&plain, &json!({ "format": format }))
        };
        let data = super::looks::uri("png", &file).split_once(',').expect("a data URI").1.to_owned();
        let text = json!({ "format": format, "encoding": "base64", "data": data });
        let job = json!({ "input": { "text": text, "material": { "color": "#ff8000", "roughness": 0.25 } } });
        let result = told(job);
        let color = json!([1, 128.0 / 255.0, 0, 1]);
        assert_eq!((&result["materials"][0]["color"], &result["materials"][0]["roughness"]), (&color, &json!(0.25)));
    }
}

#[test]
fn pictures_gltf_and_libraries_show_it() {
    let job = cube(&json!([]), &red());
    assert!(text(&job, &json!({ "format": "mtl" })).contains("newmtl material\nKd 1 0.25 0\n"));
    assert!(text(&job, &json!({ "format": "obj" })).contains("usemtl material\n"));
    let document: Value = serde_json::from_str(&text(&job, &json!({ "format": "gltf" }))).expect("JSON");
    assert_eq!(document["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0.75);
    assert!(!document["materials"][0]["doubleSided"].as_bool().unwrap_or_default());
    let output = json!({ "format": "png", "width": 64, "height": 64 });
    let blue = cube(&json!([]), &json!({ "color": "#00f" }));
    assert_ne!(written(&job, &output), written(&blue, &output));
}

/// The faces of such schemes extend over several old faces, which is harmless if these look alike.
#[test]
fn schemes_with_faces_of_their_own_carry_a_material_that_all_faces_have() {
    for plan in [json!({ "preset": "doo-sabin" }), json!({ "word": "UD" }), json!({ "word": "UDC" })] {
        let mut job = job(&nets::torus(4, 3), &json!({}), &plan, 2);
        job["input"]["material"] = red();
        let result = told_without_ids(&job);
        let faces = result["faces"].as_array().expect("a list").len();
        assert_eq!(result["materials"][0]["faces"].as_array().map(Vec::len), Some(faces), "{plan}");
        for format in ["glb", "obj", "ply", "mtl", "png"] {
            let plain = written(&job, &json!({ "format": format }));
            assert!(!plain.is_empty(), "{format}");
        }
    }
    let mut triangles = job(&nets::tetrahedron(), &json!({}), &json!({ "preset": "sqrt-3" }), 3);
    triangles["input"]["material"] = red();
    assert_eq!(told_without_ids(&triangles)["materials"][0]["faces"].as_array().map(Vec::len), Some(4 * 27));
}

fn told_without_ids(job: &Value) -> Value {
    serde_json::from_str(&text(job, &json!({ "format": "json" }))).expect("JSON")
}

#[test]
fn a_material_that_no_face_has_is_named_in_a_warning() {
    let all = json!([{ "name": "all", "faces": [0, 1, 2, 3, 4, 5], "color": [0, 1, 0] }]);
    let mut job = cube(&all, &red());
    job["outputs"] = json!([{ "format": "json" }]);
    let (bytes, report) = render(&job).expect("it runs");
    let warnings = report.warnings;
    assert!(warnings.iter().any(|warning| warning.contains("every face has a material of its own")), "{warnings:?}");
    assert!(!String::from_utf8_lossy(&bytes).contains("\"metallic\""));
}

#[test]
fn what_is_no_material_is_refused_at_its_place() {
    let of_cube = |look: &Value| refusal(&cube(&json!([]), look));
    for (look, place) in [
        (json!({ "color": [1, 0] }), "/input/material/color"),
        (json!({ "color": "red" }), "/input/material/color"),
        (json!({ "color": [1, 0, 2] }), "/input/material/color/2"),
        (json!({ "roughness": -0.1 }), "/input/material/roughness"),
        (json!({ "alpha_cutoff": 0.5 }), "/input/material/alpha_cutoff"),
        (json!({ "name": "red" }), "/input/material/name"),
        (json!({ "texture": { "image": "x" } }), "/input/material/texture/image"),
        (
            json!({ "texture": { "image": super::looks::uri("jpeg", &super::looks::jpeg()) } }),
            "/input/material/texture",
        ),
        (json!([]), "/input/material"),
    ] {
        let found = of_cube(&look);
        assert_eq!(found.iter().map(|(place, _)| place.as_str()).collect::<Vec<_>>(), [place], "{look}: {found:?}");
    }
    let polygon = json!({ "input": { "polygon": { "points": [[0, 0], [1, 0]] }, "material": red() } });
    assert_eq!(refusal(&polygon)[0].0, "/input/material");
    let names: Vec<Value> = (0..256).map(|i| json!({ "name": format!("m{i}"), "faces": [] })).collect();
    let found = of_cube_with(&json!(names));
    assert!(found[0].0 == "/input/material" && found[0].1.starts_with("256 materials and faces without"), "{found:?}");
}

fn of_cube_with(materials: &Value) -> Vec<(String, String)> {
    refusal(&cube(materials, &red()))
}
