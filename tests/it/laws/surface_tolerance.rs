//! Levels by tolerance on meshes: the bound holds, is not much larger than the true distance, and falls by a factor of
//! 4 per level.

use std::collections::{BTreeMap, BTreeSet};

use planish::math::functions::{cos, sin, sqrt};
use planish::wire::answer::EstimateAnswer;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{Net, control, cube, cylinder, grid, manifold, torus, triangle_manifold, triangulated};
use crate::support::surfaces::Surface;
use crate::support::{self, faults, parsed};

/// Maximum number of points of the limit that are compared with a surface.
const SAMPLES: usize = 2000;

fn job(input: &Value, plan: &Value, levels: &Value, positions: &str) -> Value {
    json!({ "input": input, "plan": plan, "levels": levels, "outputs": [{ "format": "json", "positions": positions }] })
}

/// Returns the level and the bound for a tolerance.
fn within(input: &Value, plan: &Value, tolerance: f64, positions: &str) -> (u32, f64) {
    let job = job(input, plan, &json!({ "tolerance": tolerance }), positions);
    let job = parsed(job.to_string().as_bytes()).unwrap_or_else(|f| panic!("{f:?} for {plan}"));
    let reached = job.reached.expect("a tolerance was asked for");
    assert_eq!(job.levels, reached.level);
    (reached.level, reached.bound.expect("a tolerance has a bound"))
}

fn at_level(input: &Value, plan: &Value, levels: u32, positions: &str) -> Net {
    let (bytes, _) = support::render(&job(input, plan, &json!(levels), positions)).unwrap_or_else(|f| panic!("{f:?}"));
    Net::of(&serde_json::from_slice(&bytes).expect("json output"))
}

/// Returns the greatest distance between a level, with its quads cut along either diagonal, and points of the limit,
/// which are those of deeper levels; in both directions.
fn deviation(input: &Value, plan: &Value, level: u32, positions: &str) -> f64 {
    let coarse = at_level(input, plan, level, positions);
    let more = if coarse.faces.len() > 500 { 1 } else { 2 };
    let limit = at_level(input, plan, level + more, "limit");
    let fine = Surface::cut(&limit, 0);
    let some = |points: Vec<[f64; 3]>| points.iter().copied().step_by(points.len() / SAMPLES + 1).collect::<Vec<_>>();
    let used: BTreeSet<usize> = limit.faces.iter().flatten().copied().collect();
    let shown = some(used.iter().map(|&v| limit.positions[v]).collect());
    let both = |first: usize| {
        let surface = Surface::cut(&coarse, first);
        surface.farthest(&shown).max(fine.farthest(&some(surface.samples())))
    };
    [0, 1].map(both).into_iter().fold(0.0, f64::max)
}

fn preset(name: &str) -> Value {
    json!({ "preset": name })
}

fn on_triangles(word: &str) -> Value {
    json!({ "word": word, "parameters": { "split": "triangle" } })
}

/// Returns a round torus of `n x n` quads.
fn round(n: usize) -> Net {
    let whole = |i: usize| f64::from(u32::try_from(i).expect("small"));
    let Net { faces, positions } = torus(n, n);
    let around = |i: usize| 2.0 * std::f64::consts::PI * whole(i) / whole(n);
    let place = |v: usize| {
        let (u, w) = (around(v % n), around(v / n));
        [(3.0 + cos(w)) * cos(u), (3.0 + cos(w)) * sin(u), sin(w)]
    };
    Net { positions: (0..positions.len()).map(place).collect(), faces }
}

/// Returns the cube of side 2 with two sharp edges.
fn creased(sharpness: f64) -> Value {
    let mut input = control("cube");
    let face = input["mesh"]["faces"][0].clone();
    input["mesh"]["creases"] = json!([
        { "edge": [face[0], face[1]], "sharpness": 10 }, { "edge": [face[1], face[2]], "sharpness": sharpness },
    ]);
    input
}

