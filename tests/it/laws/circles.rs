//! Regular polygons become circles with kernel cos(alpha/2), compensation 1/cos(alpha/2) and alpha = 2 pi / K.

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use super::{refined, semi_stationary};

/// Tolerance relative to the unit radius: the rounding of about ten operators per level.
const TOLERANCE: f64 = 1e-12;

fn regular_polygon(k: u32, winding: u32) -> Vec<[f64; 2]> {
    let angle = |i: u32| 2.0 * std::f64::consts::PI * f64::from(winding * i) / f64::from(k);
    (0..k).map(|i| [cos(angle(i)), sin(angle(i))]).collect()
}

/// Returns the common radius of all points after `levels` levels.
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

/// Returns the radius after the levels: `prod_h (g + delta (1 - g))`, `g = cos(a/2) cos(a/4)^(2(k-1))`, with a halved
/// each time.
fn radius(alpha: f64, averages: u32, delta: f64, levels: u32) -> f64 {
    let mut alpha = alpha;
    (0..levels).fold(1.0, |radius, _| {
        let g = (1..averages).fold(cos(alpha / 2.0), |g, _| g * cos(alpha / 4.0) * cos(alpha / 4.0));
        alpha /= 2.0;
        radius * (g + delta * (1.0 - g))
    })
}

#[test]
fn regular_polygons_that_are_stretched_become_ellipses() {
    let image = |[x, y]: [f64; 2]| [3.0 * x + 1.5 * y - 4.0, -0.5 * x + 0.75 * y + 2.0];
    for (k, winding, averages) in [(3, 1, 1), (5, 1, 2), (8, 1, 1), (7, 2, 1)] {
        for delta in [0.0, 0.5, 1.0] {
            let polygon: Vec<[f64; 2]> = regular_polygon(k, winding).into_iter().map(image).collect();
            let plan = semi_stationary(&format!("UC^{averages}P"), &format!("2*pi*{winding}/{k}"), delta);
            let points = refined(&polygon, true, &plan, 5);
            let alpha = 2.0 * std::f64::consts::PI * f64::from(winding) / f64::from(k);
            let expected = radius(alpha, averages, delta, 5);
            for (j, p) in (0_u32..).zip(&points) {
                let angle = alpha * f64::from(j) / 32.0;
                let [x, y] = image([expected * cos(angle), expected * sin(angle)]);
                assert!((p[0] - x).abs() <= TOLERANCE && (p[1] - y).abs() <= TOLERANCE, "{plan}: {p:?}, not {x}, {y}");
            }
        }
    }
}

#[test]
fn screwed_polygons_become_helices() {
    const POINTS: u32 = 31;
    const LEVELS: u32 = 4;
    for (k, averages) in [(4, 1), (6, 1), (5, 2)] {
        for delta in [0.0, 0.5, 1.0] {
            let alpha = 2.0 * std::f64::consts::PI / f64::from(k);
            let on_helix = |t: f64, r: f64| [r * cos(alpha * t), r * sin(alpha * t), 0.3 * t];
            let polygon: Vec<[f64; 3]> = (0..POINTS).map(|i| on_helix(f64::from(i), 1.0)).collect();
            let plan = semi_stationary(&format!("UC^{averages}P"), &format!("2*pi/{k}"), delta);
            let points = refined(&polygon, false, &plan, LEVELS);
            let radius = radius(alpha, averages, delta, LEVELS);
            // away from the ends, whose reflections are not helices
            let middle = (10 << LEVELS)..=((POINTS - 11) << LEVELS);
            assert!(middle.clone().count() > 100);
            for j in middle {
                let expected = on_helix(f64::from(j) / f64::from(1 << LEVELS), radius);
                let found = points[j as usize];
                let off = found.iter().zip(expected).fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()));
                assert!(off <= TOLERANCE, "{plan}: {found:?} is not {expected:?}");
            }
        }
    }
}

#[test]
fn circles_are_circles_at_level_10() {
    let circular = json!({ "arity": 2, "averages": 2, "alpha": "2*pi/5", "delta": 0.5 });
    let with_angle = |name: &str, parameters: &Value| json!({ "preset": name, "parameters": parameters });
    for plan in [
        semi_stationary("UCP", "2*pi/5", 0.0),
        semi_stationary("UCP", "2*pi/5", 0.5),
        semi_stationary("UC^2P", "2*pi/5", 1.0),
        with_angle("c-b-spline", &json!({ "degree": 2, "alpha": "2*pi/5" })),
        with_angle("c-b-spline", &json!({ "degree": 3, "alpha": "2*pi/5" })),
        with_angle("c-b-spline", &json!({ "degree": 6, "alpha": "2*pi/5" })),
        with_angle("d-ary-circle", &circular),
        json!({ "preset": "incenter" }),
    ] {
        check(&regular_polygon(5, 1), &plan, 10);
    }
    let ternary = json!({ "arity": 3, "averages": 1, "alpha": "2*pi/3" });
    check(&regular_polygon(3, 1), &with_angle("d-ary-circle", &ternary), 10);
}
