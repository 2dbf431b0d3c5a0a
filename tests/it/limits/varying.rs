//! Limits with data that differ from vertex to vertex: parameters of vertices, latitude lines.

use planish::analysis::circles::outlooks;
use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use crate::support::nets::{self, Net, distance};
use crate::support::{json_with, parsed, render};

fn limit(mesh: &Value, plan: &Value, levels: u32) -> (Net, Vec<[f64; 3]>) {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
    let result = json_with(job, &json!({ "positions": "limit", "normals": "limit" }));
    let normals = serde_json::from_value(result["normals"].clone()).expect("normals are lists of numbers");
    (Net::of(&result), normals)
}

fn with(net: &Net, parameters: &Value) -> Value {
    let mut mesh = net.to_json();
    mesh["parameters"] = parameters.clone();
    mesh
}

/// Returns numbers between two bounds, one per vertex.
fn numbers(net: &Net, low: f64, high: f64) -> Vec<f64> {
    let place = |v: usize| f64::from(u8::try_from((7 * v * v + 3 * v) % 11).expect("below 11")) / 10.0;
    (0..net.positions.len()).map(|v| low + (high - low) * place(v)).collect()
}

/// Returns meshes whose vertices have parameters, with plans that use them.
fn parametrised() -> Vec<(Net, Value, Value)> {
    let (cube, grid, prism) = (nets::cube(), nets::grid(2, 2), nets::prism(5));
    let circles = json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    vec![
        (cube.clone(), json!({ "delta": numbers(&cube, 0.0, 1.0) }), json!({ "word": "UCP" })),
        (grid.clone(), json!({ "alpha": numbers(&grid, 0.2, 1.5) }), json!({ "word": "UCP", "parameters": circles })),
        (
            prism.clone(),
            json!({ "kernel": numbers(&prism, 0.8, 1.3), "compensation": numbers(&prism, 0.7, 1.1) }),
            json!({ "word": "UCCP", "parameters": { "delta": 0.4 } }),
        ),
    ]
}

#[test]
fn limits_with_parameters_of_vertices_do_not_move_under_one_more_level() {
    for (net, parameters, plan) in parametrised() {
        let mesh = with(&net, &parameters);
        let [(coarse, normals), (fine, fine_normals)] = [0, 1].map(|levels| limit(&mesh, &plan, levels));
        for v in 0..net.positions.len() {
            let off = distance(&coarse.positions[v], &fine.positions[v]);
            assert!(off <= 1e-13, "{plan}: vertex {v} moves by {off}");
            let off = distance(&normals[v], &fine_normals[v]);
            assert!(off <= 1e-12, "{plan}: normal {v} turns by {off}");
        }
    }
}

/// Differences between refined vertices and their limits, and between area normals and limit normals, shrink.
#[test]
fn refined_vertices_with_parameters_approach_their_limits() {
    for (net, parameters, plan) in parametrised() {
        let mesh = with(&net, &parameters);
        let (found, normals) = limit(&mesh, &plan, 0);
        let off = |levels: u32| {
            let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
            let result = json_with(job, &json!({ "normals": "area" }));
            let deep_normals: Vec<[f64; 3]> = serde_json::from_value(result["normals"].clone()).expect("normals");
            let deep = Net::of(&result);
            let vertices = 0..net.positions.len();
            let place = |v: usize| distance(&found.positions[v], &deep.positions[v]);
            let turn = |v: usize| distance(&normals[v], &deep_normals[v]);
            [vertices.clone().map(place).fold(0.0, f64::max), vertices.map(turn).fold(0.0, f64::max)]
        };
        let [early, late] = [3, 6].map(off);
        assert!(late[0] < 1e-3 && late[0] < early[0] / 16.0, "{plan}: {early:?}, then {late:?}");
        assert!(late[1] < 3e-2 && late[1] < early[1] / 2.0, "{plan}: {early:?}, then {late:?}");
    }
}

