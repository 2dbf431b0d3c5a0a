//! Doo-Sabin: the tensor product of Chaikin on regular nets, its weights and eigenvalues elsewhere.

use planish::math::functions::{cos, sin};
use serde_json::{Value, json};

use super::{refined, refined_mesh};
use crate::support;
use crate::support::nets::{self, Net, distance};

const TOLERANCE: f64 = 1e-12;

fn doo_sabin(boundary: &str) -> Value {
    json!({ "preset": "doo-sabin", "boundary": boundary })
}

fn chaikin() -> Value {
    json!({ "preset": "chaikin" })
}

/// Checks that two lists have the same points, one to one.
fn assert_same_points(found: &[[f64; 3]], expected: &[[f64; 3]], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let mut left = found.to_vec();
    for p in expected {
        let at = left.iter().position(|q| distance(p, q) <= TOLERANCE);
        left.swap_remove(at.unwrap_or_else(|| panic!("{what}: {p:?} is missing")));
    }
}

/// Refines rows and then columns as curves.
fn tensor(points: &[[f64; 3]], width: usize, closed: bool, plan: &Value, levels: u32) -> Vec<[f64; 3]> {
    let rows: Vec<Vec<[f64; 3]>> = points.chunks(width).map(|row| refined(row, closed, plan, levels)).collect();
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    (0..rows[0].len()).flat_map(|i| refined(&column(i), closed, plan, levels)).collect()
}

#[test]
fn a_grid_is_the_tensor_product_of_clamped_chaikin() {
    for (n, m) in [(1, 1), (3, 2), (2, 4)] {
        let net = nets::grid(n, m);
        for levels in 1..=3 {
            let fine = refined_mesh(&net, &doo_sabin("edge-and-corner"), levels);
            let expected = tensor(&net.positions, n + 1, false, &chaikin(), levels);
            assert_same_points(&fine.positions, &expected, &format!("{n} x {m}, level {levels}"));
        }
    }
}

#[test]
fn a_torus_is_the_tensor_product_of_closed_chaikin() {
    let net = nets::torus(4, 3);
    let fine = refined_mesh(&net, &doo_sabin("edge-only"), 3);
    assert_same_points(&fine.positions, &tensor(&net.positions, 4, true, &chaikin(), 3), "torus");
    assert!(fine.faces.iter().all(|face| face.len() == 4));
}

#[test]
fn boundaries_are_chaikin_curves_of_their_polygons() {
    let net = nets::mixed();
    let rim = [0, 1, 5, 6, 7, 2, 3, 4].map(|v: usize| net.positions[v]);
    for levels in 1..=3 {
        let surface = refined_mesh(&net, &doo_sabin("edge-only"), levels);
        let on_rim = boundary(&surface);
        assert_same_points(&on_rim, &refined(&rim, true, &chaikin(), levels), &format!("level {levels}"));
    }
}

/// Returns the positions of the boundary vertices.
fn boundary(net: &Net) -> Vec<[f64; 3]> {
    let side = |face: &Vec<usize>, j: usize| (face[j], face[(j + 1) % face.len()]);
    let sides = || net.faces.iter().flat_map(|face| (0..face.len()).map(move |j| side(face, j)));
    let all: std::collections::BTreeSet<_> = sides().collect();
    sides().filter(|(a, b)| !all.contains(&(*b, *a))).map(|(a, _)| net.positions[a]).collect()
}

#[test]
fn weights_are_those_of_doo_and_sabin() {
    let unit = |n: usize| {
        let mut net = nets::prism(n);
        net.positions.iter_mut().for_each(|p| *p = [0.0; 3]);
        // the last face of a prism has the vertices n, n + 1, ..., 2n - 1
        net.positions[n] = [1.0, 0.0, 0.0];
        let fine = refined_mesh(&net, &doo_sabin("edge-only"), 1);
        (0..n).map(|i| fine.positions[fine.positions.len() - n + i][0]).collect::<Vec<_>>()
    };
    assert_eq!(unit(4), [9.0 / 16.0, 3.0 / 16.0, 1.0 / 16.0, 3.0 / 16.0]);
    for (n, expected) in [
        (3, vec![2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0]),
        (6, [11.0, 4.0, 2.0, 1.0, 2.0, 4.0].map(|w| w / 24.0).to_vec()),
        (
            5,
            [10.0, 3.618_033_988_749_895, 1.381_966_011_250_105, 1.381_966_011_250_105, 3.618_033_988_749_895]
                .map(|w| w / 20.0)
                .to_vec(),
        ),
    ] {
        assert!(distance(&unit(n), &expected) <= 1e-15, "{n}: {:?}", unit(n));
    }
}

