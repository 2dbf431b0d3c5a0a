//! Reports about latitude lines are true: a line reported as exact is a circle of that radius in the limit.

use planish::analysis::circles::{Outlook, outlooks};
use planish::math::functions::{cos, sin, sqrt};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{self, json_with};

pub(crate) type Point = [f64; 3];

pub(crate) fn real(n: usize) -> f64 {
    f64::from(u32::try_from(n).expect("a small number"))
}

/// The radius, height and rotation of a ring.
pub(crate) type Ring = (f64, f64, f64);

/// Returns a tagged tube of k-gons.
pub(crate) fn tube(k: usize, rings: &[Ring]) -> Value {
    let angle = |i: usize| std::f64::consts::TAU * real(i) / real(k);
    let ring = |&(r, z, t): &Ring| (0..k).map(move |i| [r * cos(angle(i) + t), r * sin(angle(i) + t), z]);
    let positions: Vec<Point> = rings.iter().flat_map(ring).collect();
    let at = |u: usize, i: usize| u * k + i % k;
    let pairs = |u: usize, i: usize| [at(u, i), at(u, i + 1), at(u + 1, i + 1), at(u + 1, i)];
    let faces: Vec<_> = (0..rings.len() - 1).flat_map(|u| (0..k).map(move |i| pairs(u, i))).collect();
    let latitude: Vec<_> = (0..rings.len()).flat_map(|u| (0..k).map(move |i| [at(u, i), at(u, i + 1)])).collect();
    let longitude: Vec<_> = (0..rings.len() - 1).flat_map(|u| (0..k).map(move |i| [at(u, i), at(u + 1, i)])).collect();
    json!({ "positions": positions, "faces": faces, "latitude": latitude, "longitude": longitude })
}

/// Returns the reports about the lines of a mesh under a plan.
pub(crate) fn told(mesh: &Value, plan: &Value) -> Vec<Outlook> {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1, "outputs": [{ "format": "json" }] });
    let job = support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
    let planish::job::Input::Mesh(mesh) = &*job.input else { panic!("a mesh was given") };
    outlooks(mesh, Ok(&job.plan))
}

/// Returns the points on each of these lines after some levels, or the limits of its vertices.
pub(super) fn points(mesh: &Value, plan: &Value, lines: &[Outlook], levels: usize, positions: &str) -> Vec<Vec<Point>> {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
    let result = json_with(job, &json!({ "isolines": true, "positions": positions }));
    let points: Vec<Point> = serde_json::from_value(result["positions"].clone()).expect("positions");
    let isolines: Vec<Vec<usize>> = serde_json::from_value(result["isolines"].clone()).expect("lists of vertices");
    let between = |a: u32, b: u32| {
        let ends = |line: &&Vec<usize>| {
            [[a, b], [b, a]].map(|ends| ends.map(|v| v as usize)).contains(&[line[0], line[line.len() - 1]])
        };
        isolines.iter().find(ends).expect("the edge has a line").iter().map(|&v| points[v])
    };
    let around = |outlook: &Outlook| {
        let vertices = &outlook.line.vertices;
        (0..vertices.len()).flat_map(|i| between(vertices[i], vertices[(i + 1) % vertices.len()])).collect()
    };
    lines.iter().map(around).collect()
}

/// Returns the distances from the z axis.
fn radii(points: &[Point]) -> impl Iterator<Item = f64> + '_ {
    points.iter().map(|p| sqrt(p[0] * p[0] + p[1] * p[1]))
}

/// Returns the number of lines reported as exact, and checks that each has the reported radius in the limit and is a
/// circle after two levels.
fn exact(mesh: &Value, plan: &Value) -> usize {
    let mut lines = told(mesh, plan);
    lines.retain(|outlook| outlook.circle.is_ok());
    let spread =
        |values: &mut dyn Iterator<Item = f64>, at: f64| values.fold(0.0, |most: f64, x| most.max((x - at).abs()));
    let [limits, fine] = [(0, "limit"), (2, "refined")].map(|(levels, what)| points(mesh, plan, &lines, levels, what));
    for ((outlook, limit), fine) in lines.iter().zip(&limits).zip(&fine) {
        let radius = outlook.circle.as_ref().expect("kept are those with a circle").radius;
        let off = spread(&mut radii(limit), radius)
            .max(spread(&mut radii(fine), radii(fine).next().expect("a line has points")))
            .max(spread(&mut fine.iter().map(|p| p[2]), fine[0][2]));
        assert!(off < 1e-9, "line {:?}, off by {off}, told {radius}: {plan} {mesh}", outlook.line.vertices);
    }
    lines.len()
}

