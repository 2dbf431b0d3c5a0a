//! Compressed glTF: numbers of 16 bits, and views that are streams of `EXT_meshopt_compression`.

use serde_json::{Value, json};

use super::round_trips::base64;
use crate::support;
use crate::support::nets::{self, Net, same_surface};

/// Returns a torus with all data that a vertex can carry, including seams of texture coordinates and of colours.
fn mesh() -> Value {
    let net = nets::torus(9, 7);
    let mut mesh = net.to_json();
    let n = net.faces.len();
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let own = |value: &dyn Fn(usize) -> usize| (0..n).map(|f| vec![value(f); 4]).collect::<Vec<_>>();
    mesh["uvs"] = json!({ "values": square, "faces": vec![[0, 1, 2, 3]; n] });
    mesh["channels"] = json!({
        "color": { "values": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "faces": own(&|f| f % 3) },
        "heat": (0..net.positions.len()).collect::<Vec<_>>(),
    });
    mesh["groups"] = json!([{ "name": "first", "faces": [0, 1, 2, 3] }]);
    mesh
}

fn written(output: &Value) -> Vec<u8> {
    let mut output = output.clone();
    output["format"] = json!("glb");
    let (bytes, _) =
        support::render(&json!({ "input": { "mesh": mesh() }, "outputs": [output] })).expect("it is written");
    bytes
}

fn read(bytes: &[u8]) -> Value {
    let text = json!({ "format": "glb", "data": base64(bytes), "encoding": "base64" });
    support::json(json!({ "input": { "text": text, "weld": 0 } }))
}

#[test]
fn what_was_packed_comes_back_as_what_was_written_plainly() {
    let plain = read(&written(&json!({ "normals": "none" })));
    for way in ["quantize", "meshopt"] {
        for normals in ["none", "area"] {
            let found = read(&written(&json!({ "compression": way, "normals": normals })));
            // half a step of the grid, whose side is below 8
            same_surface(&Net::of(&found), &Net::of(&plain), 8.0 / 65_535.0).expect("the same surface");
            let count = |result: &Value, name: &str| result["channels"][name]["values"].as_array().map(Vec::len);
            for name in ["color", "heat"] {
                assert_eq!(count(&found, name), count(&plain, name), "{way}: {name}");
            }
            assert_eq!(
                found["uvs"]["values"].as_array().map(Vec::len),
                plain["uvs"]["values"].as_array().map(Vec::len)
            );
            assert_eq!(found["groups"][0]["faces"].as_array().map(Vec::len), Some(8), "{way}");
        }
    }
}

/// Returns the message about a document with one invalid stream.
fn refused(stream: &Value) -> String {
    let document = json!({
        "asset": { "version": "2.0" }, "extensionsUsed": ["EXT_meshopt_compression"],
        "buffers": [{ "byteLength": 8, "uri": "data:;base64,oAAAAAAAAAA=" }, { "byteLength": 4 }],
        "bufferViews": [{ "buffer": 1, "byteLength": 4, "extensions": { "EXT_meshopt_compression": stream } }],
    });
    let input = json!({ "text": { "format": "gltf", "data": document.to_string() } });
    let faults = support::faults(json!({ "input": input }));
    assert_eq!((faults.len(), faults[0].pointer.as_str()), (1, "/input/text/data"), "{faults:?}");
    faults[0].detail.clone()
}

#[test]
fn streams_that_are_broken_or_too_long_are_refused() {
    let with = |name: &str, value: Value| {
        let mut stream = json!({ "buffer": 0, "byteLength": 8, "byteStride": 4, "count": 16, "mode": "ATTRIBUTES" });
        stream[name] = value;
        refused(&stream)
    };
    for (name, value, sentence) in [
        ("mode", json!("TRIANGLE"), "16 rows of 4 bytes are not packed so"),
        ("filter", json!("EXP"), "16 rows of 4 bytes are not packed so"),
        ("byteStride", json!(3), "16 rows of 3 bytes are not packed so"),
        ("count", json!(0), "0 rows of 4 bytes are not packed so"),
        ("buffer", json!(2), "there is no buffer 2"),
        ("byteLength", json!(9), "9 bytes from byte 0; buffer 0 has 8; send it whole"),
        ("byteOffset", json!(u64::MAX), "buffer 0 has 8; send it whole"),
        ("count", json!(17), "it is broken"),
        ("count", json!(100_000_000), "it takes 1.4 GiB to read; a file of "),
        ("count", json!(-1), "expected usize"),
    ] {
        let found = with(name, value);
        assert!(found.starts_with("bufferView 0: its stream EXT_meshopt_compression: "), "{found}");
        assert!(found.contains(sentence), "{found}, not {sentence}");
    }
}
