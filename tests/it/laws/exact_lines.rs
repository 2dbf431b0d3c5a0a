//! Reported latitude lines agree with measurements of the limit: those reported as exact are circles of the reported
//! radius, and the others are not circles.

use planish::analysis::circles::Outlook;
use planish::math::functions::{cos, sin, sqrt};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::outlooks::{Point, Ring, UNEVEN, points, real, told, tube, word};

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// Returns the mean distance of points from their mean, and their largest deviation from the circle of this radius in a
/// plane.
fn circle(points: &[Point]) -> (f64, f64) {
    let n = real(points.len());
    let centre: Point = std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let arms: Vec<Point> = points.iter().map(|&p| minus(p, centre)).collect();
    let turns = (0..arms.len()).map(|i| cross(arms[i], arms[(i + 1) % arms.len()]));
    let turn = turns.fold([0.0; 3], |sum, turn| std::array::from_fn(|i| sum[i] + turn[i]));
    let length = sqrt(dot(turn, turn)).max(1e-300);
    let radius = arms.iter().map(|&arm| sqrt(dot(arm, arm))).sum::<f64>() / n;
    let missed = |&arm: &Point| (sqrt(dot(arm, arm)) - radius).abs().max((dot(arm, turn) / length).abs());
    (radius, arms.iter().map(missed).fold(0.0, f64::max))
}

/// Returns the lines that are reported as exact, and checks that these are circles in the limit and the others are not.
fn judged(mesh: &Value, plan: &Value) -> Vec<usize> {
    let lines = told(mesh, plan);
    let is_exact = |line: &(usize, (&Outlook, Vec<Point>))| {
        let &(i, (outlook, ref points)) = line;
        let (radius, off) = circle(points);
        match &outlook.circle {
            Ok(circle) => {
                let off = off.max((radius - circle.radius).abs());
                assert!(off < 1e-12, "line {i} is off by {off}, told {}: {plan}", circle.radius);
                true
            }
            Err(said) => {
                assert!(off > 1e-8, "line {i} is off by {off} alone: {said}: {plan}");
                false
            }
        }
    };
    let found = points(mesh, plan, &lines, 1, "limit");
    lines.iter().zip(found).enumerate().filter(is_exact).map(|(i, _)| i).collect()
}

fn all(n: usize) -> Vec<usize> {
    (0..n).collect()
}

/// Returns a tube with each ring moved by `by`.
fn moved(k: usize, rings: &[Ring], by: impl Fn(usize, Point) -> Point) -> Value {
    let mut mesh = tube(k, rings);
    let points: Vec<Point> = serde_json::from_value(mesh["positions"].clone()).expect("positions");
    mesh["positions"] = points.into_iter().enumerate().map(|(v, p)| json!(by(v / k, p))).collect();
    mesh
}

fn aside(u: usize, [x, y, z]: Point) -> Point {
    [x + 0.8 * sin(2.0 * real(u)), y - 0.6 * cos(3.0 * real(u)), z]
}

/// Rotates a point about the x axis through the origin.
fn tilted([x, y, z]: Point, angle: f64) -> Point {
    let (c, s) = (cos(angle), sin(angle));
    [x, c * y - s * z, s * y + c * z]
}

/// Rings in parallel planes with centres off a common axis have circles in the limit, too: the rule for reports
/// requires more than necessary.
#[test]
fn oblique_tubes_have_circles_that_are_not_told() {
    for (letters, rule) in [("UC", "difference"), ("UCP", "difference"), ("UCP", "position"), ("UCCPC", "difference")] {
        let plan = word(letters, &json!({ "delta": 0.5, "latitude_rule": rule }));
        let mesh = moved(5, &UNEVEN, aside);
        let lines = told(&mesh, &plan);
        for (i, points) in points(&mesh, &plan, &lines, 1, "limit").into_iter().enumerate() {
            let off = circle(&points).1;
            assert!(off < 1e-12, "{letters}, {rule}: line {i} is off by {off}");
        }
        for outlook in &lines[1..7] {
            let said = outlook.circle.as_ref().expect_err("the rings beside have other centres");
            assert!(said.ends_with("another axis"), "{letters}, {rule}: {said}");
        }
    }
}

/// Lines that depend on a tilted ring are not circles.
#[test]
fn lines_beside_a_tilted_ring_are_no_circles() {
    for (letters, rule) in [("UC", "difference"), ("UCP", "difference"), ("UCP", "position"), ("UCCPC", "difference")] {
        let plan = word(letters, &json!({ "delta": 0.5, "latitude_rule": rule }));
        assert_eq!(judged(&tube(5, &UNEVEN), &plan), all(8), "{letters}, {rule}");
        let bent = |u: usize, p: Point| if u == 4 { tilted(p, 0.3) } else { p };
        let exact = judged(&moved(5, &UNEVEN, bent), &plan);
        assert_eq!(exact.first().zip(exact.last()), Some((&0, &7)), "{letters}, {rule}");
        assert!(!exact.contains(&3) && !exact.contains(&5), "{letters}, {rule}: {exact:?}");
    }
}

/// The planes on both sides of a pole are compared, too: the pole itself has none.
#[test]
fn poles_between_other_planes_are_no_circles() {
    let rings: Vec<Ring> = (0..7).map(|u| (if u == 3 { 0.0 } else { 1.0 }, real(u) - 3.0, 0.0)).collect();
    let plan = word("UC", &json!({}));
    assert_eq!(judged(&tube(5, &rings), &plan), all(7));
    let bent = |u: usize, p: Point| if u > 3 { tilted(p, 0.5) } else { p };
    assert_eq!(judged(&moved(5, &rings, bent), &plan), [0, 1, 2, 4, 5, 6]);
}

