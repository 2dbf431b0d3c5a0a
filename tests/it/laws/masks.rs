//! Words have the classical masks: one level of a unit impulse on a long closed polygon.

use serde_json::{Value, json};

use super::{refined, word};
use crate::support::render;

/// Returns the values at the points that an impulse reaches, with the index of the first.
fn mask(plan: &Value) -> (usize, Vec<f64>) {
    let impulse: Vec<[f64; 1]> = (0..32).map(|i| [if i == 16 { 1.0 } else { 0.0 }]).collect();
    let values = refined(&impulse, true, plan, 1);
    let first = values.iter().position(|[x]| *x != 0.0).expect("the impulse leaves a trace");
    let last = values.iter().rposition(|[x]| *x != 0.0).expect("the impulse leaves a trace");
    (first, values[first..=last].iter().map(|[x]| *x).collect())
}

/// Checks the mask exactly; `reach` is the distance of its first entry before the child of the impulse.
fn check(plan: &Value, reach: usize, denominator: f64, expected: &[f64]) {
    let expected: Vec<f64> = expected.iter().map(|x| x / denominator).collect();
    assert_eq!(mask(plan), (32 - reach, expected), "{plan}");
}

#[test]
fn words_spell_the_classical_masks() {
    check(&word("U"), 1, 2.0, &[1., 2., 1.]);
    check(&word("UD"), 2, 4.0, &[1., 3., 3., 1.]);
    check(&word("UC"), 2, 8.0, &[1., 4., 6., 4., 1.]);
    check(&word("UCP"), 3, 16.0, &[-1., 0., 9., 16., 9., 0., -1.]);
    check(&word("UCC"), 3, 32.0, &[1., 6., 15., 20., 15., 6., 1.]);
}

#[test]
fn presets_spell_the_classical_masks() {
    check(&json!({ "preset": "chaikin" }), 2, 4.0, &[1., 3., 3., 1.]);
    check(&json!({ "preset": "cubic-b-spline" }), 2, 8.0, &[1., 4., 6., 4., 1.]);
    check(&json!({ "preset": "four-point" }), 3, 16.0, &[-1., 0., 9., 16., 9., 0., -1.]);
    check(&json!({ "preset": "four-point", "parameters": { "w": "1/8" } }), 3, 8.0, &[-1., 0., 5., 8., 5., 0., -1.]);
}

/// `s = (1 - delta) / (4 (1 + f))`, `w = delta omega / (8 (1 + f))`: `(-w, s, 1/2 + w, 1 - 2s, 1/2 + w, s, -w)`.
#[test]
fn push_back_has_the_mask_of_its_closed_form() {
    for (f, omega, delta) in [(1.0, 1.0, 0.5), (3.0, 2.0, 0.25), (1.0, -1.0, -0.5), (3.0, 4.0, 1.5)] {
        let (s, w) = ((1.0 - delta) / (4.0 * (1.0 + f)), delta * omega / (8.0 * (1.0 + f)));
        let plan =
            json!({ "preset": "push-back", "parameters": { "kernel": f, "compensation": omega, "delta": delta } });
        check(&plan, 3, 1.0, &[-w, s, 0.5 + w, 1.0 - 2.0 * s, 0.5 + w, s, -w]);
    }
}

#[test]
fn b_splines_have_binomial_masks() {
    let mut binomials = vec![1.0, 1.0];
    for degree in 1..=12_u32 {
        binomials = [0.0].iter().chain(&binomials).zip(binomials.iter().chain(&[0.0])).map(|(a, b)| a + b).collect();
        let denominator = f64::from(1 << degree);
        let reach = usize::try_from(degree).expect("small").div_ceil(2) + usize::from(degree % 2 == 0);
        check(&json!({ "preset": "b-spline", "parameters": { "degree": degree } }), reach, denominator, &binomials);
        check(&word(&format!("U{}", "D".repeat(degree as usize - 1))), reach, denominator, &binomials);
    }
}

#[test]
fn clamped_ends_stay_under_masks_that_are_not_their_own_mirror_image() {
    let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 1.0], [4.0, 4.0]];
    for (mask, first) in [(json!([0.2, 0.9, 0.8, 0.1]), 0), (json!([0.4, 0.8, 0.5, 0.2, 0.1]), -2)] {
        let plan = json!({ "preset": "mask", "parameters": { "arity": 2, "mask": mask, "first": first } });
        for levels in 1..=4 {
            let found = refined(&points, false, &plan, levels);
            assert_eq!((found[0], found[found.len() - 1]), (points[0], points[3]), "{plan}");
        }
        let job = |closed: bool, levels: Value, positions: &str| {
            json!({ "input": { "polygon": { "points": points, "closed": closed } }, "plan": plan, "levels": levels,
                "outputs": [{ "format": "json", "positions": positions }] })
        };
        // a result for one side of an end does not hold for its mirror image
        for (levels, positions) in [(json!(2), "limit"), (json!({ "tolerance": 0.1 }), "refined")] {
            let faults = render(&job(false, levels, positions)).err().unwrap_or_default();
            assert!(faults.len() == 1 && faults[0].detail.contains("close the polygon"), "{faults:?}");
        }
        assert!(render(&job(true, json!(2), "limit")).is_ok());
    }
}