fn typical() -> Vec<(&'static str, Value, Value, f64)> {
    vec![
        ("cube", control("cube"), preset("catmull-clark"), 0.02),
        ("torus", control("torus"), preset("catmull-clark"), 0.05),
        ("barrel", control("barrel"), preset("catmull-clark"), 0.1),
        ("grid", control("grid"), preset("catmull-clark"), 0.01),
        ("mixed", control("mixed"), preset("catmull-clark"), 0.03),
        ("grid, edge-only", control("grid"), json!({ "preset": "catmull-clark", "boundary": "edge-only" }), 0.02),
        ("mixed, edge-only", control("mixed"), json!({ "preset": "catmull-clark", "boundary": "edge-only" }), 0.01),
        ("torus of triangles", triangulated(round(10)).input(), preset("catmull-clark"), 0.2),
        ("cube with sharp edges", creased(10.0), preset("catmull-clark"), 0.05),
        ("cube with an edge that is sharp for a while", creased(1.5), preset("catmull-clark"), 0.05),
        ("torus, UC", control("torus"), super::word("UC"), 0.02),
        ("grid, UCC", control("grid"), super::word("UCC"), 0.02),
        ("cube, UDD", control("cube"), super::word("UDD"), 0.03),
        ("cube, UDDC", control("cube"), super::word("U(UDDC)"), 0.05),
        ("cube, two upsamplings", control("cube"), super::word("UCUCC"), 0.2),
        ("cube, UD", control("cube"), super::word("UD"), 0.05),
        ("torus, UD", control("torus"), super::word("UD"), 0.05),
        ("cube, UDDD", control("cube"), super::word("UDDD"), 0.05),
        ("barrel, UD", control("barrel"), super::word("UD"), 0.05),
        ("barrel, UDDD", control("barrel"), super::word("UDDD"), 0.05),
        ("animal, UD", control("animal"), super::word("UD"), 0.2),
        ("tetrahedron, UCD", control("tetrahedron"), super::word("UCD"), 0.05),
        (
            "torus of degree 4",
            control("torus"),
            json!({ "preset": "repeated-averaging", "parameters": { "degree": 4 } }),
            0.05,
        ),
        ("tetrahedron, loop", control("tetrahedron"), preset("loop"), 0.02),
        ("stellated, loop", control("stellated"), preset("loop"), 0.1),
        ("stellated, UC", control("stellated"), on_triangles("UC"), 0.2),
        ("tetrahedron, UCC", control("tetrahedron"), on_triangles("UCC"), 0.02),
    ]
}

#[test]
fn bounds_hold_and_are_close_on_typical_meshes() {
    for (name, input, plan, tolerance) in typical() {
        let (level, bound) = within(&input, &plan, tolerance, "refined");
        assert!(bound <= tolerance && level > 0, "{name}: level {level} has the bound {bound}");
        let truth = deviation(&input, &plan, level, "refined");
        assert!(truth <= bound, "{name}, level {level}: {truth} is beyond the bound {bound}");
        assert!(bound < 10.0 * truth, "{name}, level {level}: the bound {bound} is far from {truth}");
    }
}

#[test]
fn limit_positions_are_within_the_tolerance_too() {
    for (name, input, plan, tolerance) in typical().into_iter().step_by(5) {
        let (level, bound) = within(&input, &plan, 2.0 * tolerance, "limit");
        let truth = deviation(&input, &plan, level, "limit");
        assert!(truth <= bound && bound <= 2.0 * tolerance, "{name}, level {level}: {truth} {bound}");
        assert!(bound < 10.0 * truth, "{name}, level {level}: the bound {bound} is far from {truth}");
    }
}

/// Returns bounds of consecutive levels.
fn falling(input: &Value, plan: &Value, start: f64, n: usize) -> Vec<(u32, f64)> {
    let mut tolerance = start;
    let next = |_| {
        let found = within(input, plan, tolerance, "refined");
        tolerance = found.1 * 0.999;
        found
    };
    (0..n).map(next).collect()
}

#[test]
fn each_level_divides_the_bound_by_4() {
    let cases = [
        ("torus", control("torus"), super::word("UC"), 0.05),
        ("grid", control("grid"), preset("catmull-clark"), 0.04),
        ("tetrahedron", control("tetrahedron"), preset("loop"), 0.06),
    ];
    for (name, input, plan, start) in cases {
        for pair in falling(&input, &plan, start, 3).windows(2) {
            let ((level, bound), (next, smaller)) = (pair[0], pair[1]);
            assert_eq!(next, level + 1, "{name}");
            assert!((bound / smaller - 4.0).abs() < 1.0, "{name}, level {next}: {bound} then {smaller}");
        }
    }
}

