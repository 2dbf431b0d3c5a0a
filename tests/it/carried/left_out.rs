//! A warning names all data that a format cannot hold, and no other data.

use serde_json::{Value, json};

use super::looks::uri;
use super::{job, written};
use crate::support::{nets, render};

/// Returns a cube that carries data of every kind.
fn laden() -> Value {
    let mut file = std::io::Cursor::new(Vec::new());
    let pixel = image::RgbaImage::from_raw(1, 1, vec![9; 4]).expect("one pixel");
    pixel.write_to(&mut file, image::ImageFormat::Png).expect("a PNG");
    let net = nets::cube();
    let carried = json!({
        "groups": [{ "name": "top", "faces": [0] }],
        "materials": [{
            "name": "glass", "faces": [0, 1], "color": [1, 0, 0, 0.5], "metallic": 0.5, "double_sided": true,
            "alpha_mode": "mask", "alpha_cutoff": 0.25, "texture": { "image": uri("png", &file.into_inner()) },
        }],
        "channels": { "color": vec![[0.5, 0.5, 0.5, 0.5]; 8], "heat": vec![1; 8] },
        "uvs": { "values": net.positions.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(), "faces": net.faces },
        "creases": [{ "edge": [net.faces[0][0], net.faces[0][1]], "sharpness": 2 }],
    });
    let mut job = job(&net, &carried, &Value::Null, 0);
    let fields = job.as_object_mut().expect("an object");
    fields.retain(|name, _| name == "input");
    job
}

fn warnings(job: &Value, output: &Value) -> Vec<String> {
    let mut job = job.clone();
    job["outputs"] = json!([output]);
    render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {output}")).1.warnings
}

const SHARP: &str = "sharp edges and vertices are left out";

#[test]
fn what_has_no_place_in_a_format_is_named_and_nothing_else() {
    let of_channels = ["the alpha of the channel \"color\" is left out", "the channel \"heat\" is left out"];
    let of_libraries =
        ["what the alpha of materials does is left out", "which sides of materials are seen is left out"];
    let solid = [
        "the channel \"heat\" is left out",
        "texture coordinates are left out",
        "metalness and roughness of materials are left out",
        "which sides of materials are seen is left out",
        "textures are left out",
        "materials are left out",
        "groups are left out",
        SHARP,
    ];
    let rows: [(&str, Value, Vec<&str>); 11] = [
        ("json", json!({}), vec![]),
        ("glb", json!({}), vec![SHARP]),
        ("gltf", json!({}), vec![SHARP]),
        ("obj", json!({ "mtllib": "x.mtl" }), of_channels.to_vec()),
        ("obj", json!({}), [&of_channels[..], &["how materials look is left out"]].concat()),
        ("mtl", json!({ "textures": "x" }), of_libraries.to_vec()),
        ("mtl", json!({}), [&of_libraries[..], &["textures are left out"]].concat()),
        ("ply", json!({}), vec!["how materials look is left out", SHARP]),
        ("usda", json!({}), vec!["textures are left out", SHARP]),
        ("3mf", json!({}), solid.to_vec()),
        (
            "stl",
            json!({}),
            vec![
                "the channels \"color\", \"heat\" are left out",
                "texture coordinates are left out",
                "groups are left out",
                "materials are left out",
                SHARP,
            ],
        ),
    ];
    let job = laden();
    for (format, mut output, expected) in rows {
        output["format"] = json!(format);
        let found = warnings(&job, &output);
        for start in &expected {
            assert!(found.iter().any(|warning| warning.starts_with(start)), "{format}: {start}: {found:?}");
        }
        assert_eq!(found.len(), expected.len(), "{format}: {found:?}");
    }
}

#[test]
fn a_mesh_that_carries_nothing_loses_nothing() {
    let mut job = job(&nets::cube(), &json!({}), &Value::Null, 0);
    job.as_object_mut().expect("an object").retain(|name, _| name == "input");
    for format in ["json", "stats", "obj", "mtl", "glb", "gltf", "ply", "stl", "usda", "3mf", "png"] {
        let found = warnings(&job, &json!({ "format": format }));
        assert!(found.is_empty(), "{format}: {found:?}");
    }
}

#[test]
fn a_json_result_is_an_input_with_all_that_stands_beside_its_mesh() {
    let plan = json!({ "preset": "catmull-clark" });
    let mut net = nets::cube();
    net.positions.push(net.positions[0]);
    let mut job = job(&net, &json!({ "channels": { "heat": vec![1; 9] } }), &plan, 1);
    let planes = json!([{ "point": [0, 0, 0.1], "normal": [0, 0, 1] }]);
    let first = json!({ "format": "json", "normals": "area", "ids": true, "isolines": true, "sections": planes });
    // merging vertices leaves a warning in the result
    job["input"]["weld"] = json!(0);
    let result = written(&job, &first);
    let told: Value = serde_json::from_slice(&result).expect("JSON");
    for entry in ["normals", "ids", "isolines", "sections", "warnings"] {
        assert!(!told[entry].is_null(), "{entry} is told: {told}");
    }
    let text = json!({ "format": "json", "data": String::from_utf8(result).expect("text") });
    for input in [json!({ "mesh": told }), json!({ "text": text })] {
        let mut again = json!({ "input": input, "outputs": [{ "format": "json" }] });
        let (bytes, report) = render(&again).unwrap_or_else(|faults| panic!("{faults:?}"));
        let left_out = "what a result says beside its mesh is left out: normals, ids, isolines, sections";
        assert_eq!(report.warnings, [left_out]);
        let found: Value = serde_json::from_slice(&bytes).expect("JSON");
        for kept in ["positions", "faces", "channels"] {
            assert_eq!(found[kept], told[kept], "{kept}");
        }
        again["input"] = json!({ "mesh": found });
        assert!(render(&again).is_ok(), "and so on");
    }
}
