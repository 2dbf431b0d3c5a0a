//! Identities of schemes on triangles and of higher arities on quads.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::invariance::{Affine, assert_near};
use super::{refined, refined_mesh, semi_stationary, static_word, word};
use crate::support::nets::{self, Net, distance};

const TOLERANCE: f64 = 1e-12;

fn on_triangles(mut plan: Value) -> Value {
    plan["parameters"]["split"] = json!("triangle");
    plan
}

fn with_boundary(mut plan: Value, boundary: &str) -> Value {
    plan["boundary"] = json!(boundary);
    plan
}

/// Returns Loop's scheme as a word: the push-back that corresponds to beta of each valence.
fn loop_as_word() -> Value {
    on_triangles(json!({ "word": "UCP", "parameters": {
        "compensation": 0, "delta": "1 - 8/3*(5/8 - (3/8 + cos(2*pi/valence)/4)^2)",
    } }))
}

fn triangle_meshes() -> [Net; 6] {
    [
        nets::tetrahedron(),
        nets::octahedron(),
        nets::triangulated(nets::torus(4, 3)),
        nets::triangulated(nets::grid(3, 2)),
        nets::triangulated(nets::mixed()),
        nets::triangulated(nets::prism(7)),
    ]
}

/// Returns plans for meshes of triangles.
fn triangle_plans() -> Vec<Value> {
    let mut plans: Vec<Value> = ["U", "UC", "UCP", "C", "UCCP", "U3CP", "U4CC"].map(word).into();
    plans.extend(["UC", "UCP", "U(UCP)", "U3CCP"].map(static_word));
    plans.push(semi_stationary("UCP", "pi/3", 0.4));
    plans.push(json!({ "word": "UC", "parameters": { "mu": "1/3" } }));
    plans.push(loop_as_word());
    let mut plans: Vec<Value> = plans.into_iter().map(on_triangles).collect();
    plans.push(json!({ "preset": "loop" }));
    plans.push(json!({ "preset": "loop", "boundary": "edge-only" }));
    plans.push(json!({ "preset": "push-back", "parameters": { "split": "triangle", "delta": 0.5 } }));
    plans
}

/// Returns plans of arities above 2 for meshes of any faces.
fn plans_of_higher_arity() -> Vec<Value> {
    let mut plans: Vec<Value> = ["U3", "U3C", "U3CP", "U4CCP", "U5CC"].map(word).into();
    plans.extend(["U3C", "U3CP", "U(U3CP)", "U3(UCP)"].map(static_word));
    plans.push(semi_stationary("U3CCP", "pi/3", 0.4));
    plans
}

fn assert_same_points(found: &Net, expected: &Net, what: &Value) {
    assert_eq!(found.positions.len(), expected.positions.len(), "{what}");
    for (i, (p, q)) in found.positions.iter().zip(&expected.positions).enumerate() {
        assert!(distance(p, q) <= TOLERANCE, "{what}: vertex {i} is {p:?} and {q:?}");
    }
    assert_eq!(found.faces, expected.faces, "{what}");
}

#[test]
fn loop_is_a_word_with_push_back() {
    for boundary in ["edge-and-corner", "edge-only"] {
        for net in triangle_meshes() {
            for levels in 1..=3 {
                let [a, b] = [json!({ "preset": "loop" }), loop_as_word()].map(|plan| with_boundary(plan, boundary));
                assert_same_points(&refined_mesh(&net, &a, levels), &refined_mesh(&net, &b, levels), &b);
            }
        }
    }
}

/// If all valences are 6, `UC` is Loop's scheme without a push-back; on an octahedron it is not.
#[test]
fn averages_with_mu_a_quarter_are_loop_at_regular_vertices() {
    let [preset, average] = [json!({ "preset": "loop" }), on_triangles(word("UC"))];
    let torus = nets::triangulated(nets::torus(5, 4));
    assert_same_points(&refined_mesh(&torus, &preset, 2), &refined_mesh(&torus, &average, 2), &average);
    let [a, b] = [&preset, &average].map(|plan| refined_mesh(&nets::octahedron(), plan, 1));
    let [vertices, edges] =
        [0..6, 6..18].map(|range| range.map(|i| distance(&a.positions[i], &b.positions[i])).fold(0.0, f64::max));
    assert!(vertices > 1e-3 && edges <= TOLERANCE, "{vertices} {edges}");
}

