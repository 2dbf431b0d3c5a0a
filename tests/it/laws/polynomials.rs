//! Polynomials: the degrees up to which a scheme maps polynomials to polynomials (generation), and to themselves
//! (reproduction). Both agree with the stated degrees exactly.

use planish::scheme::preset::Refines;
use planish::scheme::presets::PRESETS;
use serde_json::{Value, json};

use super::refined;

/// Number of points of the closed polygon; the result is checked away from its seam.
const N: u32 = 41;
const MIDDLE: f64 = 20.0;
/// Divisor of parameters, so that powers remain near 1 within reach of masks of 12 points.
const SCALE: f64 = 8.0;
/// A few roundings of sums of a dozen numbers below 100.
const TOLERANCE: f64 = 1e-12;

fn power(x: f64, degree: u32) -> f64 {
    (0..degree).fold(1.0, |product, _| product * x)
}

/// Returns the index of the first point near the middle after one level of a power, the arity, and the points.
fn images(plan: &Value, degree: u32) -> (u32, u32, Vec<f64>) {
    let points: Vec<[f64; 1]> = (0..N).map(|i| [power((f64::from(i) - MIDDLE) / SCALE, degree)]).collect();
    let found = refined(&points, true, plan, 1);
    let arity = u32::try_from(found.len()).expect("few points") / N;
    let range = 16 * arity..=24 * arity;
    (16 * arity, arity, range.map(|j| found[j as usize][0]).collect())
}

/// Whether the points lie on a polynomial of the degree: their differences of the next order are 0.
fn generates(plan: &Value, degree: u32) -> bool {
    let (_, _, mut differences) = images(plan, degree);
    for _ in 0..=degree {
        differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    // each difference may double the rounding error
    differences.iter().all(|d| d.abs() <= TOLERANCE * power(2.0, degree))
}

/// Whether the points are those of the power itself, at the parameters that the scheme gives for a line.
fn reproduces(plan: &Value, degree: u32) -> bool {
    let (first, arity, line) = images(plan, 1);
    let even = |j: u32| (f64::from(j) / f64::from(arity) - MIDDLE) / SCALE;
    let shift = line[0] - even(first);
    let (_, _, found) = images(plan, degree);
    (first..).zip(found).all(|(j, x)| (x - power(even(j) + shift, degree)).abs() <= TOLERANCE)
}

/// Checks the highest degrees of generation and reproduction.
fn check(plan: &Value, generation: u32, reproduction: u32) {
    for degree in 0..=generation + 1 {
        assert_eq!(generates(plan, degree), degree <= generation, "{plan} generates degree {degree}");
    }
    for degree in 0..=reproduction + 1 {
        assert_eq!(reproduces(plan, degree), degree <= reproduction, "{plan} reproduces degree {degree}");
    }
}

fn preset(name: &str, parameters: &Value) -> Value {
    json!({ "preset": name, "parameters": parameters })
}

#[test]
fn b_splines_generate_their_degree_and_reproduce_lines() {
    check(&preset("chaikin", &json!({})), 2, 1);
    check(&preset("cubic-b-spline", &json!({})), 3, 1);
    for degree in 1..=6 {
        check(&preset("b-spline", &json!({ "degree": degree })), degree, 1);
    }
    for (arity, degree) in [(2, 3), (3, 1), (3, 2), (3, 4), (4, 3), (5, 2), (8, 2)] {
        check(&preset("d-ary-b-spline", &json!({ "arity": arity, "degree": degree })), degree, 1);
    }
    for (name, degree) in ["linear", "quadratic", "cubic", "quartic", "quintic"].into_iter().zip(1..) {
        check(&preset(&format!("ternary-{name}"), &json!({})), degree, 1);
    }
}

/// Sine and cosine replace two of the powers of a B-spline's degree.
#[test]
fn schemes_for_circles_keep_two_powers_less() {
    for degree in 3..=6 {
        check(&preset("c-b-spline", &json!({ "degree": degree, "alpha": 1 })), degree - 2, 1);
        check(&preset("c-b-spline", &json!({ "degree": degree, "alpha": 0 })), degree, 1);
    }
    for (arity, averages) in [(2, 2), (3, 2), (3, 4), (4, 3)] {
        let plan = |alpha: f64| json!({ "arity": arity, "averages": averages, "alpha": alpha });
        check(&preset("d-ary-circle", &plan(1.0)), averages - 1, 1);
        check(&preset("d-ary-circle", &plan(0.0)), averages + 1, 1);
    }
    let parameters =
        json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5, "k": 2 });
    check(&preset("push-back", &parameters), 1, 1);
}

