//! Levels by tolerance: the bound holds, and is not much larger than the true distance.

use planish::math::functions::{cos, sin, sqrt};
use planish::wire::answer::EstimateAnswer;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{faults, parsed, render};

type Point = [f64; 2];

/// Returns the level and the bound for a job, and its polygon.
fn within(polygon: &Value, plan: &Value, tolerance: f64) -> (u32, f64, Vec<Point>) {
    let job = json!({ "input": { "polygon": polygon }, "plan": plan, "levels": { "tolerance": tolerance },
        "outputs": [{ "format": "json" }] });
    let reached = parsed(job.to_string().as_bytes()).unwrap_or_else(|f| panic!("{f:?} for {job}")).reached;
    let reached = reached.expect("a tolerance was asked for");
    (reached.level, reached.bound.expect("a tolerance has a bound"), points(&render(&job).expect("the job runs").0))
}

fn points(bytes: &[u8]) -> Vec<Point> {
    let result: Value = serde_json::from_slice(bytes).expect("json output");
    serde_json::from_value(result["points"].clone()).expect("points in the plane")
}

fn at_level(polygon: &Value, plan: &Value, levels: u32) -> Vec<Point> {
    let job = json!({ "input": { "polygon": polygon }, "plan": plan, "levels": levels,
        "outputs": [{ "format": "json", "positions": "limit" }] });
    points(&render(&job).unwrap_or_else(|f| panic!("{f:?} for {job}")).0)
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = u[0] * u[0] + u[1] * u[1];
    let t = if length > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    let d = [v[0] - t * u[0], v[1] - t * u[1]];
    sqrt(d[0] * d[0] + d[1] * d[1])
}

/// Returns the greatest distance of points of the limit from the polygon, each compared with edges near its own
/// position.
fn deviation(coarse: &[Point], limit: &[Point], closed: bool) -> f64 {
    let n = coarse.len();
    let edges = if closed { n } else { n - 1 };
    let mut most: f64 = 0.0;
    for (k, p) in limit.iter().enumerate() {
        let here = k * edges / limit.len();
        let near = (here + n - 4..=here + n + 4).filter(|i| closed || (n..n + edges).contains(i));
        let near = near.map(|i| to_segment(*p, coarse[i % n], coarse[(i + 1) % n]));
        most = most.max(near.fold(f64::INFINITY, f64::min));
    }
    most
}

fn plans() -> Vec<Value> {
    let preset = |name: &str, parameters: Value| json!({ "preset": name, "parameters": parameters });
    vec![
        preset("cubic-b-spline", json!({})),
        preset("b-spline", json!({ "degree": 5 })),
        preset("chaikin", json!({})),
        preset("four-point", json!({})),
        preset("four-point", json!({ "w": 0.1 })),
        preset("two-n-point", json!({ "n": 4 })),
        preset("ternary-cubic", json!({})),
        preset("ternary-four-point", json!({ "mu": "1/11" })),
        preset("d-ary-b-spline", json!({ "arity": 4, "degree": 3 })),
        super::semi_stationary("UCP", "pi/4", 0.6),
        super::semi_stationary("UCCP", "pi/5", 1.0),
        preset("push-back", json!({ "kernel": 2, "alpha": 2, "compensation": "1/cos(alpha/2)" })),
        json!({ "word": "U" }),
        json!({ "word": "UUCPD(UC)" }),
    ]
}

fn wobbly(n: u32, seed: f64) -> Vec<Point> {
    let point = |i: u32| {
        let t = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        let r = 3.0 + sin(3.0 * t + seed) + 0.5 * cos(5.0 * t);
        [r * cos(t), r * sin(t)]
    };
    (0..n).map(point).collect()
}

#[test]
fn bounds_hold_and_are_close() {
    for plan in plans() {
        for closed in [true, false] {
            let polygon = json!({ "points": wobbly(14, 0.7), "closed": closed });
            let (level, bound, coarse) = within(&polygon, &plan, 0.02);
            assert!(bound <= 0.02, "{plan}: level {level} has the bound {bound}");
            let more = if plan.to_string().contains("ary") { 3 } else { 4 };
            let truth = deviation(&coarse, &at_level(&polygon, &plan, level + more), closed);
            assert!(truth <= bound + 1e-12, "{plan}, closed {closed}: {truth} is beyond the bound {bound}");
            let loose = truth < bound / 10.0 && bound > 1e-12;
            assert!(!loose, "{plan}, closed {closed}, level {level}: the bound {bound} is far from {truth}");
        }
    }
}

/// Bounds fall by the square of the arity per level.
#[test]
fn each_level_divides_the_bound_by_the_square_of_the_arity() {
    for (plan, square) in [(json!({ "preset": "cubic-b-spline" }), 4.0), (json!({ "preset": "ternary-cubic" }), 9.0)] {
        let polygon = json!({ "points": wobbly(9, 0.2), "closed": true });
        let (level, bound, _) = within(&polygon, &plan, 1e-2);
        let (next, smaller, _) = within(&polygon, &plan, bound * 0.999);
        assert_eq!(next, level + 1);
        let ratio = bound / smaller;
        assert!((ratio / square - 1.0).abs() < 0.25, "{plan}: {bound} then {smaller}");
    }
}

