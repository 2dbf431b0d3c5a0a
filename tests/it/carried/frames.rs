//! Unit and up axis become the transform of the node in glTF, comments in other formats, and the up direction in
//! pictures.

use serde_json::{Value, json};

use super::{job, text, written};
use crate::support::nets::{self, Net, distance};

fn framed(net: &Net, unit: &str, up: &str) -> Value {
    let mut question = job(net, &json!({}), &json!({ "preset": "catmull-clark" }), 1);
    question["input"]["unit"] = json!(unit);
    question["input"]["up"] = json!(up);
    question
}

fn moved(net: &Net, by: [f64; 3]) -> Net {
    let positions = net.positions.iter().map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]).collect();
    Net { positions, faces: net.faces.clone() }
}

/// Returns the world positions of a glTF file, from the stored positions and the transforms of the nodes in f64.
fn world(document: &Value, glb: &[u8]) -> Vec<[f64; 3]> {
    let n = usize::try_from(document["accessors"][0]["count"].as_u64().expect("a count")).expect("small");
    let start =
        glb.len() - usize::try_from(document["buffers"][0]["byteLength"].as_u64().expect("a length")).expect("small");
    let stored = glb[start..start + 12 * n].as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b)));
    let stored: Vec<f64> = stored.collect();
    let nodes = document["nodes"].as_array().expect("nodes");
    stored
        .chunks_exact(3)
        .map(|p| nodes.iter().rev().fold([p[0], p[1], p[2]], |p, node| transformed(node, p)))
        .collect()
}

fn transformed(node: &Value, p: [f64; 3]) -> [f64; 3] {
    let numbers = |name: &str| -> Option<Vec<f64>> { serde_json::from_value(node.get(name)?.clone()).ok() };
    let scale = numbers("scale").unwrap_or(vec![1.0; 3]);
    let mut turned = [p[0] * scale[0], p[1] * scale[1], p[2] * scale[2]];
    if let Some(m) = numbers("matrix") {
        turned = [0, 1, 2].map(|i| (0..3).map(|j| m[4 * j + i] * turned[j]).sum::<f64>() + m[12 + i]);
    }
    let translation = numbers("translation").unwrap_or(vec![0.0; 3]);
    [turned[0] + translation[0], turned[1] + translation[1], turned[2] + translation[2]]
}

fn document(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

#[test]
fn gltf_is_in_metres_with_y_up_near_and_far() {
    for (unit, metres) in [("m", 1.0), ("mm", 0.001), ("cm", 0.01), ("in", 0.0254)] {
        for up in ["y", "z"] {
            for by in [[0.0; 3], [4e6, -3e6, 1e6]] {
                let question = framed(&moved(&nets::prism(5), by), unit, up);
                let glb = written(&question, &json!({ "format": "glb" }));
                let found = world(&document(&glb), &glb);
                let result: Value = serde_json::from_str(&text(&question, &json!({ "format": "json" }))).expect("JSON");
                for (found, [x, y, z]) in found.iter().zip(Net::of(&result).positions) {
                    let p = if up == "z" { [x, z, -y] } else { [x, y, z] };
                    let expected = p.map(|x| x * metres);
                    // positions are f32 relative to the centre, and the centre itself is exact
                    assert!(
                        distance(found, &expected) < 1e-6 * metres,
                        "{unit} {up} {by:?}: {found:?} and {expected:?}"
                    );
                }
            }
        }
    }
}

/// The translation is a decimal number: reading it as f64 restores every digit of the positions.
#[test]
fn far_models_lose_nothing_to_the_translation() {
    for by in [[1_000_000.437_5, -3_333_333.3, 7e6], [123_456_789.1, 0.3, -98_765.432_1]] {
        for (unit, up) in [("m", "y"), ("m", "z"), ("mm", "z"), ("in", "y")] {
            let question = framed(&moved(&nets::prism(5), by), unit, up);
            let glb = written(&question, &json!({ "format": "glb" }));
            let result: Value = serde_json::from_str(&text(&question, &json!({ "format": "json" }))).expect("JSON");
            let metres =
                [("m", 1.0), ("mm", 0.001), ("in", 0.0254)].iter().find(|known| known.0 == unit).expect("it").1;
            for (found, [x, y, z]) in world(&document(&glb), &glb).iter().zip(Net::of(&result).positions) {
                let p = if up == "z" { [x, z, -y] } else { [x, y, z] };
                let expected = p.map(|x| x * metres);
                assert!(distance(found, &expected) < 1e-6 * metres, "{unit} {up}: {found:?} and {expected:?}");
            }
        }
    }
}

#[test]
fn the_defaults_may_be_written_out() {
    let plain = job(&nets::prism(5), &json!({}), &json!({ "preset": "catmull-clark" }), 1);
    for format in ["glb", "ply", "obj", "json"] {
        let output = json!({ "format": format });
        assert_eq!(written(&framed(&nets::prism(5), "m", "y"), &output), written(&plain, &output));
    }
}

#[test]
fn text_formats_keep_model_units_and_say_which() {
    let plain = text(&framed(&nets::cube(), "m", "y"), &json!({ "format": "obj" }));
    let told = text(&framed(&nets::cube(), "mm", "z"), &json!({ "format": "obj" }));
    assert_eq!(told.replacen("# unit mm\n# up z\n", "", 1), plain);
    let ascii = json!({ "format": "ply", "ascii": true });
    let told = text(&framed(&nets::cube(), "in", "y"), &ascii);
    assert_eq!(told.replacen("comment unit in\n", "", 1), text(&framed(&nets::cube(), "m", "y"), &ascii));
}

#[test]
fn pictures_have_the_up_axis_upright() {
    let small = json!({ "format": "png", "width": 64, "height": 64 });
    let mut told = small.clone();
    told["camera"] = json!({ "up": [0, 0, 1] });
    let upright = written(&framed(&nets::prism(5), "mm", "z"), &small);
    assert_eq!(upright, written(&framed(&nets::prism(5), "m", "y"), &told));
    assert_ne!(upright, written(&framed(&nets::prism(5), "mm", "y"), &small));
}

#[test]
fn curves_have_frames_too() {
    let polygon = json!({
        "input": { "polygon": { "points": [[0, 0, 1], [2, 0, 0], [2, 1, 0]] }, "unit": "cm", "up": "z" },
        "plan": { "preset": "chaikin" }, "levels": 1,
    });
    let document: Value = serde_json::from_str(&text(&polygon, &json!({ "format": "gltf" }))).expect("JSON");
    let turned = [0.01, 0., 0., 0., 0., 0., -0.01, 0., 0., 0.01, 0., 0., 0., 0., 0., 1.];
    assert_eq!(document["nodes"][0]["matrix"], json!(turned));
    assert!(text(&polygon, &json!({ "format": "obj" })).starts_with("# planish\n# unit cm\n# up z\nv 0 0 1\n"));
}