/// Vertices that all have the values of the plan have its limits.
#[test]
fn equal_parameters_change_no_limit() {
    let circles = json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    let net = nets::mixed();
    let n = net.positions.len();
    for (parameters, plain, carried) in [
        (json!({ "alpha": vec![1.0; n] }), circles.clone(), circles),
        (json!({ "delta": vec![0.3; n], "kernel": vec![1.2; n] }), json!({ "delta": 0.3, "kernel": 1.2 }), json!({})),
    ] {
        let plan = |parameters: &Value| json!({ "word": "UCP", "parameters": parameters });
        let (expected, normals) = limit(&net.to_json(), &plan(&plain), 1);
        let (found, found_normals) = limit(&with(&net, &parameters), &plan(&carried), 1);
        for v in 0..expected.positions.len() {
            let off = distance(&expected.positions[v], &found.positions[v]);
            assert!(off <= 1e-13, "{parameters}: vertex {v} is off by {off}");
            assert!(distance(&normals[v], &found_normals[v]) <= 1e-9, "{parameters}: normal {v}");
        }
    }
}

/// A mesh can interpolate some of its vertices and approximate the others.
#[test]
fn vertices_of_delta_1_stay_in_the_limit() {
    let net = nets::cube();
    let delta: Vec<f64> = (0..8).map(|v| if v < 4 { 1.0 } else { 0.0 }).collect();
    let (found, _) = limit(&with(&net, &json!({ "delta": delta })), &json!({ "word": "UCP" }), 0);
    for v in 0..8 {
        let off = distance(&found.positions[v], &net.positions[v]);
        assert!(if v < 4 { off <= 1e-14 } else { off > 0.1 }, "vertex {v} moves by {off}");
    }
}

/// Differences that do not shrink at some vertices.
#[test]
fn parameters_without_a_limit_are_refused() {
    let net = nets::cube();
    let mut wild = vec![0.0; 8];
    wild[3] = 9.0;
    let job = json!({ "input": { "mesh": with(&net, &json!({ "delta": wild })) }, "plan": { "word": "UCP" },
        "levels": 1, "outputs": [{ "format": "obj", "positions": "limit" }] });
    let faults = render(&job).expect_err("it has no limit");
    assert!(faults[0].detail.contains("no continuous limit"), "{faults:?}");
}

/// Each vertex is followed separately, so that their number is bounded.
#[test]
fn too_many_vertices_with_different_parameters_are_refused() {
    let net = nets::cube();
    let job = json!({ "input": { "mesh": with(&net, &json!({ "delta": numbers(&net, 0.0, 1.0) })) },
        "plan": { "word": "UCP" }, "levels": 6, "outputs": [{ "format": "obj", "positions": "limit" }] });
    let faults = render(&job).expect_err("there are too many");
    assert!(faults[0].detail.contains("more than 16384 different surroundings"), "{faults:?}");
    assert!(faults[0].detail.contains("ask for fewer levels"), "{faults:?}");
}

fn real(n: usize) -> f64 {
    f64::from(u32::try_from(n).expect("a small number"))
}

const UNEVEN: [(f64, f64); 7] = [(1.0, 0.0), (1.7, 0.4), (1.2, 2.0), (0.6, 2.2), (1.4, 3.9), (0.9, 4.5), (1.1, 5.5)];

/// Returns a tube of regular k-gons with these radii and heights; the first `bare` rings and the edges between them are
/// tagged.
fn tube(k: usize, rings: &[(f64, f64)], bare: usize) -> Value {
    let angle = |i: usize| std::f64::consts::TAU * real(i) / real(k) + 0.3;
    let ring = |&(r, z): &(f64, f64)| (0..k).map(move |i| [r * cos(angle(i)), r * sin(angle(i)), z]);
    let positions: Vec<[f64; 3]> = rings.iter().flat_map(ring).collect();
    let at = |u: usize, i: usize| u * k + i % k;
    let face = |u: usize, i: usize| [at(u, i), at(u, i + 1), at(u + 1, i + 1), at(u + 1, i)];
    let all = |n: usize| (0..n).flat_map(move |u| (0..k).map(move |i| (u, i)));
    let faces: Vec<_> = all(rings.len() - 1).map(|(u, i)| face(u, i)).collect();
    let latitude: Vec<_> = all(bare).map(|(u, i)| [at(u, i), at(u, i + 1)]).collect();
    let longitude: Vec<_> = all(bare - 1).map(|(u, i)| [at(u, i), at(u + 1, i)]).collect();
    json!({ "positions": positions, "faces": faces, "latitude": latitude, "longitude": longitude })
}

fn push_back(delta: f64, k: u32, rule: &str) -> Value {
    json!({ "preset": "push-back", "boundary": "edge-only",
        "parameters": { "delta": delta, "k": k, "latitude_rule": rule } })
}

