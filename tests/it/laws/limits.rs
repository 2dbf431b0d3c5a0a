//! Limit points and tangents of curves, and their discrete curvature.

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use crate::support::{faults, render};

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];

/// Returns the JSON output with options.
fn with(options: &Value, polygon: &Value, plan: &Value, levels: u32) -> Value {
    let mut output = json!({ "format": "json" });
    for (name, value) in options.as_object().expect("options are an object") {
        output[name] = value.clone();
    }
    let job = json!({ "input": { "polygon": polygon }, "plan": plan, "levels": levels, "outputs": [output] });
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    serde_json::from_slice(&bytes).expect("the output is JSON")
}

fn array<const D: usize>(result: &Value, name: &str) -> Vec<[f64; D]>
where
    [f64; D]: serde::de::DeserializeOwned,
{
    serde_json::from_value(result[name].clone()).unwrap_or_else(|error| panic!("{name} of {result}: {error}"))
}

fn limit(polygon: &Value, plan: &Value, levels: u32) -> Vec<[f64; 2]> {
    array(&with(&json!({ "positions": "limit" }), polygon, plan, levels), "points")
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]))
}

fn wobbly(n: u32) -> Vec<[f64; 2]> {
    let point = |i: u32| {
        let t = f64::from(i);
        [cos(t) * (2.0 + sin(3.0 * t)), sin(1.3 * t) + 0.2 * t]
    };
    (0..n).map(point).collect()
}

/// Returns plans with limits, whose limit rows have various widths.
fn plans() -> Vec<Value> {
    let push = |alpha: &str, delta: f64, k: u32| {
        json!({ "preset": "push-back", "parameters": {
            "alpha": alpha, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": delta, "k": k,
        } })
    };
    let mut plans = vec![push("pi/3", 0.0, 1), push("pi/3", 0.5, 1), push("1", 1.0, 1), push("0", -0.1, 2)];
    plans.extend(["UC", "UCP", "UCC", "U3AA", "UUCPD(UC)"].map(|word| json!({ "word": word })));
    // the first two levels equal the last ones
    plans.push(json!({ "word": "UC", "parameters": { "kernel": "2+cos(alpha)", "alpha": "4*pi" } }));
    let presets = ["chaikin", "ternary-quadratic", "ternary-quartic", "ternary-quintic", "four-point"];
    plans.extend(presets.map(|preset| json!({ "preset": preset })));
    plans.push(json!({ "preset": "b-spline", "parameters": { "degree": 6 } }));
    plans.push(json!({ "preset": "c-b-spline", "parameters": { "degree": 4, "alpha": "pi/4" } }));
    plans.push(json!({ "preset": "two-n-point", "parameters": { "n": 4 } }));
    plans.push(json!({ "preset": "d-ary-b-spline", "parameters": { "arity": 4, "degree": 3 } }));
    plans.push(json!({ "preset": "d-ary-circle", "parameters": { "arity": 3, "averages": 3, "alpha": "pi/5" } }));
    plans.push(json!({ "preset": "ternary-four-point", "parameters": { "mu": "1/11" } }));
    plans
}

#[test]
fn b_splines_have_the_limit_points_of_their_basis_functions() {
    let square = json!({ "points": SQUARE, "closed": true });
    // the neighbours of the corner (0, 0) are (0, 4) and (4, 0)
    for (degree, side) in [(2, 1.0 / 8.0), (3, 1.0 / 6.0)] {
        let plan = json!({ "preset": "b-spline", "parameters": { "degree": degree } });
        let points = limit(&square, &plan, 0);
        assert!(distance(points[0], [4.0 * side, 4.0 * side]) < 1e-14, "degree {degree}: {:?}", points[0]);
    }
    // quartic: 1, 76, 230, 76, 1 over 384; quintic: 1, 26, 66, 26, 1 over 120
    for (degree, side) in [(4, 76.0 / 384.0), (5, 26.0 / 120.0)] {
        let far = if degree == 4 { 1.0 / 384.0 } else { 1.0 / 120.0 };
        let plan = json!({ "preset": "b-spline", "parameters": { "degree": degree } });
        let points = limit(&square, &plan, 0);
        let expected = 4.0 * side + 8.0 * far;
        assert!(distance(points[0], [expected, expected]) < 1e-14, "degree {degree}: {:?}", points[0]);
    }
}

