//! Refused compressions, and the reasons.

use serde_json::{Value, json};

use crate::support::{nets, render};

fn refusal(job: &Value) -> (String, String) {
    let faults = render(job).expect_err("a refusal");
    (faults[0].pointer.clone(), faults[0].detail.clone())
}

#[test]
fn curves_are_written_as_they_are() {
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "closed": true });
    let mut job = json!({ "input": { "polygon": polygon }, "plan": { "preset": "chaikin" }, "levels": 1 });
    for (option, value) in [("compression", "meshopt"), ("vertex_order", "cache")] {
        for format in ["glb", "gltf"] {
            job["outputs"] = json!([{ "format": format, option: value }]);
            let (pointer, detail) = refusal(&job);
            assert_eq!(pointer, format!("/outputs/0/{option}"));
            assert!(detail.contains("meshes"), "{detail}");
        }
    }
}

#[test]
fn frames_are_written_as_they_are() {
    let net = nets::cube();
    let mut mesh = net.to_json();
    mesh["frames"] = json!([net.positions]);
    let mut job = json!({ "input": { "mesh": mesh }, "plan": { "preset": "catmull-clark" }, "levels": 1 });
    job["outputs"] = json!([{ "format": "glb", "compression": "quantize" }]);
    let (pointer, detail) = refusal(&job);
    assert_eq!(pointer, "/outputs/0/compression");
    assert!(detail.contains("\"frame\""), "{detail}");
    job["outputs"][0]["frame"] = json!(1);
    render(&job).expect("one frame is a mesh");
}