pub(super) fn word(word: &str, parameters: &Value) -> Value {
    json!({ "word": word, "boundary": "edge-only", "parameters": parameters })
}

pub(super) const UNEVEN: [Ring; 8] = [
    (1.0, 0.0, 0.2),
    (1.7, 0.4, 0.2),
    (1.2, 2.0, 0.5),
    (0.6, 2.2, 0.2),
    (1.4, 3.9, 0.1),
    (0.9, 4.5, 0.2),
    (1.1, 5.0, 0.2),
    (1.0, 5.1, 0.3),
];

/// Averages after a P, and several P, are part of the closed form.
#[test]
fn words_are_judged_by_all_their_letters() {
    for letters in ["UC", "UCC", "UCP", "UCCP", "UCPC", "UCPCC", "UCPP", "UC(UCP)"] {
        for rule in ["difference", "position"] {
            let plan = word(letters, &json!({ "delta": 0.5, "latitude_rule": rule }));
            assert_eq!(exact(&tube(3, &UNEVEN), &plan), 8, "{letters}, {rule}");
        }
    }
}

/// Several U in a cycle, compared with a deep refinement.
#[test]
fn cycles_of_several_steps_have_radii() {
    let (mesh, plan) = (tube(3, &UNEVEN[..5]), word("UCPUCCPC", &json!({ "delta": 0.5 })));
    let lines = told(&mesh, &plan);
    for (outlook, found) in lines.iter().zip(points(&mesh, &plan, &lines, 3, "refined")) {
        let radius = outlook.circle.as_ref().expect("an exact line").radius;
        assert!(radii(&found).all(|found| (found - radius).abs() < 2e-3), "{radius}: {:?}", found[0]);
    }
}

/// The limit of a line depends on the rings within reach: if a mesh diverges elsewhere, here at vertices of three edges
/// around a cap, its other lines are still circles.
#[test]
fn what_diverges_elsewhere_leaves_lines_exact() {
    let (k, n) = (8, 6);
    let rings: Vec<Ring> = (0..n).map(|i| (1.0 + 0.2 * sin(1.3 * real(i)), real(i), 0.0)).collect();
    let mut mesh = tube(k, &rings);
    let (first, centre) = ((n - 1) * k, n * k);
    mesh["positions"].as_array_mut().expect("points").push(json!([0, 0, 6]));
    let cap = (0..k / 2).map(|i| json!([first + 2 * i, first + 2 * i + 1, first + (2 * i + 2) % k, centre]));
    mesh["faces"].as_array_mut().expect("faces").extend(cap);
    let plan = json!({ "preset": "push-back", "boundary": "edge-only", "parameters": { "delta": "60*(valence-4)" } });
    let limit = json!({
        "input": { "mesh": mesh }, "plan": plan, "levels": 1, "outputs": [{ "format": "json", "positions": "limit" }]
    });
    let refused = format!("{:?}", support::render(&limit).expect_err("there is no limit"));
    assert!(refused.contains("no continuous limit"), "{refused}");
    let mut lines = told(&mesh, &plan);
    lines.retain(|outlook| outlook.circle.is_ok());
    assert_eq!(lines.len(), n - 2, "lines away from the cap");
    for (outlook, found) in lines.iter().zip(points(&mesh, &plan, &lines, 4, "refined")) {
        let radius = outlook.circle.as_ref().expect("an exact line").radius;
        let (first, height) = (radii(&found).next().expect("a line has points"), found[0][2]);
        assert!((first - radius).abs() < 1e-3, "{first}, told {radius}");
        let off = radii(&found).map(|r| (r - first).abs()).chain(found.iter().map(|p| (p[2] - height).abs()));
        assert!(off.fold(0.0, f64::max) < 1e-12, "line {:?}", outlook.line.vertices);
    }
}

