//! Schemes given by masks: each row of the blending scheme's table is the named scheme, special cases coincide,
//! polynomials are reproduced, ends are fixed.

#![expect(clippy::float_cmp, reason = "weights that are dyadic are exact")]

use serde_json::{Value, json};

use crate::support::json;

/// Returns the mask of a plan: one level on a unit impulse of a long closed polygon, from the middle outwards.
fn mask(plan: &Value) -> Vec<f64> {
    let mut points = vec![[0.0]; 33];
    points[16] = [1.0];
    let job = json!({ "input": { "polygon": { "points": points, "closed": true } }, "plan": plan, "levels": 1 });
    let found: Vec<[f64; 1]> = serde_json::from_value(json(job)["points"].clone()).expect("points are lists");
    let middle = 16 * found.len() / 33;
    (0..=8).map(|k| found[middle + k][0]).collect()
}

fn preset(name: &str, parameters: &Value) -> Value {
    json!({ "preset": name, "parameters": parameters })
}

fn agree(a: &Value, b: &Value) {
    for (x, y) in mask(a).iter().zip(mask(b)) {
        assert!((x - y).abs() < 1e-15, "{a} has {x} where {b} has {y}");
    }
}

#[test]
fn ternary_b_splines_are_the_d_ary_ones() {
    let names = ["linear", "quadratic", "cubic", "quartic", "quintic"];
    for (name, degree) in names.into_iter().zip(1..) {
        let other = preset("d-ary-b-spline", &json!({ "arity": 3, "degree": degree }));
        agree(&preset(&format!("ternary-{name}"), &json!({})), &other);
    }
}

#[test]
fn rows_of_the_table_are_the_schemes_they_name() {
    let row = |eta: &str, theta: &str, omega: &str, delta: &str, lambda: &str| {
        let parameters = json!({ "eta": eta, "theta": theta, "omega": omega, "delta": delta, "lambda": lambda });
        preset("ternary-blending", &parameters)
    };
    agree(&row("0", "0", "0", "0", "2/3"), &preset("ternary-linear", &json!({})));
    agree(&row("0", "1/9", "0", "0", "2/3"), &preset("ternary-quadratic", &json!({})));
    agree(&row("0", "4/27", "-1/27", "1", "8/13"), &preset("ternary-cubic", &json!({})));
    agree(&row("0", "5/27", "-2/27", "5/6", "3/5"), &preset("ternary-quartic", &json!({})));
    agree(&row("1/243", "52/243", "-1/9", "7/9", "7/12"), &preset("ternary-quintic", &json!({})));
    let three = preset("ternary-three-point", &json!({ "alpha": "1/4" }));
    agree(&row("0", "0", "1/3-1/4", "1", "(4-6/4)/(4-3/4)"), &three);
    let four = preset("ternary-four-point", &json!({ "mu": "1/11" }));
    agree(&row("0", "0", "1/9", "1/2+3/22", "13/20+9/220"), &four);
    let novara = preset("ternary-combined-novara", &json!({ "alpha": "1/30", "beta": "1/40", "gamma": "1/50" }));
    agree(&row("0", "1/9-1/30", "-9/200", "5/9", "(2+3/50-6/40)/(3-3/40-3/50)"), &novara);
    let pan = preset("ternary-combined-pan", &json!({ "alpha": "1/2", "beta": "3/11" }));
    let bend = "(-2+(5+9/11)/2)";
    agree(&row("0", "2/27", "1/27", &format!("{bend}/2"), "(32+(7+27/11)/2)/56"), &pan);
    let rehan = preset("ternary-combined-rehan", &json!({ "alpha": "1/60", "beta": "1/7" }));
    let bend = "(59/60/7)";
    let (delta, lambda) = (format!("(5+81*{bend})/(9+162*{bend})"), format!("(60+81*{bend})/(90+162*{bend})"));
    agree(&row("-1/60", "1/30", &format!("1/9+2*{bend}"), &delta, &lambda), &rehan);
}

/// The masks as their own papers give them, entry by entry.
#[test]
fn combined_schemes_have_the_masks_that_are_told_of_them() {
    let check = |name: &str, parameters: &Value, expected: [f64; 7]| {
        let found = mask(&preset(name, parameters));
        for (x, y) in found.iter().zip(expected.into_iter().chain([0.0, 0.0])) {
            assert!((x - y).abs() < 1e-15, "{name} has {x}, not {y}");
        }
    };
    let (a, b, c): (f64, f64, f64) = (0.26, 0.1, -0.03);
    check("ternary-three-point", &json!({ "alpha": a }), [1.0, 4.0 / 3.0 - 2.0 * a, a, 0.0, a - 1.0 / 3.0, 0.0, 0.0]);
    let four =
        [1.0, 13.0 / 18.0 + b / 2.0, 7.0 / 18.0 - b / 2.0, 0.0, -1.0 / 18.0 - b / 6.0, -1.0 / 18.0 + b / 6.0, 0.0];
    check("ternary-four-point", &json!({ "mu": b }), four);
    let novara = [7.0 / 9.0 + 2.0 * a, 2.0 / 3.0 + c - 2.0 * b, 1.0 / 3.0 + b - 2.0 * c, 1.0 / 9.0 - a, b, c, 0.0];
    check("ternary-combined-novara", &json!({ "alpha": a, "beta": b, "gamma": c }), novara);
    let c4 = |eta: f64| {
        // (1 + z + z^2)^5 over 81 times (t, 1 - 2t, t) with t = 81 eta
        let quartic = [51.0, 45.0, 30.0, 15.0, 5.0, 1.0, 0.0, 0.0].map(|x| x / 81.0);
        let at = |i: usize| quartic[i];
        [0, 1, 2, 3, 4, 5, 6].map(|k: usize| (1.0 - 162.0 * eta) * at(k) + 81.0 * eta * (at(k.abs_diff(1)) + at(k + 1)))
    };
    check("ternary-c4", &json!({ "eta": "1/200" }), c4(1.0 / 200.0));
    // for the other two, the papers give vertex points only
    let vertex = |name: &str, parameters: &Value| {
        let found = mask(&preset(name, parameters));
        [found[0], found[3], found[6]]
    };
    let pan = vertex("ternary-combined-pan", &json!({ "alpha": a, "beta": b }));
    let rehan = vertex("ternary-combined-rehan", &json!({ "alpha": a, "beta": b }));
    for (x, y) in pan.iter().zip([1.0 - 8.0 * a / 27.0, 4.0 * a / 27.0, 0.0]) {
        assert!((x - y).abs() < 1e-15, "{pan:?}");
    }
    for (x, y) in rehan.iter().zip([1.0 - 6.0 * a, 4.0 * a, -a]) {
        assert!((x - y).abs() < 1e-15, "{rehan:?}");
    }
}

