//! The incenter scheme: circles remain circles, convex polygons remain convex, the curve does not depend on its
//! placement, and data at which formulas have poles give finite points.

#![expect(clippy::float_cmp, reason = "what stays, stays exactly")]

use planish::job::Input;
use planish::math::functions::{atan2, cos, sin, sqrt};
use planish::refine::refine_polygon;
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{faults, parsed, render};

const PI: f64 = std::f64::consts::PI;

type Points = Vec<[f64; 2]>;

/// Returns the points and tangents of a refined polygon.
fn refined(polygon: &Value, mu: &Value, levels: u32) -> (Points, Points) {
    let plan = json!({ "preset": "incenter", "parameters": { "mu": mu } });
    let job = json!({
        "input": { "polygon": polygon }, "plan": plan, "levels": levels, "outputs": [{ "format": "json" }],
    });
    let job = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let Input::Polygons(polygons) = &*job.input else { panic!("a polygon") };
    let steps = job.plan.schedule(levels).expect("there are no functions");
    let curve = refine_polygon(&polygons[0], &job.plan, &steps, &Watch::new()).expect("it can be refined");
    let tangents = curve.tangents.expect("the scheme turns tangents");
    assert_eq!(tangents.len(), curve.points.len());
    assert!(curve.points.iter().chain(&tangents).all(|x| x.is_finite()), "{polygon}");
    let tangents = tangents.as_chunks().0.to_vec();
    for tangent in &tangents {
        assert!((length(*tangent) - 1.0).abs() < 1e-14, "{tangent:?} has length 1");
    }
    (curve.points.as_chunks().0.to_vec(), tangents)
}

fn closed(points: &[[f64; 2]]) -> Value {
    json!({ "points": points, "closed": true })
}

