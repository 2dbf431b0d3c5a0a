//! Latitude lines of tubes remain circles for every delta, and untagged parts are not affected.

use planish::analysis::circles::outlooks;
use planish::math::functions::sqrt;
use serde_json::{Value, json};

use crate::support::{self, faults, nets};

type Point = [f64; 3];

fn real(n: usize) -> f64 {
    f64::from(u32::try_from(n).expect("a small number"))
}

/// Returns a tagged tube of regular k-gons with these radii and heights.
fn tube(k: usize, rings: &[(f64, f64)], turn: f64) -> Value {
    let turned: Vec<_> = rings.iter().map(|&(r, z)| (r, z, turn)).collect();
    super::outlooks::tube(k, &turned)
}

const UNEVEN: [(f64, f64); 6] = [(1.0, 0.0), (1.7, 0.4), (1.2, 2.0), (0.6, 2.2), (1.4, 3.9), (0.9, 4.5)];

fn refined(mesh: &Value, plan: &Value, levels: u32) -> Vec<Point> {
    let result = support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels }));
    serde_json::from_value(result["positions"].clone()).expect("positions")
}

/// Returns the greatest spread of radii, and of heights, over all latitude lines: points of the same height are one
/// line.
fn spreads(points: &[Point], rings: usize) -> (f64, f64) {
    let mut sorted: Vec<(f64, f64)> = points.iter().map(|p| (p[2], sqrt(p[0] * p[0] + p[1] * p[1]))).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = sorted.len() / rings;
    assert_eq!(size * rings, sorted.len());
    let spread = |values: &[f64]| {
        values.iter().fold(f64::MIN, |a, b| a.max(*b)) - values.iter().fold(f64::MAX, |a, b| a.min(*b))
    };
    sorted.chunks(size).fold((0.0, 0.0), |(radius, height), ring| {
        let (heights, radii): (Vec<f64>, Vec<f64>) = ring.iter().copied().unzip();
        (f64::max(radius, spread(&radii)), f64::max(height, spread(&heights)))
    })
}

fn push_back(delta: f64, k: u32, rule: &str) -> Value {
    json!({ "preset": "push-back", "boundary": "edge-only",
        "parameters": { "delta": delta, "k": k, "latitude_rule": rule } })
}

#[test]
fn latitude_lines_of_uneven_tubes_are_circles() {
    for k in 3..=12 {
        for delta in [-0.1, 0.0, 0.5, 1.0] {
            for averages in [1, 2] {
                for rule in ["difference", "position"] {
                    let points = refined(&tube(k, &UNEVEN, 0.3), &push_back(delta, averages, rule), 3);
                    let (radius, height) = spreads(&points, 5 * 8 + 1);
                    assert!(
                        radius < 1e-12 && height < 1e-12,
                        "K = {k}, delta {delta}, k = {averages}: {radius} {height}"
                    );
                }
            }
        }
    }
}

/// Without the tags, unevenly spaced rings do not remain plane.
#[test]
fn without_the_rule_uneven_rings_are_not_plane() {
    let plan = json!({ "preset": "push-back", "boundary": "edge-only", "parameters": {
        "latitude_rule": "isotropic", "alpha": "2*pi/5", "kernel": "cos(alpha/2)",
        "compensation": "1/cos(alpha/2)" } });
    let (_, height) = spreads(&refined(&tube(5, &UNEVEN, 0.0), &plan, 2), 5 * 4 + 1);
    assert!(height > 1e-3, "{height}");
}

#[test]
fn a_straight_cylinder_keeps_its_radius_with_delta_1() {
    let rings: Vec<(f64, f64)> = [0.0, 1.0, 1.3, 2.9, 3.0, 5.0].map(|z| (2.0, z)).into();
    for rule in ["difference", "position"] {
        for p in refined(&tube(7, &rings, 0.0), &push_back(1.0, 1, rule), 3) {
            assert!((sqrt(p[0] * p[0] + p[1] * p[1]) - 2.0).abs() < 1e-12, "{rule}: {p:?}");
        }
    }
}

#[test]
fn surfaces_of_revolution_are_invariant_under_one_sector() {
    let k = 5;
    let angle = std::f64::consts::TAU / real(k);
    let [a, b] = [0.0, angle].map(|turn| refined(&tube(k, &UNEVEN, turn), &push_back(0.4, 1, "difference"), 2));
    for p in &a {
        let near = b.iter().map(|q| (0..3).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum::<f64>());
        assert!(near.fold(f64::INFINITY, f64::min) < 1e-24);
    }
}