/// Beyond the size of nets that are measured, only second differences bound the distance of regular regions.
#[test]
fn bounds_go_on_where_nets_are_too_large_to_be_measured() {
    let found = falling(&round(60).input(), &super::word("UC"), 1e-3, 4);
    assert!(found[3].0 >= 4, "{found:?}");
    for pair in found.windows(2) {
        assert!(pair[0].1 / pair[1].1 > 3.0 && pair[0].1 / pair[1].1 < 9.0, "{found:?}");
    }
}

#[test]
fn flat_and_bilinear_surfaces_are_their_own_limits() {
    let flat = Net { positions: grid(3, 3).positions.iter().map(|p| [p[0], p[1], 0.5]).collect(), ..grid(3, 3) };
    let (level, bound) = within(&flat.input(), &preset("catmull-clark"), 1e-9, "refined");
    assert!(level == 0 && bound < 1e-12, "level {level}, bound {bound}");
    // quads of a bilinear surface bend by their twist only, which a level halves twice
    let found = falling(&cube().input(), &preset("bilinear"), 1.0, 4);
    let levels: Vec<u32> = found.iter().map(|&(level, _)| level).collect();
    assert_eq!(levels, [0, 1, 2, 3]);
    assert!(found.windows(2).all(|pair| (pair[0].1 / pair[1].1 - 4.0).abs() < 0.5), "{found:?}");
}

/// Faces other than quads are split first.
#[test]
fn meshes_of_other_faces_are_within_a_tolerance_from_level_1_on() {
    for input in [control("mixed"), control("tetrahedron")] {
        let (level, bound) = within(&input, &preset("catmull-clark"), 1e3, "refined");
        assert!(level == 1 && bound < 10.0, "level {level}, bound {bound}");
    }
}

#[test]
fn the_level_is_part_of_the_key_and_the_tolerance_is_not() {
    let of = |levels: Value, positions: &str| {
        let job = job(&control("cube"), &preset("catmull-clark"), &levels, positions);
        parsed(job.to_string().as_bytes()).expect("a job")
    };
    let within = of(json!({ "tolerance": 0.05 }), "refined");
    let counted = of(json!(within.levels), "refined");
    assert_eq!(within.keys()[0], counted.keys()[0]);
    let limits = planish::job::limits::Limits::default();
    let [answer, expected] =
        [&within, &counted].map(|job| EstimateAnswer::new(job, &limits.estimate(job).expect("a small job")));
    let reached = answer.reached.expect("the answer says what the tolerance led to");
    assert!(reached.level == within.levels && reached.bound.is_some_and(|bound| bound <= 0.05));
    let counts = |answer: &EstimateAnswer| serde_json::to_value(&answer.levels).expect("counts");
    assert_eq!(counts(&answer), counts(&expected));
}

#[test]
fn the_output_that_is_farther_decides() {
    let outputs = json!([{ "format": "obj" }, { "format": "ply", "positions": "limit" }]);
    let both = json!({
        "input": control("cube"), "plan": preset("catmull-clark"), "levels": { "tolerance": 0.05 }, "outputs": outputs
    });
    let both = parsed(both.to_string().as_bytes()).expect("a job").reached.expect("a level");
    let each =
        ["refined", "limit"].map(|positions| within(&control("cube"), &preset("catmull-clark"), 0.05, positions));
    assert_eq!(both.level, each[0].0.max(each[1].0));
    assert!(each.iter().any(|&(level, bound)| level == both.level && Some(bound) == both.bound));
}