/// The closed form of the limit mask of the static push-back with one average.
#[test]
fn static_push_back_has_its_closed_limit_mask() {
    for (f, w, d) in [(1.0, 1.0, 0.0), (1.0, 1.0, 0.5), (2.0, 1.5, 0.8), (1.2, 0.7, -0.2), (0.6, 1.0, 1.0)] {
        let sum = 4.0 * f * f + 11.0 * f + 6.0 - 3.0 * d * f - d - d * d + d * w * (d + f);
        let (far, near) = (-d * w * (1.0 - d) / (4.0 * sum), (1.0 - d) * (3.0 + d + 4.0 * f) / (2.0 * sum));
        let plan = json!({ "preset": "push-back", "parameters": { "kernel": f, "compensation": w, "delta": d } });
        let mut points = vec![[0.0, 0.0]; 9];
        points[4][0] = 1.0;
        let result = limit(&json!({ "points": points, "closed": true }), &plan, 0);
        let expected = [0.0, 0.0, far, near, 1.0 - 2.0 * (near + far), near, far, 0.0, 0.0];
        for (point, expected) in result.iter().zip(expected) {
            assert!((point[0] - expected).abs() < 1e-14, "{plan}: {} is not {expected}", point[0]);
        }
    }
}

#[test]
fn limit_points_are_where_many_more_levels_lead() {
    for plan in plans() {
        for (closed, n) in [(true, 5), (false, 7)] {
            let polygon = json!({ "points": wobbly(n), "closed": closed });
            let limit = limit(&polygon, &plan, 1);
            let deep = limit_of_deep(&polygon, &plan);
            for (i, point) in limit.iter().enumerate() {
                let ends = deep.iter().zip(deep.iter().cycle().skip(1)).take(deep.len() - usize::from(!closed));
                let near = ends.map(|(a, b)| to_segment(*point, *a, *b)).fold(f64::INFINITY, f64::min);
                assert!(near < 1e-4, "{plan}, closed {closed}: limit point {i} is {near} from the curve");
            }
        }
    }
}

fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1])).clamp(0.0, 1.0);
    distance(p, [a[0] + t * u[0], a[1] + t * u[1]])
}

fn limit_of_deep(polygon: &Value, plan: &Value) -> Vec<[f64; 2]> {
    let arity = if plan.to_string().contains("ternary") { 3 } else { 2 };
    let levels = if arity == 3 || plan.to_string().contains("arity") { 5 } else { 8 };
    array(&with(&json!({}), polygon, plan, levels), "points")
}

#[test]
fn limit_points_stay_under_one_more_level() {
    for plan in plans() {
        let polygon = json!({ "points": wobbly(11), "closed": true });
        let (coarse, fine) = (limit(&polygon, &plan, 2), limit(&polygon, &plan, 3));
        let is_primal = coarse.iter().all(|p| fine.iter().any(|q| distance(*p, *q) < 1e-12));
        let text = plan.to_string();
        let dual = ["chaikin", "quadratic", "quartic", "\"degree\":6", "\"degree\":4", "arity"];
        assert!(is_primal || dual.iter().any(|part| text.contains(part)), "{plan}: limit points moved");
    }
}

#[test]
fn interpolating_schemes_leave_points_where_they_are() {
    for plan in [json!({ "preset": "four-point" }), json!({ "preset": "two-n-point", "parameters": { "n": 6 } })] {
        let polygon = json!({ "points": wobbly(8), "closed": false });
        let refined: Vec<[f64; 2]> = array(&with(&json!({}), &polygon, &plan, 2), "points");
        for (a, b) in limit(&polygon, &plan, 2).iter().zip(&refined) {
            assert!(distance(*a, *b) < 1e-14);
        }
    }
}

