//! Curvature of meshes against closed forms.

use serde_json::{Value, json};

use super::{number, sheet, sphere, stats, torus};
use crate::support::nets::{self, Net};

fn near(value: &Value, expected: f64, tolerance: f64, what: &str) {
    let found = number(value);
    assert!((found - expected).abs() <= tolerance, "{what}: {found} is not {expected}");
}

/// Returns the input of a sphere with coincident vertices merged.
fn welded(net: &Net, radius: f64) -> Value {
    let mut input = net.input();
    input["weld"] = (1e-9 * radius).into();
    input
}

#[test]
fn a_sphere_bends_alike_everywhere() {
    for radius in [0.5, 3.0, 1e-40, 1e40] {
        let found = stats(json!({ "input": welded(&sphere(24, radius), radius) }));
        let curvature = &found["curvature"];
        for (which, expected) in [("gaussian", 1.0 / radius / radius), ("mean", 1.0 / radius)] {
            for end in ["min", "max", "mean"] {
                near(&curvature[which][end], expected, 1e-6 * expected, &format!("{which} {end} at {radius}"));
            }
        }
    }
}

/// Returns the differences from the closed forms of a torus of radii 2 and 1: of Gaussian curvature from -1 to 1 / 3,
/// of mean curvature from 0 to 2 / 3.
fn torus_errors(n: usize) -> [f64; 4] {
    let found = stats(json!({ "input": torus(2 * n, n).input() }));
    let curvature = &found["curvature"];
    [("gaussian", "min", -1.0), ("gaussian", "max", 1.0 / 3.0), ("mean", "min", 0.0), ("mean", "max", 2.0 / 3.0)]
        .map(|(which, end, expected)| (number(&curvature[which][end]) - expected).abs())
}

#[test]
fn the_curvature_of_a_torus_tends_to_its_closed_form_with_the_square_of_the_edges() {
    let [coarse, fine] = [24, 48].map(torus_errors);
    for (coarse, fine) in coarse.iter().zip(fine) {
        assert!(*coarse < 0.05 && fine < 0.3 * coarse, "{coarse} then {fine}");
    }
    let found = stats(json!({ "input": torus(96, 48).input() }));
    let gaussian = &found["curvature"]["gaussian"];
    near(&gaussian["mean"], 0.0, 1e-3, "all of it");
    // on the inner circle the surface is a saddle, on the outer one a dome
    for (end, radius) in [("min_at", 1.0), ("max_at", 3.0)] {
        let at: [f64; 3] = serde_json::from_value(gaussian[end].clone()).expect("a place");
        near(&json!(at[0] * at[0] + at[2] * at[2]), radius * radius, 1e-9, end);
    }
}

#[test]
fn the_sum_of_all_curvature_is_that_of_the_topology() {
    for (net, preset, euler) in [
        (nets::cube(), "catmull-clark", 2.0),
        (nets::torus(5, 4), "catmull-clark", 0.0),
        (nets::tetrahedron(), "loop", 2.0),
        (nets::cube(), "doo-sabin", 2.0),
    ] {
        let plan = json!({ "preset": preset });
        let found = stats(json!({ "input": net.input(), "plan": plan, "levels": 4 }));
        let total = number(&found["curvature"]["gaussian"]["mean"]) * number(&found["area"]);
        let expected = 2.0 * std::f64::consts::PI * euler;
        assert!((total - expected).abs() < 0.02 * 12.6, "{preset}: {total} is not {expected}");
    }
}

#[test]
fn a_boundary_has_the_curvature_of_what_is_beside_it() {
    // x^2 / 2: a trough of mean curvature 1 / 2 in the middle and sqrt(2) / 8 at the sides
    let found = stats(json!({ "input": sheet(40, |x, _| -0.5 * x * x).input() }));
    let curvature = &found["curvature"];
    near(&curvature["gaussian"]["min"], 0.0, 1e-6, "a trough is flat along itself");
    near(&curvature["gaussian"]["max"], 0.0, 1e-6, "a trough is flat along itself");
    near(&curvature["mean"]["max"], 0.5, 2e-3, "in the middle");
    near(&curvature["mean"]["min"], 2.0_f64.sqrt() / 8.0, 0.04, "at the sides");
}

#[test]
fn turning_a_surface_over_changes_the_sign_of_its_mean_curvature_only() {
    let net = sphere(8, 1.0);
    let faces = net.faces.iter().map(|face| face.iter().rev().copied().collect()).collect();
    let turned = Net { positions: net.positions.clone(), faces };
    let [found, other] = [net, turned].map(|net| stats(json!({ "input": welded(&net, 1.0) }))["curvature"].clone());
    near(&other["mean"]["min"], -number(&found["mean"]["max"]), 1e-12, "mean");
    near(&other["gaussian"]["min"], number(&found["gaussian"]["min"]), 1e-12, "gaussian");
}

#[test]
fn the_largest_jump_of_normals_is_told_with_its_edge() {
    let found = stats(json!({ "input": nets::prism(6).input() }));
    assert!(number(&found["normal_jump"]["degrees"]) > 59.0, "{found}");
    let brick: Vec<[u32; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]).collect();
    let mesh = json!({ "positions": brick, "faces": nets::cube().faces });
    let found = stats(json!({ "input": { "mesh": mesh } }));
    near(&found["normal_jump"]["degrees"], 90.0, 1e-12, "a box");
    assert_eq!(
        (&found["normal_jump"]["vertices"], &found["normal_jump"]["at"]),
        (&json!([0, 1]), &json!([0.5, 0.0, 0.0]))
    );
    // a plane has no jump, and a single face has no edge with two faces
    let flat = stats(json!({ "input": sheet(3, |_, _| 0.0).input() }));
    near(&flat["normal_jump"]["degrees"], 0.0, 1e-6, "a plane");
    assert_eq!(stats(json!({ "input": sheet(1, |_, _| 0.0).input() }))["normal_jump"], Value::Null);
    // refinement reduces the jump, level by level
    let jump = |levels: u32| {
        let job = json!({ "input": nets::cube().input(), "plan": { "preset": "catmull-clark" }, "levels": levels });
        number(&stats(job)["normal_jump"]["degrees"])
    };
    assert!(jump(2) > 1.5 * jump(3) && jump(3) > 1.5 * jump(4));
}

#[test]
fn hostile_meshes_have_finite_curvature_or_none() {
    let point = [1.0, 2.0, 3.0];
    for positions in [
        vec![point; 4],
        vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
        vec![[0.0; 3], [1e-300, 0.0, 0.0], [0.0, 1e-300, 0.0], [0.0, 0.0, 1e-300]],
        vec![[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e300, 0.0], [0.0, 0.0, 1e300]],
    ] {
        let net = Net { positions, faces: nets::tetrahedron().faces };
        let found = stats(json!({ "input": net.input() }));
        assert!(found["curvature"]["gaussian"].is_object() || found["curvature"]["gaussian"].is_null(), "{found}");
    }
}
