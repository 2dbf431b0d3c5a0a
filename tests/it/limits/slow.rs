//! Plans whose differences grow for some levels before they shrink, or shrink before they grow, or grow between
//! vertices.

use serde_json::{Value, json};

use super::{limit, warnings};
use crate::support::nets::{self, Net, distance};
use crate::support::render;

fn pushed_back(delta: f64) -> Value {
    json!({ "word": "UCP", "parameters": { "delta": delta } })
}

fn has_no_limit(net: &Net, plan: &Value) -> bool {
    let job = json!({ "input": net.input(), "plan": plan, "levels": 0,
        "outputs": [{ "format": "obj", "positions": "limit" }] });
    render(&job).is_err_and(|faults| faults[0].detail.contains("no continuous limit"))
}

/// On regular nets, `UCP` is continuous for deltas above -9: at -8.5 the differences of an impulse grow by a factor of
/// 4.6 in the first six levels, and shrink from the eleventh on.
#[test]
fn differences_that_shrink_late_vanish() {
    let net = nets::torus(4, 5);
    for delta in [-7.5, -8.5] {
        let [coarse, fine] = [0, 1].map(|levels| limit(&net, &pushed_back(delta), levels).0);
        for (v, place) in coarse.positions.iter().enumerate() {
            let off = distance(place, &fine.positions[v]);
            assert!(off < 1e-11, "delta {delta}: the limit of vertex {v} moves by {off}");
        }
    }
    assert!(has_no_limit(&net, &pushed_back(-9.1)));
}

/// Divided second differences vanish only for deltas from about -4.87 to 3, although those of the first levels suggest
/// otherwise.
#[test]
fn second_differences_that_shrink_late_vanish() {
    let net = nets::torus(4, 5);
    for delta in [-4.4, 2.8] {
        let plan = pushed_back(delta);
        assert_eq!(warnings(&net, &plan, 0), [""; 0], "delta {delta}");
        let [coarse, fine] = [0, 1].map(|levels| limit(&net, &plan, levels).1);
        for (v, normal) in coarse.iter().enumerate() {
            let off = distance(normal, &fine[v]);
            assert!(off < 1e-8, "delta {delta}: the normal of vertex {v} turns by {off}");
        }
    }
    for delta in [-5.2, 3.2] {
        let warnings = warnings(&net, &pushed_back(delta), 0);
        assert!(warnings[0].ends_with("no continuous tangents"), "delta {delta}: {warnings:?}");
    }
}

/// Differences may grow in thirds of edges and faces while they vanish around vertices: with compensations above 1
/// under two levels of `UCP`, whose matrices there have spectral radii of 1.22 for delta 2 and compensation 2. Bounds
/// of the compensation from such radii: for delta 1, 2.669 for a limit and 1.658 for tangents; for delta 2, 1.889 and
/// 1.288.
#[test]
fn what_grows_between_vertices_is_seen() {
    let net = nets::torus(4, 5);
    let with = |delta: f64, compensation: f64| {
        json!({
            "word": "UCP", "parameters": { "delta": delta, "compensation": compensation }
        })
    };
    for (delta, continuous, smooth) in [(1.0, 2.669, 1.658), (2.0, 1.889, 1.288)] {
        assert!(has_no_limit(&net, &with(delta, 1.01 * continuous)), "delta {delta}");
        let warnings = |compensation: f64| warnings(&net, &with(delta, compensation), 0);
        let rough = warnings(0.99 * continuous);
        assert!(rough[0].ends_with("no continuous tangents"), "delta {delta}: {rough:?}");
        let rough = warnings(1.01 * smooth);
        assert!(rough[0].contains("limit ones do not exist"), "delta {delta}: {rough:?}");
        assert_eq!(warnings(0.99 * smooth), [""; 0], "delta {delta}");
    }
}

/// At a growth of 1.12 per level, the rounding of positions would have hidden everything after 32 levels.
#[test]
fn what_grows_slowly_between_vertices_is_seen() {
    let parameters = json!({ "kernel": 1.4409, "compensation": 1.8778, "delta": 2.8512 });
    assert!(has_no_limit(&nets::torus(4, 5), &json!({ "word": "UCP", "parameters": parameters })));
}

/// The same on triangles: at a delta of -3, divided second differences approach 1 from below.
#[test]
fn what_grows_between_vertices_of_triangles_is_seen() {
    let net = nets::triangulated(nets::torus(4, 5));
    let with = |delta: f64| json!({ "word": "UCP", "parameters": { "delta": delta, "split": "triangle" } });
    for delta in [-6.0, 5.5] {
        assert!(has_no_limit(&net, &with(delta)), "delta {delta}");
    }
    for delta in [-3.0, 3.0] {
        let warnings = warnings(&net, &with(delta), 0);
        assert!(warnings[0].ends_with("no continuous tangents"), "delta {delta}: {warnings:?}");
    }
}