/// Around a face of n vertices, the eigenvalues are 1, twice 1/2, and 1/4 (Doo and Sabin 1978).
#[test]
fn eigenvalues_are_one_two_halves_and_quarters() {
    for n in 3..=9_usize {
        for frequency in 0..=n / 2 {
            let whole = |i: usize| f64::from(u32::try_from(i).expect("small"));
            let angle = |i: usize| 2.0 * std::f64::consts::PI * whole(frequency * i) / whole(n);
            let mut net = nets::prism(n);
            net.positions.iter_mut().for_each(|p| *p = [0.0; 3]);
            for i in 0..n {
                net.positions[n + i] = [cos(angle(i)), sin(angle(i)), 0.0];
            }
            let fine = refined_mesh(&net, &doo_sabin("edge-only"), 1);
            let value = [1.0, 0.5].get(frequency).copied().unwrap_or(0.25);
            for i in 0..n {
                let expected = net.positions[n + i].map(|x| value * x);
                let found = fine.positions[fine.positions.len() - n + i];
                assert!(distance(&found, &expected) <= 1e-14, "{n}, {frequency}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn a_triangle_is_cut_and_its_half_faces_are_reflected() {
    let net = Net { positions: vec![[0.0, 0.0, 0.0], [24.0, 0.0, 0.0], [0.0, 24.0, 0.0]], faces: vec![vec![0, 1, 2]] };
    let once = refined_mesh(&net, &doo_sabin("edge-only"), 1);
    let expected = [
        [4.0, 4.0],
        [16.0, 4.0],
        [4.0, 16.0],
        [6.0, 0.0],
        [18.0, 0.0],
        [18.0, 6.0],
        [6.0, 18.0],
        [0.0, 18.0],
        [0.0, 6.0],
    ];
    assert_eq!(once.positions.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(), expected);
    let twice = refined_mesh(&net, &doo_sabin("edge-only"), 2);
    // inside the half face of the edge from 0 to 1: (3 c + d + 3 a + b)/8, and of vertex 0: (2 c + a + b)/4
    assert_eq!(twice.positions.get(3), Some(&[(12.0 + 16.0 + 18.0 + 18.0) / 8.0, 2.0, 0.0]));
    assert!(twice.positions.contains(&[(8.0 + 6.0) / 4.0, (8.0 + 6.0) / 4.0, 0.0]));
    let kept = refined_mesh(&net, &doo_sabin("edge-and-corner"), 3);
    assert!(net.positions.iter().all(|corner| kept.positions.contains(corner)));
}

#[test]
fn what_it_cannot_carry_is_refused() {
    let refused = |mesh: &Value, boundary: &str| {
        support::faults(json!({ "input": { "mesh": mesh }, "plan": doo_sabin(boundary), "levels": 2 }))[0].clone()
    };
    let mut mesh = nets::cube().to_json();
    mesh["corners"] = json!([{ "vertex": 3, "sharpness": 10 }]);
    assert!(refused(&mesh, "edge-only").detail.contains("vertex 3 is tagged as a corner"));
    let mut mesh = nets::cube().to_json();
    mesh["holes"] = json!([2]);
    assert!(refused(&mesh, "edge-only").detail.contains("doo-sabin cannot carry holes"));
    assert!(refused(&nets::grid(3, 3).to_json(), "none").detail.contains("doo-sabin cannot carry holes"));
    let pillow = json!({ "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2], [2, 1, 0]] });
    let fault = refused(&pillow, "edge-only");
    assert_eq!(fault.pointer, "/plan");
    assert!(fault.detail.contains("all around vertex 0 there are only two faces"), "{fault:?}");
    assert!(refused(&nets::prism(1025).to_json(), "edge-only").detail.contains("face 1025 has 1025 vertices"));
    let mut mesh = nets::grid(2, 2).to_json();
    mesh["corners"] = json!([{ "vertex": 0, "sharpness": 10 }]);
    let fine =
        Net::of(&support::json(json!({ "input": { "mesh": mesh }, "plan": doo_sabin("edge-only"), "levels": 3 })));
    assert!(fine.positions.contains(&nets::grid(2, 2).positions[0]), "a tagged corner with one face stays");
    assert!(!fine.positions.contains(&nets::grid(2, 2).positions[2]));
}
