//! Limits under arities above 2, which first split all faces into quads if one face of the mesh is not a quad.

use serde_json::{Value, json};

use super::limit;
use crate::support::json_with;
use crate::support::nets::{self, Net, distance};

fn plan(word: &str, boundary: &str) -> Value {
    json!({ "word": word, "boundary": boundary })
}

/// Returns a net with a distant triangle.
fn with_a_triangle(net: &Net) -> Net {
    let positions = vec![[9.0, 0.0, 0.0], [10.0, 0.0, 0.5], [9.0, 1.0, 0.0]];
    together(net, &Net { positions, faces: vec![vec![0, 1, 2]] })
}

fn assert_still(net: &Net, plan: &Value) {
    let (coarse, normals) = limit(net, plan, 0);
    let (fine, fine_normals) = limit(net, plan, 1);
    for v in 0..net.positions.len() {
        let off = distance(&coarse.positions[v], &fine.positions[v]);
        assert!(off <= 1e-12, "{plan}: vertex {v} moves by {off}");
        let off = distance(&normals[v], &fine_normals[v]);
        assert!(off <= 1e-8, "{plan}: normal {v} turns by {off}");
    }
}

#[test]
fn limits_know_of_faces_far_away() {
    let nets = [nets::grid(3, 3), nets::torus(4, 3), nets::cube()].map(|net| with_a_triangle(&net));
    for word in ["U3CC", "U3C", "U4C", "U5CC"] {
        for boundary in ["edge-and-corner", "edge-only", "none"] {
            assert_still(&nets[0], &plan(word, boundary));
        }
    }
    for net in &nets[1..] {
        assert_still(net, &plan("U3CC", "edge-and-corner"));
    }
}

/// Also in the regular part of a large mesh, whose vertices share one mask.
#[test]
fn regular_limits_know_of_faces_far_away() {
    let net = with_a_triangle(&nets::grid(9, 9));
    assert_still(&net, &plan("U3CC", "edge-only"));
}

/// D makes faces other than quads of the vertices of a cube, so that all faces beside it are cut into six by six, too.
#[test]
fn dual_limits_know_of_faces_far_away() {
    let (torus, mut cube) = (nets::torus(4, 3), nets::cube());
    cube.positions.iter_mut().for_each(|p| p[0] += 100.0);
    let both = together(&torus, &cube);
    let word = plan("U3DC", "edge-and-corner");
    let job = json!({ "input": both.input(), "plan": word, "levels": 1 });
    let (limits, _) = limit(&both, &word, 1);
    let near = |p: &[f64; 3]| p[0] < 50.0;
    let refined = Net::of(&json_with(job, &json!({})));
    let kept: Vec<usize> = (0..refined.positions.len()).filter(|&v| near(&refined.positions[v])).collect();
    let number = |v: &usize| kept.binary_search(v).expect("faces lie in one part");
    let faces = refined.faces.iter().filter(|face| near(&refined.positions[face[0]]));
    let part = Net {
        positions: kept.iter().map(|&v| refined.positions[v]).collect(),
        faces: faces.map(|face| face.iter().map(number).collect()).collect(),
    };
    let (expected, _) = limit(&part, &plan("UU3DC", "edge-and-corner"), 0);
    for (i, &v) in kept.iter().enumerate() {
        let off = distance(&limits.positions[v], &expected.positions[i]);
        assert!(off <= 1e-12, "vertex {v} is off by {off}");
    }
}

fn together(a: &Net, b: &Net) -> Net {
    let n = a.positions.len();
    let shifted = b.faces.iter().map(|face| face.iter().map(|v| v + n).collect());
    Net {
        positions: a.positions.iter().chain(&b.positions).copied().collect(),
        faces: a.faces.iter().cloned().chain(shifted).collect(),
    }
}
