//! Scans: the proofs at each value of a parameter, and the ends of the proved intervals.

use planish::job::Form;
use planish::watch::Watch;
use planish::wire::analysis::AnalysisAnswer;
use serde_json::{Value, json};

use super::{asked, key, question, refused};

/// Returns the only interval of C^k in a scan, as `[disproved below, from, to, disproved above]`.
fn interval(answer: &Value, k: i64) -> [Option<f64>; 4] {
    let of_k: Vec<&Value> = answer["intervals"].as_array().unwrap().iter().filter(|found| found["k"] == k).collect();
    assert_eq!(of_k.len(), 1, "{answer}");
    ["disproved_below", "from", "to", "disproved_above"].map(|end| of_k[0][end]["value"].as_f64())
}

fn scan(plan: &Value, parameter: &str, from: &str, to: &str, steps: u32) -> Value {
    let scan = json!({ "parameter": parameter, "from": from, "to": to, "steps": steps });
    asked(&json!({ "plan": plan, "scan": scan, "nodes": 50_000 }))
}

#[test]
fn the_four_point_scheme_is_bracketed_to_be_c1_between_0_and_the_zero_of_32_w3_4_w_1() {
    let answer = scan(&json!({ "preset": "four-point" }), "w", "-1/10", "3/10", 16);
    assert_eq!((&answer["kind"], &answer["parameter"]), (&json!("scan"), &json!("w")));
    assert_eq!(answer["values"].as_array().unwrap().len(), 17);
    assert_eq!(answer["values"][5]["exact"], "1/40");
    let [below, from, to, above] = interval(&answer, 1).map(Option::unwrap);
    assert!(below <= 0.0 && 0.0 < from && from - below < 1e-5, "{below} {from}");
    let zero = 0.192_729_249_264_812;
    assert!(to < zero && zero < above && above - to < 1e-3, "{to} {above}");
    assert!(answer["intervals"].as_array().unwrap().iter().all(|found| found["k"] != 2), "never C2");
}

#[test]
fn the_ternary_five_point_scheme_is_bracketed_to_be_c4_between_0_and_1_over_81() {
    let answer = scan(&json!({ "preset": "ternary-c4" }), "eta", "0", "1/60", 20);
    let [below, from, to, above] = interval(&answer, 4).map(Option::unwrap);
    assert!(below >= 0.0 && from > 0.0 && from < 1e-7, "{below} {from}");
    assert!(to < 1.0 / 81.0 && 1.0 / 81.0 <= above && above - to < 1e-7, "{to} {above}");
    let [_, from, to, _] = interval(&answer, 3);
    assert_eq!((from, to), (Some(0.0), Some(1.0 / 60.0)), "C3 all along");
    for row in answer["values"].as_array().unwrap() {
        let eta = row["value"].as_f64().unwrap();
        let inside = 0.0 < eta && eta < 1.0 / 81.0;
        assert_eq!(
            (&row["proved_c"], &row["disproved_c"]),
            (&json!(3 + i64::from(inside)), &json!(4 + i64::from(inside)))
        );
        let holder = super::numbers(&row["holder"]);
        assert!(holder[0] <= holder[1] && (holder[0] > 4.0) == inside, "{row}");
    }
}

#[test]
fn whole_parameters_run_through_whole_numbers_and_words_have_scans_too() {
    let degrees = scan(&json!({ "preset": "b-spline" }), "degree", "1", "5", 4);
    let proved: Vec<&Value> = degrees["values"].as_array().unwrap().iter().map(|row| &row["proved_c"]).collect();
    assert_eq!(json!(proved), json!([0, 1, 2, 3, 4]));
    for (k, found) in degrees["intervals"].as_array().unwrap().iter().enumerate() {
        let k = u32::try_from(k).unwrap();
        assert_eq!((&found["k"], &found["to"]["exact"]), (&json!(k), &json!("5")));
        assert_eq!(found["from"]["exact"], (k + 1).to_string());
    }
    let by_default = json!({ "parameter": "n", "from": 1, "to": 4 });
    let points = asked(&json!({ "plan": { "preset": "two-n-point" }, "scan": by_default }));
    assert_eq!((&points["steps"], points["values"].as_array().unwrap().len()), (&json!(3), 4));
    // the kernel -1 has no average, and the scan continues with the next value
    let kernels = scan(&json!({ "word": "UCP", "parameters": { "delta": 0 } }), "kernel", "-3", "3", 6);
    let rows = kernels["values"].as_array().unwrap();
    assert!(rows[2]["refused"].is_string(), "{}", rows[2]);
    assert!(rows[2].get("proved_c").is_none() && rows[4]["proved_c"] == 2, "{kernels}");
}

