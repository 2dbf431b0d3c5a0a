//! Channels are refined like positions, names follow the faces, and origins agree with the geometry.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{indices, job, told, written};
use crate::support::nets::{self, Net, distance};

fn plans() -> Vec<Value> {
    vec![
        json!({ "word": "U" }),
        json!({ "preset": "catmull-clark" }),
        json!({ "preset": "catmull-clark", "boundary": "edge-only" }),
        json!({ "preset": "push-back", "parameters": { "alpha": 0.4, "delta": "(valence-4)/valence" } }),
        json!({ "word": "UCCP", "parameters": { "kernel": 1.7, "delta": -0.3 } }),
    ]
}

fn closed_and_open() -> [Net; 5] {
    [nets::cube(), nets::prism(5), nets::grid(3, 2), nets::mixed(), nets::torus(4, 3)]
}

#[test]
fn a_channel_that_equals_the_positions_is_refined_to_the_positions_bit_by_bit() {
    for net in closed_and_open() {
        for plan in plans() {
            let result = told(job(&net, &json!({ "channels": { "place": net.positions } }), &plan, 2));
            assert_eq!(result["channels"]["place"], result["positions"], "{plan}");
        }
    }
}

#[test]
fn duals_carry_channels_too() {
    let net = nets::torus(4, 3);
    let mut question = job(&net, &json!({ "channels": { "place": net.positions } }), &json!({ "word": "UD" }), 2);
    question["outputs"] = json!([{ "format": "json" }]);
    let result: Value = serde_json::from_slice(&super::bytes(&question)).expect("JSON");
    assert_eq!(result["channels"]["place"], result["positions"]);
}

#[test]
fn a_constant_channel_stays_constant_and_positions_do_not_feel_it() {
    for net in closed_and_open() {
        let constant = vec![json!([0.25, -3.0]); net.positions.len()];
        for plan in plans() {
            let carrying = told(job(&net, &json!({ "channels": { "constant": constant } }), &plan, 2));
            let bare = told(job(&net, &json!({}), &plan, 2));
            assert_eq!(carrying["positions"], bare["positions"]);
            assert_eq!(carrying["faces"], bare["faces"]);
            let rows: Vec<[f64; 2]> = serde_json::from_value(carrying["channels"]["constant"].clone()).expect("pairs");
            assert_eq!(rows.len(), bare["positions"].as_array().map_or(0, Vec::len));
            assert!(rows.iter().all(|row| distance(row, &[0.25, -3.0]) < 1e-12), "{plan}");
        }
    }
}

#[test]
fn what_json_tells_is_an_input_that_gives_the_same_again() {
    let net = nets::mixed();
    let extra = json!({
        "channels": { "color": net.positions, "weight": (0..net.positions.len()).collect::<Vec<_>>() },
        "groups": [{ "name": "some", "faces": [1, 2] }, { "name": "none", "faces": [] }],
        "materials": [{ "name": "red", "faces": [0, 2] }],
        "holes": [1],
    });
    let output = || json!({ "format": "json" });
    let first = written(&job(&net, &extra, &json!({ "preset": "catmull-clark" }), 2), &output());
    let mesh: Value = serde_json::from_slice(&first).expect("JSON");
    let second = written(&json!({ "input": { "mesh": mesh } }), &output());
    assert_eq!(String::from_utf8_lossy(&first), String::from_utf8_lossy(&second));
}

