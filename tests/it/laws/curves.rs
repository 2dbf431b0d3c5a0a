//! Identities of curve schemes: two D are one C, levels add up, ends and corners are fixed, delta 1 interpolates.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{refined, refined_polygon, semi_stationary, static_word, word};

fn polygon() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [3.0, 1.0], [2.5, 4.0], [-1.0, 5.0], [-3.0, 2.0], [-2.0, 0.5], [-1.0, -1.25]]
}

fn kernels(text: &str, kernels: &[f64]) -> Value {
    json!({ "word": text, "parameters": { "kernel": kernels, "delta": 0.5 } })
}

fn check_equal(a: &Value, b: &Value, levels: u32) {
    for (closed, ends) in [(true, "clamped"), (false, "clamped"), (false, "natural")] {
        let of = |plan: &Value| {
            let mut plan = plan.clone();
            plan["ends"] = json!(ends);
            refined(&polygon(), closed, &plan, levels)
        };
        let (a_points, b_points) = (of(a), of(b));
        assert_eq!(a_points.len(), b_points.len(), "{a} and {b}, closed {closed}, {ends}");
        for (p, q) in a_points.as_flattened().iter().zip(b_points.as_flattened()) {
            assert!((p - q).abs() <= 1e-13, "{a} and {b}, closed {closed}, {ends}: {p} and {q}");
        }
    }
}

/// A list of kernels prevents the two D from being merged, so that both sides are really computed.
#[test]
fn two_duals_are_one_average_point_for_point() {
    for f in [1.0, 1.5, 0.25] {
        for levels in 1..=2 {
            check_equal(&kernels("UDD", &[f, 1.0]), &kernels("UC", &[f]), levels);
            check_equal(&kernels("UDDDD", &[f, 1.0]), &kernels("UCC", &[f]), levels);
        }
        check_equal(&kernels("UDDD", &[f, 1.0]), &kernels("UCD", &[f]), 1);
        check_equal(&kernels("UDC", &[f]), &kernels("UCD", &[f]), 1);
        check_equal(&kernels("UDC", &[f]), &kernels("UDDD", &[f, 1.0, 1.0]), 2);
    }
    check_equal(&kernels("DD(U)", &[1.0, 1.0]), &kernels("C(U)", &[1.0]), 1);
}

#[test]
fn push_back_sees_two_duals_as_one_average() {
    for closed in [true, false] {
        let [duals, average] =
            [kernels("UDDP", &[1.5, 1.0]), kernels("UCP", &[1.5])].map(|plan| refined(&polygon(), closed, &plan, 2));
        for (p, q) in duals.as_flattened().iter().zip(average.as_flattened()) {
            assert!((p - q).abs() <= 1e-13, "{p} and {q}");
        }
        assert_eq!(duals.len(), average.len());
    }
}

#[test]
fn levels_add_up_for_static_words() {
    for plan in [word("UC"), word("UCP"), static_word("UCCP"), static_word("UC"), word("U")] {
        for closed in [true, false] {
            for (first, second) in [(1, 1), (1, 2), (2, 1)] {
                let halfway = refined(&polygon(), closed, &plan, first);
                let whole = refined(&polygon(), closed, &plan, first + second);
                assert_eq!(refined(&halfway, closed, &plan, second), whole, "{plan} closed {closed}");
            }
        }
    }
}

#[test]
fn levels_add_up_for_dual_words_on_closed_polygons() {
    for plan in [word("UD"), static_word("UDDD"), word("UUCPD")] {
        let halfway = refined(&polygon(), true, &plan, 1);
        assert_eq!(refined(&halfway, true, &plan, 1), refined(&polygon(), true, &plan, 2), "{plan}");
    }
}

/// alpha is halved after a level, so that the rest of a semi-stationary plan starts at half of it.
#[test]
fn levels_add_up_for_semi_stationary_words_when_alpha_goes_on() {
    let plan = |alpha: &str| semi_stationary("UCP", alpha, 0.5);
    let halfway = refined(&polygon(), true, &plan("2*pi/7"), 1);
    assert_eq!(refined(&halfway, true, &plan("pi/7"), 2), refined(&polygon(), true, &plan("2*pi/7"), 3));
}

#[test]
fn clamped_ends_stay_exactly() {
    let mut plans: Vec<Value> =
        ["U", "UD", "UC", "UDDD", "UCP", "UUCPD(UC)", "D(UC)", "UUCPD", "UDCD"].map(word).into();
    plans.extend(["UC", "UCP", "UD", "UUCPD"].map(static_word));
    plans.push(semi_stationary("UCP", "pi/4", 0.5));
    for plan in plans {
        for levels in 0..=3 {
            let points = refined(&polygon(), false, &plan, levels);
            assert_eq!(points.first(), polygon().first(), "{plan} at level {levels}");
            assert_eq!(points.last(), polygon().last(), "{plan} at level {levels}");
        }
    }
}

