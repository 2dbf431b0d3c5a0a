//! Limits against formulas that others have published.

use serde_json::{Value, json};

use super::limit;
use crate::support::json_with;
use crate::support::nets::{self, Net, distance};

fn weighted(parts: &[(f64, &[[f64; 3]])]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (weight, points) in parts {
        for point in *points {
            sum = [0, 1, 2].map(|k| sum[k] + weight * point[k]);
        }
    }
    sum
}

fn catmull_clark() -> Value {
    json!({ "preset": "catmull-clark" })
}

fn positions(net: &Net, plan: &Value, levels: u32) -> Vec<[f64; 3]> {
    let job = json!({ "input": net.input(), "plan": plan, "levels": levels });
    Net::of(&json_with(job, &json!({ "positions": "limit" }))).positions
}

/// `(N^2 V + 4 sum E + sum F) / (N (N + 5))`: Halstead, Kass, DeRose, SIGGRAPH 1993.
#[test]
fn catmull_clark_vertices_converge_to_the_published_mask() {
    for n in 3..=12_u32 {
        let (net, places) = nets::sectors_of_quads(n as usize, 1);
        let of = |place| -> Vec<[f64; 3]> {
            (0..places.len()).filter(|&v| places[v] == Some(place)).map(|v| net.positions[v]).collect()
        };
        let whole = f64::from(n);
        let sum = whole * (whole + 5.0);
        let (edges, faces) = (of([1, 0]), of([1, 1]));
        let expected =
            weighted(&[(whole * whole / sum, &net.positions[..1]), (4.0 / sum, &edges), (1.0 / sum, &faces)]);
        let found = positions(&net, &catmull_clark(), 0)[0];
        assert!(distance(&found, &expected) <= 1e-13, "valence {n}: {found:?} not {expected:?}");
    }
}

/// Boundary curves are cubic B-splines: `(1, 4, 1) / 6`; corners stay.
#[test]
fn boundaries_converge_to_cubic_b_splines() {
    let net = nets::grid(4, 3);
    for plan in [catmull_clark(), json!({ "word": "UC" })] {
        let found = positions(&net, &plan, 0);
        for i in 1..4 {
            let p = &net.positions;
            let expected =
                weighted(&[(1.0 / 6.0, &p[i - 1..i]), (4.0 / 6.0, &p[i..=i]), (1.0 / 6.0, &p[i + 1..i + 2])]);
            assert!(distance(&found[i], &expected) <= 1e-13, "{plan}: {:?} not {expected:?}", found[i]);
        }
        for corner in [0, 4, 15, 19] {
            assert!(distance(&found[corner], &net.positions[corner]) <= 1e-15, "{plan}");
        }
    }
}

/// UD is the biquadratic B-spline; the centre of a vertex's child face converges to `(1, 6, 1) / 8` in both directions.
#[test]
fn dual_vertices_converge_to_the_centres_of_their_faces() {
    let (n, m) = (6, 5);
    let net = nets::torus(n, m);
    let found = positions(&net, &json!({ "word": "UD" }), 0);
    let mask = [1.0 / 8.0, 6.0 / 8.0, 1.0 / 8.0];
    for j in 0..m {
        for i in 0..n {
            let mut expected = [0.0; 3];
            for (dj, b) in mask.iter().enumerate() {
                for (di, a) in mask.iter().enumerate() {
                    let p = net.positions[(j + dj + m - 1) % m * n + (i + di + n - 1) % n];
                    expected = [0, 1, 2].map(|k| expected[k] + a * b * p[k]);
                }
            }
            assert!(distance(&found[j * n + i], &expected) <= 1e-13, "{i}, {j}");
        }
    }
}

/// A surface of valence 100 beside one of valence 4.
#[test]
fn high_valences_have_limits() {
    for (plan, centre) in
        [(catmull_clark(), 100.0 / 105.0), (json!({ "word": "UCP", "parameters": { "delta": 0 } }), 4.0 / 9.0)]
    {
        let (mut net, _) = nets::sectors_of_quads(100, 1);
        net.positions.iter_mut().for_each(|p| *p = [0.0; 3]);
        net.positions[0] = [1.0, 2.0, -1.0];
        let found = positions(&net, &plan, 1)[0];
        assert!(distance(&found, &[centre, 2.0 * centre, -centre]) <= 1e-12, "{plan}: {found:?}");
    }
    let (net, _) = nets::sectors_of_quads(100, 2);
    let (_, normals) = limit(&net, &catmull_clark(), 0);
    assert!(distance(&normals[0], &[0.0, 0.0, 1.0]) <= 1e-9, "{:?}", normals[0]);
}