/// At delta 0, the rule by differences changes neither tagged nor untagged parts.
#[test]
fn with_delta_0_nothing_is_pushed_back() {
    let tagged = refined(&tube(6, &UNEVEN, 0.1), &push_back(0.0, 1, "difference"), 2);
    let mut bare = tube(6, &UNEVEN, 0.1);
    bare.as_object_mut().expect("an object").retain(|name, _| name == "positions" || name == "faces");
    let plan = json!({ "word": "UC", "boundary": "edge-only",
        "parameters": { "alpha": "2*pi/6", "kernel": "cos(alpha/2)" } });
    for (p, q) in tagged.iter().zip(refined(&bare, &plan, 2)) {
        assert!((0..3).all(|i| (p[i] - q[i]).abs() < 1e-12), "{p:?} {q:?}");
    }
}

/// The kernel across the lines may differ: circles remain, the profile changes.
#[test]
fn the_longitude_kernel_shapes_the_profile_alone() {
    let mut plan = push_back(0.5, 1, "difference");
    plan["parameters"]["kernel_longitude"] = json!(1);
    let other = refined(&tube(5, &UNEVEN, 0.0), &plan, 3);
    let (radius, height) = spreads(&other, 5 * 8 + 1);
    assert!(radius < 1e-12 && height < 1e-12, "{radius} {height}");
    assert_ne!(other, refined(&tube(5, &UNEVEN, 0.0), &push_back(0.5, 1, "difference"), 3));
}

/// Poles as rings of coincident vertices.
#[test]
fn collapsed_poles_leave_circles_exact() {
    let rings = [(0.0, 0.0), (0.9, 0.1), (1.3, 1.0), (0.8, 1.9), (0.0, 2.0)];
    let (radius, height) = spreads(&refined(&tube(6, &rings, 0.0), &push_back(0.7, 1, "difference"), 3), 4 * 8 + 1);
    assert!(radius < 1e-12 && height < 1e-12, "{radius} {height}");
}

/// An explicit alpha has precedence: lines are not circles if it is wrong.
#[test]
fn an_explicit_alpha_beats_the_lines() {
    let mut plan = push_back(0.5, 1, "difference");
    plan["parameters"]["alpha"] = json!("2*pi/5");
    let right = refined(&tube(5, &UNEVEN, 0.0), &plan, 2);
    assert_eq!(right, refined(&tube(5, &UNEVEN, 0.0), &push_back(0.5, 1, "difference"), 2));
    plan["parameters"]["alpha"] = json!(0);
    let (radius, _) = spreads(&refined(&tube(5, &UNEVEN, 0.0), &plan, 2), 5 * 4 + 1);
    assert!(radius > 1e-3, "{radius}");
}

/// Two tubes of different numbers of vertices in one mesh each have their own alpha.
#[test]
fn several_tubes_have_their_own_alpha() {
    let (a, b) = (tube(5, &UNEVEN, 0.0), tube(8, &UNEVEN, 0.0));
    let shift = a["positions"].as_array().expect("positions").len();
    let mut both = a.clone();
    let moved = |pair: &Value| {
        json!(
            pair.as_array()
                .expect("a list")
                .iter()
                .map(|v| v.as_u64().expect("an index") + shift as u64)
                .collect::<Vec<_>>()
        )
    };
    for name in ["faces", "latitude", "longitude"] {
        let more: Vec<Value> = b[name].as_array().expect("a list").iter().map(moved).collect();
        both[name].as_array_mut().expect("a list").extend(more);
    }
    let lifted: Vec<Point> = serde_json::from_value::<Vec<Point>>(b["positions"].clone()).expect("positions");
    let lifted: Vec<Value> = lifted.iter().map(|p| json!([p[0], p[1], p[2] + 10.0])).collect();
    both["positions"].as_array_mut().expect("a list").extend(lifted);
    let points = refined(&both, &push_back(0.6, 1, "difference"), 2);
    let (low, high): (Vec<Point>, Vec<Point>) = points.into_iter().partition(|p| p[2] < 7.0);
    for part in [low, high] {
        let (radius, height) = spreads(&part, 5 * 4 + 1);
        assert!(radius < 1e-12 && height < 1e-12, "{radius} {height}");
    }
}

