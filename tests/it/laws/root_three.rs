//! Sqrt 3: its weights, its eigenvalues, and its boundaries, which are ternary cubic B-splines.

use planish::math::functions::{cos, sin};
use serde_json::{Value, json};

use super::{refined, refined_mesh};
use crate::support;
use crate::support::nets::{self, Net, distance};

const PI: f64 = std::f64::consts::PI;

fn plan(boundary: &str) -> Value {
    json!({ "preset": "sqrt-3", "boundary": boundary })
}

fn whole(i: usize) -> f64 {
    f64::from(u32::try_from(i).expect("small"))
}

/// Returns a fan of n triangles around vertex 0 with `centre` there and `ring(i)` around, closed by a fan on the other
/// side.
fn double_fan(n: usize, centre: [f64; 3], ring: impl Fn(usize) -> [f64; 3]) -> Net {
    let positions = [centre].into_iter().chain((0..n).map(ring)).chain([[0.0; 3]]).collect();
    let next = |i: usize| 1 + (i + 1) % n;
    let above = (0..n).map(|i| vec![0, 1 + i, next(i)]);
    let below = (0..n).map(|i| vec![n + 1, next(i), 1 + i]);
    Net { positions, faces: above.chain(below).collect() }
}

#[test]
fn a_step_has_the_weights_of_the_paper() {
    let net = nets::tetrahedron();
    let fine = refined_mesh(&net, &plan("edge-only"), 1);
    assert_eq!((fine.positions.len(), fine.faces.len()), (8, 12));
    for v in 0..4 {
        // valence 3: a = 5/9
        let around = (0..4).filter(|&u| u != v);
        let expected = [0, 1, 2].map(|i| {
            let sum: f64 = around.clone().map(|u| net.positions[u][i]).sum();
            4.0 / 9.0 * net.positions[v][i] + 5.0 / 27.0 * sum
        });
        assert!(distance(&fine.positions[v], &expected) <= 1e-15, "{v}");
    }
    for (f, face) in net.faces.iter().enumerate() {
        let expected = [0, 1, 2].map(|i| face.iter().map(|&v| net.positions[v][i]).sum::<f64>() / 3.0);
        assert!(distance(&fine.positions[4 + f], &expected) <= 1e-15, "{f}");
    }
}

/// Around a vertex of valence n, a step turns the ring by pi/n and shrinks it by 2/3 cos(pi/n), at valence 6 by
/// 1/sqrt(3), which is 1/3 in two steps; the height over the ring shrinks by the square of that (Kobbelt 2000, section
/// 4).
#[test]
fn eigenvalues_are_those_of_the_paper() {
    for n in 3..=9 {
        let shrink = 2.0 / 3.0 * cos(PI / whole(n));
        let ring = |i: usize, turn: f64| {
            let angle = (2.0 * whole(i) + turn) * PI / whole(n);
            [cos(angle), sin(angle), 0.0]
        };
        let fine = refined_mesh(&double_fan(n, [0.0; 3], |i| ring(i, 0.0)), &plan("edge-only"), 1);
        assert!(distance(&fine.positions[0], &[0.0; 3]) <= 1e-15);
        for i in 0..n {
            let expected = ring(i, 1.0).map(|x| shrink * x);
            assert!(distance(&fine.positions[n + 2 + i], &expected) <= 1e-15, "{n}");
        }
        let cone = refined_mesh(&double_fan(n, [0.0, 0.0, 1.0], |i| ring(i, 0.0)), &plan("edge-only"), 1);
        let height = cone.positions[0][2] - cone.positions[n + 2][2];
        assert!((height - shrink * shrink).abs() <= 1e-15, "{n}: {height}");
    }
    let third = 2.0 / 3.0 * cos(PI / 6.0);
    assert!((third * third - 1.0 / 3.0).abs() <= 1e-15);
}

#[test]
fn boundaries_are_ternary_cubic_b_splines_every_second_level() {
    let net = Net {
        faces: vec![vec![0, 1, 2], vec![2, 3, 0], vec![3, 4, 0], vec![1, 5, 6], vec![6, 7, 1], vec![7, 2, 1]],
        ..nets::mixed()
    };
    let rim = [0, 1, 5, 6, 7, 2, 3, 4].map(|v: usize| net.positions[v]);
    for (levels, half) in [(1, 0), (2, 1), (3, 1), (4, 2)] {
        let fine = refined_mesh(&net, &plan("edge-only"), levels);
        let curve = refined(&rim, true, &json!({ "preset": "ternary-cubic" }), half);
        for p in &curve {
            assert!(fine.positions.iter().any(|q| distance(p, q) <= 1e-13), "level {levels}: {p:?} is missing");
        }
    }
}

/// Between corners, the curve is the one with clamped ends.
#[test]
fn boundaries_end_in_corners() {
    let net = Net { positions: vec![[0.0, 0.0, 0.0], [27.0, 0.0, 0.0], [0.0, 27.0, 0.0]], faces: vec![vec![0, 1, 2]] };
    let fine = refined_mesh(&net, &plan("edge-and-corner"), 2);
    assert_eq!(fine.positions[..4], [[0.0, 0.0, 0.0], [27.0, 0.0, 0.0], [0.0, 27.0, 0.0], fine.positions[3]]);
    assert!(distance(&fine.positions[4], &[9.0, 0.0, 0.0]) <= 1e-14);
    assert!(distance(&fine.positions[7], &[18.0, 0.0, 0.0]) <= 1e-14);
    let smooth = refined_mesh(&net, &plan("edge-only"), 2);
    assert!(distance(&smooth.positions[0], &[4.0, 4.0, 0.0]) <= 1e-14);
    // (16 a + 10 b + c)/27 next to the start
    assert!(distance(&smooth.positions[4], &[10.0, 1.0, 0.0]) <= 1e-14);
    assert!(distance(&smooth.positions[7], &[16.0, 1.0, 0.0]) <= 1e-14);
    let mut mesh = nets::tetrahedron().to_json();
    mesh["corners"] = json!([{ "vertex": 2, "sharpness": 10 }]);
    let kept = Net::of(&support::json(json!({ "input": { "mesh": mesh }, "plan": plan("edge-only"), "levels": 3 })));
    assert_eq!(kept.positions.get(2), nets::tetrahedron().positions.get(2));
    assert_ne!(kept.positions.get(1), nets::tetrahedron().positions.get(1));
}

#[test]
fn what_it_cannot_refine_is_refused() {
    let refused = |mesh: &Value, boundary: &str| {
        support::faults(json!({ "input": { "mesh": mesh }, "plan": plan(boundary), "levels": 1 }))[0].detail.clone()
    };
    assert!(
        refused(&nets::mixed().to_json(), "edge-only")
            .contains("face 0 has 4 vertices, and only triangles are split into triangles")
    );
    let mut holed = nets::tetrahedron().to_json();
    holed["holes"] = json!([1]);
    assert!(refused(&holed, "edge-only").contains("sqrt-3 cannot carry holes"));
    let pillow = json!({ "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2], [2, 1, 0]] });
    assert!(refused(&pillow, "edge-only").contains("all around vertex 0 there are only two faces; sqrt-3"));
}