#[test]
fn what_has_no_bound_is_refused_with_the_reason() {
    let with = |parameters: Value| json!({ "word": "UC", "parameters": parameters });
    let (cube, triangles, open) = (control("cube"), control("stellated"), control("grid"));
    let cases = [
        (&cube, preset("kobbelt"), "make splines"),
        (&cube, preset("doo-sabin"), "make splines"),
        (&triangles, preset("butterfly"), "make splines"),
        (&triangles, preset("sqrt-3"), "make splines"),
        (&cube, super::word("UCP"), "P pushes back"),
        (&cube, super::word("CU"), "begin with a U"),
        (&cube, super::word("U3C"), "arity above 2"),
        (&cube, super::word("UDUC"), "pairs of D"),
        (&cube, super::word("UDCD"), "pairs of D"),
        (&open, super::word("UDD"), "boundary"),
        (&cube, with(json!({ "kernel": 2 })), "kernel is 2"),
        (&cube, with(json!({ "alpha": "pi/4", "kernel": "cos(alpha/2)" })), "kernel is 0.9"),
        (&cube, with(json!({ "perturbation": { "amplitude": 0.1 } })), "perturbation"),
        (&triangles, json!({ "word": "UC", "parameters": { "split": "triangle", "mu": 0.5 } }), "mu than 1/4"),
        (&triangles, on_triangles("UDD"), "triangles"),
    ];
    let refused = |input: &Value, plan: &Value, tolerance: f64| {
        let fault = faults(json!({ "input": input, "plan": plan, "levels": { "tolerance": tolerance } })).remove(0);
        format!("{}: {}", fault.pointer, fault.detail)
    };
    for (input, plan, expected) in cases {
        let said = refused(input, &plan, 0.1);
        assert!(said.starts_with("/levels/tolerance: ") && said.contains(expected), "{said} for {plan}");
        assert!(expected == "boundary" || said.contains("\"levels\" as a number"), "{said}");
    }
    let own = |key: &str, value: Value| {
        let mut input = cube.clone();
        input["mesh"][key] = value;
        input
    };
    let parameters = own("parameters", json!({ "kernel": [1, 1, 1, 1, 1, 1, 1, 2] }));
    assert!(refused(&parameters, &super::word("UC"), 0.1).contains("parameters of vertices"));
    let tagged = refused(&control("barrel-tagged"), &super::word("UC"), 0.1);
    assert!(tagged.contains("latitude"), "{tagged}");
    assert!(refused(&cube, &preset("catmull-clark"), 1e-15).contains("rounding"));
    assert!(refused(&cube, &preset("catmull-clark"), -1.0).contains("positive"));
}

/// Too many vertices for an irregular net; and a level that is found, but has too many faces for the server.
#[test]
fn what_is_too_large_is_refused_with_the_remedy() {
    let many = triangulated(torus(60, 60));
    let input = json!({ "input": many.input(), "plan": preset("catmull-clark"), "levels": { "tolerance": 1e-3 } });
    let fault = faults(input).remove(0);
    assert!(fault.pointer == "/levels/tolerance" && fault.detail.contains("are looked at"), "{fault:?}");
    let fine = json!({ "input": control("grid"), "plan": preset("catmull-clark"), "levels": { "tolerance": 1e-8 } });
    let fault = faults(fine).remove(0);
    assert!(fault.pointer == "/levels" && fault.detail.contains("coarser tolerance"), "{fault:?}");
}

/// Returns the greatest second difference over straight lines of edges, and over rhombi of triangles, of a regular net.
fn greatest_second_difference(net: &Net) -> f64 {
    let mut most: f64 = 0.0;
    let mut measure = |weighted: &[(usize, f64)]| {
        let x = [0, 1, 2].map(|k| weighted.iter().map(|&(v, w)| w * net.positions[v][k]).sum::<f64>());
        most = most.max(sqrt(x.iter().map(|x| x * x).sum()));
    };
    let triangles = net.faces[0].len() == 3;
    for v in 0..net.positions.len() {
        // around the vertex: the successor of each neighbour
        let mut after = BTreeMap::new();
        for face in &net.faces {
            if let Some(j) = face.iter().position(|&u| u == v) {
                let n = face.len();
                after.insert(face[(j + 1) % n], face[(j + n - 1) % n]);
            }
        }
        let open = after.keys().copied().find(|a| !after.values().any(|b| b == a));
        let first = open.unwrap_or_else(|| *after.keys().next().expect("no vertex is isolated"));
        let ring: Vec<usize> =
            std::iter::successors(Some(first), |at| after.get(at).copied().filter(|&b| b != first)).collect();
        let n = ring.len();
        let lines = match open {
            None => (0..n / 2).map(|i| [ring[i], ring[i + n / 2]]).collect(),
            // a corner of one quad has no line
            Some(_) if n == 2 => vec![],
            Some(_) => vec![[ring[0], ring[n - 1]]],
        };
        lines.iter().for_each(|&[a, b]| measure(&[(a, 1.0), (v, -2.0), (b, 1.0)]));
        let inner = if open.is_some() { 1..n - 1 } else { 0..n };
        for i in inner.filter(|_| triangles) {
            measure(&[(ring[(i + n - 1) % n], 1.0), (ring[(i + 1) % n], 1.0), (v, -1.0), (ring[i], -1.0)]);
        }
    }
    most
}

