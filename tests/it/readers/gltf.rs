//! Scenes of glTF: transforms, instances, strips and fans, sparse and normalized numbers.

use planish::input::FaceSet;
use serde_json::{Value, json};

use super::{mesh, net, sentences};

/// Returns bytes as a data URI.
fn uri(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::from("data:application/octet-stream;base64,");
    for group in bytes.chunks(3) {
        let word = group.iter().fold(0_u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - group.len()));
        let letter = |k: usize| char::from(letters[(word >> (18 - 6 * k)) as usize & 63]);
        (0..4).for_each(|k| text.push(if k <= group.len() { letter(k) } else { '=' }));
    }
    text
}

pub(super) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Returns a document with one buffer of sections, each with its own view.
pub(super) fn document(sections: &[Vec<u8>], rest: &Value) -> Value {
    let mut bytes = Vec::new();
    let views: Vec<Value> = sections
        .iter()
        .map(|section| {
            let start = bytes.len();
            bytes.extend_from_slice(section);
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            json!({ "buffer": 0, "byteOffset": start, "byteLength": section.len() })
        })
        .collect();
    let mut document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": uri(&bytes) }], "bufferViews": views,
    });
    let fields = rest.as_object().cloned().unwrap_or_default();
    fields.into_iter().for_each(|(name, value)| document[name] = value);
    document
}

pub(super) const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];