#[test]
fn special_cases_coincide() {
    agree(&preset("ternary-c4", &json!({ "eta": "1/243" })), &preset("ternary-quintic", &json!({})));
    agree(&preset("ternary-c4", &json!({ "eta": 0 })), &preset("ternary-quartic", &json!({})));
    agree(&preset("two-n-point", &json!({ "n": 2 })), &preset("four-point", &json!({})));
    agree(&preset("push-back", &json!({})), &preset("four-point", &json!({})));
    agree(&preset("two-n-point", &json!({ "n": 1 })), &json!({ "word": "U" }));
    let pan = |alpha: &str, beta: &str| preset("ternary-combined-pan", &json!({ "alpha": alpha, "beta": beta }));
    agree(&pan("1", "3"), &preset("ternary-cubic", &json!({})));
    agree(&pan("5/4", "1/9"), &preset("ternary-quartic", &json!({})));
    agree(&pan("0", "3/10"), &preset("ternary-four-point", &json!({ "mu": "1/10" })));
    let novara = json!({ "alpha": "-2/27", "beta": "5/81", "gamma": "1/81" });
    agree(&preset("ternary-combined-novara", &novara), &preset("ternary-quartic", &json!({})));
    let chaikin = json!({ "mask": [0.25, 0.75, 0.75, 0.25], "first": -2 });
    let points = json!([[0, 0], [4, 0], [5, 3], [1, 6]]);
    let job = |plan: Value, closed: bool| {
        json(json!({ "input": { "polygon": { "points": points, "closed": closed } }, "plan": plan, "levels": 3 }))
    };
    for closed in [true, false] {
        assert_eq!(job(preset("mask", &chaikin), closed), job(json!({ "preset": "chaikin" }), closed));
    }
}

#[test]
fn two_n_point_schemes_reproduce_polynomials_of_degree_2n_less_1() {
    for n in 1..=16_i32 {
        let outwards = mask(&preset("two-n-point", &json!({ "n": n })));
        assert_eq!(outwards[0], 1.0);
        let power = |x: f64, k: i32| (0..k).fold(1.0, |p, _| p * x);
        if n <= 4 {
            for degree in (0..2 * n).step_by(2) {
                let sum: f64 = (1..=n)
                    .map(|j| {
                        let offset = 2 * j - 1;
                        2.0 * outwards[usize::try_from(offset).unwrap()] * power(f64::from(offset), degree)
                    })
                    .sum();
                let expected = if degree == 0 { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-11, "n = {n}, degree {degree}: {sum}");
            }
        }
    }
    let weights = mask(&preset("two-n-point", &json!({ "n": 4 })));
    assert_eq!([weights[1], weights[3], weights[5], weights[7]].map(|w| w * 2048.0), [1225.0, -245.0, 49.0, -5.0]);
}

#[test]
fn clamped_ends_stay_for_wide_masks_and_odd_arities() {
    let zigzag = json!([[0, 0], [1, 2], [3, -1], [4, 1]]);
    let plans = [
        (2, preset("two-n-point", &json!({ "n": 8 }))),
        (3, preset("ternary-c4", &json!({}))),
        (3, json!({ "word": "U3AA" })),
        (3, json!({ "word": "U3C" })),
        (4, json!({ "word": "U4AA" })),
    ];
    for (arity, plan) in plans {
        let job = json!({ "input": { "polygon": { "points": zigzag } }, "plan": plan, "levels": 2 });
        let found: Vec<[f64; 2]> = serde_json::from_value(json(job)["points"].clone()).unwrap();
        assert_eq!(found.len(), arity * arity * 3 + 1, "{plan}");
        assert_eq!((found[0], found[found.len() - 1]), ([0.0, 0.0], [4.0, 1.0]), "{plan}");
    }
    let dual = json!({ "input": { "polygon": { "points": zigzag } }, "plan": { "word": "U4A" }, "levels": 2 });
    let found: Vec<[f64; 2]> = serde_json::from_value(json(dual)["points"].clone()).unwrap();
    assert_eq!((found[0], found[found.len() - 1]), ([0.0, 0.0], [4.0, 1.0]));
}

#[test]
fn a_needs_an_upsampling() {
    let job = json!({
        "input": { "polygon": { "points": [[0], [1], [2]], "closed": true } },
        "plan": { "word": "A" }, "levels": 1, "outputs": [{ "format": "json" }],
    });
    let faults = crate::support::render(&job).unwrap_err();
    assert_eq!(faults[0].pointer, "/plan/word");
    assert!(faults[0].detail.starts_with("A needs a U before it"));
}
