//! Limits compared with published formulas.

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

/// Boundary curves are cubic B-splines: `(1, 4, 1) / 6`; corners are fixed.
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

/// Wide words: on a torus `UC^k` is the tensor product of B-splines of degree 2k + 1, with the values of the B-spline
/// of that degree at the knots, by the recursion of Cox and de Boor at the whole numbers.
#[test]
fn wide_words_have_limits() {
    let (k, n) = (10_u32, 3_usize);
    let degree = 2 * k + 1;
    // b[i] is the value at i of the B-spline with the knots 0, ..., d + 1
    let mut values = vec![0.0, 1.0, 0.0];
    for d in 2..=degree {
        let at = |i: u32| values.get(i as usize).copied().unwrap_or(0.0);
        let before = |i: u32| i.checked_sub(1).map_or(0.0, at);
        values =
            (0..=d + 1).map(|i| (f64::from(i) * at(i) + f64::from(d + 1 - i) * before(i)) / f64::from(d)).collect();
    }
    let mut line = vec![0.0; n];
    for (i, value) in values.iter().enumerate() {
        line[(i + n * 8 - (k as usize + 1)) % n] += value;
    }
    let net = nets::torus(n, n);
    let found = positions(&net, &json!({ "word": format!("UC^{k}") }), 0);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let mut expected = [0.0; 3];
        for (di, a) in line.iter().enumerate() {
            for (dj, b) in line.iter().enumerate() {
                let p = net.positions[(j + dj) % n * n + (i + di) % n];
                expected = [0, 1, 2].map(|c| expected[c] + a * b * p[c]);
            }
        }
        let off = distance(&found[j * n + i], &expected);
        assert!(off <= 1e-12, "{i}, {j}: off by {off}");
    }
}
