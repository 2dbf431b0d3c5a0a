//! Levels of detail: one document, and a buffer for each level.

use planish::job::limits::Limits;
use planish::job::{Job, run};
use planish::watch::Watch;
use serde_json::{Value, json};

use super::model::Model;
use super::{laden, with};
use crate::support::{nets, parsed, render};

fn question(mesh: &Value, output: &Value) -> Value {
    json!({ "input": { "mesh": mesh }, "plan": { "preset": "catmull-clark" }, "levels": 3, "outputs": [output] })
}

/// Returns the bytes of a job's output.
fn made(job: Job) -> Vec<u8> {
    let admitted = Limits::default().admit(job).expect("within limits");
    let mut bytes = Vec::new();
    run(&admitted, &admitted.job().outputs[0], &mut bytes, &Watch::new()).expect("it runs");
    let most = admitted.estimate().outputs[0].1.bytes();
    assert!(bytes.len() as u128 <= most, "{} of at most {most} bytes", bytes.len());
    bytes
}

/// Returns the document of a job, and the buffers to which it refers, with their addresses.
fn document(question: &Value) -> (Value, Vec<(String, Vec<u8>)>) {
    let job = parsed(question.to_string().as_bytes()).expect("a job");
    let details = job.details(&job.outputs[0]);
    let address = |job: &Job| format!("{}.bin", job.keys()[0]);
    let buffers = details.into_iter().map(|detail| (address(&detail), made(detail))).collect();
    (serde_json::from_slice(&made(job)).expect("JSON"), buffers)
}

/// Returns the bytes of each buffer of a document; none for a buffer without an address.
fn found<'a>(document: &Value, buffers: &'a [(String, Vec<u8>)]) -> Vec<&'a [u8]> {
    let of = |told: &Value| {
        let Some(uri) = told.get("uri") else { return &[][..] };
        let (_, bytes) = buffers.iter().find(|(address, _)| uri == address).expect("a buffer of this address");
        assert_eq!(bytes.len(), Model::number(&told["byteLength"]));
        bytes
    };
    document["buffers"].as_array().expect("buffers").iter().map(of).collect()
}

#[test]
fn the_finest_level_names_the_coarser_ones_that_stand_for_it() {
    for (compression, buffers) in [("none", 3), ("quantize", 3), ("meshopt", 6)] {
        let output = json!({ "format": "gltf", "compression": compression, "lod": [1, 2, 3] });
        let (document, written) = document(&question(&nets::torus(5, 4).to_json(), &output));
        assert_eq!(document["buffers"].as_array().expect("buffers").len(), buffers, "{compression}");
        assert_eq!(document["scenes"], json!([{ "nodes": [2] }]));
        assert_eq!(document["nodes"][2]["extensions"]["MSFT_lod"]["ids"], json!([1, 0]));
        let used = document["extensionsUsed"].as_array().expect("extensions");
        assert_eq!(used.iter().filter(|name| **name == "MSFT_lod").count(), 1);
        let model = Model::of_parts(document.clone(), &found(&document, &written));
        for level in 0..3 {
            assert_eq!(document["nodes"][level]["mesh"], json!(level));
            let alone = json!({ "format": "glb", "compression": compression });
            let mut job = question(&nets::torus(5, 4).to_json(), &alone);
            job["levels"] = json!(level + 1);
            let alone = Model::of(&render(&job).expect("a model").0);
            assert_eq!(model.triangles(level), alone.triangles(0), "{compression}");
            assert_eq!(model.places(level), alone.places(0), "{compression}");
        }
    }
}

#[test]
fn all_that_a_mesh_carries_is_there_at_each_level() {
    for compression in ["none", "meshopt"] {
        let output = json!({ "format": "gltf", "compression": compression, "lod": [0, 3], "ids": true });
        let (document, written) = document(&question(&laden(), &output));
        let model = Model::of_parts(document.clone(), &found(&document, &written));
        for (level, first) in [(0, 0), (3, 5)] {
            let way = json!({ "compression": compression });
            let mut job = question(&laden(), &with(&way, &json!({ "format": "glb", "ids": true })));
            job["levels"] = json!(level);
            let alone = Model::of(&render(&job).expect("a model").0);
            assert_eq!(alone.n_primitives(), 5);
            for i in 0..5 {
                assert_eq!(model.triangles(first + i), alone.triangles(i));
                assert_eq!(model.faces(first + i), alone.faces(i));
                for name in ["COLOR_0", "_HEAT", "TEXCOORD_0", "NORMAL", "_ORIGIN"] {
                    assert_eq!(model.rows(first + i, name), alone.rows(i, name), "{name} at {level}");
                }
            }
        }
    }
}

#[test]
fn a_buffer_has_the_key_of_the_job_that_asks_for_it_alone() {
    let output = json!({ "format": "gltf", "compression": "meshopt", "lod": [1, 3] });
    let (_, buffers) = document(&question(&nets::cube().to_json(), &output));
    let mut alone = question(&nets::cube().to_json(), &json!({ "format": "gltf-bin", "compression": "meshopt" }));
    alone["levels"] = json!(1);
    let job = parsed(alone.to_string().as_bytes()).expect("a job");
    assert_eq!(buffers[0].0, format!("{}.bin", job.keys()[0]));
    assert_eq!(buffers[0].1, made(job));
}

#[test]
fn levels_are_whole_and_ascend_to_that_of_the_job() {
    let mesh = nets::cube().to_json();
    for (lod, said) in [
        (json!([2, 1, 3]), "level 1 comes after 2"),
        (json!([1, 1, 3]), "level 1 comes after 1"),
        (json!([0.5, 3]), "0.5 is no level"),
        (json!([-1, 3]), "-1 is no level"),
        (json!([1, 2]), "that of the job, 3"),
        (json!([1, 4]), "that of the job, 3"),
        (json!([]), "1 to 16"),
        (json!((0..17).collect::<Vec<_>>()), "1 to 16"),
    ] {
        let faults = render(&question(&mesh, &json!({ "format": "gltf", "lod": lod }))).expect_err("a refusal");
        assert_eq!(faults[0].pointer, "/outputs/0/lod", "{lod}");
        assert!(faults[0].detail.contains(said), "{lod}: {}", faults[0].detail);
    }
    let faults = render(&question(&mesh, &json!({ "format": "glb", "lod": [3] }))).expect_err("a refusal");
    assert_eq!(faults[0].pointer, "/outputs/0/lod");
    let mut framed = mesh.clone();
    framed["frames"] = json!([nets::cube().positions]);
    let faults = render(&question(&framed, &json!({ "format": "gltf", "lod": [1, 3] }))).expect_err("a refusal");
    assert!(faults[0].detail.contains("frame"), "{}", faults[0].detail);
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "closed": true });
    let curve = json!({ "input": { "polygon": polygon }, "plan": { "preset": "chaikin" }, "levels": 3,
        "outputs": [{ "format": "gltf", "lod": [1, 3] }] });
    let faults = render(&curve).expect_err("a refusal");
    assert_eq!(faults[0].pointer, "/outputs/0/lod");
    assert!(faults[0].detail.contains("curves"), "{}", faults[0].detail);
}
