//! Plans whose differences grow for some levels before they shrink, or shrink before they grow.

use serde_json::{Value, json};

use super::{limit, warnings};
use crate::support::nets::{self, distance};
use crate::support::render;

fn pushed_back(delta: f64) -> Value {
    json!({ "word": "UCP", "parameters": { "delta": delta } })
}

/// Where regular, `UCP` is continuous for deltas above -9: the differences of an impulse grow by a factor of 4.6 in the
/// first six levels at -8.5, and shrink from the eleventh on.
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
    let job = json!({ "input": net.input(), "plan": pushed_back(-9.1), "levels": 0,
        "outputs": [{ "format": "obj", "positions": "limit" }] });
    let faults = render(&job).expect_err("there is no limit");
    assert!(faults[0].detail.contains("no continuous limit"), "{faults:?}");
}

/// Divided second differences vanish for deltas from about -4.87 to 3 only, those of the first levels say otherwise.
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