/// The masks of REFERENCE 7 around a regular vertex: 5/8 and 1/16; 3/8 and 1/8. With mu = 1/3: 2/3 and 1/18; 7/18, 1/9.
#[test]
fn unit_vertices_show_the_masks() {
    let torus = nets::triangulated(nets::torus(6, 6));
    for (mu, own, far, near, opposite) in
        [("1/4", 5.0 / 8.0, 1.0 / 16.0, 3.0 / 8.0, 1.0 / 8.0), ("1/3", 2.0 / 3.0, 1.0 / 18.0, 7.0 / 18.0, 1.0 / 9.0)]
    {
        let mut net = torus.clone();
        net.positions = vec![[0.0; 3]; net.positions.len()];
        net.positions[14] = [1.0, 0.0, 0.0];
        let plan = json!({ "word": "UC", "parameters": { "split": "triangle", "mu": mu } });
        let weights: Vec<f64> = refined_mesh(&net, &plan, 1).positions.iter().map(|p| p[0]).collect();
        let count = |weight: f64, range: std::ops::Range<usize>| {
            weights[range].iter().filter(|&&w| (w - weight).abs() <= 1e-15).count()
        };
        assert!((weights[14] - own).abs() <= 1e-15);
        assert_eq!((count(far, 0..36), count(0.0, 0..36)), (6, 29), "{mu}");
        assert_eq!((count(near, 36..144), count(opposite, 36..144)), (6, 6), "{mu}");
    }
}

#[test]
fn delta_one_interpolates_with_any_split_and_arity() {
    for text in ["UCP", "UCCP", "U3CP", "U5CCP"] {
        for net in triangle_meshes() {
            let fine = refined_mesh(&net, &on_triangles(word(text)), 1);
            assert!(net.positions.iter().zip(&fine.positions).all(|(p, q)| distance(p, q) <= TOLERANCE), "{text}");
        }
        for net in [nets::cube(), nets::mixed(), nets::prism(5), nets::grid(2, 3)] {
            let fine = refined_mesh(&net, &word(text), 1);
            assert!(net.positions.iter().zip(&fine.positions).all(|(p, q)| distance(p, q) <= TOLERANCE), "{text}");
        }
    }
}

