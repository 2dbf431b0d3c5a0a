//! Regular polygons become circles with kernel cos(alpha/2), compensation 1/cos(alpha/2) and alpha = 2 pi / K.

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use super::{refined, semi_stationary};

/// Rounding of about ten operators a level leaves this much of the unit radius.
const TOLERANCE: f64 = 1e-12;

fn regular_polygon(k: u32, winding: u32) -> Vec<[f64; 2]> {
    let angle = |i: u32| 2.0 * std::f64::consts::PI * f64::from(winding * i) / f64::from(k);
    (0..k).map(|i| [cos(angle(i)), sin(angle(i))]).collect()
}

/// The common radius of all points after `levels` levels.
fn check(polygon: &[[f64; 2]], plan: &Value, levels: u32) -> f64 {
    let points = refined(polygon, true, plan, levels);
    let radii: Vec<f64> = points.iter().map(|[x, y]| sqrt(x * x + y * y)).collect();
    assert!(radii[0] > 0.1, "{plan}: the circle has collapsed to {}", radii[0]);
    for radius in &radii {
        assert!((radius - radii[0]).abs() <= TOLERANCE, "{plan}, level {levels}: {radius} is not {}", radii[0]);
    }
    radii[0]
}

#[test]
fn circles_stay_circles() {
    for k in 3..=12 {
        for delta in [0.0, 0.5, 1.0] {
            for levels in 1..=6 {
                let plan = semi_stationary("UCP", &format!("2*pi/{k}"), delta);
                let radius = check(&regular_polygon(k, 1), &plan, levels);
                assert!(delta < 1.0 || (radius - 1.0).abs() <= TOLERANCE, "delta 1 keeps the radius, not {radius}");
            }
        }
    }
}

#[test]
fn circles_stay_circles_for_every_number_of_averages() {
    for (k, averages) in [(3, 2), (4, 3), (5, 2), (7, 4)] {
        for delta in [0.0, 0.5, 1.0] {
            check(&regular_polygon(k, 1), &semi_stationary(&format!("UC^{averages}P"), &format!("2*pi/{k}"), delta), 5);
        }
    }
}

#[test]
fn star_polygons_become_circles_too() {
    for (k, winding) in [(5, 2), (7, 2), (7, 3), (9, 4)] {
        for delta in [0.0, 0.5, 1.0] {
            let plan = semi_stationary("UCP", &format!("2*pi*{winding}/{k}"), delta);
            check(&regular_polygon(k, winding), &plan, 5);
        }
    }
}

/// After each level the radius is `R cos(a/2) cos(a/4)^(degree - 3)`, with a halved afterwards.
#[test]
fn c_b_splines_of_circles_are_circles() {
    for k in 3..=12 {
        for degree in 2..=5 {
            let plan = json!({ "preset": "c-b-spline", "parameters": {
                "degree": degree, "alpha": format!("2*pi/{k}"),
            } });
            let mut expected = 1.0;
            for levels in 1..=6_u32 {
                let alpha = 2.0 * std::f64::consts::PI / f64::from(k) / f64::from(1 << (levels - 1));
                expected *= cos(alpha / 2.0);
                match degree {
                    2 => expected /= cos(alpha / 4.0),
                    degree => (3..degree).for_each(|_| expected *= cos(alpha / 4.0)),
                }
                let radius = check(&regular_polygon(k, 1), &plan, levels);
                assert!((radius - expected).abs() <= TOLERANCE, "K {k}, degree {degree}: {radius} is not {expected}");
            }
        }
    }
}

#[test]
fn a_wrong_alpha_gives_no_circle() {
    let points = refined(&regular_polygon(5, 1), true, &semi_stationary("UCP", "2*pi/6", 0.5), 3);
    let radii: Vec<f64> = points.iter().map(|[x, y]| sqrt(x * x + y * y)).collect();
    let spread = radii.iter().fold(0.0, |most: f64, r| most.max((r - radii[0]).abs()));
    assert!(spread > 1e-4, "{spread}");
}

#[test]
fn d_ary_circle_schemes_keep_circles_for_every_arity_and_delta() {
    for arity in 2..=8 {
        for (k, averages, delta) in [(3, 0, 0.0), (3, 2, 0.5), (5, 2, 1.0), (6, 4, -0.1), (12, 1, 0.0)] {
            let plan = json!({ "preset": "d-ary-circle", "parameters": {
                "arity": arity, "averages": averages, "alpha": format!("2*pi/{k}"), "delta": delta,
            } });
            let radius = check(&regular_polygon(k, 1), &plan, if arity < 5 { 4 } else { 2 });
            assert!(delta < 1.0 || (radius - 1.0).abs() <= TOLERANCE, "delta 1 keeps the radius, not {radius}");
        }
    }
}

#[test]
fn the_compensation_may_have_an_alpha_of_its_own() {
    let square = regular_polygon(4, 1);
    let plan = |parameters: Value| json!({ "word": "UCP", "parameters": parameters });
    let both = plan(json!({ "alpha": "pi/2", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)" }));
    let split = plan(json!({
        "alpha": "pi/2", "compensation_alpha": "pi/4", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha)",
    }));
    for (a, b) in refined(&square, true, &both, 3).iter().zip(refined(&square, true, &split, 3)) {
        assert!((a[0] - b[0]).abs() < 1e-14 && (a[1] - b[1]).abs() < 1e-14);
    }
}
