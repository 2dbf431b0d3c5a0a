//! Carried data in the formats.

use planish::job::limits::Limits;
use planish::output::Size;
use serde_json::{Value, json};

use super::{bytes, job, text, written};
use crate::support::{nets, parsed};

/// Checks that the size is as forecast: exactly, or below a bound that is not far off.
pub(super) fn check_size(job: &Value) {
    let estimate =
        Limits::default().estimate(&parsed(job.to_string().as_bytes()).expect("a job")).expect("within limits");
    let length = bytes(job).len() as u128;
    match estimate.outputs[0].1 {
        Size::Exact(n) => assert_eq!(length, n, "{job}"),
        Size::AtMost(n) => assert!(length <= n && n < 8 * length + 20_000, "{length} and {n} for {job}"),
    }
}

/// Returns a cube whose top is red and grouped, the rest green, with colours and a weight.
fn cube() -> Value {
    let net = nets::cube();
    let n = net.positions.len();
    job(
        &net,
        &json!({
            "channels": {
                "color": (0..n).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1]).collect::<Vec<_>>(),
                "weight": vec![0.5; n],
            },
            "groups": [{ "name": "top", "faces": [1] }],
            "materials": [{ "name": "red", "faces": [1] }, { "name": "green", "faces": [0, 2, 3, 4, 5] }],
        }),
        &json!({ "preset": "catmull-clark" }),
        1,
    )
}

