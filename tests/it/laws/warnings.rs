//! A warning tells of parameters for which a scheme need not converge, or is less smooth than it is known for.

use serde_json::{Value, json};

use crate::support::render;

fn warnings(plan: &Value, levels: u32) -> Vec<String> {
    let job = json!({ "input": { "polygon": { "points": [[0, 0], [1, 0], [1, 1], [0, 2]], "closed": true } },
        "plan": plan, "levels": levels, "outputs": [{ "format": "json" }] });
    let (bytes, report) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let result: Value = serde_json::from_slice(&bytes).expect("json output");
    let written: Vec<String> =
        serde_json::from_value(result.get("warnings").cloned().unwrap_or(json!([]))).expect("a list");
    assert_eq!(written, report.warnings, "json output and report say the same");
    written
}

fn preset(name: &str, parameters: &Value) -> Value {
    json!({ "preset": name, "parameters": parameters })
}

#[test]
fn parameters_outside_are_answered_with_the_range() {
    let cases = [
        (preset("four-point", &json!({ "w": 0.2 })), "0 < w < 0.19273"),
        (preset("four-point", &json!({ "w": -0.05 })), "0 < w < 0.19273"),
        (preset("ternary-three-point", &json!({ "alpha": 0.2 })), "2/9 < alpha < 1/3"),
        (preset("ternary-four-point", &json!({ "mu": 0.2 })), "1/15 < mu < 1/9"),
        (preset("ternary-c4", &json!({ "eta": 0.02 })), "0 < eta < 1/81"),
        (preset("push-back", &json!({ "kernel": 0.2, "compensation": 6, "delta": 1 })), "-2 < compensation < 2"),
        (preset("mask", &json!({ "mask": [1, 1, 1], "first": 0 })), "sum to 2"),
        (preset("mask", &json!({ "mask": [-2, 3, 3, -2], "first": 0 })), "not known to converge"),
    ];
    for (plan, expected) in cases {
        let found = warnings(&plan, 2);
        assert!(found.iter().any(|warning| warning.contains(expected)), "{plan}: {found:?}");
        assert!(warnings(&plan, 0).is_empty(), "{plan}: level 0 knows no scheme");
    }
}

#[test]
fn parameters_inside_are_answered_without_a_word() {
    let mut plans = vec![
        preset("four-point", &json!({})),
        preset("four-point", &json!({ "w": 0.19 })),
        preset("four-point", &json!({ "w": 0 })),
        preset("ternary-three-point", &json!({})),
        preset("ternary-four-point", &json!({})),
        preset("ternary-c4", &json!({})),
        preset("two-n-point", &json!({ "n": 16 })),
        preset("d-ary-b-spline", &json!({ "arity": 5, "degree": 6 })),
        preset("b-spline", &json!({ "degree": 1 })),
        preset("incenter", &json!({})),
        preset("d-ary-circle", &json!({ "arity": 3, "averages": 2, "alpha": "pi/3", "delta": 1 })),
        preset("push-back", &json!({ "alpha": "pi/4", "kernel": "10*cos(alpha/2)", "compensation": 1, "delta": 0.8 })),
        json!({ "word": "UC", "parameters": { "perturbation": { "amplitude": 0.2 } } }),
    ];
    plans.extend(["U", "UD", "UUCPD(UC)", "U3AA"].map(|word| json!({ "word": word })));
    for plan in plans {
        assert_eq!(warnings(&plan, 2), Vec::<String>::new(), "{plan}");
    }
}

/// The key of a preset is that of its word, and so are the warnings stored under it.
#[test]
fn a_word_is_warned_of_as_its_preset_is() {
    let word = json!({ "word": "UCP", "parameters": { "compensation": 4.8 } });
    assert_eq!(warnings(&word, 3), warnings(&preset("four-point", &json!({ "w": 0.3 })), 3));
}

#[test]
fn values_are_told_as_they_were_given() {
    let told = |name: &str, parameters: Value, expected: &str| {
        let found = warnings(&preset(name, &parameters), 1);
        assert!(found.len() == 1 && found[0].contains(expected), "{found:?}");
    };
    told("ternary-three-point", json!({ "alpha": 0.1 }), "alpha = 0.1 lies");
    told("ternary-four-point", json!({ "mu": 0.2 }), "mu = 0.2 lies");
    told("four-point", json!({ "w": "-1/3" }), "w = -0.333333333333 lies");
}

#[test]
fn the_ends_of_a_range_belong_to_it() {
    for (name, parameters) in [
        ("four-point", json!({ "w": 0 })),
        ("ternary-three-point", json!({ "alpha": "2/9" })),
        ("ternary-three-point", json!({ "alpha": "1/3" })),
        ("ternary-four-point", json!({ "mu": "1/15" })),
        ("ternary-c4", json!({ "eta": "1/81" })),
    ] {
        assert!(warnings(&preset(name, &parameters), 1).is_empty(), "{name} {parameters}");
    }
}

#[test]
fn a_warning_names_no_parameters_that_the_preset_has_not() {
    let plan = preset("d-ary-circle", &json!({ "arity": 3, "averages": 1, "alpha": 1, "delta": 12 }));
    let found = warnings(&plan, 1);
    assert!(found.len() == 1 && !found[0].contains("kernel"), "{found:?}");
}