/// Delta and compensation have no effect without a P, nor before the first C.
#[test]
fn what_is_never_used_disturbs_nothing() {
    let n = 5 * UNEVEN.len();
    let some: Vec<f64> = (0..n).map(|v| 0.5 + 0.3 * sin(7.0 * real(v))).collect();
    for (letters, expected) in [("UC", true), ("UPC", true), ("UPPC", true), ("UCP", false), ("UPCP", false)] {
        for name in ["delta", "compensation"] {
            let mut mesh = tube(5, &UNEVEN);
            mesh["parameters"] = json!({ name: some });
            let exact = judged(&mesh, &word(letters, &json!({ "delta": 0.5 })));
            assert_eq!(exact, if expected { all(8) } else { vec![] }, "{letters}, {name}");
        }
    }
    let by_places = word("UPC", &json!({ "latitude_rule": "position" }));
    assert!(judged(&tube(5, &UNEVEN), &by_places).is_empty());
}

/// Without a push-back, the kernel `cos(alpha/2)` suffices; tags do not matter.
#[test]
fn the_isotropic_rule_keeps_circles_where_nothing_is_pushed_back() {
    let cases = [
        ("UC", json!(0.5), "cos(alpha/2)", "2*pi/5", true),
        ("UCC", json!(0.5), "cos(alpha/2)", "2*pi/5", true),
        ("UCP", json!(0), "cos(alpha/2)", "2*pi/5", true),
        ("UCP", json!("4-valence"), "cos(alpha/2)", "2*pi/5", true),
        ("UPC", json!(0.5), "cos(alpha/2)", "2*pi/5", true),
        ("UCP", json!(0.5), "cos(alpha/2)", "2*pi/5", false),
        ("UC", json!(0.5), "cos(alpha/2)", "2*pi/6", false),
        ("UC", json!(0.5), "1", "2*pi/5", false),
    ];
    for (letters, delta, kernel, alpha, expected) in cases {
        let parameters = json!({ "delta": delta, "kernel": kernel, "alpha": alpha, "latitude_rule": "isotropic" });
        // boundary curves are circles with the right compensation, but not with 1
        let exact = judged(&tube(5, &UNEVEN), &word(letters, &parameters));
        assert_eq!(exact, if expected { all(8) } else { vec![] }, "{letters}, {parameters}");
    }
}

/// Winding p times in one direction is winding n - p times in the other: the alpha of both is right, others are not.
#[test]
fn stars_may_go_round_either_way() {
    for (k, p) in [(5, 1), (5, 2), (7, 2), (7, 3)] {
        let mut mesh = tube(k, &UNEVEN);
        let whole = mesh["positions"].clone();
        for v in 0..8 * k {
            mesh["positions"][v] = whole[v - v % k + v % k * p % k].clone();
        }
        for turns in 1..k {
            let plan = word("UCCP", &json!({ "delta": 0.5, "alpha": format!("2*pi*{turns}/{k}") }));
            let expected = if turns == p || turns == k - p { all(8) } else { vec![] };
            assert_eq!(judged(&mesh, &plan), expected, "{turns}: {k}/{p}");
        }
    }
}

/// Of the rings beside a line, exactly those matter on which its limit depends.
#[test]
fn lines_look_as_far_as_their_limits_reach() {
    let rings: Vec<Ring> = (0..13).map(|u| (1.0 + 0.3 * cos(2.0 * real(u)), real(u), 0.1 * real(u))).collect();
    let bent = moved(5, &rings, |u, p| if u == 6 { [1.3 * p[0], p[1], p[2] + 0.2 * p[1]] } else { p });
    let reaches = [
        ("UC", 1),
        ("UCC", 2),
        ("UCCC", 3),
        ("UCP", 2),
        ("UCCP", 2),
        ("UCCCP", 4),
        ("UCPC", 3),
        ("UCPP", 2),
        ("UPCP", 2),
        ("UCCPC", 3),
        ("UC(UCCC)", 2),
        ("UCCC(UC)", 2),
        ("UCCP(UC)", 2),
    ];
    for (letters, reach) in reaches {
        let exact = judged(&bent, &word(letters, &json!({ "delta": 0.5 })));
        let expected: Vec<usize> = all(13).into_iter().filter(|u| u.abs_diff(6) > reach).collect();
        assert_eq!(exact, expected, "{letters}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any rings, one of them possibly tilted.
    #[test]
    fn lines_are_told_as_they_are(
        rings in prop::collection::vec((0.3_f64..2.0, 0.2_f64..1.5, -0.4_f64..0.4), 4..9),
        letters in prop::sample::select(vec!["UC", "UCP", "UCC", "UCCP", "UCPC", "UPCP"]),
        delta in prop::sample::select(vec![-0.1, 0.0, 0.5, 0.9]),
        rule in prop::sample::select(vec!["difference", "isotropic"]),
        tilt in prop::sample::select(vec![0.0, 0.0, 0.2]),
        place in 0_usize..9,
    ) {
        let mut height = 0.0;
        let rings: Vec<Ring> = rings.into_iter().map(|(r, step, turn)| {
            height += step;
            (r, height, turn)
        }).collect();
        let place = place % rings.len();
        let mesh = moved(5, &rings, |u, p| if u == place { tilted(p, tilt) } else { p });
        let parameters =
            json!({ "delta": delta, "latitude_rule": rule, "alpha": "2*pi/5", "kernel": "cos(alpha/2)" });
        let exact = judged(&mesh, &word(letters, &parameters));
        let pushed = letters.ends_with('P') || letters == "UCPC";
        let expected = rule != "isotropic" || !pushed || delta == 0.0;
        prop_assert!(tilt != 0.0 || exact.len() == if expected { rings.len() } else { 0 }, "{:?}", exact);
    }
}
