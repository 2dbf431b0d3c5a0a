//! Equivalent analysis requests, and refused ones.

use serde_json::{Value, json};

use super::{asked, key, refused};

#[expect(clippy::needless_pass_by_value, reason = "plans are written where they are handed over")]
fn plan(plan: Value) -> Value {
    json!({ "plan": plan })
}

#[test]
fn a_scheme_has_one_key_however_it_is_written() {
    let four_point = key(&plan(json!({ "preset": "four-point", "parameters": { "w": "1/20" } })));
    for same in [
        json!({ "preset": "four-point", "parameters": { "w": 0.05 } }),
        json!({ "word": "UCP", "parameters": { "compensation": "4/5" } }),
        json!({ "word": "UDDP", "parameters": { "compensation": 0.8, "delta": "2 - 1" } }),
        json!({ "preset": "mask", "parameters": { "arity": 2, "first": -3,
            "mask": ["-1/20", 0, "11/20", 1, 0.55, 0, -0.05] } }),
        json!({ "word": "UCP", "parameters": { "compensation": "0.8*cos(alpha)" } }),
    ] {
        assert_eq!(key(&plan(same.clone())), four_point, "{same}");
    }
    let thirds = |w: Value| key(&plan(json!({ "preset": "four-point", "parameters": { "w": w } })));
    assert_ne!(thirds(json!("1/30")), thirds(json!(1.0 / 30.0)), "1/30 is no decimal");
    assert_ne!(
        four_point,
        key(&json!({ "plan": { "preset": "four-point", "parameters": { "w": "1/20" } }, "grid": 2 }))
    );
    let asked =
        |nodes: u64| json!({ "plan": { "preset": "four-point", "parameters": { "w": "1/20" } }, "nodes": nodes });
    assert_eq!(four_point, key(&asked(100_000)), "the default");
    assert_ne!(four_point, key(&asked(10)));
}

#[test]
fn masks_are_exact_where_every_number_is_a_fraction_and_say_so_where_not() {
    let exact = |plan: Value| asked(&json!({ "plan": plan, "nodes": 100 }))["mask"]["exact"].is_array();
    assert!(exact(json!({ "preset": "four-point", "parameters": { "w": "sqrt(1/256)" } })));
    assert!(exact(json!({ "word": "UCP", "parameters": { "kernel": "cos(alpha/2)", "delta": "abs(-1/3)^2" } })));
    assert!(!exact(json!({ "preset": "four-point", "parameters": { "w": "1/(5*pi)" } })));
    assert!(!exact(json!({ "word": "UC", "parameters": { "kernel": "cos(1)" } })));
    let rounded = asked(&json!({ "plan": { "preset": "four-point", "parameters": { "w": "1/(5*pi)" } } }));
    assert_eq!(super::smoothness(&rounded).0, 1, "rounding is no obstacle to a proof");
    assert_eq!(rounded["smoothness"]["assumptions"].as_array().unwrap().len(), 1, "but it is told");
}

#[test]
fn what_is_no_scheme_for_curves_is_refused_with_a_reason() {
    for (question, pointer, word) in [
        (plan(json!({ "preset": "incenter" })), "/plan/preset", "not linear"),
        (
            plan(json!({ "preset": "push-back", "parameters": { "perturbation": { "amplitude": 0.1 } } })),
            "/plan/preset",
            "perturb",
        ),
        (plan(json!({ "word": "CU" })), "/plan/word", "begin"),
        (plan(json!({ "word": "U8^7" })), "/plan/word", "reaches too far"),
        (plan(json!({ "preset": "four-pint" })), "/plan/preset", "four-point"),
        (plan(json!({ "word": "UC", "parameters": { "delta": "valence" } })), "/plan/parameters/delta", "valence"),
        (json!({ "plan": { "word": "UC" }, "nodes": 100_000_000 }), "/nodes", "at most"),
        (json!({ "plan": { "word": "UC" }, "grid": 14 }), "/grid", "coarser"),
        (json!({ "spec": 2, "plan": { "word": "UC" } }), "/spec", "speaks 1"),
    ] {
        let faults = refused(&question);
        let found = faults.iter().any(|fault| fault.pointer == pointer && fault.detail.contains(word));
        assert!(found, "{question}: {faults:?}");
    }
}