#[test]
fn words_that_keep_no_circles_are_told_so() {
    for letters in ["U", "UP", "UUC", "CU", "C(UC)", "U(UCP)"] {
        for outlook in told(&tube(6, &UNEVEN), &word(letters, &json!({ "delta": 0.5 }))) {
            let said = outlook.circle.expect_err("no circle");
            assert!(said.contains("a C follows each U"), "{letters}: {said}");
        }
    }
}

/// The report on a disturbed tube: its lines, and a part of the reason why they are not circles.
#[test]
fn disturbances_are_seen_and_named() {
    let ring = |u: usize| (0..6).map(|i| [6 * u + i, 6 * u + (i + 1) % 6]).collect::<Vec<_>>();
    let sharp =
        |edges: &[[usize; 2]]| json!(edges.iter().map(|e| json!({ "edge": e, "sharpness": 10 })).collect::<Vec<_>>());
    let per_ring: Vec<f64> = (0..48).map(|v| 0.1 * real(v / 6)).collect();
    let one_off: Vec<f64> = (0..48).map(|v| if v == 25 { 0.6 } else { 0.5 }).collect();
    let right = std::f64::consts::TAU / 6.0;
    let cases = [
        ("corners", json!([{ "vertex": 25, "sharpness": 10 }]), 5, "a vertex is a corner"),
        ("creases", sharp(&[[24, 25]]), 5, "an edge is sharp"),
        ("creases", sharp(&[[24, 30]]), 4, "an edge is sharp"),
        ("creases", sharp(&ring(4)), 8, ""),
        ("holes", json!([20]), 8, ""),
        ("parameters", json!({ "delta": one_off }), 5, "delta differs"),
        ("parameters", json!({ "delta": per_ring }), 8, ""),
        ("parameters", json!({ "alpha": vec![0.5; 48] }), 0, "2 pi / 6"),
        ("parameters", json!({ "alpha": vec![right; 48] }), 8, ""),
        ("parameters", json!({ "kernel": vec![0.9; 48] }), 0, "carry a kernel"),
    ];
    for (field, value, expected, reason) in cases {
        let (mut mesh, plan) = (tube(6, &UNEVEN), word("UCP", &json!({ "delta": 0.5 })));
        mesh[field] = value;
        assert_eq!(exact(&mesh, &plan), expected, "{field}: {reason}: {:?}", told(&mesh, &plan));
        let mut said = told(&mesh, &plan).into_iter().filter_map(|outlook| outlook.circle.err());
        assert!(said.all(|said| said.contains(reason)), "{field}: {reason}");
    }
}

#[test]
fn plans_that_lose_circles_are_told_so() {
    let cases = [
        (json!({ "perturbation": { "amplitude": 0.1, "decay": 0.4 } }), "at random"),
        (json!({ "kernel": 1 }), "cos(alpha/2)"),
        (json!({ "kernel": ["cos(alpha/2)", 0.5] }), "1 in later averages"),
        (json!({ "alpha": 1 }), "2 pi / 6"),
        (json!({ "compensation": 1 }), "1/cos(alpha/2)"),
        (json!({ "alpha": "2*pi/6", "compensation_alpha": 0.3 }), "1/cos(alpha/2)"),
        (json!({ "compensation_alpha": 0.3 }), "1/cos(alpha/2)"),
        (json!({ "compensation_alpha": 0 }), "1/cos(alpha/2)"),
    ];
    for (parameters, reason) in cases {
        for outlook in told(&tube(6, &UNEVEN), &word("UCCP", &parameters)) {
            let said = outlook.circle.expect_err("no circle");
            assert!(said.contains(reason), "{parameters}: {said}");
        }
    }
}