/// Returns a square of two triangles in one drawing mode.
pub(super) fn square(mode: u32, indices: &[u8]) -> Value {
    document(
        &[floats(&SQUARE), indices.to_vec()],
        &json!({
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5121, "count": indices.len(), "type": "SCALAR" },
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": mode }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        }),
    )
}

fn faces(document: &Value) -> Vec<Vec<usize>> {
    net(&mesh("gltf", document.to_string().as_bytes())).faces
}

#[test]
fn triangles_strips_and_fans() {
    assert_eq!(faces(&square(4, &[0, 1, 2, 2, 1, 3])), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(faces(&square(5, &[0, 1, 2, 3])), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(faces(&square(6, &[0, 1, 3, 2])), [[1, 3, 0], [3, 2, 0]]);
    // degenerate triangles join strips
    let found = mesh("gltf", square(5, &[0, 1, 2, 2, 3]).to_string().as_bytes());
    assert_eq!(net(&found).faces, [[0, 1, 2]]);
    assert_eq!(found.notes, ["triangles left out because two of their corners are one vertex: 2"]);
    let lines = mesh("gltf", square(1, &[0, 1]).to_string().as_bytes());
    assert_eq!(lines.notes, ["primitives of points or lines are left out: 1"]);
}

#[test]
fn nodes_are_where_their_transforms_put_them() {
    let mut document = square(4, &[0, 1, 2]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    document["nodes"] = json!([
        { "children": [1, 2], "translation": [10, 0, 0] },
        // a quarter turn about z, after doubling
        { "mesh": 0, "name": "turned", "rotation": [0, 0, half, half], "scale": [2, 2, 2], "translation": [0, 5, 0] },
        // mirrored, so that the winding is reversed
        { "mesh": 0, "name": "mirrored", "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1] },
    ]);
    let found = mesh("gltf", document.to_string().as_bytes());
    let expected = [
        [10., 5., 0.],
        [10., 7., 0.],
        [8., 5., 0.],
        [8., 7., 0.],
        [10., 0., 7.],
        [9., 0., 7.],
        [10., 1., 7.],
        [9., 1., 7.],
    ];
    for (found, expected) in found.positions.iter().zip(expected) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} for {expected:?}");
    }
    assert_eq!(net(&found).faces, [[0, 1, 2], [4, 6, 5]]);
    let groups = [("turned", 0), ("mirrored", 1)].map(|(name, f)| FaceSet { name: name.into(), faces: vec![f] });
    assert_eq!(found.groups, groups);
}

/// Numbers of nodes are not rounded to f32, unlike those of vertices.
#[test]
fn nodes_are_read_in_f64() {
    let first = |node: Value| {
        let mut document = square(4, &[0, 1, 2]);
        document["nodes"] = json!([node]);
        mesh("gltf", document.to_string().as_bytes()).positions[..2].to_vec()
    };
    let far = [1_000_000.1, 0.1, 16_777_217.0];
    assert_eq!(first(json!({ "mesh": 0, "translation": far }))[..1], [far]);
    let matrix = [0.1, 0.2, 0.3, 0., 0., 1., 0., 0., 0., 0., 1., 0., far[0], far[1], far[2], 1.];
    let places = [far, [far[0] + 0.1, far[1] + 0.2, far[2] + 0.3]];
    assert_eq!(first(json!({ "mesh": 0, "matrix": matrix })), places);
    assert_eq!(first(json!({ "mesh": 0, "scale": [0.1, 1, 1], "translation": null }))[1..], [[0.1, 0., 0.]]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let quarter = json!({ "mesh": 0, "rotation": [0, 0, half, half], "translation": [1e6, 0.1, 0] });
    assert_eq!(first(quarter), [[1e6, 0.1, 0.], [1e6, 1.1, 0.]]);
    // as written with three digits
    let short = json!({ "mesh": 0, "rotation": [0, 0, 0.707, 0.707] });
    assert_eq!(first(short)[1..], [[0., 1., 0.]]);
}

/// Returns a document with positions in bytes, sparse changes, normalized colours, shared vertices and two materials.
pub(super) fn every_feature() -> String {
    let document = document(
        &[
            vec![0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9, 1, 1, 0, 9], // positions in bytes, 4 apart
            vec![3],                                              // the vertex that changes
            vec![1, 1, 5],                                        // its new place
            vec![255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 51],
            floats(&[0., 0., 1., 0., 0., 1., 1., 0.25]),
            [0_u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()).collect(),
            [2_u32, 1, 3].iter().flat_map(|i| i.to_le_bytes()).collect(),
        ],
        &json!({
            "extensionsRequired": ["KHR_mesh_quantization"],
            "accessors": [
                { "bufferView": 0, "componentType": 5120, "count": 4, "type": "VEC3", "sparse": {
                    "count": 1, "indices": { "bufferView": 1, "componentType": 5121 },
                    "values": { "bufferView": 2 } } },
                { "bufferView": 3, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true },
                { "bufferView": 4, "componentType": 5126, "count": 4, "type": "VEC2" },
                { "bufferView": 5, "componentType": 5123, "count": 3, "type": "SCALAR" },
                { "bufferView": 6, "componentType": 5125, "count": 3, "type": "SCALAR" },
            ],
            "materials": [{ "name": "red" }, {}],
            "meshes": [{ "name": "both", "primitives": [
                { "attributes": { "POSITION": 0, "COLOR_0": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 },
                { "attributes": { "POSITION": 0, "COLOR_0": 1, "TEXCOORD_0": 2 }, "indices": 4, "material": 1 },
            ] }],
            "nodes": [{ "mesh": 0 }],
        }),
    );
    let mut document = document;
    document["bufferViews"][0]["byteStride"] = json!(4);
    document.to_string()
}

#[test]
fn numbers_of_every_kind_and_vertices_shared_between_primitives() {
    let found = mesh("gltf", every_feature().as_bytes());
    assert_eq!(found.positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 5.]]);
    assert_eq!(net(&found).faces, [[0, 1, 2], [2, 1, 3]]);
    // a fifth of the light is sRGB 0.4845
    let gray = 0.484_529_204_481_703_4;
    let colors = [1., 0., 0., 1., 0., 1., 0., 1., 0., 0., 1., 1., gray, gray, gray, 0.2];
    let off = found.channels[0].values.iter().zip(colors).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let full = |k: &usize| colors[*k].to_bits() == 1.0_f64.to_bits();
    let kept = (0..16).filter(full).all(|k| found.channels[0].values[k].to_bits() == 1.0_f64.to_bits());
    assert!(kept, "full light is exactly 1: {found:?}");
    assert!(found.channels[0].name == "color" && found.channels[0].values.len() == 16 && off < 1e-12, "{found:?}");
    let uvs = found.uvs.expect("it has them");
    assert_eq!(uvs.values, [[0., 1.], [1., 1.], [0., 0.], [1., 0.75]], "v counts upwards");
    assert_eq!(found.materials, [FaceSet { name: "red".into(), faces: vec![0] }], "a material without a name is none");
}

#[test]
fn sparse_rows_have_to_increase() {
    let mut document: Value = serde_json::from_str(&every_feature()).expect("a document");
    document["accessors"][0]["sparse"]["count"] = json!(3);
    document["accessors"][0]["sparse"]["indices"]["bufferView"] = json!(0);
    document["accessors"][0]["sparse"]["values"]["bufferView"] = json!(0);
    let found = sentences("gltf", document.to_string().as_bytes());
    assert_eq!(found, ["mesh 0, primitive 0: accessor 0: sparse row 0 after 1; they have to increase"]);
}

#[test]
fn what_leads_nowhere_is_named() {
    let check = |pointer: &str, value: Value, sentence: &str| {
        let mut document = square(4, &[0, 1, 2]);
        *document.pointer_mut(pointer).expect("the place is there") = value;
        assert_eq!(sentences("gltf", document.to_string().as_bytes()), [sentence]);
    };
    let primitive = "mesh 0, primitive 0: ";
    check("/scene", json!(1), "there is no scene 1; the file has 1");
    check("/scenes/0/nodes/0", json!(7), "there is no node 7; the file has 1");
    check("/nodes/0", json!({ "children": [0] }), "node 0 is reached twice; nodes are to form trees");
    check("/nodes/0/mesh", json!(2), "node 0: there is no mesh 2");
    check("/meshes/0/primitives/0/mode", json!(9), &format!("{primitive}its mode is not known"));
    check("/meshes/0/primitives/0/attributes", json!({}), &format!("{primitive}it has no POSITION"));
    check("/meshes/0/primitives/0/indices", json!(5), &format!("{primitive}there is no accessor 5; the file has 2"));
    check("/meshes/0/primitives/0/indices", json!(0), &format!("{primitive}accessor 0: indices are unsigned scalars"));
    check("/accessors/0/type", json!("VEC2"), &format!("{primitive}POSITION is to be VEC3"));
    check(
        "/accessors/0/type",
        json!("MAT4"),
        &format!("{primitive}accessor 0: its type is not SCALAR, VEC2, VEC3 or VEC4"),
    );
    check("/accessors/0/bufferView", json!(4), &format!("{primitive}accessor 0: there is no bufferView 4"));
    let many = "accessor 0: 5 rows, 12 bytes apart, from byte 0 of a view of 48 bytes; too many";
    check("/accessors/0/count", json!(5), &format!("{primitive}{many}"));
    let huge = "accessor 0: 4000000000 rows, 12 bytes apart, from byte 0 of a view of 48 bytes; too many";
    check("/accessors/0/count", json!(4_000_000_000_u64), &format!("{primitive}{huge}"));
    check("/accessors/1/count", json!(2), &format!("{primitive}2 corners; triangles have 3 each"));
    check("/accessors/0/count", json!(2), &format!("{primitive}there is no vertex 2; it has 2, counted from 0"));
    let beyond = "accessor 0: bufferView 0: 48 bytes from byte 0; buffer 0 has 10";
    check("/buffers/0/byteLength", json!(10), &format!("{primitive}{beyond}"));
    let long =
        "node 0: the length of its rotation 0, 0, 1, 1 is 1.4142135623730951; a rotation is a quaternion of length 1";
    check("/nodes/0", json!({ "mesh": 0, "rotation": [0, 0, 1, 1] }), long);
    let matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.5, 0., 0., 0., 1.];
    let projective = "node 0: the last row of its matrix is 0, 0, 0.5, 1; it has to be 0, 0, 0, 1";
    check("/nodes/0", json!({ "mesh": 0, "matrix": matrix }), projective);
    let both = "node 0: its place is a matrix and parts of one; give either";
    check("/nodes/0", json!({ "mesh": 0, "matrix": matrix, "scale": [1, 1, 1] }), both);
    let view = "accessor 0: bufferView 0: 99 bytes from byte 0; buffer 0 has 52";
    check("/bufferViews/0/byteLength", json!(99), &format!("{primitive}{view}"));
}

/// A small file that claims to be large: a mesh of a thousand triangles at two hundred nodes.
#[test]
fn instances_are_bounded_by_the_bytes_that_are_there() {
    let indices: Vec<u8> = [0, 1, 2].repeat(1000);
    let mut document = square(4, &indices);
    document["nodes"] = json!(vec![json!({ "mesh": 0 }); 200]);
    document.as_object_mut().expect("an object").remove("scene");
    document.as_object_mut().expect("an object").remove("scenes");
    let found = sentences("gltf", document.to_string().as_bytes());
    let says = |part: &str| found[0].contains(part);
    assert!(says("mesh 0, primitive 0: it takes ") && says(" are taken: send less at once"), "{found:?}");
    document["nodes"] = json!(vec![json!({ "mesh": 0 }); 10]);
    assert_eq!(faces(&document).len(), 10_000);
}

/// Primitives name the groups; other faces are in the group of their node if there are several nodes.
#[test]
fn primitives_name_groups_and_nodes_the_rest() {
    let mut document = square(4, &[0, 1, 2]);
    let primitive = |extras: Value| json!({ "attributes": { "POSITION": 0 }, "indices": 1, "extras": extras });
    let named = primitive(json!({ "group": "top", "faces": 7 }));
    let others = [json!({ "group": 7 }), json!("group"), Value::Null].map(primitive);
    document["meshes"][0]["primitives"] = json!([others[0], named, others[1], named, others[2]]);
    let groups = |document: &Value| -> Vec<(String, Vec<u64>)> {
        let found = mesh("gltf", document.to_string().as_bytes()).groups;
        found.into_iter().map(|set| (set.name, set.faces)).collect()
    };
    let set = |name: &str, faces: &[u64]| (name.to_owned(), faces.to_vec());
    assert_eq!(groups(&document), [set("top", &[1, 3])]);
    document["nodes"] = json!([{ "mesh": 0, "name": "a" }, { "mesh": 0, "name": "b" }]);
    document["scenes"][0]["nodes"] = json!([0, 1]);
    assert_eq!(groups(&document), [set("top", &[1, 3, 6, 8]), set("a", &[0, 2, 4]), set("b", &[5, 7, 9])]);
}

#[test]
fn what_no_mesh_is_made_of_is_named() {
    let mut document = square(4, &[0, 1, 2, 2, 1, 3]);
    let sets = ["TEXCOORD_1", "COLOR_1", "JOINTS_0", "WEIGHTS_0", "TANGENT", "UNHEARD"];
    for set in sets {
        document["meshes"][0]["primitives"][0]["attributes"][set] = json!(0);
    }
    document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]);
    document["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let found = mesh("gltf", document.to_string().as_bytes());
    let expected = [
        "cameras are left out: 1",
        "attributes of primitives are left out: COLOR_1 (1), JOINTS_0 (1), TANGENT (1), TEXCOORD_1 (1), WEIGHTS_0 (1), \
         one that glTF does not know (1)",
        "extensions are left out: \"KHR_lights_punctual\"",
    ];
    assert_eq!(found.notes, expected);
}

#[test]
fn texture_coordinates_and_colours_that_some_vertices_lack_are_named() {
    let mut document = square(4, &[0, 1, 2, 2, 1, 3]);
    let bare = document["meshes"][0]["primitives"][0].clone();
    document["accessors"].as_array_mut().expect("a list").push(json!({
        "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"
    }));
    let last = document["accessors"].as_array().map_or(0, Vec::len) - 1;
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    attributes["COLOR_0"] = json!(0);
    attributes["TEXCOORD_0"] = json!(last);
    document["meshes"][0]["primitives"].as_array_mut().expect("a list").push(bare);
    let found = mesh("gltf", document.to_string().as_bytes());
    assert_eq!(
        found.notes,
        [
            "texture coordinates are left out: 4 of 8 vertices have none",
            "colours are left out: 4 of 8 vertices have one"
        ]
    );
}

/// Attributes of applications are channels if all vertices have them, whatever their component type.
#[test]
fn attributes_of_applications_are_channels() {
    let mut document = document(
        &[floats(&SQUARE), vec![0, 51, 102, 255], vec![0, 1, 2]],
        &json!({
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR", "normalized": true },
                { "bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR" },
                { "componentType": 5126, "count": 4, "type": "MAT2" },
            ],
            "meshes": [{ "primitives": [{ "attributes": {
                "POSITION": 0, "_HEAT": 1, "_DIRECTION": 0, "_COLOR": 1, "_ORIGIN": 1, "_SHORT": 2, "_MATRIX": 3
            }, "indices": 2 }] }],
            "nodes": [{ "mesh": 0 }],
        }),
    );
    let found = mesh("gltf", document.to_string().as_bytes());
    let channels: Vec<_> = found.channels.iter().map(|channel| (channel.name.as_str(), channel.width)).collect();
    assert_eq!(channels, [("COLOR", 1), ("direction", 3), ("heat", 1)]);
    assert_eq!(found.channels[2].values, [0.0, 0.2, 0.4, 1.0]);
    let left_out = "2 attributes are left out, as not every vertex has them: \"matrix\", \"short\"";
    assert_eq!(found.notes, [left_out]);
    // a second primitive whose vertices have no heat
    let other = json!({ "attributes": { "POSITION": 0, "_DIRECTION": 0 }, "indices": 2 });
    document["meshes"][0]["primitives"].as_array_mut().expect("primitives").push(other);
    let found = mesh("gltf", document.to_string().as_bytes());
    assert_eq!((found.channels.len(), found.channels[0].values.len()), (1, 24));
    assert!(found.notes[0].contains("\"heat\""), "{:?}", found.notes);
}

/// Accessors without bytes are zeros: many of them must not take much memory for a small file.
#[test]
fn attributes_are_bounded_by_the_bytes_that_are_there() {
    let mut document = square(4, &[0, 1, 2]);
    document["accessors"][0] = json!({ "componentType": 5126, "count": 3000, "type": "VEC3" });
    for k in 0..60 {
        document["meshes"][0]["primitives"][0]["attributes"][format!("_A{k}")] = json!(0);
    }
    let found = mesh("gltf", document.to_string().as_bytes());
    let count = |note: &String| note.split(' ').next()?.parse::<usize>().ok();
    let left_out = found.notes.first().and_then(count).unwrap_or(0);
    assert_eq!((found.positions.len(), found.channels.len() + left_out), (3000, 60));
    assert!(found.channels.len() < 10, "{}", found.channels.len());
}