fn check(net: &Net, plan: &Value, positions: &str) -> Result<(), TestCaseError> {
    let (level, bound) = within(&net.input(), plan, 0.3, positions);
    let truth = deviation(&net.input(), plan, level, positions);
    prop_assert!(truth <= bound + 1e-12, "{} at level {}: {} is beyond {}", plan, level, truth, bound);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    #[test]
    fn regular_nets_divide_second_differences_by_4(
        heights in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 30),
        triangles in any::<bool>(),
        signs in any::<bool>(),
        word in prop::sample::select(vec!["UC", "UCC", "UCCC"]),
    ) {
        let net = if triangles { triangulated(cylinder(5, 5)) } else { grid(4, 4) };
        let heights = heights.iter().map(|p| if signs { p.map(f64::signum) } else { *p });
        let net = Net { positions: heights.take(25).collect(), ..net };
        let plan = if triangles { on_triangles(word) } else { super::word(word) };
        let mut before = greatest_second_difference(&net);
        for level in 1..3 {
            let after = greatest_second_difference(&at_level(&net.input(), &plan, level, "refined"));
            prop_assert!(after <= before / 4.0 + 1e-12, "{}, level {}: {} then {}", plan, level, before, after);
            before = after;
        }
    }

    #[test]
    fn bounds_hold_on_random_meshes(net in manifold(), which in 0..5_usize, limit in any::<bool>()) {
        let plan = [
            preset("catmull-clark"),
            json!({ "preset": "catmull-clark", "boundary": "edge-only" }),
            super::word("UC"),
            super::word("UCC"),
            preset("bilinear"),
        ][which].clone();
        check(&net, &plan, if limit && which != 4 { "limit" } else { "refined" })?;
    }

    #[test]
    fn bounds_hold_on_random_triangles(net in triangle_manifold(), which in 0..4_usize, limit in any::<bool>()) {
        let plan = [
            preset("loop"),
            json!({ "preset": "loop", "boundary": "edge-only" }),
            on_triangles("UC"),
            on_triangles("UCC"),
        ][which].clone();
        check(&net, &plan, if limit { "limit" } else { "refined" })?;
    }

    #[test]
    fn bounds_hold_on_random_tori_under_dual_schemes(
        n in 3..6_usize, m in 3..5_usize, moves in prop::collection::vec(prop::array::uniform3(-0.4..0.4_f64), 20),
        which in 0..3_usize, cut in any::<bool>(), limit in any::<bool>(),
    ) {
        let mut net = torus(n, m);
        net.positions.iter_mut().zip(moves.iter().cycle()).for_each(|(p, x)| (0..3).for_each(|k| p[k] += x[k]));
        let net = if cut { triangulated(net) } else { net };
        let (plan, placed) = (super::word(["UD", "UDDD", "UCD"][which]), ["refined", "limit"][usize::from(limit)]);
        // for any tolerance, so that the bound of the second level is tested
        let (_, first) = within(&net.input(), &plan, 1e3, placed);
        let (level, bound) = within(&net.input(), &plan, first * 0.999, placed);
        let truth = deviation(&net.input(), &plan, level, placed);
        prop_assert!(truth <= bound + 1e-12, "{} at level {}: {} is beyond {}", plan, level, truth, bound);
    }

    #[test]
    fn bounds_hold_beside_creases_and_corners(
        net in manifold(),
        picks in prop::collection::vec((any::<prop::sample::Index>(), 0..3_usize), 0..5),
        corner in any::<prop::sample::Index>(),
    ) {
        let edges: Vec<_> = net.edges().into_iter().collect();
        let mut tagged: Vec<_> = picks.iter().map(|(at, s)| (at.get(&edges), [0.7, 2.0, 10.0][*s])).collect();
        tagged.sort_by_key(|(edge, _)| **edge);
        tagged.dedup_by_key(|(edge, _)| **edge);
        let mut input = net.input();
        input["mesh"]["creases"] = tagged.iter().map(|(e, s)| json!({ "edge": [e.0, e.1], "sharpness": s })).collect();
        input["mesh"]["corners"] = json!([{ "vertex": corner.index(net.positions.len()), "sharpness": 10 }]);
        let (level, bound) = within(&input, &preset("catmull-clark"), 0.4, "refined");
        let truth = deviation(&input, &preset("catmull-clark"), level, "refined");
        prop_assert!(truth <= bound + 1e-12, "level {}: {} is beyond {}", level, truth, bound);
    }
}