#[test]
fn corners_stay_exactly() {
    for closed in [true, false] {
        let input = json!({ "points": polygon(), "closed": closed, "corners": [2, 5] });
        for plan in [word("UC"), word("UCP"), static_word("UCCP"), semi_stationary("UCP", "pi/3", 0.5)] {
            for levels in 0..=3 {
                let points: Vec<[f64; 2]> = refined_polygon(&input, &plan, levels);
                for corner in [2, 5] {
                    assert_eq!(points.get(corner << levels), polygon().get(corner), "{plan} at level {levels}");
                }
            }
        }
    }
}

#[test]
fn a_corner_splits_a_curve_into_two_clamped_ones() {
    let input = json!({ "points": polygon(), "corners": [3] });
    for plan in [word("UC"), word("UCP"), static_word("UCCP")] {
        let whole: Vec<[f64; 2]> = refined_polygon(&input, &plan, 1);
        let (left, right) = (refined(&polygon()[..4], false, &plan, 1), refined(&polygon()[3..], false, &plan, 1));
        let joined: Vec<[f64; 2]> = left.iter().chain(&right[1..]).copied().collect();
        assert_eq!(whole.len(), joined.len());
        for (p, q) in whole.as_flattened().iter().zip(joined.as_flattened()) {
            assert!((p - q).abs() <= 1e-14, "{plan}: {whole:?} and {joined:?}");
        }
    }
}

#[test]
fn delta_one_interpolates() {
    for closed in [true, false] {
        for plan in [word("UCP"), word("UCCP"), semi_stationary("UCP", "1", 1.0), semi_stationary("UCCCP", "9.05", 1.0)]
        {
            let points = refined(&polygon(), closed, &plan, 3);
            for (i, p) in polygon().iter().enumerate() {
                let child = points[i * 8];
                assert!((child[0] - p[0]).abs() <= 1e-13 && (child[1] - p[1]).abs() <= 1e-13, "{plan}: {child:?}");
            }
        }
    }
}