#[test]
fn scans_of_plans_that_follow_alpha_prove_what_their_conclusion_does() {
    let functions = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)" });
    let answer = scan(&json!({ "word": "UCP", "parameters": functions }), "delta", "0", "1", 2);
    for (row, proved) in answer["values"].as_array().unwrap().iter().zip([2, 2, 1]) {
        assert_eq!((&row["proved_c"], row.get("disproved_c")), (&json!(proved), None), "{row}");
    }
}

#[test]
fn scans_that_cannot_be_are_refused_with_a_reason() {
    let with = |scan: Value| json!({ "plan": { "preset": "ternary-c4" }, "scan": scan });
    let scan = |parameter: &str, from: Value, to: &str, steps: u32| {
        with(json!({ "parameter": parameter, "from": from, "to": to, "steps": steps }))
    };
    for (question, pointer, word) in [
        (scan("eta", json!(0), "1/60", 0), "/scan/steps", "from 1 to 1000"),
        (scan("eta", json!(0), "1/60", 1001), "/scan/steps", "from 1 to 1000"),
        (scan("eta", json!("1/60"), "1/60", 10), "/scan/to", "not above"),
        (scan("eta", json!("a"), "1/60", 10), "/scan/from", "write a number"),
        (scan("theta", json!(0), "1/60", 10), "/scan/parameter", "unknown parameter"),
        (
            json!({ "plan": { "preset": "b-spline" },
                "scan": { "parameter": "degree", "from": 1, "to": "5/2", "steps": 2 } }),
            "/scan/to",
            "whole number",
        ),
        (
            json!({ "plan": { "preset": "catmull-clark" }, "scan": { "parameter": "w", "from": 1, "to": 2 } }),
            "/scan",
            "scans are of schemes for curves",
        ),
        (
            json!({ "plan": { "preset": "four-point" }, "nodes": 100_000,
            "scan": { "parameter": "w", "from": 0, "to": 1, "steps": 100 } }),
            "/nodes",
            "at most 10000000",
        ),
        (
            json!({ "plan": { "preset": "four-point" }, "grid": 3, "scan": { "parameter": "w", "from": 0, "to": 1 } }),
            "/grid",
            "scan\" out",
        ),
    ] {
        let faults = refused(&question);
        let found = faults.iter().any(|fault| fault.pointer == pointer && fault.detail.contains(word));
        assert!(found, "{question}: {faults:?}");
    }
}

#[test]
fn a_scan_has_one_key_whatever_the_plan_says_of_its_parameter_and_stops_when_asked() {
    let scan = |w: Value, from: Value| {
        json!({ "plan": { "preset": "four-point", "parameters": { "w": w } },
            "scan": { "parameter": "w", "from": from, "to": "1/10", "steps": 3 } })
    };
    let one = key(&scan(json!("1/16"), json!("1/20")));
    assert_eq!(one, key(&scan(json!(0.07), json!(0.05))));
    assert_ne!(one, key(&scan(json!(0.07), json!(0.06))));
    let watch = Watch::new();
    let analysis = question(&scan(json!(0), json!(0))).resolve(Form::Json, &watch).unwrap();
    watch.stop();
    assert!(AnalysisAnswer::of(&analysis, &watch).is_err());
}