#[test]
fn push_back_generates_cubics_for_every_delta_and_reproduces_them_for_delta_1() {
    // the quintic B-spline
    check(&preset("push-back", &json!({ "delta": -0.5 })), 5, 1);
    for delta in [-0.1, 0.25, 0.5] {
        check(&preset("push-back", &json!({ "delta": delta })), 3, 1);
    }
    check(&preset("push-back", &json!({})), 3, 3);
    check(&preset("push-back", &json!({ "kernel": 2, "compensation": 1 })), 1, 1);
    check(&preset("push-back", &json!({ "kernel": 2, "compensation": 1.5 })), 3, 3);
}

#[test]
fn interpolating_schemes_reproduce_what_they_generate() {
    check(&preset("four-point", &json!({})), 3, 3);
    check(&preset("four-point", &json!({ "w": "1/20" })), 1, 1);
    for n in 1..=5 {
        check(&preset("two-n-point", &json!({ "n": n })), 2 * n - 1, 2 * n - 1);
    }
    check(&preset("ternary-three-point", &json!({ "alpha": "1/4" })), 1, 1);
    check(&preset("ternary-three-point", &json!({ "alpha": "2/9" })), 2, 2);
    check(&preset("ternary-four-point", &json!({ "mu": "1/11" })), 2, 2);
    let cubic = json!({ "mask": ["-1/16", 0, "9/16", 1, "9/16", 0, "-1/16"], "first": -3 });
    check(&preset("mask", &cubic), 3, 3);
}

#[test]
fn blending_schemes_have_the_sum_rules_of_their_parameters() {
    let awkward = json!({ "eta": 0.01, "theta": 0.03, "omega": 0.1, "delta": 0.4, "lambda": 0.7 });
    check(&preset("ternary-blending", &awkward), 0, 0);
    let lines = json!({ "eta": 0.01, "theta": 0.03, "omega": 0.1, "delta": 0.4, "lambda": "(2/3-0.1+0.3*0.4)/1.1" });
    check(&preset("ternary-blending", &lines), 1, 1);
    check(&preset("ternary-c4", &json!({ "eta": "1/100" })), 4, 1);
    check(&preset("ternary-c4", &json!({ "eta": "1/243" })), 5, 1);
    let pan = |alpha: &str, beta: &str| preset("ternary-combined-pan", &json!({ "alpha": alpha, "beta": beta }));
    check(&pan("1/2", "3/11"), 2, 1);
    check(&pan("0", "3/11"), 2, 2);
    check(&pan("1/2", "1/9"), 3, 1);
    check(&pan("5/4", "1/9"), 4, 1);
    let rehan = |alpha: &str, beta: &str| preset("ternary-combined-rehan", &json!({ "alpha": alpha, "beta": beta }));
    check(&rehan("1/60", "0"), 3, 3);
    check(&rehan("1/60", "1/7"), 1, 1);
    let novara = |alpha: &str, beta: &str, gamma: &str| {
        preset("ternary-combined-novara", &json!({ "alpha": alpha, "beta": beta, "gamma": gamma }))
    };
    check(&novara("1/30", "1/40", "1/50"), 1, 1);
    check(&novara("-9/200", "1/40", "1/50"), 2, 1);
    check(&novara("-2/27", "5/81", "1/81"), 4, 1);
}

/// For a new scheme, add its behaviour on polynomials here.
#[test]
fn no_curve_scheme_is_left_out() {
    let known = [
        "chaikin",
        "cubic-b-spline",
        "b-spline",
        "c-b-spline",
        "four-point",
        "two-n-point",
        "d-ary-b-spline",
        "d-ary-circle",
        "ternary-blending",
        "ternary-c4",
        "ternary-linear",
        "ternary-quadratic",
        "ternary-cubic",
        "ternary-quartic",
        "ternary-quintic",
        "ternary-three-point",
        "ternary-four-point",
        "ternary-combined-pan",
        "ternary-combined-rehan",
        "ternary-combined-novara",
        "mask",
        "push-back",
    ];
    let curves = PRESETS.iter().filter(|preset| preset.refines != Refines::Meshes).map(|preset| preset.name);
    let others: Vec<_> = curves.filter(|name| !known.contains(name)).collect();
    assert_eq!(others, ["incenter"], "incenter is not linear; straight points stay straight, evenly spaced or not");
}