/// Returns the radius and height of a point.
fn polar(p: [f64; 3]) -> [f64; 2] {
    [sqrt(p[0] * p[0] + p[1] * p[1]), p[2]]
}

/// Limit points lie on circles, and those of the input's rings have the radius of the rule of exact lines.
#[test]
fn limits_of_latitude_lines_are_circles() {
    for (k, delta, averages, rule) in [
        (3, 0.5, 1, "difference"),
        (5, 1.0, 1, "position"),
        (4, -0.1, 2, "difference"),
        (8, 0.0, 1, "position"),
        (6, 1.0, 2, "difference"),
    ] {
        let (mesh, plan) = (tube(k, &UNEVEN, UNEVEN.len()), push_back(delta, averages, rule));
        let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 0, "outputs": [{ "format": "json" }] });
        let job = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
        let planish::job::Input::Mesh(read) = &*job.input else { panic!("a mesh was given") };
        let radii: Vec<f64> =
            outlooks(read, Ok(&job.plan)).into_iter().map(|line| line.circle.expect("an exact line").radius).collect();
        for levels in [0, 2] {
            let (found, normals) = limit(&mesh, &plan, levels);
            // points of the same height belong to one ring
            let mut points: Vec<([f64; 2], f64)> =
                found.positions.iter().zip(&normals).map(|(p, normal)| (polar(*p), normal[2])).collect();
            points.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
            for ring in points.chunks(k << levels) {
                for (p, slope) in ring {
                    let off = distance(p, &ring[0].0).max((slope - ring[0].1).abs());
                    assert!(off < 1e-12, "K {k}, delta {delta}, k {averages}, {rule}, level {levels}: {off}");
                }
            }
            for (u, radius) in radii.iter().enumerate() {
                let off = (polar(found.positions[k * u])[0] - radius).abs();
                assert!(off < 1e-12, "K {k}, delta {delta}, {rule}: the radius of ring {u} is off by {off}");
            }
        }
    }
}

/// Poles as rings of coincident vertices, and a line with a different kernel across.
#[test]
fn limits_of_poles_and_of_other_profiles_are_circles() {
    let poles = [(0.0, 0.0), (0.9, 0.1), (1.3, 1.0), (0.8, 1.9), (0.0, 2.0)];
    let mut profile = push_back(0.7, 1, "difference");
    profile["parameters"]["kernel_longitude"] = json!("cos(alpha)");
    for (rings, plan) in [(&poles[..], push_back(0.7, 1, "difference")), (&UNEVEN, profile)] {
        let mesh = tube(6, rings, rings.len());
        let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 });
        let found = Net::of(&json_with(job, &json!({ "positions": "limit" })));
        let mut points: Vec<[f64; 2]> = found.positions.iter().map(|p| polar(*p)).collect();
        points.sort_by(|a, b| a[1].total_cmp(&b[1]));
        for ring in points.chunks(12) {
            assert!(ring.iter().all(|p| distance(p, &ring[0]) < 1e-12), "{plan}: {ring:?}");
        }
    }
}

/// If a tube is tagged in part, alpha differs from ring to ring; the tagged end is out of reach.
#[test]
fn limits_between_tags_do_not_move_under_one_more_level() {
    let (mesh, plan) = (tube(5, &UNEVEN, 4), push_back(0.6, 1, "difference"));
    let [(coarse, normals), (fine, fine_normals)] = [0, 1].map(|levels| limit(&mesh, &plan, levels));
    for v in 0..5 * UNEVEN.len() {
        let off = distance(&coarse.positions[v], &fine.positions[v]);
        assert!(off <= 1e-13, "vertex {v} moves by {off}");
        assert!(distance(&normals[v], &fine_normals[v]) <= 1e-12, "normal {v}");
    }
    let first: Vec<[f64; 2]> = coarse.positions[..5].iter().map(|p| polar(*p)).collect();
    assert!(first.iter().all(|p| distance(p, &first[0]) < 1e-12), "{first:?}");
}

#[test]
fn any_number_of_threads_finds_the_same_limits() {
    let net = nets::cube();
    let job = json!({ "input": { "mesh": with(&net, &json!({ "delta": numbers(&net, 0.0, 1.0) })) },
        "plan": { "word": "UCP" }, "levels": 1,
        "outputs": [{ "format": "ply", "positions": "limit", "normals": "limit" }] });
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start");
        pool.install(|| render(&job)).expect("it has a limit").0
    };
    assert_eq!(with_threads(1), with_threads(8));
}