#[test]
fn gltf_has_a_named_mesh_for_each_group_and_a_primitive_for_each_material() {
    let document: Value =
        serde_json::from_str(&text(&cube(), &json!({ "format": "gltf", "ids": true }))).expect("JSON");
    let primitives = [0, 1].map(|mesh| &document["meshes"][mesh]["primitives"][0]);
    let accessor =
        |index: &Value| &document["accessors"][usize::try_from(index.as_u64().expect("an index")).expect("small")];
    let material = |primitive: &Value| {
        let index = usize::try_from(primitive["material"].as_u64().expect("an index")).expect("small");
        document["materials"][index]["name"].clone()
    };
    // five faces come first, as face 0 is green
    for (primitive, name, faces) in [(primitives[0], "green", 5), (primitives[1], "red", 1)] {
        assert_eq!(material(primitive), name);
        assert_eq!(accessor(&primitive["indices"])["count"], faces * 4 * 2 * 3);
        assert_eq!(accessor(&primitive["extras"]["faces"])["count"], faces * 4 * 2);
        for (attribute, kind) in [("COLOR_0", "VEC3"), ("_WEIGHT", "SCALAR"), ("_ORIGIN", "VEC2"), ("NORMAL", "VEC3")] {
            let accessor = accessor(&primitive["attributes"][attribute]);
            assert_eq!((&accessor["type"], &accessor["count"]), (&json!(kind), &json!(26)), "{attribute}");
        }
    }
    assert_eq!(primitives[1]["extras"]["group"], "top");
    assert!(primitives[0]["extras"].get("group").is_none());
    let nodes = json!([{ "name": "planish", "mesh": 0, "children": [1] }, { "name": "top", "mesh": 1 }]);
    assert_eq!(document["nodes"], nodes);
    assert_eq!(document["meshes"][1]["name"], "top");
    let white = json!([1.0, 1.0, 1.0, 1.0]);
    assert_eq!(document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"], white);
}

/// A mesh that is written with groups of adjacent faces has one vertex at each position when it is read again.
#[test]
fn gltf_that_is_read_again_has_its_groups_and_whole_vertices() {
    let names = ["bottom", "top", "front"];
    let groups: Vec<Value> = names.iter().enumerate().map(|(i, name)| json!({ "name": name, "faces": [i] })).collect();
    let net = nets::cube();
    for compression in ["none", "quantize"] {
        let question = job(&net, &json!({ "groups": groups }), &json!({ "word": "U" }), 0);
        let output = json!({ "format": "gltf", "normals": "none", "compression": compression });
        let read = json!({ "input": { "text": { "format": "gltf", "data": text(&question, &output) } } });
        let told: Value = serde_json::from_slice(&written(&read, &json!({ "format": "json" }))).expect("JSON");
        assert_eq!(told["positions"].as_array().expect("positions").len(), 8, "{compression}");
        let obj = text(&read, &json!({ "format": "obj" }));
        let found: Vec<&str> = obj.lines().filter_map(|line| line.strip_prefix("g ")).collect();
        assert_eq!(found, ["default", "bottom", "top", "front"], "{compression}");
    }
}

#[test]
fn gltf_stores_colours_in_linear_light() {
    let net = nets::grid(1, 1);
    let colors = json!({ "channels": { "color": [[0.5, 1, 0], [0, 0, 0], [2, -1, 0.5], [1, 1, 1]] } });
    let mut question = job(&net, &colors, &json!({ "word": "U" }), 0);
    question["outputs"] = json!([{ "format": "glb", "normals": "none" }]);
    let glb = bytes(&question);
    let binary = &glb[glb.len() - 4 * 12 - 2 * 6..];
    let floats: Vec<f32> = binary[..48].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let middle = 0.214_041_14;
    let expected = [middle, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, middle, 1.0, 1.0, 1.0];
    for (x, y) in floats.iter().zip(expected) {
        assert!((x - y).abs() < 1e-7, "{floats:?}");
    }
}

#[test]
fn obj_names_groups_and_materials_where_they_change() {
    let lines = text(&cube(), &json!({ "format": "obj" }));
    let told: Vec<&str> = lines.lines().filter(|line| !line.starts_with("v ") && !line.starts_with("f ")).collect();
    let expected = ["# planish", "g default", "usemtl green", "g top", "usemtl red", "g default", "usemtl green"];
    assert_eq!(told, expected);
    let vertex = lines.lines().nth(1).expect("a vertex");
    assert_eq!(vertex.split(' ').count(), 7, "{vertex}");
    let with_origins = text(&cube(), &json!({ "format": "obj", "ids": true }));
    let count = |what: &str| with_origins.lines().filter(|line| line.starts_with(what)).count();
    assert_eq!(["# from vertex ", "# from edge ", "# from face "].map(count), [8, 12, 12]);
}

#[test]
fn ply_tells_everything_in_properties_and_comments() {
    let lines = text(&cube(), &json!({ "format": "ply", "ascii": true, "ids": true }));
    let (header, rows) = lines.split_once("end_header\n").expect("a header");
    let expected = "ply\nformat ascii 1.0\ncomment planish\ncomment group 0 top\ncomment material 0 red\n\
        comment material 1 green\nelement vertex 26\nproperty double x\nproperty double y\nproperty double z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double weight\n\
        property uchar origin_dimension\nproperty uint origin\nelement face 24\n\
        property list uchar int vertex_indices\nproperty int group\nproperty int material\nproperty uint origin\n";
    assert_eq!(header, expected);
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(' ').collect()).collect();
    assert!(rows[..26].iter().all(|row| row.len() == 9 && row[6] == "0.5"));
    assert_eq!(rows[25][7..], ["2", "5"]);
    for (i, row) in rows[26..].iter().enumerate() {
        let expected = if i / 4 == 1 { ["0", "0", "1"] } else { ["-1", "1", if i < 4 { "0" } else { row[7] }] };
        assert_eq!(row[5..], expected, "face {i}");
        assert_eq!(row[7], (i / 4).to_string());
    }
}

#[test]
fn formats_without_a_place_for_it_write_what_they_wrote() {
    let bare = job(&nets::cube(), &json!({}), &json!({ "preset": "catmull-clark" }), 1);
    for format in ["stl", "stats"] {
        assert_eq!(written(&cube(), &json!({ "format": format })), written(&bare, &json!({ "format": format })));
    }
}

#[test]
fn numbers_that_f32_does_not_hold_are_refused_by_the_formats_that_need_it() {
    let net = nets::grid(1, 1);
    let extra = json!({ "channels": { "w": [0, 0, 1e39, 0] } });
    let mut question = job(&net, &extra, &json!({ "word": "U" }), 0);
    for (output, fits) in [
        (json!({ "format": "glb" }), false),
        (json!({ "format": "ply", "precision": "f32" }), false),
        (json!({ "format": "ply" }), true),
    ] {
        question["outputs"] = json!([output]);
        match crate::support::render(&question) {
            Ok(_) => assert!(fits, "{question}"),
            Err(faults) => assert!(!fits && faults[0].detail.starts_with("vertex 2 has 1e39 in the channel \"w\"")),
        }
    }
}