#[test]
fn tangents_of_circles_are_at_right_angles_to_the_radius() {
    for (k, delta) in [(3, 0.0), (5, 0.5), (8, 1.0)] {
        let turn = |i: u32| 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(k);
        let points: Vec<[f64; 2]> = (0..k).map(|i| [cos(turn(i)), sin(turn(i))]).collect();
        let plan = super::semi_stationary("UCP", &format!("2*pi/{k}"), delta);
        let options = json!({ "positions": "limit", "tangents": true, "discrete_curvature": true });
        let result = with(&options, &json!({ "points": points, "closed": true }), &plan, 3);
        let (points, tangents) = (array::<2>(&result, "points"), array::<2>(&result, "tangents"));
        let radius = sqrt(points[0][0] * points[0][0] + points[0][1] * points[0][1]);
        for (p, t) in points.iter().zip(&tangents) {
            assert!((t[0] + p[1] / radius).abs() < 1e-12 && (t[1] - p[0] / radius).abs() < 1e-12, "{p:?} {t:?}");
        }
        for curvature in result["discrete_curvature"].as_array().expect("an array") {
            let curvature = curvature.as_f64().expect("a number");
            assert!((curvature - 1.0 / radius).abs() < 1e-10, "{curvature} is not {}", 1.0 / radius);
        }
    }
}

/// Two adjacent points of a deep refinement give the direction of the tangent.
#[test]
fn tangents_are_the_directions_of_a_deep_refinement() {
    for plan in plans() {
        for closed in [true, false] {
            let polygon = json!({ "points": wobbly(6), "closed": closed });
            let result = with(&json!({ "positions": "limit", "tangents": true }), &polygon, &plan, 1);
            let (points, tangents) = (array::<2>(&result, "points"), array::<2>(&result, "tangents"));
            let deep = limit_of_deep(&polygon, &plan);
            for (p, t) in points.iter().zip(&tangents) {
                assert!((t[0] * t[0] + t[1] * t[1] - 1.0).abs() < 1e-12, "{plan}: {t:?} is no unit vector");
                let i = (0..deep.len()).min_by(|&i, &j| distance(deep[i], *p).total_cmp(&distance(deep[j], *p)));
                let i = i.expect("there are points");
                let n = deep.len();
                let around = if closed {
                    [deep[(i + n - 1) % n], deep[(i + 1) % n]]
                } else {
                    [deep[i.saturating_sub(1)], deep[(i + 1).min(n - 1)]]
                };
                let length = distance(around[0], around[1]);
                let along = ((around[1][0] - around[0][0]) * t[0] + (around[1][1] - around[0][1]) * t[1]) / length;
                assert!(along > 0.999, "{plan}, closed {closed}: {t:?} at {p:?} makes the cosine {along}");
            }
        }
    }
}

/// A corner ends the curves on both sides of it: each side is a separate polygon.
#[test]
fn corners_cut_limits() {
    let points = wobbly(9);
    let plan = super::semi_stationary("UCCP", "pi/7", 0.3);
    let whole = with(
        &json!({ "positions": "limit", "tangents": true }),
        &json!({ "points": points, "corners": [4] }),
        &plan,
        2,
    );
    let found = array::<2>(&whole, "points");
    let sides = [&points[..5], &points[4..]].map(|side| limit(&json!({ "points": side }), &plan, 2));
    let joined = sides[0].iter().chain(&sides[1][1..]);
    assert_eq!(found.len(), sides[0].len() + sides[1].len() - 1);
    for (a, b) in found.iter().zip(joined) {
        assert!(distance(*a, *b) < 1e-13, "{a:?} {b:?}");
    }
    let tangents = whole["tangents"].as_array().expect("an array");
    assert_eq!(tangents.iter().filter(|t| t.is_null()).count(), 1, "the corner has no tangent");
    assert!(tangents[16].is_null());
}