/// A tube closed by a single face: the vertices there have three edges, and a delta other than 0 at them disturbs the
/// lines that their displacement reaches.
#[test]
fn rings_of_another_valence_are_pushed_back_by_their_own_delta() {
    let rings: Vec<Ring> = (0..12).map(|u| (1.0 + 0.3 * cos(2.0 * real(u)), real(u), 0.0)).collect();
    let mut mesh = tube(5, &rings);
    mesh["faces"].as_array_mut().expect("faces").push(json!([55, 56, 57, 58, 59]));
    for (letters, delta, expected) in [
        ("UCP", "(valence-4)/valence", 10),
        ("UCPC", "(valence-4)/valence", 9),
        ("UCPP", "(valence-4)/valence", 10),
        ("UCP", "0", 11),
        ("UCPC", "0", 10),
        ("UCP", "4-valence", 10),
        ("UCP", "0.5", 10),
        ("UCP", "valence/8", 10),
        ("UCCP", "0.5", 10),
        ("UPCP", "0.5", 10),
        ("UC", "4-valence", 11),
        ("UPC", "0.5", 11),
    ] {
        assert_eq!(exact(&mesh, &word(letters, &json!({ "delta": delta }))), expected, "{letters}, {delta}");
    }
}

/// If the limit is refused, no line is a circle in it.
#[test]
fn plans_without_a_limit_are_told_so() {
    let mesh = tube(6, &UNEVEN);
    for (delta, is_refused) in [(30.0, true), (-20.0, true), (1.0, false)] {
        let plan = word("UCP", &json!({ "delta": delta }));
        let outputs = json!([{ "format": "json", "positions": "limit" }]);
        let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 0, "outputs": outputs });
        let refused = support::render(&job).err().map(|faults| faults[0].detail.clone());
        assert_eq!(refused.is_some(), is_refused, "{refused:?}");
        for outlook in told(&mesh, &plan) {
            let said = outlook.circle.err();
            assert_eq!(said.is_some(), is_refused, "{said:?}");
            let pair = said.zip(refused.as_ref());
            assert!(pair.is_none_or(|(said, refused)| refused.contains(&said) && said.contains("no continuous limit")));
        }
    }
}

/// Rings that wind around their axis several times need the alpha `2 pi p / n`.
#[test]
fn stars_become_circles_under_their_own_alpha() {
    for (k, p) in [(5, 2), (7, 3), (6, 2), (5, 1)] {
        let mut mesh = tube(k, &UNEVEN);
        let whole = mesh["positions"].clone();
        for v in 0..8 * k {
            mesh["positions"][v] = whole[v - v % k + v % k * p % k].clone();
        }
        let plan = |alpha: &str| word("UCP", &json!({ "delta": 0.5, "alpha": alpha }));
        assert_eq!(exact(&mesh, &plan(&format!("2*pi*{p}/{k}"))), 8, "{k}/{p}");
        let said: Vec<String> =
            told(&mesh, &plan("1.1")).into_iter().filter_map(|outlook| outlook.circle.err()).collect();
        assert!(
            said.len() == 8 && said.iter().all(|said| said.contains(&format!("alpha = {} pi / {k}", 2 * p))),
            "{said:?}"
        );
        assert_eq!(exact(&mesh, &word("UCP", &json!({}))), if p == 1 { 8 } else { 0 });
    }
    let mut mesh = tube(5, &UNEVEN);
    let whole = mesh["positions"].clone();
    (20..25).for_each(|v| mesh["positions"][v] = whole[20 + 2 * (v - 20) % 5].clone());
    let said: Vec<String> = told(&mesh, &word("UCP", &json!({ "delta": 0.5 })))
        .into_iter()
        .filter_map(|outlook| outlook.circle.err())
        .collect();
    assert!(said.iter().any(|said| said.contains("another number of times")), "{said:?}");
}

/// A ring in the opposite direction makes ellipses of its neighbours, although it is regular, too.
#[test]
fn rings_that_run_the_other_way_round_are_seen() {
    let mut mesh = tube(6, &UNEVEN);
    for i in 0..6 {
        mesh["positions"][18 + i][1] = json!(-mesh["positions"][18 + i][1].as_f64().expect("a number"));
    }
    assert_eq!(exact(&mesh, &word("UCP", &json!({}))), 3);
}

