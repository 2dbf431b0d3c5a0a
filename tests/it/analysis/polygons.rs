//! Analyses of polygons that are given beside a plan.

use planish::math::functions::sqrt;
use serde_json::{Value, json};

use super::{asked, key, refused};

fn question(plan: &Value, closed: bool) -> Value {
    let points = json!([[0, 0], [4, 0], [4, 4], [0, 4]]);
    json!({ "plan": plan, "input": { "polygon": { "points": points, "closed": closed } }, "nodes": 100 })
}

/// Bounds shrink by a factor of four per level if the scheme allows it, and they hold for the true distances.
#[test]
fn polygons_are_told_how_close_levels_come() {
    for closed in [true, false] {
        let answer = asked(&question(&json!({ "preset": "cubic-b-spline" }), closed));
        let bounds = answer["input"]["bounds"].as_array().unwrap();
        assert!(bounds.len() >= 4, "{bounds:?}");
        for pair in bounds.windows(2) {
            let [a, b] = [0, 1].map(|k| pair[k]["bound"].as_f64().unwrap());
            assert!(2.0 * b <= a && pair[0]["level"].as_u64() < pair[1]["level"].as_u64(), "{pair:?}");
        }
        // a corner of the square moves by a sixth of its second difference, which is 4 sqrt(2)
        let first = bounds[0]["bound"].as_f64().unwrap();
        let true_distance = if closed { 4.0 * sqrt(2.0) / 6.0 } else { 0.0 };
        assert!(first >= true_distance * (1.0 - 1e-12) && first < 10.0, "{first}");
        assert_eq!(answer["input"]["warnings"], json!([]));
        assert_eq!(answer["smoothness"]["proved_c"], 2, "the scheme is analysed as it is without them");
    }
}

#[test]
fn parameters_that_have_no_value_are_refused_and_schemes_that_diverge_warned_of() {
    let warnings = |plan: &Value| -> String { asked(&question(plan, true))["input"]["warnings"].to_string() };
    let pole = json!({ "compensation": "1/(alpha - 1)", "alpha": 4, "delta": 1 });
    let without_value = &refused(&question(&json!({ "word": "UCP", "parameters": pole }), true))[0];
    assert!(without_value.pointer == "/plan/word" && without_value.detail.contains("level 3"), "{without_value:?}");
    let wild = json!({ "preset": "four-point", "parameters": { "w": 1 } });
    assert!(warnings(&wild).contains("converge"), "{}", warnings(&wild));
}

#[test]
fn plans_that_follow_alpha_have_the_bounds_beside_their_conclusion() {
    let plan = json!({ "preset": "c-b-spline", "parameters": { "degree": 3, "alpha": "pi/2" } });
    let answer = asked(&question(&plan, true));
    assert!(!answer["input"]["bounds"].as_array().unwrap().is_empty(), "{answer}");
    assert!(answer["static_limit"].get("input").is_none());
    assert_eq!(answer["exponentials"], true);
}

#[test]
fn questions_about_other_polygons_have_other_keys_and_scans_have_none() {
    let plan = json!({ "preset": "cubic-b-spline" });
    let [closed, open] = [true, false].map(|closed| key(&question(&plan, closed)));
    let alone = key(&json!({ "plan": plan, "nodes": 100 }));
    assert!(closed != open && open != alone && closed != alone);
    let mut scan = question(&json!({ "preset": "ternary-c4" }), true);
    scan["scan"] = json!({ "parameter": "eta", "from": 0, "to": "1/60", "steps": 2 });
    assert_eq!(refused(&scan)[0].pointer, "/input");
}

#[test]
fn parameters_of_single_points_are_refused() {
    let mut polygon = question(&json!({ "word": "UCP" }), true);
    polygon["input"]["polygon"]["parameters"] = json!({ "alpha": [1, 1, 2, 1] });
    let fault = &refused(&polygon)[0];
    assert!(fault.pointer == "/input" && fault.detail.contains("parameters of their own"), "{fault:?}");
}
