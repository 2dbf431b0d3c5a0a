//! Meshes from the wild: a result if possible, else a refusal that names the fault.

use std::collections::BTreeMap;
use std::fmt::Write;

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{Net, cube, grid, prism, tetrahedron};
use crate::support::{self, render};

fn stats(net: &Net, levels: u32) -> Value {
    let job = json!({
        "input": net.input(), "plan": { "preset": "catmull-clark" }, "levels": levels,
        "outputs": [{ "format": "stats" }],
    });
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?}"));
    serde_json::from_slice(&bytes).expect("stats are JSON")
}

fn check(found: &Value, expected: &Value) {
    for (name, value) in expected.as_object().into_iter().flatten() {
        assert_eq!(&found[name], value, "{name}");
    }
}

#[test]
fn a_thousand_components() {
    let one = tetrahedron();
    let mut net = Net::default();
    for i in 0..1000 {
        let start = net.positions.len();
        net.positions.extend(one.positions.iter().map(|p| [p[0] + 3.0 * f64::from(i), p[1], p[2]]));
        net.faces.extend(one.faces.iter().map(|face| face.iter().map(|v| v + start).collect::<Vec<_>>()));
    }
    let expected = json!({ "components": 1000, "faces": 12_000, "closed": true, "euler_characteristic": 2000 });
    check(&stats(&net, 1), &expected);
}

#[test]
fn a_face_of_a_hundred_vertices() {
    check(&stats(&prism(100), 1), &json!({ "faces": 600, "vertices": 602, "euler_characteristic": 2 }));
}

/// Returns a cone: `n` triangles around one vertex, open below.
fn cone(n: usize) -> Net {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    positions.extend(grid(n - 1, 1).positions[..n].iter().map(|p| [p[0], p[2] + 0.01 * p[0] * p[0], 0.0]));
    Net { positions, faces: (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect() }
}

#[test]
fn a_vertex_of_valence_a_hundred() {
    check(&stats(&cone(100), 2), &json!({ "faces": 1200, "boundary_loops": 1, "euler_characteristic": 1 }));
}

/// Returns the faces between the cells of a slab with `genus` holes and the outside.
fn slab(genus: usize) -> Net {
    let solid = |x: i64, y: i64, z: i64| {
        let width = i64::try_from(2 * genus + 1).expect("few holes");
        (0..width).contains(&x) && (0..3).contains(&y) && z == 0 && !(x % 2 == 1 && y == 1)
    };
    let mut numbers: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut net = Net::default();
    let sides = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    for (x, y) in (0..=2 * genus).flat_map(|x| (0..3).map(move |y| (x, y))) {
        let (x, y) = (i64::try_from(x).expect("few"), y);
        for side in sides.iter().filter(|[a, b, c]| solid(x, y, 0) && !solid(x + a, y + b, *c)) {
            let axis = side.iter().position(|&k| k != 0).expect("one is not 0");
            let face = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| {
                let mut at = [x, y, 0];
                at[axis] += side[axis].max(0);
                at[(axis + 1) % 3] += if side[axis] > 0 { u } else { v };
                at[(axis + 2) % 3] += if side[axis] > 0 { v } else { u };
                at
            });
            let face = face.map(|at| {
                let next = numbers.len();
                let number = *numbers.entry(at).or_insert(next);
                if number == next {
                    #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
                    net.positions.push(at.map(|k| k as f64));
                }
                number
            });
            net.faces.push(face.to_vec());
        }
    }
    net
}

#[test]
fn schemes_that_weigh_whole_rings_name_the_vertex_that_is_too_large() {
    for preset in ["butterfly", "kobbelt", "doo-sabin"] {
        let job = |n: usize| {
            json!({
                "input": cone(n).input(), "plan": { "preset": preset }, "levels": 1, "outputs": [{ "format": "stats" }]
            })
        };
        let refusal = render(&job(1025)).expect_err("one face too many");
        let expected = format!("vertex 0 has 1025 faces; {preset} takes at most 1024 around a vertex");
        assert!(refusal[0].detail.contains(&expected), "{refusal:?}");
        assert!(render(&job(1024)).is_ok(), "{preset}");
    }
}

#[test]
fn many_holes() {
    for genus in [0, 1, 2, 25] {
        let euler = 2 - 2 * i64::try_from(genus).expect("few holes");
        check(&stats(&slab(genus), 1), &json!({ "closed": true, "components": 1, "euler_characteristic": euler }));
    }
}

#[test]
fn fans_that_share_a_vertex_are_parted_and_told() {
    // three triangles that meet in one point
    let net = Net {
        positions: (0..7).map(|i| [f64::from(i), f64::from(i * i % 5), f64::from(i % 3)]).collect(),
        faces: vec![vec![0, 1, 2], vec![0, 3, 4], vec![0, 5, 6]],
    };
    let job = json!({ "input": net.input(), "outputs": [{ "format": "json" }] });
    let (bytes, report) = render(&job).expect("it is refined");
    let found = Net::of(&serde_json::from_slice(&bytes).expect("the output is JSON"));
    assert_eq!(found.faces, [[0, 1, 2], [7, 3, 4], [8, 5, 6]]);
    let told = "2 vertices were split from others, which joined several fans of faces: 7 from 0, 8 from 0";
    assert_eq!(report.warnings, [told]);
}