#[test]
fn natural_ends_keep_only_points_whose_stencil_exists() {
    let ends = |text: &str| json!({ "word": text, "ends": "natural" });
    let n = polygon().len();
    for (text, expected) in [("U", 2 * n - 1), ("UD", 2 * n - 2), ("UC", 2 * n - 3), ("UDDD", 2 * n - 4)] {
        let open = refined(&polygon(), false, &ends(text), 1);
        let closed = refined(&polygon(), true, &word(text), 1);
        assert_eq!(open.len(), expected, "{text}");
        // they are points of the closed curve through the same control points, far from its seam
        assert!(closed.windows(expected).any(|window| window == open), "{text}: {open:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// Reversing a polygon reverses its curve.
    #[test]
    fn curves_have_no_preferred_direction(
        points in proptest::collection::vec(proptest::array::uniform2(-10.0..10.0_f64), 3..9),
    ) {
        let reversed: Vec<[f64; 2]> = points.iter().rev().copied().collect();
        for plan in [word("UC"), word("UD"), word("UCP"), static_word("UCCP"), static_word("UDCD"), word("UUCPD")] {
            let mut there = refined(&points, false, &plan, 2);
            there.reverse();
            let back = refined(&reversed, false, &plan, 2);
            prop_assert_eq!(there.len(), back.len());
            for (p, q) in there.as_flattened().iter().zip(back.as_flattened()) {
                prop_assert!((p - q).abs() <= 1e-12, "{}: {} and {}", plan, p, q);
            }
        }
    }
}

#[test]
fn rational_points_are_divided_by_their_weight() {
    let plan = json!({ "preset": "cubic-b-spline" });
    let run = |polygon: Value| {
        crate::support::json(json!({ "input": { "polygon": polygon }, "plan": plan, "levels": 3 }))["points"].clone()
    };
    let plain = run(json!({ "points": [[0, 0], [2, 1], [3, 5], [-1, 4]], "closed": true }));
    let weighted = [[0, 0, 4], [8, 4, 4], [12, 20, 4], [-4, 16, 4]];
    assert_eq!(run(json!({ "points": weighted, "closed": true, "rational": true })), plain);
    let uneven =
        run(json!({ "points": [[0, 0, 1], [2, 1, 1], [6, 10, 2], [-1, 4, 1]], "closed": true, "rational": true }));
    assert_ne!(uneven, plain);
    assert_eq!(uneven[0].as_array().map(Vec::len), Some(2));
}

#[test]
fn an_average_is_two_duals_after_higher_arities_too() {
    let parameters = json!({ "alpha": 1, "kernel": "2*cos(alpha/2)" });
    for (duals, average) in [("UDD", "UC"), ("U3DD", "U3C"), ("U5DD", "U5C")] {
        // a list of kernels prevents the two D from being merged
        let list = json!({ "alpha": 1, "kernel": ["2*cos(alpha/2)", 1] });
        let points = [[0.0, 0.0], [2.0, 1.0], [3.0, 5.0], [-1.0, 4.0]];
        let a = refined(&points, true, &json!({ "word": duals, "parameters": list }), 2);
        let b = refined(&points, true, &json!({ "word": average, "parameters": parameters }), 2);
        for (p, q) in a.iter().zip(&b) {
            assert!((p[0] - q[0]).abs() < 1e-14 && (p[1] - q[1]).abs() < 1e-14, "{duals}: {p:?} {q:?}");
        }
    }
}

#[test]
fn equal_parameters_of_points_are_those_of_the_plan() {
    let plan = |parameters: Value| json!({ "word": "UCP", "parameters": parameters });
    let run = |points: Value, plan: Value, closed: bool| {
        let polygon = json!({ "points": [[0, 0], [2, 1], [3, 5], [-1, 4]], "closed": closed, "parameters": points });
        let points = crate::support::json(json!({ "input": { "polygon": polygon }, "plan": plan, "levels": 3 }));
        serde_json::from_value::<Vec<[f64; 2]>>(points["points"].clone()).unwrap()
    };
    for closed in [true, false] {
        let own = run(json!({ "kernel": [2, 2, 2, 2], "delta": [0.5, 0.5, 0.5, 0.5] }), plan(json!({})), closed);
        let of_plan = run(json!({}), plan(json!({ "kernel": 2, "delta": 0.5 })), closed);
        let functions = json!({ "kernel": "2*cos(alpha/2)", "compensation": "1/cos(alpha/2)" });
        let by_alpha = run(json!({ "alpha": [1, 1, 1, 1] }), plan(functions.clone()), closed);
        let mut with_alpha = functions;
        with_alpha["alpha"] = json!(1);
        for (a, b) in [(own, of_plan), (by_alpha, run(json!({}), plan(with_alpha), closed))] {
            let close = |(p, q): (&[f64; 2], &[f64; 2])| (p[0] - q[0]).abs() < 1e-14 && (p[1] - q[1]).abs() < 1e-14;
            assert!(a.len() == b.len() && a.iter().zip(&b).all(close));
        }
    }
}

#[test]
fn parameters_of_points_are_refused_where_nothing_uses_them() {
    for (plan, says) in [("UD", "D cannot carry parameters of points"), ("U3A", "")] {
        let job = json!({
            "input": { "polygon": {
                "points": [[0], [1], [2]], "closed": true, "parameters": { "kernel": [1, 1, 1] },
            } },
            "plan": { "word": plan }, "levels": 1, "outputs": [{ "format": "json" }],
        });
        let refused = crate::support::render(&job).err();
        assert!(says.is_empty() == refused.is_none(), "{plan}: {refused:?}");
        assert!(refused.is_none_or(|faults| faults[0].detail.contains(says)));
    }
    let job = json!({
        "input": { "polygon": { "points": [[0], [1], [2]], "closed": true, "parameters": { "delta": [1, 1] } } },
        "plan": { "word": "UCP" }, "levels": 1, "outputs": [{ "format": "json" }],
    });
    let faults = crate::support::render(&job).unwrap_err();
    assert_eq!(faults[0].pointer, "/input/polygon/parameters/delta");
}

/// n points, arity d, a mask of w + 1 entries: `d (n-1) + 1` clamped and primal, `d (n-1) + 2`, then `d (n-2) + 2`
/// clamped and dual, `d (n+1) - 1 - w` natural, `d n` closed.
#[test]
fn ends_give_the_counts_that_are_told_of_them() {
    let counts = |plan: &Value, closed: bool, ends: &str| {
        let mut plan = plan.clone();
        plan["ends"] = json!(ends);
        [1, 2].map(|levels| refined(&polygon(), closed, &plan, levels).len())
    };
    let preset = |name: &str, parameters: Value| json!({ "preset": name, "parameters": parameters });
    let narrow = json!({ "mask": ["1/3", "2/3", "2/3", "1/3"], "first": -2 });
    for (plan, d, w, dual) in [
        (word("UC"), 2, 4, false),
        (preset("b-spline", json!({ "degree": 2 })), 2, 3, true),
        (preset("mask", narrow), 2, 3, true),
        (preset("d-ary-b-spline", json!({ "arity": 4, "degree": 2 })), 4, 9, true),
        (preset("d-ary-b-spline", json!({ "arity": 3, "degree": 2 })), 3, 6, false),
        (preset("ternary-quartic", json!({})), 3, 10, false),
        (preset("two-n-point", json!({ "n": 3 })), 2, 10, false),
    ] {
        let n = polygon().len();
        assert_eq!(counts(&plan, true, "natural"), [d * n, d * d * n], "{plan}");
        let clamped =
            if dual { [d * (n - 1) + 2, d * d * (n - 1) + 2] } else { [d * (n - 1) + 1, d * d * (n - 1) + 1] };
        assert_eq!(counts(&plan, false, "clamped"), clamped, "{plan}");
        if w == 10 && d == 2 {
            continue; // after one level too few points are left for another
        }
        let natural = d * (n + 1) - 1 - w;
        assert_eq!(counts(&plan, false, "natural"), [natural, d * (natural + 1) - 1 - w], "{plan}");
    }
}