#[test]
fn tags_that_cannot_be_are_refused_at_their_place() {
    let job = |mesh: Value, plan: Value| json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 });
    let first = |job: Value| {
        let fault = &faults(job)[0];
        format!("{}: {}", fault.pointer, fault.detail)
    };
    let with = |name: &str, edges: Value| {
        let mut mesh = tube(4, &UNEVEN, 0.0);
        mesh[name] = edges;
        mesh
    };
    let plan = json!({ "word": "UCP" });
    let cases = [
        (job(with("latitude", json!([[0, 2]])), plan.clone()), "/input/mesh/latitude/0: there is no edge"),
        (job(with("longitude", json!([[0, 1]])), plan.clone()), "/input/mesh/longitude/0: the edge from vertex 0"),
        (job(with("latitude", json!([[0, 99]])), plan), "/input/mesh/latitude/0: there is no edge"),
        (job(tube(4, &UNEVEN, 0.0), json!({ "word": "UD" })), "latitude and longitude tags"),
        (job(tube(4, &UNEVEN, 0.0), json!({ "preset": "catmull-clark" })), "knows no latitude"),
        (
            job(tube(4, &UNEVEN, 0.0), json!({ "word": "U3CP" })),
            "/plan/word: latitude and longitude tags act in words over U, C and P with arity 2 and split quad; here \
             stands U3",
        ),
        (
            job(tube(4, &UNEVEN, 0.0), json!({ "word": "UCP", "parameters": { "kernel_longitude": -1 } })),
            "/plan/parameters/kernel_longitude: the kernel_longitude is -1",
        ),
        (
            job(tube(4, &UNEVEN, 0.0), json!({ "word": "UCP", "parameters": { "kernel_longitude": "alpha-1-pi/2" } })),
            "/plan/parameters/kernel_longitude: level 1: the kernel_longitude of point 0 is -1",
        ),
        (job(with("latitude", json!([[0]])), json!({ "word": "UC" })), "/input/mesh/latitude/0"),
    ];
    for (job, expected) in cases {
        let said = first(job);
        assert!(said.contains(expected), "{said}");
    }
}

/// Returns the lines of a mesh under a plan: the radius, or the reason why there is none.
fn lines(mesh: &Value, plan: &Value) -> Vec<Result<f64, String>> {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1, "outputs": [{ "format": "json" }] });
    let job = support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
    let planish::job::Input::Mesh(mesh) = &*job.input else { panic!("a mesh was given") };
    outlooks(mesh, Ok(&job.plan)).into_iter().map(|outlook| outlook.circle.map(|circle| circle.radius)).collect()
}

#[test]
fn limit_radii_are_those_of_a_deep_refinement() {
    for (delta, k) in [(0.0, 1), (0.6, 1), (1.0, 1), (-0.1, 2), (0.5, 3)] {
        let (mesh, plan) = (tube(5, &UNEVEN, 0.2), push_back(delta, k, "difference"));
        let radii = lines(&mesh, &plan);
        assert_eq!(radii.len(), UNEVEN.len());
        let points = refined(&mesh, &plan, 6);
        for (u, radius) in radii.iter().enumerate() {
            let radius = radius.as_ref().unwrap_or_else(|reason| panic!("ring {u}: {reason}"));
            let p = points[5 * u];
            let deep = sqrt(p[0] * p[0] + p[1] * p[1]);
            assert!((radius - deep).abs() < 1e-3, "delta {delta}, k {k}, ring {u}: {radius} is not {deep}");
        }
    }
}

#[test]
fn lines_that_are_no_circles_are_explained() {
    let plan = push_back(1.0, 1, "difference");
    let mut bent = tube(6, &UNEVEN, 0.0);
    bent["positions"][14] = json!([1.3, 0.1, 2.0]);
    let reasons = lines(&bent, &plan);
    let said = |u: usize| reasons[u].clone().expect_err("the tube is not regular");
    assert!(said(2).contains("no regular polygon") && !said(2).contains("away"), "{}", said(2));
    assert!(said(4).contains("2 rings away") && said(3).contains("next to it"), "{reasons:?}");
    assert!(reasons[0].is_ok() && reasons[5].is_ok(), "boundaries depend on themselves alone: {reasons:?}");
    let isotropic = lines(&tube(6, &UNEVEN, 0.0), &push_back(1.0, 1, "isotropic"));
    assert!(isotropic[0].as_ref().is_err_and(|reason| reason.contains("does not look")));
    let mut wrong = push_back(1.0, 1, "difference");
    wrong["parameters"]["kernel"] = json!(1);
    assert!(lines(&tube(6, &UNEVEN, 0.0), &wrong)[2].as_ref().is_err_and(|reason| reason.contains("cos(alpha/2)")));
}

/// The nets for this purpose in `tests/nets`: a vase, a barrel with collapsed ends, and two tubes that meet.
#[test]
fn the_tagged_nets_have_exact_lines() {
    for (name, least) in [("barrel-tagged", 1), ("t-junction-tagged", 3)] {
        let net = nets::control(name);
        let found = lines(&net["mesh"], &push_back(1.0, 1, "difference"));
        let exact = found.iter().filter(|line| line.is_ok()).count();
        assert!(exact >= least, "{name}: {exact} of {} lines are exact: {found:?}", found.len());
    }
}