/// A strip of `n` quads, closed after half a turn, as a file.
#[test]
fn moebius_strips_are_refused_naming_an_edge() {
    for n in [3, 10, 101] {
        let mut obj = String::new();
        for i in 0..n {
            writeln!(obj, "v {i} 0 {}\nv {i} 1 {}", i * i % 7, i * i % 5).expect("text grows");
        }
        for i in 1..n {
            writeln!(obj, "f {} {} {} {}", 2 * i - 1, 2 * i + 1, 2 * i + 2, 2 * i).expect("text grows");
        }
        writeln!(obj, "f {} 2 1 {}", 2 * n - 1, 2 * n).expect("text grows");
        for orient in ["refuse", "repair"] {
            let input = json!({ "text": { "format": "obj", "data": obj }, "orient": orient, "non_manifold": "refuse" });
            let found = support::faults(json!({ "input": input }));
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].detail.contains("the faces cannot be oriented: around edge ("), "{found:?}");
        }
    }
}

#[test]
fn faces_of_two_vertices_are_refused() {
    let mut net = cube();
    net.faces.push(vec![0, 1]);
    let found = support::faults(json!({ "input": net.input() }));
    assert_eq!(found[0].to_string(), "/input/mesh/faces/6: a face of 2 vertices; a face has at least 3");
}

#[test]
fn degenerate_quads_are_refined_or_refused() {
    // two corners at one position are two vertices
    let mut net = cube();
    net.positions[7] = net.positions[6];
    check(&stats(&net, 2), &json!({ "faces": 96, "closed": true }));
    // all at one position
    net.positions.iter_mut().for_each(|p| *p = [1.0; 3]);
    check(&stats(&net, 2), &json!({ "faces": 96, "area": 0.0 }));
    // a repeated vertex is one vertex too few
    let mut net = cube();
    net.faces[0] = vec![0, 2, 2, 1];
    let mut input = net.input();
    input["non_manifold"] = json!("refuse");
    let found = support::faults(json!({ "input": input }));
    assert!(found[0].detail.starts_with("vertex 2 occurs twice"), "{found:?}");
}

#[test]
fn a_hundred_thousand_coarse_faces() {
    let net = grid(400, 250);
    let expected = json!({ "faces": 400_000, "vertices": 801 * 501, "boundary_loops": 1, "euler_characteristic": 1 });
    check(&stats(&net, 1), &expected);
}

fn refined(net: &Net) -> Vec<[f64; 3]> {
    let job = json!({ "input": net.input(), "plan": { "preset": "catmull-clark" }, "levels": 3 });
    Net::of(&support::json(job)).positions
}

/// Distant and tiny meshes are refined as well as others: to the rounding of their own coordinates.
#[test]
fn coordinates_of_a_million_and_a_millionth() {
    let plain = refined(&cube());
    let moved = |scale: f64, by: f64| {
        let positions = cube().positions.iter().map(|p| p.map(|x| x * scale + by)).collect();
        refined(&Net { positions, ..cube() })
    };
    for (scale, by) in [(1e6, 0.0), (1e-6, 0.0), (1.0, 1e6), (1e-6, 1e6), (1e6, -1e6)] {
        let tolerance = 1e-14 * (scale + f64::abs(by));
        for (found, plain) in moved(scale, by).iter().zip(&plain) {
            let off = found.iter().zip(plain).map(|(x, y)| (x - (y * scale + by)).abs()).fold(0.0, f64::max);
            assert!(off < tolerance, "{scale} {by}: {off}");
        }
    }
    for (scale, by) in [(1e6, 0.0), (1e-6, 0.0), (1.0, 1e6)] {
        let positions = cube().positions.iter().map(|p| p.map(|x| x * scale + by)).collect();
        let net = Net { positions, ..cube() };
        for format in ["glb", "stl", "png", "ply"] {
            let job = json!({ "input": net.input(), "outputs": [{ "format": format }] });
            assert!(render(&job).is_ok(), "{format}");
        }
    }
}

/// Returns faces over few vertices on a coarse lattice, so that positions coincide and triangles are flat, as a file.
fn file() -> impl Strategy<Value = String> {
    (1..14_usize).prop_flat_map(|n| {
        let vertex = proptest::array::uniform3(0..3_i32).prop_map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let face = proptest::collection::vec(1..=n, 3..5)
            .prop_map(|face| face.iter().fold("f".to_owned(), |line, v| format!("{line} {v}")) + "\n");
        let lines = (proptest::collection::vec(vertex, n), proptest::collection::vec(face, 1..10));
        lines.prop_map(|(vertices, faces)| vertices.concat() + &faces.concat())
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn soups_from_files_are_repaired_refined_or_refused(
        data in file(), weld in prop::option::of(0.0..1.5_f64), pair in any::<bool>(), repair in any::<bool>(),
    ) {
        let mut input = json!({ "text": { "format": "obj", "data": data }, "pair_quads": pair });
        if repair {
            input["orient"] = json!("repair");
        }
        if let Some(weld) = weld {
            input["weld"] = json!(weld);
        }
        let plan = json!({ "preset": "catmull-clark" });
        let job = json!({ "input": input, "plan": plan, "levels": 1, "outputs": [{ "format": "json" }] });
        match render(&job) {
            Ok((bytes, _)) => {
                let found = Net::of(&serde_json::from_slice(&bytes).expect("the output is JSON"));
                prop_assert!(found.faces.iter().flatten().all(|&v| v < found.positions.len()));
            }
            Err(faults) => {
                let named = |pointer: &str| pointer.starts_with("/input/text/data") || pointer == "/input/weld";
                prop_assert!(faults.iter().all(|fault| named(&fault.pointer)), "{:?}", faults);
            }
        }
    }
}