/// Far from the origin, a ring is as regular as one near it.
#[test]
fn far_tubes_are_judged_by_their_size() {
    let mut mesh = tube(6, &UNEVEN);
    for p in mesh["positions"].as_array_mut().expect("positions") {
        p[0] = json!(p[0].as_f64().expect("a number") + 1e6);
    }
    let plan = word("UCP", &json!({}));
    let is_exact = |mesh: &Value| told(mesh, &plan).iter().filter(|outlook| outlook.circle.is_ok()).count();
    assert_eq!(is_exact(&mesh), 8);
    mesh["positions"][25][1] = json!(1.0);
    assert_eq!(is_exact(&mesh), 3);
}

/// Adds one possible disturbance to a tube of `k`-gons with `n` rings: to the mesh, or to the parameters.
fn disturbed(mesh: &mut Value, parameters: &mut Value, k: usize, n: usize, what: usize, place: usize) {
    let v = place % (k * n);
    let (u, i) = (v / k, v % k);
    let next = u * k + (i + 1) % k;
    let sharp = |a: usize, b: usize| json!({ "edge": [a, b], "sharpness": 10 });
    let all = |f: &dyn Fn(usize) -> f64| json!((0..k * n).map(f).collect::<Vec<f64>>());
    let own = std::f64::consts::TAU / real(k);
    match what {
        0 => mesh["corners"] = json!([{ "vertex": v, "sharpness": 10 }]),
        1 => mesh["creases"] = json!([sharp(v, next)]),
        2 if u + 1 < n => mesh["creases"] = json!([sharp(v, v + k)]),
        3 => mesh["creases"] = json!((0..k).map(|i| sharp(u * k + i, u * k + (i + 1) % k)).collect::<Vec<_>>()),
        4 => mesh["parameters"] = json!({ "delta": all(&|w| if w == v { 0.9 } else { 0.4 }) }),
        5 => mesh["parameters"] = json!({ "delta": all(&|w| 0.2 * real(w / k)) }),
        6 => mesh["parameters"] = json!({ "alpha": all(&|w| if w == v { 0.5 } else { own }) }),
        7 => mesh["parameters"] = json!({ "compensation": all(&|_| 1.1) }),
        8 => mesh["positions"][v][2] = json!(-0.3),
        9 => mesh["holes"] = json!([0]),
        10 => mesh["parameters"] = json!({ "alpha": all(&|w| if w / k == u { 0.5 } else { own }) }),
        11 => parameters["kernel_longitude"] = json!(0.6),
        12 => parameters["alpha"] = json!(own),
        13 => parameters["alpha"] = json!(0.7),
        14 => parameters["kernel"] = json!(["cos(alpha/2)", 1.2]),
        15 => parameters["compensation_alpha"] = json!(0.7),
        _ => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn lines_told_exact_are_circles(
        k in 3_usize..6,
        rings in prop::collection::vec((0.3_f64..2.0, 0.1_f64..1.5, -0.4_f64..0.4), 2..8),
        letters in prop::sample::select(vec!["UC", "UCP", "UCC", "UCCP", "UCPC", "UCPP", "UPCP"]),
        delta in prop::sample::select(vec![-0.1, 0.0, 0.5, 1.0]),
        rule in prop::sample::select(vec!["difference", "position"]),
        boundary in prop::sample::select(vec!["edge-only", "edge-and-corner", "none"]),
        what in 0_usize..20,
        place in 0_usize..64,
    ) {
        let mut height = 0.0;
        let rings: Vec<Ring> = rings.into_iter().map(|(r, step, turn)| {
            height += step;
            (r, height, turn)
        }).collect();
        let mut mesh = tube(k, &rings);
        let mut parameters = json!({ "delta": delta, "latitude_rule": rule });
        disturbed(&mut mesh, &mut parameters, k, rings.len(), what, place);
        let plan = json!({ "word": letters, "boundary": boundary, "parameters": parameters });
        let lines = exact(&mesh, &plan);
        let undisturbed = what > 15 && !(letters.starts_with("UP") && rule == "position");
        prop_assert!(!undisturbed || lines == rings.len(), "{} of {} lines", lines, rings.len());
    }
}