/// A rational quadratic B-spline of a quarter: tangents of the projected curve.
#[test]
fn tangents_of_rational_curves_are_projected() {
    let points = [[0.0, 0.0, 1.0], [2.0, 0.0, 2.0], [6.0, 6.0, 3.0], [0.0, 8.0, 2.0], [-1.0, 2.0, 1.0]];
    let polygon = json!({ "points": points, "closed": true, "rational": true });
    let plan = json!({ "preset": "cubic-b-spline" });
    let result = with(&json!({ "positions": "limit", "tangents": true }), &polygon, &plan, 5);
    let (points, tangents) = (array::<2>(&result, "points"), array::<2>(&result, "tangents"));
    let n = points.len();
    for i in 0..n {
        let (a, b) = (points[(i + n - 1) % n], points[(i + 1) % n]);
        let length = distance(a, b);
        let along = ((b[0] - a[0]) * tangents[i][0] + (b[1] - a[1]) * tangents[i][1]) / length;
        assert!(along > 0.999, "point {i}: cosine {along}");
    }
}

#[test]
fn discrete_curvature_has_a_sign_in_the_plane_and_none_in_space() {
    let plan = json!({ "word": "U" });
    let polygon = json!({ "points": [[0, 0], [0, 1], [1, 1], [1, 1]] });
    let result = with(&json!({ "discrete_curvature": true }), &polygon, &plan, 0);
    let right = -sqrt(2.0);
    let found: Vec<Option<f64>> = serde_json::from_value(result["discrete_curvature"].clone()).expect("an array");
    assert_eq!(found[0], None);
    assert!((found[1].expect("a number") - right).abs() < 1e-15);
    assert_eq!(found[2..], [None, None], "repeated points and ends have none");
    let polygon = json!({ "points": [[0, 0, 0], [0, 1, 0], [1, 1, 0]] });
    let result = with(&json!({ "discrete_curvature": true }), &polygon, &plan, 0);
    assert!((result["discrete_curvature"][1].as_f64().expect("a number") + right).abs() < 1e-15);
}

#[test]
fn what_has_no_limit_is_refused_with_the_reason() {
    let refusal = |polygon: Value, plan: Value, option: Value| {
        let mut output = json!({ "format": "json" });
        output.as_object_mut().expect("an object").extend(option.as_object().expect("an object").clone());
        let job = json!({ "input": { "polygon": polygon }, "plan": plan, "levels": 2, "outputs": [output] });
        let faults = render(&job).err().unwrap_or_else(|| panic!("{job} was accepted"));
        format!("{}: {}", faults[0].pointer, faults[0].detail)
    };
    let (square, limit) = (json!({ "points": SQUARE, "closed": true }), json!({ "positions": "limit" }));
    let cases = [
        (
            square.clone(),
            json!({ "preset": "mask", "parameters": { "mask": [1, 1, 1], "first": -1 } }),
            limit.clone(),
            "converge",
        ),
        (square.clone(), json!({ "word": "D" }), limit.clone(), "begin with an upsampling"),
        (
            square.clone(),
            json!({ "word": "UC", "parameters": { "perturbation": { "amplitude": 0.1 } } }),
            limit.clone(),
            "random",
        ),
        (json!({ "points": SQUARE }), json!({ "word": "UC", "ends": "natural" }), limit.clone(), "natural"),
        (
            json!({ "points": SQUARE, "parameters": { "delta": [0, 0, 1, 1] } }),
            json!({ "word": "UCP" }),
            limit,
            "parameters",
        ),
        (square.clone(), json!({ "word": "U" }), json!({ "tangents": true }), "not C1"),
        (square, json!({ "preset": "four-point", "parameters": { "w": 0.3 } }), json!({ "tangents": true }), "not C1"),
    ];
    for (polygon, plan, option, expected) in cases {
        let said = refusal(polygon, plan, option);
        assert!(said.contains(expected) && said.starts_with("/outputs/0/"), "{said}");
    }
    let points =
        faults(json!({ "input": { "mesh": { "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]] } },
        "plan": { "word": "U" }, "levels": 65 }));
    assert!(!points.is_empty());
}