#[test]
fn corners_and_several_polygons_are_within_the_tolerance_too() {
    let plan = super::semi_stationary("UCP", "pi/6", 0.3);
    let whole = json!({ "points": wobbly(10, 0.0), "corners": [3, 7] });
    let (level, bound, coarse) = within(&whole, &plan, 0.01);
    let truth = deviation(&coarse, &at_level(&whole, &plan, level + 4), false);
    assert!(truth <= bound && bound <= 0.01, "{truth} {bound}");

    let far: Vec<Point> = wobbly(10, 0.0).iter().map(|p| [10.0 * p[0], 10.0 * p[1]]).collect();
    let small = json!({ "points": wobbly(10, 0.0), "closed": true });
    let large = json!({ "points": far, "closed": true });
    let job = |polygons: Value| {
        json!({ "input": { "polygons": polygons }, "plan": plan, "levels": { "tolerance": 0.01 },
            "outputs": [{ "format": "json" }] })
    };
    let level = |polygons: Value| parsed(job(polygons).to_string().as_bytes()).expect("a job").levels;
    assert!(level(json!([small])) < level(json!([large])));
    assert_eq!(level(json!([small, large])), level(json!([large])), "the worst polygon decides");
}

#[test]
fn the_level_is_part_of_the_key_and_the_tolerance_is_not() {
    let job = |levels: Value| {
        let job = json!({ "input": { "polygon": { "points": wobbly(8, 0.1), "closed": true } },
            "plan": { "preset": "cubic-b-spline" }, "levels": levels, "outputs": [{ "format": "json" }] });
        parsed(job.to_string().as_bytes()).expect("a job")
    };
    let within = job(json!({ "tolerance": 0.01 }));
    let counted = job(json!(within.levels));
    assert_eq!(within.keys()[0], counted.keys()[0]);
    let limits = planish::job::limits::Limits::default();
    let answer = EstimateAnswer::new(&within, &limits.estimate(&within).expect("a small job"));
    let reached = answer.reached.expect("the answer says what the tolerance led to");
    assert_eq!(reached.level, within.levels);
    assert!(reached.bound.is_some_and(|bound| bound <= 0.01));
}

/// The polygon of limit points is a different one, which is also within the bound.
#[test]
fn limit_points_are_within_the_tolerance_too() {
    for plan in plans() {
        let polygon = json!({ "points": wobbly(14, 0.7), "closed": true });
        let job = json!({ "input": { "polygon": polygon }, "plan": plan, "levels": { "tolerance": 0.02 },
            "outputs": [{ "format": "json", "positions": "limit" }] });
        let resolved = parsed(job.to_string().as_bytes()).unwrap_or_else(|f| panic!("{f:?}"));
        let bound = resolved.reached.expect("a tolerance was asked for").bound;
        let more = if plan.to_string().contains("ary") { 3 } else { 4 };
        let deep = at_level(&polygon, &plan, resolved.levels + more);
        let truth = deviation(&at_level(&polygon, &plan, resolved.levels), &deep, true);
        let bound = bound.expect("a tolerance has a bound");
        assert!(truth <= bound + 1e-12 && bound <= 0.02, "{plan}: {truth} {bound}");
    }
}

#[test]
fn what_has_no_bound_is_refused_with_the_reason() {
    let square = json!({ "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true });
    let rational = json!({ "points": [[0, 0, 1], [1, 0, 1], [1, 1, 2]], "closed": true, "rational": true });
    let job = |polygon: &Value, plan: Value, tolerance: f64| {
        json!({
            "input": { "polygon": polygon }, "plan": plan, "levels": { "tolerance": tolerance }
        })
    };
    let zigzag = json!({ "points": (0..8000).map(|i| [i, i % 2]).collect::<Vec<_>>() });
    let cubic = json!({ "preset": "cubic-b-spline" });
    let cases = [
        (job(&square, json!({ "preset": "incenter" }), 0.1), "not linear"),
        (job(&rational, cubic.clone(), 0.1), "rational"),
        (job(&square, json!({ "word": "UC", "parameters": { "perturbation": { "amplitude": 0.1 } } }), 0.1), "random"),
        (job(&square, cubic.clone(), -1.0), "positive"),
        (job(&square, cubic.clone(), 1e-15), "rounding"),
        (job(&zigzag, cubic.clone(), 8.1e-9), "coarser"),
        (job(&square, json!({ "preset": "four-point", "parameters": { "w": 0.6 } }), 0.1), "need not vanish"),
        (
            job(
                &square,
                json!({ "preset": "ternary-blending", "parameters":
                { "eta": 0, "theta": 0, "omega": 0.3, "delta": 0.1, "lambda": 0.5 } }),
                0.1,
            ),
            "linear functions",
        ),
    ];
    for (job, expected) in cases {
        let faults = faults(job.clone());
        let said = format!("{}: {}", faults[0].pointer, faults[0].detail);
        assert!(said.starts_with("/levels") && said.contains(expected), "{said} for {job}");
    }
    let none = json!({ "input": { "polygon": square }, "levels": { "tolerance": 0.1 } });
    assert_eq!(faults(none)[0].pointer, "/plan");
    let typo = json!({ "input": { "polygon": square }, "plan": cubic, "levels": { "tolerence": 0.1 } });
    assert!(faults(typo)[0].detail.contains("tolerence"));
    let text = json!({ "input": { "polygon": square }, "plan": cubic, "levels": "many" });
    assert_eq!(faults(text)[0].pointer, "/levels");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    #[test]
    fn bounds_hold_against_level_14(
        points in prop::collection::vec(prop::array::uniform2(-10.0..10.0_f64), 3..9),
        closed in any::<bool>(),
        which in 0..3_usize,
    ) {
        let preset = ["cubic-b-spline", "four-point", "chaikin"][which];
        let plan = json!({ "preset": preset });
        let polygon = json!({ "points": points, "closed": closed });
        let (level, bound, coarse) = within(&polygon, &plan, 0.05);
        let truth = deviation(&coarse, &at_level(&polygon, &plan, 14), closed);
        prop_assert!(truth <= bound + 1e-12, "{} at level {}: {} is beyond {}", plan, level, truth, bound);
    }
}
