//! Statistics of results: solids and surfaces of known measures, and laws of measures and hashes.

use planish::job::key::content;
use planish::math::functions::{cos, sin};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{json, render};

/// Returns the statistics of a job without outputs.
fn of_job(mut job: Value) -> Value {
    job["outputs"] = json!([{ "format": "stats" }]);
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    serde_json::from_slice(&bytes).expect("stats are JSON")
}

fn stats(net: &Net) -> Value {
    of_job(json!({ "input": net.input() }))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn vector(value: &Value) -> [f64; 3] {
    serde_json::from_value(value.clone()).unwrap_or_else(|_| panic!("{value} is no vector"))
}

fn matrix(value: &Value) -> [[f64; 3]; 3] {
    serde_json::from_value(value.clone()).unwrap_or_else(|_| panic!("{value} is no matrix"))
}

#[track_caller]
fn near(found: f64, expected: f64, what: &str) {
    // some dozen roundings of numbers below 100
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{what}: {found} is not {expected}");
}

#[track_caller]
fn near_all(found: &Value, expected: [[f64; 3]; 3]) {
    let found = matrix(found);
    (0..9).for_each(|i| near(found[i / 3][i % 3], expected[i / 3][i % 3], "second moment"));
}

fn moved(net: &Net, map: impl Fn([f64; 3]) -> [f64; 3]) -> Net {
    Net { positions: net.positions.iter().map(|&p| map(p)).collect(), faces: net.faces.clone() }
}

/// Returns a box with these sides and its lowest corner at `low`.
fn brick(low: [f64; 3], sides: [f64; 3]) -> Net {
    let corner = |i: u32| [0, 1, 2].map(|k| low[k] + f64::from(i >> k & 1) * sides[k]);
    Net { positions: (0..8).map(corner).collect(), ..nets::cube() }
}

#[test]
fn a_box_has_the_measures_of_a_box() {
    let sides = [2.0, 3.0, 0.5];
    let found = stats(&brick([1.0, -1.0, 4.0], sides));
    for (name, expected) in [
        ("kind", json!("mesh")),
        ("vertices", json!(8)),
        ("edges", json!(12)),
        ("faces", json!(6)),
        ("triangles", json!(12)),
        ("components", json!(1)),
        ("closed", json!(true)),
        ("isolated_vertices", json!(0)),
        ("boundary_edges", json!(0)),
        ("boundary_loops", json!(0)),
        ("euler_characteristic", json!(2)),
        ("valences", json!({ "interior": { "3": 8 }, "boundary": {} })),
        ("face_sizes", json!({ "4": 6 })),
        ("bounding_box", json!({ "min": [1.0, -1.0, 4.0], "max": [3.0, 2.0, 4.5] })),
        ("moments_of", json!("solid")),
    ] {
        assert_eq!(found[name], expected, "{name}");
    }
    near(number(&found["area"]), 2.0 * (6.0 + 1.0 + 1.5), "area");
    near(number(&found["volume"]), 3.0, "volume");
    let centroid = vector(&found["centroid"]);
    assert!(nets::distance(&centroid, &[2.0, 0.5, 4.25]) < 1e-13, "{centroid:?}");
    // V a^2 / 12 about the centre
    let moment = |k: usize| 3.0 * sides[k] * sides[k] / 12.0;
    near_all(&found["second_moments"], [[moment(0), 0.0, 0.0], [0.0, moment(1), 0.0], [0.0, 0.0, moment(2)]]);
}

#[test]
fn a_tetrahedron_has_the_measures_of_a_simplex() {
    let positions = [[0.0, 0.0, 1.0], [3.0, 0.5, 1.0], [1.0, 2.0, 0.0], [0.5, 1.0, 4.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(Vec::from).to_vec();
    let found = stats(&Net { positions: positions.to_vec(), faces: faces.clone() });
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [o, a, b, c] = positions;
    let volume = dot(minus(a, o), cross(minus(b, o), minus(c, o))) / 6.0;
    near(number(&found["volume"]), volume, "volume");
    let area = faces.iter().map(|f| {
        let [a, b, c] = [f[0], f[1], f[2]].map(|v: usize| positions[v]);
        let normal = cross(minus(b, a), minus(c, a));
        dot(normal, normal).sqrt() / 2.0
    });
    near(number(&found["area"]), area.sum(), "area");
    let mean: [f64; 3] = std::array::from_fn(|k| positions.iter().map(|p| p[k]).sum::<f64>() / 4.0);
    assert!(nets::distance(&vector(&found["centroid"]), &mean) < 1e-13);
    // V / 20 sum (v - c)(v - c)^T over the corners of a simplex in space
    let second =
        |i: usize, j: usize| volume / 20.0 * positions.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    near_all(&found["second_moments"], std::array::from_fn(|i| std::array::from_fn(|j| second(i, j))));
}

#[test]
fn an_open_sheet_has_the_measures_of_its_surface() {
    let found = stats(&moved(&nets::grid(4, 2), |[x, y, _]| [x, y, 3.0]));
    assert_eq!((&found["closed"], &found["volume"]), (&json!(false), &Value::Null));
    assert_eq!(found["moments_of"], "surface");
    assert_eq!((&found["boundary_loops"], &found["boundary_edges"]), (&json!(1), &json!(12)));
    assert_eq!(found["valences"], json!({ "interior": { "4": 3 }, "boundary": { "2": 4, "3": 8 } }));
    near(number(&found["area"]), 8.0, "area");
    near_all(&found["second_moments"], [[8.0 * 16.0 / 12.0, 0.0, 0.0], [0.0, 8.0 * 4.0 / 12.0, 0.0], [0.0; 3]]);
}

#[test]
fn pieces_add_up() {
    let (one, other) = (brick([0.0; 3], [1.0, 2.0, 3.0]), brick([5.0, 0.0, 0.0], [2.0, 1.0, 1.0]));
    let mut both = one.clone();
    both.positions.extend(&other.positions);
    both.faces.extend(other.faces.iter().map(|face| face.iter().map(|v| v + 8).collect::<Vec<_>>()));
    both.positions.push([9.0, 9.0, 9.0]);
    let [one, other, both] = [&one, &other, &both].map(stats);
    for name in ["area", "volume", "faces", "edges"] {
        near(number(&both[name]), number(&one[name]) + number(&other[name]), name);
    }
    assert_eq!((&both["components"], &both["isolated_vertices"]), (&json!(3), &json!(1)));
    assert_eq!(both["bounding_box"]["max"], json!([9.0, 9.0, 9.0]), "isolated vertices count");
}

#[test]
fn the_hash_of_positions_is_that_of_their_bytes() {
    let job = json!({ "input": nets::mixed().input(), "plan": { "preset": "catmull-clark" }, "levels": 2 });
    let found = of_job(job.clone());
    let bytes: Vec<u8> = Net::of(&json(job)).positions.iter().flatten().flat_map(|x| (x + 0.0).to_le_bytes()).collect();
    assert_eq!(found["positions_hash"], content(&bytes).to_string());
}

#[test]
fn curves_have_length_centroid_and_moments() {
    let corner = json!({ "points": [[0, 0, 0], [3, 0, 0], [3, 4, 0]] });
    let found = of_job(json!({ "input": { "polygon": corner } }));
    assert_eq!((&found["length"], &found["area"], &found["edges"]), (&json!(7.0), &Value::Null, &json!(2)));
    let centroid = vector(&found["centroid"]);
    assert!(nets::distance(&centroid, &[(3.0 * 1.5 + 4.0 * 3.0) / 7.0, 4.0 * 2.0 / 7.0, 0.0]) < 1e-14);
    // the integral of x^2 over both segments: 9 and 36
    let about = |square: f64, mean: f64| square - 7.0 * mean * mean;
    let second = matrix(&found["second_moments"]);
    near(second[0][0], about(9.0 + 36.0, centroid[0]), "second moment");
    near(second[1][1], about(64.0 / 3.0, centroid[1]), "second moment");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn measures_follow_motions_and_scalings(
        net in nets::manifold(),
        angle in -3.0..3.0_f64,
        shift in proptest::array::uniform3(-5.0..5.0_f64),
    ) {
        let turn = |[x, y, z]: [f64; 3]| [cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y, z];
        let there = moved(&net, |p| [0, 1, 2].map(|k| 2.0 * turn(p)[k] + shift[k]));
        let (here, there) = (stats(&net), stats(&there));
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
        prop_assert!(close(number(&there["area"]), 4.0 * number(&here["area"])));
        for name in ["edges", "euler_characteristic", "boundary_loops", "valences", "closed"] {
            prop_assert_eq!(&here[name], &there[name], "{}", name);
        }
        let solid = here["moments_of"] == "solid";
        if here["closed"] == true {
            prop_assert!(close(number(&there["volume"]), 8.0 * number(&here["volume"])));
        }
        // folded nets have hardly any volume, so that rounding decides whether they are solids, and where their
        // centroid is
        if here["moments_of"].is_null() || here["closed"] == true && number(&here["volume"]).abs() < 1e-3 {
            return Ok(());
        }
        prop_assert_eq!(&here["moments_of"], &there["moments_of"]);
        let expected = [0, 1, 2].map(|k| 2.0 * turn(vector(&here["centroid"]))[k] + shift[k]);
        prop_assert!(nets::distance(&vector(&there["centroid"]), &expected) < 1e-9);
        let trace = |found: &Value| (0..3).map(|k| matrix(&found["second_moments"])[k][k]).sum::<f64>();
        let power = if solid { 32.0 } else { 16.0 };
        prop_assert!((trace(&there) - power * trace(&here)).abs() < 1e-8 * (1.0 + trace(&here).abs()));
    }

    #[test]
    fn the_shape_hash_is_that_of_the_shape(
        net in nets::manifold(), seed in any::<u32>(), vertex in any::<prop::sample::Index>(), axis in 0..3_usize,
    ) {
        let n = net.positions.len();
        // another order of vertices and of faces, and other first corners
        let mut order: Vec<usize> = (0..n).collect();
        let mixed = |i: usize| (u64::try_from(i).expect("small") + 1).wrapping_mul(u64::from(seed) | 1).rotate_left(23);
        order.sort_by_key(|&v| mixed(v));
        let mut other = Net { positions: vec![[0.0; 3]; n], faces: net.faces.clone() };
        for (old, &new) in order.iter().enumerate() {
            other.positions[new] = net.positions[old];
        }
        for (f, face) in other.faces.iter_mut().enumerate() {
            face.iter_mut().for_each(|v| *v = order[*v]);
            let first = f % face.len();
            face.rotate_left(first);
        }
        other.faces.reverse();
        let hash = |net: &Net| stats(net)["shape_hash"].clone();
        let expected = hash(&net);
        prop_assert_eq!(&hash(&other), &expected);
        // a vertex moved by the last bit, a face fewer, or all faces reversed give another shape
        let mut shifted = net.clone();
        let x = &mut shifted.positions[vertex.index(n)][axis];
        *x = f64::from_bits((*x + 0.0).to_bits() + 1);
        prop_assert_ne!(&hash(&shifted), &expected);
        let mut turned = net.clone();
        turned.faces.iter_mut().for_each(|face| face.reverse());
        prop_assert_ne!(&hash(&turned), &expected);
        if net.faces.len() > 1 {
            let mut less = net.clone();
            less.faces.pop();
            prop_assert_ne!(&hash(&less), &expected);
        }
    }
}