/// In the middle of a grid, averages after U of any arity are the tensor product of those of curves.
#[test]
fn regular_regions_of_any_arity_are_tensor_products() {
    let n = 8_usize;
    let net = nets::grid(n - 1, n - 1);
    for (plan, d) in [
        (word("U3"), 3_usize),
        (static_word("U3C"), 3),
        (static_word("U4CC"), 4),
        (semi_stationary("U5C", "pi/3", 0.0), 5),
    ] {
        let fine = refined_mesh(&net, &plan, 1);
        let row = |points: &[[f64; 3]]| refined(points, true, &plan, 1);
        let rows: Vec<Vec<[f64; 3]>> = net.positions.chunks(n).map(row).collect();
        let column = |i: usize| refined(&rows.iter().map(|row| row[i]).collect::<Vec<_>>(), true, &plan, 1);
        // one control face and its border, away from the seam of the closed curves
        let middle = 3 * d..=4 * d;
        let expected: Vec<[f64; 3]> = middle.clone().flat_map(|i| column(i)[middle.clone()].to_vec()).collect();
        assert_eq!(expected.len(), (d + 1) * (d + 1));
        for p in &expected {
            assert!(fine.positions.iter().any(|q| distance(p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
        }
    }
}

/// A boundary is the curve of the curve scheme for the boundary polygon, with triangles and with any arity.
#[test]
fn boundaries_follow_the_curve_scheme() {
    let rim = |order: &[usize], net: &Net| order.iter().map(|&v| net.positions[v]).collect::<Vec<_>>();
    let grid = nets::triangulated(nets::grid(2, 2));
    for plan in [word("UC"), static_word("UCP"), static_word("U3CCP"), semi_stationary("U4CP", "1", 0.5)] {
        let boundary = rim(&[0, 1, 2, 5, 8, 7, 6, 3], &grid);
        let surface = refined_mesh(&grid, &with_boundary(on_triangles(plan.clone()), "edge-only"), 2);
        for p in refined(&boundary, true, &plan, 2) {
            assert!(surface.positions.iter().any(|q| distance(&p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
        }
        let quads = nets::grid(2, 2);
        let surface = refined_mesh(&quads, &with_boundary(plan.clone(), "edge-only"), 2);
        for p in refined(&boundary, true, &plan, 2) {
            assert!(surface.positions.iter().any(|q| distance(&p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
        }
    }
}

/// A crease from boundary to boundary is the curve of the curve scheme for its vertices, with corners at its ends.
#[test]
fn creases_follow_the_curve_scheme() {
    let path = [1, 6, 11, 16];
    let crease: Vec<Value> = path.windows(2).map(|edge| json!({ "edge": edge, "sharpness": 10 })).collect();
    let quads = nets::grid(4, 3);
    for plan in [word("UC"), static_word("UCP"), static_word("U3CCP"), semi_stationary("U4CP", "1", 0.5)] {
        let curve = refined(&path.map(|v: usize| quads.positions[v]), false, &plan, 2);
        for (net, plan) in [(quads.clone(), plan.clone()), (nets::triangulated(quads.clone()), on_triangles(plan))] {
            let mut mesh = net.to_json();
            mesh["creases"] = json!(crease);
            let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 2 });
            let surface = Net::of(&crate::support::json(job));
            for p in &curve {
                assert!(surface.positions.iter().any(|q| distance(p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
            }
        }
    }
}

#[test]
fn corners_and_holes_work_on_triangles() {
    let net = nets::triangulated(nets::grid(3, 2));
    for plan in triangle_plans().into_iter().filter(|plan| plan["word"].as_str() != Some("C")) {
        let mut mesh = net.to_json();
        mesh["corners"] = json!([{ "vertex": 5, "sharpness": 10 }]);
        let job = |mesh: &Value| json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 });
        let whole = Net::of(&crate::support::json(job(&mesh)));
        assert_eq!(whole.positions.get(5), net.positions.get(5), "{plan}");
        mesh["holes"] = json!([2]);
        let shown = Net::of(&crate::support::json(job(&mesh)));
        assert_eq!(shown.positions, whole.positions);
        let each = whole.faces.len() / net.faces.len();
        let rest = [&whole.faces[..2 * each], &whole.faces[3 * each..]].concat();
        assert_eq!(shown.faces, rest, "{plan}");
    }
}

/// The weight of V is part of C only in the first average after U, and D takes the same weights.
#[test]
fn the_dual_of_split_triangles_has_a_vertex_a_face() {
    let net = nets::octahedron();
    let fine = refined_mesh(&net, &on_triangles(word("U")), 1);
    let dual = refined_mesh(&net, &on_triangles(json!({ "word": "UD", "parameters": { "kernel": 3 } })), 1);
    assert_eq!((dual.positions.len(), dual.faces.len()), (fine.faces.len(), fine.positions.len()));
    for (p, face) in dual.positions.iter().zip(&fine.faces) {
        let weight = |v: usize| if v < net.positions.len() { 3.0 } else { 1.0 };
        let sum: f64 = face.iter().map(|&v| weight(v)).sum();
        let mean = [0, 1, 2].map(|k| face.iter().map(|&v| weight(v) * fine.positions[v][k]).sum::<f64>() / sum);
        assert!(distance(p, &mean) <= TOLERANCE);
    }
}

/// On closed meshes two D are C with the centroids, mu = 1/3, and a push-back may follow them.
#[test]
fn two_duals_of_triangles_average_their_centroids() {
    for net in [nets::tetrahedron(), nets::octahedron(), nets::triangulated(nets::prism(5))] {
        for (duals, average) in [("UDD", "UC"), ("UDDP", "UCP")] {
            let average = json!({ "word": average, "parameters": { "split": "triangle", "mu": "1/3", "delta": 0.5 } });
            let duals = json!({ "word": duals, "parameters": { "split": "triangle", "delta": 0.5 } });
            let [a, b] = [&duals, &average].map(|plan| refined_mesh(&net, plan, 1).positions);
            assert!(a.iter().zip(&b).all(|(p, q)| distance(p, q) <= TOLERANCE) && a.len() == b.len(), "{duals}");
        }
    }
}

#[test]
fn kernels_without_an_average_of_triangles_are_refused() {
    for (word, kernel, mu, refused) in [
        ("UC", "-3", 0.25, true),
        ("UC", "-5/3", 0.25, true),
        ("UD", "-2", 0.25, true),
        ("UC", "-2", 0.25, false),
        ("UD", "-3", 0.25, false),
        ("UC", "0", 1.0, true),
        ("UC", "-1.9", 0.25, false),
        ("UC", "0", 0.25, false),
    ] {
        let plan = json!({ "word": word, "parameters": { "split": "triangle", "kernel": kernel, "mu": mu } });
        let job = json!({ "input": nets::octahedron().input(), "plan": plan, "levels": 1 });
        if refused {
            let faults = crate::support::faults(job);
            assert_eq!(faults[0].pointer, "/plan/parameters/kernel");
            assert!(faults[0].detail.contains("add up to 0"), "{}", faults[0].detail);
        } else {
            crate::support::json(job);
        }
    }
}

#[test]
fn other_faces_than_triangles_are_refused_by_name() {
    let mut net = nets::triangulated(nets::cube());
    net.faces.truncate(7);
    net.faces.push(vec![0, 4, 6, 2]);
    for (plan, pointer) in [
        (json!({ "preset": "loop" }), "/plan/preset"),
        (on_triangles(word("UC")), "/plan/parameters/split"),
        (on_triangles(word("C(UC)")), "/plan/parameters/split"),
        (json!({ "preset": "push-back", "parameters": { "split": "triangle" } }), "/plan/preset"),
    ] {
        let faults = crate::support::faults(json!({ "input": net.input(), "plan": plan, "levels": 1 }));
        assert_eq!(faults.len(), 1);
        assert_eq!(faults[0].pointer, pointer);
        assert!(faults[0].detail.starts_with("face 7 has 4 vertices"), "{}", faults[0].detail);
        assert!(faults[0].detail.contains("send a mesh of triangles"), "{}", faults[0].detail);
    }
    // the faces that a D makes are known only once it is applied
    let plan = on_triangles(word("UDU"));
    let faults = crate::support::faults(json!({ "input": nets::octahedron().input(), "plan": plan, "levels": 1 }));
    assert!(faults[0].detail.contains("only triangles are split"), "{}", faults[0].detail);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn triangles_commute_with_affine_maps(net in nets::triangle_manifold(), map in Affine::<3>::random()) {
        commutes(&net, &map, &triangle_plans(), 1)?;
    }

    #[test]
    fn higher_arities_commute_with_affine_maps(net in nets::manifold(), map in Affine::<3>::random()) {
        commutes(&net, &map, &plans_of_higher_arity(), 1)?;
    }

    #[test]
    fn planes_stay_planes(net in nets::triangle_manifold(), slopes in proptest::array::uniform2(-2.0..2.0_f64)) {
        let mut flat = net;
        flat.positions.iter_mut().for_each(|p| p[2] = slopes[0] * p[0] + slopes[1] * p[1]);
        for plan in triangle_plans() {
            for p in refined_mesh(&flat, &plan, 1).positions {
                prop_assert!((p[2] - slopes[0] * p[0] - slopes[1] * p[1]).abs() <= 1e-11, "{}", plan);
            }
        }
    }

    #[test]
    fn where_a_triangle_starts_does_not_matter(net in nets::triangle_manifold(), by in 1..3_usize) {
        let mut turned = net.clone();
        turned.faces.iter_mut().for_each(|face| face.rotate_left(by));
        for plan in triangle_plans() {
            let (a, b) = (refined_mesh(&net, &plan, 1), refined_mesh(&turned, &plan, 1));
            for (p, q) in a.positions.iter().zip(&b.positions).take(net.positions.len()) {
                prop_assert!(distance(p, q) <= TOLERANCE, "{}", plan);
            }
        }
    }
}

fn commutes(net: &Net, map: &Affine<3>, plans: &[Value], levels: u32) -> Result<(), TestCaseError> {
    for plan in plans {
        let mapped = refined_mesh(&Net { positions: map.all(&net.positions), ..net.clone() }, plan, levels);
        let expected = refined_mesh(net, plan, levels);
        let image = map.all(&expected.positions);
        assert_near(mapped.positions.as_flattened(), image.as_flattened(), &plan.to_string())?;
        prop_assert_eq!(mapped.faces, expected.faces);
    }
    Ok(())
}