fn length([x, y]: [f64; 2]) -> f64 {
    sqrt(x * x + y * y)
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the angle from one vector to another.
fn turn(a: [f64; 2], b: [f64; 2]) -> f64 {
    atan2(cross(a, b), a[0] * b[0] + a[1] * b[1])
}

fn on_circle(angles: &[f64]) -> Points {
    angles.iter().map(|&t| [cos(t), sin(t)]).collect()
}

fn near(a: &[[f64; 2]], b: &[[f64; 2]], tolerance: f64, what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (p, q) in a.iter().zip(b) {
        assert!(length(minus(*p, *q)) <= tolerance, "{what}: {p:?} and {q:?}");
    }
}

/// Adds the midpoint of each arc to the angles: the joint of a biarc on a circle is the middle of its arc.
fn halved(angles: &[f64], whole: f64) -> Vec<f64> {
    let ends = angles.iter().zip(angles[1..].iter().copied().chain([angles[0] + whole]));
    ends.flat_map(|(&a, b)| [a, f64::midpoint(a, b)]).collect()
}

/// Some edges span a half circle, and more than that.
#[test]
fn points_of_a_circle_stay_on_it_for_every_mu() {
    for angles in [&[0.0, 1.0, 2.5, 3.0], &[0.0, PI, 4.0, 5.0], &[0.0, 4.5, 4.75, 5.0], &[1.0, 3.0, 3.5, 7.0]] {
        for mu in [0.0, 0.25, 0.5, 1.0] {
            let mut expected = angles.to_vec();
            for levels in 0..=5 {
                let (points, tangents) = refined(&closed(&on_circle(angles)), &json!(mu), levels);
                let what = format!("mu {mu}, level {levels} of {angles:?}");
                // an edge of 0.25 radians, cut into 32 parts, turns a rounding of 1e-16 into an angle of 1e-16 / 0.008
                near(&points, &on_circle(&expected), 1e-14, &what);
                let turned: Vec<f64> = expected.iter().map(|t| t + PI / 2.0).collect();
                near(&tangents, &on_circle(&turned), 1e-12, &what);
                expected = halved(&expected, 2.0 * PI);
            }
        }
    }
}

#[test]
fn an_open_arc_is_an_arc_up_to_its_ends() {
    let angles = [0.5, 1.0, 1.75, 2.0, 4.0];
    let (points, tangents) = refined(&json!({ "points": on_circle(&angles) }), &json!("1/4"), 4);
    assert_eq!(points.len(), 65);
    assert!(points.iter().all(|p| (length(*p) - 1.0).abs() <= 1e-14));
    near(&tangents[..1], &on_circle(&[0.5 + PI / 2.0]), 1e-14, "at the start");
    near(&tangents[64..], &on_circle(&[4.0 + PI / 2.0]), 1e-14, "at the end");
}

fn polygon() -> impl Strategy<Value = Points> {
    proptest::collection::vec(proptest::array::uniform2(-10.0..10.0_f64), 3..9)
}

/// Whether the polygon stays away from discontinuities of the scheme: turning angles of about pi, or of about 0, whose
/// sign decides between arc and inflection.
fn is_tame(points: &[[f64; 2]]) -> bool {
    let n = points.len();
    let chords: Vec<_> = (0..n).map(|i| minus(points[(i + 1) % n], points[i])).collect();
    chords.iter().all(|c| length(*c) > 1.0)
        && (0..n).all(|i| (0.25..2.5).contains(&turn(chords[i], chords[(i + 1) % n]).abs()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn moved_turned_scaled_and_mirrored_input_gives_such_output(
        points in polygon().prop_filter("tame", |points| is_tame(points)), angle in 0.0..6.0_f64,
        scale in 0.1..9.0_f64, shift in proptest::array::uniform2(-9.0..9.0_f64), is_closed in any::<bool>(),
        mirrored in any::<bool>(),
    ) {
        let (c, s) = (scale * cos(angle), scale * sin(angle));
        let side = if mirrored { -1.0 } else { 1.0 };
        let image = |[x, y]: [f64; 2]| [c * x - s * side * y + shift[0], s * x + c * side * y + shift[1]];
        let of = |points: &[[f64; 2]]| json!({ "points": points, "closed": is_closed });
        let expected: Points = refined(&of(&points), &json!("1/4"), 2).0.into_iter().map(image).collect();
        let images: Points = points.iter().copied().map(image).collect();
        near(&refined(&of(&images), &json!("1/4"), 2).0, &expected, 1e-9 * scale, "image");
    }

    #[test]
    fn the_curve_has_no_preferred_direction(points in polygon().prop_filter("tame", |points| is_tame(points))) {
        let backwards: Points = points.iter().rev().copied().collect();
        let (mut there, _) = refined(&json!({ "points": points }), &json!("1/4"), 3);
        there.reverse();
        near(&refined(&json!({ "points": backwards }), &json!("1/4"), 3).0, &there, 1e-9, "backwards");
    }

    /// Random points on an ellipse, so that edges may be very unequal.
    #[test]
    fn convex_polygons_stay_convex(
        gaps in proptest::collection::vec(0.1..1.0_f64, 4..9), high in 0.2..1.0_f64, mu in 0.0..=1.0_f64,
    ) {
        let whole: f64 = gaps.iter().sum();
        let angles = gaps.iter().scan(0.0, |sum, gap| {
            *sum += 2.0 * PI * gap / whole;
            Some(*sum)
        });
        let points: Points = angles.map(|t| [3.0 * cos(t), 3.0 * high * sin(t)]).collect();
        for levels in 1..=5 {
            let (points, _) = refined(&closed(&points), &json!(mu), levels);
            prop_assert!(turnings(&points).iter().all(|t| *t > 0.0), "mu {}, level {}", mu, levels);
            prop_assert!((turnings(&points).iter().sum::<f64>() - 2.0 * PI).abs() < 1e-9, "it goes round once");
        }
    }

    /// Few different positions, so that points coincide, fold back and lie on lines.
    #[test]
    fn awkward_points_give_finite_ones(
        points in proptest::collection::vec(proptest::array::uniform2((-1..=1).prop_map(f64::from)), 3..9),
        is_closed in any::<bool>(), mu in prop_oneof![Just(0.0), Just(0.25), Just(1.0)],
    ) {
        let (found, _) = refined(&json!({ "points": points, "closed": is_closed }), &json!(mu), 4);
        prop_assert_eq!(found.len(), if is_closed { 16 * points.len() } else { 16 * (points.len() - 1) + 1 });
        for (i, p) in points.iter().enumerate() {
            prop_assert_eq!(&found[16 * i], p, "points stay");
        }
    }
}

fn turnings(points: &[[f64; 2]]) -> Vec<f64> {
    let n = points.len();
    let chord = |i: usize| minus(points[(i + 1) % n], points[i % n]);
    (0..n).map(|i| turn(chord(i), chord(i + 1))).collect()
}

/// Returns the largest difference between the curvatures of neighbouring points, by the circles through three points
/// each.
fn curvature_jump(points: &[[f64; 2]]) -> f64 {
    let n = points.len();
    let curvature = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| points[(i + k) % n]);
        2.0 * cross(minus(b, a), minus(c, b)) / (length(minus(b, a)) * length(minus(c, b)) * length(minus(c, a)))
    };
    (0..n).map(|i| (curvature(i + 1) - curvature(i)).abs()).fold(0.0, f64::max)
}

fn egg() -> Points {
    (0..5).map(|i| f64::from(i) * 2.0 * PI / 5.0).map(|t| [3.0 * cos(t), 2.0 * sin(t) + 0.4 * cos(2.0 * t)]).collect()
}

#[test]
fn curvature_jumps_fall_by_half_at_a_quarter_and_persist_at_0() {
    let jumps = |mu: f64| (5..=9).map(move |levels| curvature_jump(&refined(&closed(&egg()), &json!(mu), levels).0));
    let quarter: Vec<f64> = jumps(0.25).collect();
    for pair in quarter.windows(2) {
        assert!(pair[1] < 0.6 * pair[0], "{quarter:?}");
    }
    let none: Vec<f64> = jumps(0.0).collect();
    for pair in none.windows(2) {
        assert!(pair[1] > 0.95 * pair[0], "{none:?}");
    }
}

#[test]
fn an_inflection_becomes_two_convex_halves() {
    let polygon = json!({ "points": [[0, 0], [3, 0]], "tangents": [[1, -1], [2, -1]] });
    for mu in [0.0, 0.25] {
        let (points, tangents) = refined(&polygon, &json!(mu), 1);
        near(&points[1..2], &[[1.5, 0.0]], 1e-15, "the midpoint");
        for i in 0..2 {
            let e = minus(points[i + 1], points[i]);
            assert!(turn(tangents[i], e) * turn(e, tangents[i + 1]) > 0.0, "mu {mu}: half {i} is convex");
        }
        let (points, _) = refined(&polygon, &json!(mu), 6);
        let turnings = turnings(&points);
        let bends = turnings[..points.len() - 2].windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        assert_eq!(bends, 1, "mu {mu}: one inflection is left");
    }
}

#[test]
fn parallel_tangents_give_a_half_circle() {
    let polygon = json!({ "points": [[-1, 0], [1, 0]], "tangents": [[0, 5], [0, -0.1]] });
    let (points, _) = refined(&polygon, &json!("1/4"), 5);
    assert!(points.iter().all(|p| (length(*p) - 1.0).abs() < 1e-14 && p[1] >= -1e-15), "{points:?}");
    let (points, _) = refined(&closed(&[[-1.0, 0.0], [1.0, 0.0], [-1.0, 0.0]]), &json!("1/4"), 5);
    assert!(points.iter().all(|p| (length(*p) - 1.0).abs() < 1e-14), "there and back turns left: {points:?}");
}

#[test]
fn tangents_that_both_run_against_their_edge_give_the_midpoint() {
    let polygon = json!({ "points": [[0, 0], [1, 0]], "tangents": [[-1, 0], [-1, 0]] });
    let (points, tangents) = refined(&polygon, &json!(0), 1);
    assert_eq!((points[1], tangents[1]), ([0.5, 0.0], [1.0, 0.0]));
}

#[test]
fn repeated_points_are_repeated_and_change_nothing_else() {
    let once = egg();
    let twice: Points = once[..3].iter().chain(&once[2..]).copied().collect();
    for is_closed in [true, false] {
        let of = |points: &[[f64; 2]]| json!({ "points": points, "closed": is_closed });
        for levels in 0..=3 {
            let [once, twice] = [&once, &twice].map(|points| refined(&of(points), &json!("1/4"), levels));
            let copies = (2 << levels)..(3 << levels);
            let without = |list: &Points| [&list[..copies.start], &list[copies.end..]].concat();
            assert_eq!((without(&twice.0), without(&twice.1)), once, "closed {is_closed}, level {levels}");
            assert!(twice.0[copies.clone()].iter().all(|p| *p == egg()[2]));
            assert!(twice.1[copies].iter().all(|t| *t == once.1[2 << levels]));
        }
    }
    let (points, _) = refined(&closed(&[[2.0, 1.0]; 4]), &json!("1/4"), 3);
    assert!(points.len() == 32 && points.iter().all(|p| *p == [2.0, 1.0]));
}

#[test]
fn pinned_tangents_stay() {
    let tangents = [[0.0, 1.0], [-1.0, 0.25], [-1.0, -1.0], [0.0, -1.0], [2.0, 1.0]];
    let mut polygon = closed(&egg());
    polygon["tangents"] = json!(tangents);
    polygon["pinned"] = json!([3, 1]);
    for levels in 0..=4 {
        let (_, found) = refined(&polygon, &json!(0.5), levels);
        let given = refined(&polygon, &json!(0.5), 0).1;
        for (i, tangent) in given.iter().enumerate() {
            let stays = found[i << levels] == *tangent;
            assert_eq!(stays, levels == 0 || [1, 3].contains(&i), "point {i}, level {levels}");
        }
    }
}

#[test]
fn a_point_given_twice_with_pinned_tangents_is_a_corner() {
    let polygon = json!({
        "points": [[0, 0], [2, 0], [2, 0], [2, 2]], "pinned": [1, 2],
        "tangents": [[1, 0], [1, 0], [0, 1], [0, 1]],
    });
    let (points, tangents) = refined(&polygon, &json!("1/4"), 3);
    assert!(points[..=8].iter().all(|p| p[1] == 0.0) && points[16..].iter().all(|p| p[0] == 2.0), "{points:?}");
    assert_eq!([tangents[8], tangents[16]], [[1.0, 0.0], [0.0, 1.0]]);
}

#[test]
fn tangents_at_open_ends_are_mirrored_or_kept() {
    let points = [[0.0, 0.0], [2.0, 1.0], [3.0, 3.0], [2.0, 4.0]];
    let (_, found) = refined(&json!({ "points": points }), &json!(1), 0);
    let chord = minus(points[1], points[0]);
    assert!((turn(found[0], chord) - turn(chord, found[1])).abs() < 1e-15);
    let given = json!({ "points": points, "tangents": [[1, 0], [1, 1], [0, 1], [-1, 0]] });
    let (_, found) = refined(&given, &json!(1), 3);
    assert_eq!((found[0], found[24]), ([1.0, 0.0], [-1.0, 0.0]));
    let (points, found) = refined(&json!({ "points": [[0, 0], [3, 4]] }), &json!(0.25), 2);
    assert!(found.iter().all(|t| *t == [0.6, 0.8]), "two points make a line: {found:?}");
    near(&points, &[[0.0, 0.0], [0.75, 1.0], [1.5, 2.0], [2.25, 3.0], [3.0, 4.0]], 1e-15, "evenly");
}

/// Rounding must not decide where the points of a straight edge go.
#[test]
fn straight_points_stay_straight_and_are_halved() {
    let points: Points = (0..7).map(|i| f64::from(i) * 0.1).map(|t| [0.3 + t / 7.0, 0.7 - 3.0 * t]).collect();
    let (found, _) = refined(&json!({ "points": points }), &json!(0.25), 6);
    for (i, p) in (0_u32..).zip(&found) {
        let t = f64::from(i) / 64.0 * 0.1;
        near(&[*p], &[[0.3 + t / 7.0, 0.7 - 3.0 * t]], 1e-14, "on the line");
    }
}

#[test]
fn tangents_come_out_beside_the_points() {
    let polygon = json!({ "points": egg(), "closed": true });
    for levels in [0, 3] {
        let (points, tangents) = refined(&polygon, &json!(0.25), levels);
        let job = json!({
            "input": { "polygon": polygon }, "plan": { "preset": "incenter" }, "levels": levels,
            "outputs": [{ "format": "json", "tangents": true, "positions": "limit" }],
        });
        let (bytes, _) = render(&job).expect("it can be refined");
        let found: Value = serde_json::from_slice(&bytes).expect("the json output is JSON");
        let [found_points, found_tangents] = ["points", "tangents"]
            .map(|name| serde_json::from_value::<Points>(found[name].clone()).expect("lists of numbers"));
        assert_eq!((found_points, found_tangents), (points, tangents), "level {levels}");
    }
}

fn refused(polygon: &Value, plan: &Value) -> Vec<(String, String)> {
    let found = faults(json!({ "input": { "polygon": polygon }, "plan": plan, "levels": 1 }));
    found.into_iter().map(|fault| (fault.pointer, fault.detail)).collect()
}

#[test]
fn what_it_cannot_refine_is_refused_at_its_place() {
    let flat = json!([[0, 0], [1, 0], [1, 1]]);
    let plan = json!({ "preset": "incenter" });
    let natural = json!({ "preset": "incenter", "ends": "natural" });
    for (polygon, plan, place, says) in [
        (json!({ "points": [[0], [1]] }), &plan, "/input/polygon/points/0", "2 coordinates; these have 1"),
        (json!({ "points": [[0, 0, 0], [1, 0, 0]] }), &plan, "/input/polygon/points/0", "2 coordinates; these have 3"),
        (json!({ "points": [[0, 0, 1], [1, 0, 1]], "rational": true }), &plan, "/input/polygon/rational", "weight"),
        (json!({ "points": flat, "corners": [1] }), &plan, "/input/polygon/corners", "give the point twice"),
        (
            json!({ "points": flat, "parameters": { "delta": [1, 1, 1] } }),
            &plan,
            "/input/polygon/parameters",
            "no alpha",
        ),
        (json!({ "points": flat }), &natural, "/plan/ends", "leave \"ends\" out"),
        (json!({ "points": flat, "tangents": [[1, 0]] }), &plan, "/input/polygon/tangents", "1 tangents for 3 points"),
        (
            json!({ "points": flat, "tangents": [[1, 0], [0, 0], [0, 1]] }),
            &plan,
            "/input/polygon/tangents/1",
            "vector 0",
        ),
        (
            json!({ "points": flat, "tangents": [[1, 0], [1], [0, 1]] }),
            &plan,
            "/input/polygon/tangents/1",
            "points have 2",
        ),
        (json!({ "points": flat, "pinned": [3] }), &plan, "/input/polygon/pinned/0", "there is no point 3"),
    ] {
        let found = refused(&polygon, plan);
        assert!(found.len() == 1 && found[0].0 == place && found[0].1.contains(says), "{polygon}: {found:?}");
    }
    let unknown = json!({ "preset": "incenter", "parameters": { "perturbation": { "amplitude": 1 } } });
    assert_eq!(refused(&json!({ "points": flat }), &unknown)[0].0, "/plan/parameters/perturbation");
    for mu in [json!(-0.01), json!(1.01), json!("2/1")] {
        let plan = json!({ "preset": "incenter", "parameters": { "mu": mu } });
        assert_eq!(refused(&json!({ "points": flat }), &plan)[0].0, "/plan/parameters/mu");
    }
    // closed polygons have no ends
    assert_eq!(refined(&json!({ "points": flat, "closed": true }), &json!(0.25), 1).0.len(), 6);
}

#[test]
fn tangents_without_a_use_are_refused_and_told_their_use() {
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "tangents": [[1, 0], [1, 1], [0, 1]], "pinned": [1] });
    let plan = json!({ "preset": "four-point" });
    let found = refused(&polygon, &plan);
    let places: Vec<&str> = found.iter().map(|(place, _)| place.as_str()).collect();
    assert_eq!(places, ["/input/polygon/tangents", "/input/polygon/pinned"]);
    assert!(found[0].1.contains("the preset incenter alone"), "{found:?}");
    let several =
        json!({ "input": { "polygons": [{ "points": [[0, 0], [1, 0]] }, polygon] }, "plan": plan, "levels": 1 });
    assert_eq!(faults(several)[0].pointer, "/input/polygons/1/tangents");
}
