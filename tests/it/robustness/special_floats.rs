//! Extreme numbers in every field.

use serde_json::{Value, json};

use crate::support::{faults, parsed, render};

const EXTREMES: [f64; 12] =
    [0.0, -0.0, 5e-324, -5e-324, 2.3e-308, 1e-160, 1e16, 1e160, -1e160, 1e308, f64::MAX, f64::MIN];

fn polygon() -> Value {
    json!({ "polygon": { "points": [[0.0, 0.5], [3.0, 1.0], [2.0, 4.0], [-1.0, 2.0]], "closed": true } })
}

/// Checks that a result has finite numbers only, or that faults have pointers; returns whether there was a result.
fn survives(job: &Value) -> bool {
    match render(job) {
        Ok((bytes, _)) => {
            let text = String::from_utf8(bytes).expect("the json output is text");
            let result: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
            assert!(!text.contains("null"), "{text}");
            assert!(result.is_object());
            true
        }
        Err(faults) => {
            assert!(!faults.is_empty() && faults.iter().all(|fault| fault.detail.len() > 10), "{faults:?} for {job}");
            false
        }
    }
}

#[test]
fn coordinates() {
    let mut refined = 0;
    for a in EXTREMES {
        for b in EXTREMES {
            let points = json!([[a, b], [b, a], [-a, b], [1.0, -b]]);
            let input = json!({ "polygon": { "points": points, "closed": true } });
            let mesh = json!({ "mesh": {
                "positions": [[a, b, 0], [b, a, 1], [-a, b, a], [1, -b, b]],
                "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            } });
            let plans = [
                (&input, json!({ "word": "UCP" })),
                (&input, json!({ "preset": "incenter" })),
                (&mesh, json!({ "preset": "catmull-clark" })),
            ];
            for (input, plan) in plans {
                let job = json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
                refined += u32::from(survives(&job));
            }
        }
    }
    assert!(refined > 100, "{refined}");
}

#[test]
fn parameters() {
    let mut refined = 0;
    for x in EXTREMES {
        for name in ["alpha", "kernel", "compensation", "delta"] {
            for other in ["cos(alpha/2)", "1/alpha", "exp(alpha)"] {
                let mut parameters = json!({ "alpha": 1.5, "kernel": other, "compensation": other });
                parameters[name] = json!(x);
                let plan = json!({ "word": "UCP", "parameters": parameters });
                let job = json!({ "input": polygon(), "plan": plan, "levels": 4, "outputs": [{ "format": "json" }] });
                refined += u32::from(survives(&job));
            }
        }
    }
    assert!(refined > 20, "{refined}");
}

#[test]
fn a_kernel_of_minus_one_is_refused_naming_level_and_alpha() {
    let check = |alpha: Value, kernel: &str, level: u32| {
        let parameters = json!({ "alpha": alpha, "kernel": kernel });
        let found =
            faults(json!({ "input": polygon(), "plan": { "word": "UC", "parameters": parameters }, "levels": 3 }));
        assert_eq!(found[0].pointer, "/plan/parameters/kernel");
        assert!(found[0].detail.starts_with(&format!("the kernel is -1 at level {level} (alpha = ")), "{found:?}");
    };
    check(json!(0), "-1", 1);
    check(json!("2*pi"), "cos(alpha/2)", 1);
    check(json!("4*pi"), "cos(alpha/2)", 2);
}

#[test]
fn a_function_without_a_value_is_refused_naming_level_and_alpha() {
    let check = |parameters: Value, pointer: &str, detail: &str| {
        let plan = json!({ "word": "UCP", "parameters": parameters });
        let found = faults(json!({ "input": polygon(), "plan": plan, "levels": 3 }));
        assert_eq!(found[0].pointer, pointer, "{found:?}");
        assert!(found[0].detail.contains(detail), "{found:?}");
    };
    check(
        json!({ "alpha": 2, "kernel": "ln(alpha-1)" }),
        "/plan/parameters/kernel",
        "the kernel is -inf at level 2 (alpha = 1); it must be finite at every level",
    );
    check(
        json!({ "alpha": 0, "kernel": "0/alpha" }),
        "/plan/parameters/kernel",
        "the kernel is NaN at level 1 (alpha = 0)",
    );
    check(json!({ "alpha": "pi", "compensation": "1/cos(alpha/2)" }), "/plan/parameters/compensation", "a pole");
    check(json!({ "alpha": "1/0" }), "/plan/parameters/alpha", "not finite");
    check(json!({ "delta": "sqrt(-1)" }), "/plan/parameters/delta", "not finite");
    check(json!({ "delta": "1/(valence-4)" }), "/plan/parameters/delta", "valence");
}

#[test]
fn coordinates_that_grow_beyond_all_bounds_are_refused_naming_the_level() {
    let points = [[1e308], [-1e308], [1e308], [-1e308], [0.0]];
    let plan = json!({ "word": "UCP", "parameters": { "kernel": 1, "delta": 1e6 } });
    let job = json!({ "input": { "polygon": { "points": points, "closed": true } }, "plan": plan, "levels": 3 });
    let found = faults(job);
    assert!(found[0].detail.starts_with("level 1: a coordinate is no longer finite"), "{found:?}");
}

#[test]
fn numbers_beyond_f64_are_faults_of_their_place() {
    for (huge, text) in [("1e309", "json"), ("-1e400", "json"), ("1e99999", "json")] {
        let job = format!(r#"{{"input":{{"polygon":{{"points":[[0],[{huge}]]}}}},"outputs":[{{"format":"{text}"}}]}}"#);
        let found = parsed(job.as_bytes()).expect_err("the number is beyond f64");
        assert_eq!(found[0].pointer, "/input/polygon/points/1/0", "{found:?}");
        assert_eq!(found[0].detail, "the number is too large; the largest is about 1.8e308");
    }
    for nothing in ["NaN", "Infinity", "-Infinity", "nan", "0x10", "1.", ".5", "+1"] {
        let job = format!(r#"{{"input":{{"polygon":{{"points":[[0],[{nothing}]]}}}}}}"#);
        let found = parsed(job.as_bytes()).expect_err("that is no JSON");
        assert!(found[0].detail.starts_with("the body is not JSON"), "{nothing}: {found:?}");
        let told = found[0].detail.ends_with("; JSON has neither NaN nor Infinity, all numbers are finite");
        assert_eq!(told, nothing.to_lowercase().contains('n'), "{nothing}: {found:?}");
    }
}
