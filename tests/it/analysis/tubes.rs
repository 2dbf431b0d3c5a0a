//! Analyses of straight tubes with latitude lines.

use planish::math::functions::{cos, sin};
use serde_json::{Value, json};

use super::{asked, refused, smoothness};
use crate::laws::outlooks::{real, told, tube};

fn question(word: &str, parameters: &Value, tube: &Value) -> Value {
    json!({ "plan": { "word": word, "parameters": parameters }, "tube": tube, "nodes": 1000 })
}

fn number(answer: &Value, name: &str) -> f64 {
    answer[name].as_f64().unwrap_or_else(|| panic!("{name}: {answer}"))
}

#[test]
fn the_factor_of_a_tube_is_the_radius_that_its_middle_rings_take() {
    for (word, k) in [("UC", 1), ("UCC", 2), ("UCP", 1), ("UCCP", 2)] {
        for vertices in [3, 6] {
            for (rule, delta) in [("difference", 0.4), ("position", 1.0), ("difference", 0.0)] {
                if rule == "position" && !word.contains('P') {
                    continue;
                }
                let parameters = json!({ "latitude_rule": rule, "delta": delta });
                let rings: Vec<(f64, f64, f64)> = (0..2 * k + 9).map(|u| (2.5, real(u), 0.0)).collect();
                let plan = json!({ "word": word, "parameters": parameters });
                let lines = told(&tube(vertices, &rings), &plan);
                let middle = lines[lines.len() / 2].circle.as_ref().unwrap().radius;
                let answer =
                    asked(&question(word, &parameters, &json!({ "vertices": vertices, "control_radius": 2.5 })));
                assert_eq!(answer["kind"], "tube");
                let off = number(&answer, "limit_radius") - middle;
                assert!(off.abs() < 1e-12, "{word}, {vertices} vertices, {parameters}: {answer} {middle}");
            }
        }
    }
}

#[test]
fn without_a_push_back_the_factor_is_a_product_of_sines_over_angles() {
    for (k, word) in ["UC", "UCC", "UCCC"].iter().enumerate() {
        let answer = asked(&question(word, &json!({}), &json!({ "vertices": 5 })));
        let t = std::f64::consts::TAU / 5.0;
        let second = 2.0 * sin(t / 2.0) / t;
        let wanted = (0..2 * k).fold(sin(t) / t, |product, _| product * second);
        assert!((number(&answer, "factor") - wanted).abs() < 1e-15, "{word}");
        assert_eq!(
            smoothness(&answer["along"]),
            (2 * i64::try_from(k).unwrap() + 2, Some(2 * i64::try_from(k).unwrap() + 3))
        );
    }
}

#[test]
#[expect(clippy::float_cmp, reason = "equal radii have the delta 1 exactly")]
fn a_wanted_pipe_has_its_control_radius_or_its_delta() {
    let parameters = json!({ "delta": 0.25 });
    let forth = asked(&question("UCP", &parameters, &json!({ "vertices": 4, "control_radius": 3 })));
    let back = json!({ "vertices": 4, "limit_radius": forth["limit_radius"] });
    let back = asked(&question("UCP", &parameters, &back));
    assert!((number(&back, "control_radius") - 3.0).abs() < 1e-14);
    let both = json!({ "vertices": 4, "limit_radius": forth["limit_radius"], "control_radius": 3 });
    let both = asked(&question("UCP", &json!({ "delta": 1 }), &both));
    assert!((number(&both, "delta") - 0.25).abs() < 1e-14, "{both}");
    let whole = json!({ "vertices": 4, "limit_radius": 3, "control_radius": 3 });
    assert_eq!(number(&asked(&question("UCP", &json!({}), &whole)), "delta"), 1.0);
}

#[test]
fn stars_have_the_angle_of_their_turns() {
    let answer = asked(&question("UC", &json!({}), &json!({ "vertices": 5, "turns": 2 })));
    let t = 2.0 * std::f64::consts::TAU / 5.0;
    assert!((number(&answer, "alpha") - t).abs() < 1e-15 && (number(&answer, "factor") - sin(t) / t).abs() < 1e-15);
    assert!(cos(t) < 0.0, "more than a quarter turn");
}

/// Reference, 5.2: with the rule `difference`, the scheme along the lines is C2 for delta from 0 to 1; with `position`,
/// it is not for delta 1.
#[test]
fn along_and_across_the_lines_stand_the_schemes_that_the_operators_apply() {
    let along = |rule: &str, delta: f64| {
        let parameters = json!({ "latitude_rule": rule, "delta": delta });
        asked(&json!({ "plan": { "word": "UCP", "parameters": parameters }, "tube": { "vertices": 6 } }))
    };
    let weissman = along("difference", 1.0);
    let values: Vec<f64> = super::numbers(&weissman["along"]["mask"]["values"]).iter().map(|a| a * 128.0).collect();
    let wanted = [1.0, 0.0, -11.0, 0.0, 74.0, 128.0, 74.0, 0.0, -11.0, 0.0, 1.0];
    assert!(values.len() == 11 && values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{values:?}");
    assert!(smoothness(&weissman["along"]).0 >= 2);
    assert_eq!(super::numbers(&weissman["across"]["mask"]["values"]).len(), 7, "the four-point scheme");
    assert_eq!(smoothness(&along("position", 1.0)["along"]), (1, Some(2)));
}

#[test]
fn a_tube_that_makes_no_circles_is_refused_with_its_place() {
    let place =
        |word: &str, parameters: Value, tube: Value| refused(&question(word, &parameters, &tube))[0].pointer.clone();
    assert_eq!(place("UC", json!({}), json!({ "vertices": 2 })), "/tube/vertices");
    assert_eq!(place("UC", json!({}), json!({ "vertices": 6, "turns": 3 })), "/tube/turns");
    assert_eq!(place("UC", json!({}), json!({ "vertices": 6, "control_radius": 0 })), "/tube/control_radius");
    assert_eq!(place("UCP", json!({ "kernel": 2 }), json!({ "vertices": 6 })), "/plan");
    assert_eq!(place("UCP", json!({ "alpha": 1 }), json!({ "vertices": 6 })), "/plan");
    let out_of_reach = json!({ "vertices": 6, "control_radius": 1, "limit_radius": 1.5 });
    assert_eq!(place("UCP", json!({}), out_of_reach), "/tube/limit_radius");
    let two = question("UC", &json!({}), &json!({ "vertices": 6 }));
    let two = json!({ "plan": two["plan"], "tube": two["tube"], "valences": [3] });
    assert_eq!(refused(&two)[0].pointer, "/valences");
}
