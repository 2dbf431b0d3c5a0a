//! Parameters of mesh vertices; seed and decay of perturbations.

use serde_json::{Value, json};

use crate::support::nets::{self, Net, distance};
use crate::support::{self, faults};

fn refined(net: &Net, parameters: &Value, plan: &Value, levels: u32) -> Net {
    let mut input = net.input();
    if !parameters.is_null() {
        input["mesh"]["parameters"] = parameters.clone();
    }
    Net::of(&support::json(json!({ "input": input, "plan": plan, "levels": levels })))
}

fn apart(a: &Net, b: &Net) -> f64 {
    a.positions.iter().zip(&b.positions).map(|(p, q)| distance(p, q)).fold(0.0, f64::max)
}

fn nets() -> [Net; 3] {
    [nets::cube(), nets::mixed(), nets::prism(5)]
}

/// A parameter with equal values at all vertices is the plan's parameter.
#[test]
fn equal_parameters_are_the_plans() {
    for net in nets() {
        let n = net.positions.len();
        let own = json!({ "kernel": vec![1.3; n], "compensation": vec![0.8; n], "delta": vec![0.4; n] });
        let plan = json!({ "word": "UCCP", "parameters": { "kernel": 1.3, "compensation": 0.8, "delta": 0.4 } });
        let bare = refined(&net, &Value::Null, &plan, 2);
        let carried = refined(&net, &own, &json!({ "word": "UCCP" }), 2);
        assert!(apart(&bare, &carried) < 1e-13, "{}", apart(&bare, &carried));
        let functions = json!({ "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.4 });
        let mut with_alpha = functions.clone();
        with_alpha["alpha"] = json!(0.9);
        let bare = refined(&net, &Value::Null, &json!({ "word": "UCP", "parameters": with_alpha }), 2);
        let own = json!({ "alpha": vec![0.9; n] });
        let carried = refined(&net, &own, &json!({ "word": "UCP", "parameters": functions }), 2);
        assert!(apart(&bare, &carried) < 1e-13, "{}", apart(&bare, &carried));
    }
}

/// One mesh, interpolated at some vertices and approximated at the others.
#[test]
fn delta_decides_vertex_by_vertex_what_is_interpolated() {
    let net = nets::cube();
    let delta = [1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let fine = refined(&net, &json!({ "delta": delta }), &json!({ "word": "UCP" }), 3);
    for (v, delta) in delta.iter().enumerate() {
        let moved = distance(&net.positions[v], &fine.positions[v]);
        assert_eq!(moved < 1e-12, *delta > 0.5, "vertex {v} moved by {moved}");
    }
}

/// Affine maps commute with all parameters of vertices.
#[test]
fn parameters_of_vertices_commute_with_scaling() {
    for net in nets() {
        let n = net.positions.len();
        let ramp = |from: f64| (0..n).scan(from, |x, _| Some(std::mem::replace(x, *x + 0.05))).collect::<Vec<f64>>();
        let own = json!({ "kernel": ramp(0.7), "compensation": ramp(0.9), "delta": ramp(-0.2) });
        let larger = Net { positions: net.positions.iter().map(|p| p.map(|x| 4.0 * x)).collect(), ..net.clone() };
        let plan = json!({ "word": "UCP" });
        let (a, b) = (refined(&net, &own, &plan, 2), refined(&larger, &own, &plan, 2));
        let a = Net { positions: a.positions.iter().map(|p| p.map(|x| 4.0 * x)).collect(), ..a };
        assert!(apart(&a, &b) < 1e-12);
    }
}

#[test]
fn perturbations_of_meshes_have_a_seed_and_end() {
    let net = nets::prism(5);
    let plan = |amplitude: f64, seed: u64| {
        json!({
            "word": "UCP", "seed": seed, "parameters": { "perturbation": { "amplitude": amplitude, "decay": 0.25 } }
        })
    };
    let bare = refined(&net, &Value::Null, &json!({ "word": "UCP" }), 3);
    let [one, again, other] = [1, 1, 2].map(|seed| refined(&net, &Value::Null, &plan(0.2, seed), 3));
    assert_eq!(one, again, "a seed gives one surface");
    assert!(apart(&one, &other) > 1e-3 && apart(&one, &bare) > 1e-3);
    assert!(apart(&refined(&net, &Value::Null, &plan(1e-9, 1), 3), &bare) < 1e-8);
    // averages and push-backs keep equal values, whatever their weights are
    let flat = Net { positions: net.positions.iter().map(|p| [p[0], p[1], 2.0]).collect(), ..net.clone() };
    for p in refined(&flat, &Value::Null, &plan(0.4, 3), 3).positions {
        assert!((p[2] - 2.0).abs() < 1e-13);
    }
}

#[test]
fn parameters_that_cannot_be_are_refused_at_their_place() {
    let job = |parameters: Value, plan: Value| {
        let mut input = nets::cube().input();
        input["mesh"]["parameters"] = parameters;
        let fault = &faults(json!({ "input": input, "plan": plan, "levels": 1 }))[0];
        format!("{}: {}", fault.pointer, fault.detail)
    };
    let word = || json!({ "word": "UCP" });
    let cases = [
        (job(json!({ "delta": [1, 2] }), word()), "/input/mesh/parameters/delta"),
        (
            job(json!({ "kernel": [1, 2, -1, 1, 1, -1, 1, 1] }), word()),
            "/input/mesh/parameters/kernel/2: with the kernel -1 no average exists",
        ),
        (job(json!({ "delta": vec![1; 8] }), json!({ "word": "UD" })), "parameters of vertices"),
        (job(json!({ "delta": vec![1; 8] }), json!({ "preset": "catmull-clark" })), "knows no parameters of vertices"),
        (
            job(json!({ "delta": vec![1; 8] }), json!({ "word": "U3C" })),
            "/plan/word: parameters of vertices act in words over U, C and P with arity 2 and split quad; here stands \
             U3",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "{said}");
    }
    // unused values may be anything, and perturbations change them
    let mut input = nets::cube().input();
    input["mesh"]["parameters"] = json!({ "kernel": vec![-1; 8] });
    let apart = json!({ "perturbation": { "amplitude": 0.1, "decay": 0.4 } });
    for (parameters, levels) in [(json!({}), 0), (apart, 1)] {
        support::json(json!({ "input": input, "plan": { "word": "UCP", "parameters": parameters }, "levels": levels }));
    }
}

/// Faults name points of polygons in their list; split triangles and perturbations name the conflicting parameter.
#[test]
fn what_single_points_cannot_have_is_told_at_its_place() {
    let first = |input: Value, plan: Value| {
        let fault = &faults(json!({ "input": input, "plan": plan, "levels": 1 }))[0];
        format!("{}: {}", fault.pointer, fault.detail)
    };
    let polygon = |kernel: [i32; 3]| json!({ "points": [[0, 0], [1, 0], [1, 1]], "parameters": { "kernel": kernel } });
    let word = |word: &str, parameters: Value| json!({ "word": word, "parameters": parameters });
    let mut triangles = nets::tetrahedron().input();
    triangles["mesh"]["parameters"] = json!({ "delta": [1, 1, 1, 1] });
    let noise = json!({ "perturbation": { "amplitude": 0.1, "decay": 0.4 } });
    let cases = [
        (
            first(json!({ "polygon": polygon([1, -1, 1]) }), word("UC", json!({}))),
            "/input/polygon/parameters/kernel/1: ",
        ),
        (
            first(json!({ "polygons": [polygon([1, 1, 1]), polygon([1, 1, -1])] }), word("UC", json!({}))),
            "/input/polygons/1/parameters/kernel/2: with the kernel -1 no average exists",
        ),
        (
            first(triangles.clone(), word("UCP", json!({ "split": "triangle" }))),
            "/plan/parameters/split: parameters of vertices act in words over U, C and P with arity 2 and split quad; \
             here stands split triangle",
        ),
        (first(triangles, json!({ "preset": "loop" })), "/plan/preset: "),
        (
            first(nets::cube().input(), word("U3C", noise.clone())),
            "/plan/parameters/perturbation: on meshes, perturbation acts in words over U, C and P with arity 2 and \
             split quad; here stands U3",
        ),
        (first(nets::cube().input(), word("UD", noise)), "split quad; leave it out"),
        (
            first(nets::cube().input(), word("UCP", json!({ "kernel": -1 }))),
            "/plan/parameters/kernel: the kernel is -1 at level 1 (alpha = 0), where no average exists",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "{said}");
    }
}

/// A kernel that has no average only between points at a later level is reported with these points, at their list.
#[test]
fn kernels_without_an_average_between_points_are_told_with_these_points() {
    let told = |shape: &str, input: Value, parameters: Value, plan: Value, levels: u32| {
        let mut input = json!({ shape: input });
        input[shape]["parameters"] = parameters;
        let faults = faults(json!({ "input": input, "plan": plan, "levels": levels }));
        faults.iter().map(|fault| format!("{}: {}", fault.pointer, fault.detail)).collect::<Vec<_>>().join("\n")
    };
    let cube = || nets::cube().input()["mesh"].clone();
    let word = || json!({ "word": "UCP" });
    let square = |closed: bool| json!({ "points": [[0, 0], [2, 0], [3, 1], [1, 2]], "closed": closed });
    // -1 is halfway along an edge, a quarter of the way, and in the middle of a face
    let edge = nets::cube().faces[0][..2].to_vec();
    let of_vertices = |some: &[usize], others: f64, own: f64| -> Vec<f64> {
        (0..8).map(|v| if some.contains(&v) { own } else { others }).collect()
    };
    let between = |points: &[usize]| {
        let mut points = points.to_vec();
        points.sort_unstable();
        let named = points.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        format!("(between the points {named} of the input) is -1")
    };
    let half = of_vertices(&edge[..1], 1.0, -3.0);
    let said = told("mesh", cube(), json!({ "kernel": half }), word(), 2);
    assert!(said.starts_with("/input/mesh/parameters/kernel: level 2: the kernel of point"), "{said}");
    // the first of the edges of that vertex, whichever it is
    assert!(said.contains(&format!("(between the points {}", edge[0].min(edge[1]))), "{said}");
    // all faces have three vertices of one kind or none: -1 is a mean of faces, not of an edge
    let corner = of_vertices(&edge[..1], 1.0, -7.0);
    let said = told("mesh", cube(), json!({ "kernel": corner }), word(), 2);
    let faces = nets::cube().faces.into_iter().filter(|face| face.contains(&edge[0]));
    assert!(faces.map(|face| between(&face)).any(|named| said.contains(&named)), "{said}");
    // the alpha of points determines a kernel of the plan
    let plan = json!({ "word": "UCP", "parameters": { "kernel": "4*alpha-3" } });
    let alpha = of_vertices(&edge[..1], 0.75, 1.25);
    let said = told("mesh", cube(), json!({ "alpha": alpha }), plan.clone(), 2);
    assert!(said.starts_with("/input/mesh/parameters/alpha: level 2: "), "{said}");
    for (closed, kernel, plan, levels, place) in [
        (
            true,
            json!([1, 1, 1, -3]),
            word(),
            2,
            "level 2: the kernel of point 5 (between the points 2, 3 of the input)",
        ),
        (
            false,
            json!([1, 1, 1, -3]),
            word(),
            2,
            "level 2: the kernel of point 5 (between the points 2, 3 of the input)",
        ),
        (
            true,
            json!([-7, 1, 1, 1]),
            word(),
            3,
            "level 3: the kernel of point 3 (between the points 0, 1 of the input)",
        ),
        (
            true,
            json!([1, 1, 1, -5]),
            json!({ "word": "U3C" }),
            2,
            "level 2: the kernel of point 7 (between the points 2, 3",
        ),
    ] {
        let said = told("polygon", square(closed), json!({ "kernel": kernel }), plan, levels);
        assert!(said.starts_with(&format!("/input/polygon/parameters/kernel: {place}")), "{said}");
    }
    // the second level has half the alpha of the first
    let said = told("polygon", square(true), json!({ "alpha": [0.75, 1.0, 2.0, 3.0] }), plan, 2);
    assert!(
        said.starts_with(
            "/input/polygon/parameters/alpha: level 2: the kernel of point 2 (point 1 of the input) is -1"
        ),
        "{said}"
    );
}