/// Under bilinear refinement, every point stays on its original cell.
#[test]
fn origins_agree_with_the_geometry() {
    for net in closed_and_open() {
        let result = told(job(&net, &json!({}), &json!({ "word": "U" }), 3));
        let refined = Net::of(&result);
        let edges = edges_by_appearance(&net);
        let origins: Vec<[usize; 2]> = serde_json::from_value(result["ids"]["vertices"].clone()).expect("pairs");
        assert_eq!(origins.len(), refined.positions.len());
        for (p, [dimension, cell]) in refined.positions.iter().zip(origins) {
            let corners: Vec<usize> = match dimension {
                0 => vec![cell],
                1 => edges[cell].to_vec(),
                _ => net.faces[cell].clone(),
            };
            assert!(within_box(p, &net, &corners), "{p:?} lies outside cell {cell} of dimension {dimension}");
            assert!(dimension != 0 || distance(p, &net.positions[cell]) == 0.0);
        }
        let origins = indices(&result["ids"]["faces"]);
        assert_eq!(origins.len(), refined.faces.len());
        for (face, origin) in refined.faces.iter().zip(origins) {
            assert!(face.iter().all(|&v| within_box(&refined.positions[v], &net, &net.faces[origin])));
        }
    }
}

fn within_box(p: &[f64; 3], net: &Net, corners: &[usize]) -> bool {
    (0..3).all(|k| {
        let values = || corners.iter().map(|&v| net.positions[v][k]);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        (low - 1e-12..=high + 1e-12).contains(&p[k])
    })
}

fn edges_by_appearance(net: &Net) -> Vec<[usize; 2]> {
    let mut edges: Vec<[usize; 2]> = Vec::new();
    for face in &net.faces {
        for (j, &a) in face.iter().enumerate() {
            let b = face[(j + 1) % face.len()];
            if !edges.contains(&[a, b]) && !edges.contains(&[b, a]) {
                edges.push([a, b]);
            }
        }
    }
    edges
}

#[test]
fn without_levels_everything_is_its_own_origin() {
    let net = nets::prism(3);
    let result = told(json!({ "input": net.input() }));
    assert_eq!(indices(&result["ids"]["faces"]), (0..net.faces.len()).collect::<Vec<_>>());
    let own: Vec<Value> = (0..net.positions.len()).map(|v| json!([0, v])).collect();
    assert_eq!(result["ids"]["vertices"], json!(own));
}

/// Returns a mesh with names on random faces and with random holes.
fn named() -> impl Strategy<Value = (Net, Vec<Option<usize>>, Vec<usize>)> {
    nets::manifold().prop_flat_map(|net| {
        let n = net.faces.len();
        let labels = prop::collection::vec(prop::option::of(0..3_usize), n);
        (Just(net), labels, prop::collection::vec(0..n, 0..3))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn names_follow_the_faces_and_sizes_are_kept((net, labels, holes) in named(), levels in 0..3_u32) {
        let set = |name: usize| (0..labels.len()).filter(|&f| labels[f] == Some(name)).collect::<Vec<_>>();
        let sets: Vec<Value> = (0..3).map(|i| json!({ "name": format!("s{i}"), "faces": set(i) })).collect();
        let channels = json!({ "color": net.positions, "w": vec![1.5; net.positions.len()] });
        let extra = json!({ "groups": sets, "materials": sets[..2], "holes": holes, "channels": channels });
        let question = job(&net, &extra, &json!({ "preset": "catmull-clark" }), levels);
        let result = told(question.clone());
        let origins = indices(&result["ids"]["faces"]);
        for (i, group) in result["groups"].as_array().expect("groups").iter().enumerate() {
            let expected: Vec<usize> = (0..origins.len()).filter(|&f| labels[origins[f]] == Some(i)).collect();
            prop_assert_eq!(indices(&group["faces"]), expected);
        }
        prop_assert!(origins.iter().all(|origin| !holes.contains(origin)));
        for output in [
            json!({ "format": "json", "ids": true }),
            json!({ "format": "obj", "ids": true, "normals": "area" }),
            json!({ "format": "glb", "ids": true }),
            json!({ "format": "gltf" }),
            json!({ "format": "ply", "ids": true }),
            json!({ "format": "ply", "ids": true, "ascii": true, "precision": "f32" }),
        ] {
            let mut question = question.clone();
            question["outputs"] = json!([output]);
            super::files::check_size(&question);
        }
    }
}
