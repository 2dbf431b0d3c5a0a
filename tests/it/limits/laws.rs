//! Laws of every limit surface.

use planish::math::functions::{cos, sin, sqrt};
use planish::output::FORMATS;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::limit;
use crate::support::nets::{self, Net, distance};
use crate::support::{json, json_with, render};

fn word(text: &str) -> Value {
    json!({ "word": text })
}

fn with(text: &str, parameters: &Value) -> Value {
    json!({ "word": text, "parameters": parameters })
}

/// Returns plans with a limit: static ones, ones that change from level to level, with two averages, with a prefix,
/// with a cycle that starts after its U, and dual ones for closed meshes.
fn plans() -> Vec<Value> {
    let circle = |delta: f64| {
        json!({
            "alpha": "pi/3", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": delta
        })
    };
    vec![
        json!({ "preset": "catmull-clark" }),
        json!({ "preset": "catmull-clark", "parameters": { "triangle_rule": "smooth" } }),
        word("UC"),
        word("UCP"),
        word("UCC"),
        word("U(CU)"),
        with("UCP", &json!({ "kernel": 1.7, "compensation": 0.5, "delta": 0.3 })),
        with("UCP", &circle(0.4)),
        with("UCCP", &circle(1.0)),
        with("UC", &json!({ "alpha": 1.5, "kernel": "1 + alpha" })),
    ]
}

/// Returns a closed mesh of triangles.
fn triangles() -> Net {
    let net = nets::prism(4);
    let cut = |face: &Vec<usize>| vec![vec![face[0], face[1], face[2]], vec![face[2], face[3], face[0]]];
    Net { faces: net.faces.iter().flat_map(cut).collect(), ..net }
}

/// Returns the classical schemes with meshes that they refine.
fn classical() -> Vec<(Value, Net)> {
    let preset = |name: &str| json!({ "preset": name });
    vec![
        (preset("doo-sabin"), nets::cube()),
        (preset("doo-sabin"), nets::prism(5)),
        (preset("kobbelt"), nets::prism(5)),
        (preset("kobbelt"), nets::grid(3, 2)),
        (preset("sqrt-3"), triangles()),
        (json!({ "preset": "repeated-averaging", "parameters": { "degree": 5 } }), nets::mixed()),
        (json!({ "preset": "repeated-averaging", "parameters": { "degree": 4 } }), nets::torus(4, 3)),
    ]
}

/// Each limit point of one level is one of the next.
#[test]
fn classical_schemes_keep_their_limits() {
    for (plan, net) in classical() {
        let [(coarse, _), (fine, _)] = [1, 2].map(|levels| limit(&net, &plan, levels));
        // the images of vertices come first, except for dual schemes, where they are centres of faces
        if ["kobbelt", "sqrt-3"].map(Value::from).contains(&plan["preset"]) {
            for (v, (p, q)) in coarse.positions.iter().zip(&fine.positions).enumerate().take(net.positions.len()) {
                assert!(distance(p, q) <= 1e-12 * extent(&net), "{plan}: vertex {v} moves from {p:?} to {q:?}");
            }
        }
        let levels = if plan["preset"] == "sqrt-3" { 7 } else { 5 };
        let deep = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": levels })));
        for p in &coarse.positions {
            let near = deep.positions.iter().map(|q| distance(p, q)).fold(f64::INFINITY, f64::min);
            assert!(near <= 3e-2 * extent(&net), "{plan}: {p:?} is {near} away");
        }
    }
}

/// The point beyond an extraordinary vertex depends on all faces there, a ring farther than a regular one.
#[test]
fn limit_normals_of_kobbelt_do_not_turn_where_extraordinary_vertices_share_faces() {
    let mut cube = nets::cube();
    (cube.positions[4], cube.positions[6]) = ([-1.0, -2.0, 1.0], [2.0, 3.0, 1.5]);
    for net in [cube, nets::prism(5)] {
        let [coarse, fine] = [0, 2].map(|levels| limit(&net, &json!({ "preset": "kobbelt" }), levels).1);
        for (v, normal) in coarse.iter().enumerate() {
            let off = distance(normal, &fine[v]);
            assert!(off < 1e-12, "the normal of vertex {v} turns by {off}");
        }
    }
}

/// Two steps of sqrt 3 divide a boundary edge into three, where patches may end in the middle.
#[test]
fn root_three_keeps_its_limits_on_open_meshes() {
    let plan = json!({ "preset": "sqrt-3" });
    let triangle =
        Net { positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]], faces: vec![vec![0, 1, 2]] };
    let mut octahedron = nets::octahedron();
    octahedron.faces.pop();
    for net in [triangle, octahedron, nets::triangulated(nets::grid(3, 2)), nets::triangulated(nets::grid(1, 1))] {
        let deep = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 8 })));
        let (first, _) = limit(&net, &plan, 0);
        for levels in 0..=4 {
            let (found, normals) = limit(&net, &plan, levels);
            assert!(normals.iter().flatten().all(|x| x.is_finite()));
            for v in 0..net.positions.len() {
                let moved = distance(&found.positions[v], &first.positions[v]);
                assert!(moved <= 1e-12 * extent(&net), "level {levels}: vertex {v} moves by {moved}");
                let off = distance(&found.positions[v], &deep.positions[v]);
                assert!(off <= 1e-3 * extent(&net), "level {levels}: vertex {v} is off by {off}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn root_three_keeps_its_limits_on_any_mesh(net in nets::triangles()) {
        let plan = json!({ "preset": "sqrt-3" });
        let at = |levels: u32| {
            let job = json!({ "input": net.input(), "plan": plan, "levels": levels,
                "outputs": [{ "format": "json", "positions": "limit" }] });
            let (bytes, _) = render(&job).ok()?;
            Some(Net::of(&serde_json::from_slice(&bytes).expect("json output")))
        };
        // vertices with only two faces all around are refused
        if let (Some(coarse), Some(fine)) = (at(0), at(1)) {
            for (p, q) in coarse.positions.iter().zip(&fine.positions) {
                prop_assert!(distance(p, q) <= 1e-11 * extent(&net).max(1.0), "{:?} moves to {:?}", p, q);
            }
        }
    }
}

/// Doo-Sabin's limit points are the centroids of faces: a vertex's child face has a fixed centre.
#[test]
fn doo_sabin_converges_to_centroids() {
    let net = nets::prism(5);
    let plan = json!({ "preset": "doo-sabin" });
    let child = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 1 })));
    let (found, _) = limit(&net, &plan, 0);
    let n_vertices = net.positions.len();
    let faces = &child.faces[child.faces.len() - n_vertices..];
    for (v, face) in faces.iter().enumerate() {
        let n = f64::from(u32::try_from(face.len()).expect("small"));
        let sum = face.iter().fold([0.0; 3], |sum: [f64; 3], &u| [0, 1, 2].map(|k| sum[k] + child.positions[u][k]));
        assert!(distance(&found.positions[v], &sum.map(|x| x / n)) <= 1e-13, "vertex {v}");
    }
}

fn nets() -> Vec<Net> {
    vec![nets::tetrahedron(), nets::grid(2, 1), nets::mixed(), nets::torus(3, 3)]
}

fn is_closed(net: &Net) -> bool {
    net.edges().len() * 2 == net.faces.iter().map(Vec::len).sum::<usize>()
}

fn extent(net: &Net) -> f64 {
    net.positions.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The images of the input vertices come first at every level.
#[test]
fn limits_do_not_move_under_more_levels() {
    for net in nets() {
        for plan in plans() {
            let (coarse, normals) = limit(&net, &plan, 0);
            for levels in [1, 2] {
                let (fine, fine_normals) = limit(&net, &plan, levels);
                for v in 0..net.positions.len() {
                    let off = distance(&coarse.positions[v], &fine.positions[v]) / extent(&net);
                    assert!(off <= 1e-12, "{plan}: vertex {v} moves by {off} at level {levels}");
                    let off = distance(&normals[v], &fine_normals[v]);
                    assert!(off <= 1e-8, "{plan}: normal {v} turns by {off} at level {levels}");
                }
            }
        }
    }
}

/// Limits are also fixed where a crease ends, fades, or meets others.
#[test]
fn limits_of_creases_do_not_move_under_more_levels() {
    let crease = |a: usize, b: usize, s: f64| json!({ "edge": [a, b], "sharpness": s });
    let cube = nets::cube();
    for creases in [
        json!([crease(4, 5, 10.0)]),
        json!([crease(4, 5, 1.7), crease(5, 7, 0.4)]),
        json!([crease(4, 5, 10.0), crease(5, 7, 10.0), crease(1, 5, 10.0), crease(6, 7, 2.5)]),
        json!([crease(4, 5, 0.5), crease(5, 7, 2.5), crease(6, 7, 1.2), crease(4, 6, 1.9)]),
    ] {
        for creasing in ["uniform", "chaikin"] {
            let at = |levels: u32| {
                let mesh = json!({ "positions": cube.positions, "faces": cube.faces, "creases": creases });
                let plan = json!({ "preset": "catmull-clark", "parameters": { "creasing": creasing } });
                let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
                Net::of(&json_with(job, &json!({ "positions": "limit" }))).positions
            };
            let (coarse, fine) = (at(0), at(3));
            for v in 0..8 {
                let off = distance(&coarse[v], &fine[v]);
                assert!(off <= 1e-13, "{creasing}: {creases}: vertex {v} moves by {off}");
            }
        }
    }
}

/// Limits are also fixed where edges remain sharp because of edges beyond the faces around a vertex.
#[test]
fn limits_of_creases_that_even_out_do_not_move_under_more_levels() {
    let net = nets::torus(6, 5);
    let sharpness = [9.0, 0.3, 8.0, 0.6, 4.0];
    let creases: Vec<Value> = (0..5).map(|i| json!({ "edge": [i, i + 1], "sharpness": sharpness[i] })).collect();
    for (preset, net) in [("catmull-clark", net.clone()), ("loop", nets::triangulated(net))] {
        let at = |levels: u32| {
            let mesh = json!({ "positions": net.positions, "faces": net.faces, "creases": creases });
            let plan = json!({ "preset": preset, "parameters": { "creasing": "chaikin" } });
            let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
            Net::of(&json_with(job, &json!({ "positions": "limit" }))).positions
        };
        let coarse = at(0);
        for levels in [1, 3] {
            for (v, (p, q)) in coarse.iter().zip(&at(levels)).enumerate() {
                let off = distance(p, q);
                assert!(off <= 1e-12, "{preset}: vertex {v} moves by {off} at level {levels}");
            }
        }
    }
}

/// Deeper levels approach the limits of the first levels.
#[test]
fn refined_vertices_approach_their_limits() {
    for net in nets() {
        for plan in plans() {
            let (found, normals) = limit(&net, &plan, 1);
            let job = json!({ "input": net.input(), "plan": plan, "levels": 4 });
            let deep = json_with(job, &json!({ "normals": "area" }));
            let deep_normals: Vec<[f64; 3]> = serde_json::from_value(deep["normals"].clone()).expect("normals");
            let deep = Net::of(&deep);
            for v in 0..net.positions.len() {
                let off = distance(&found.positions[v], &deep.positions[v]) / extent(&net);
                assert!(off <= 2e-2, "{plan}: vertex {v} is off by {off}");
                let off = distance(&normals[v], &deep_normals[v]);
                assert!(off <= 0.3, "{plan}: normal {v} is {:?}, not {:?}", normals[v], deep_normals[v]);
            }
        }
    }
}

/// The angle between limit normals and area normals falls with the levels.
#[test]
fn area_normals_turn_to_limit_normals() {
    let cos_half = json!({ "alpha": "pi/3", "kernel": "cos(alpha/2)", "delta": 0 });
    for (plan, net) in [
        (json!({ "preset": "catmull-clark" }), nets::cube()),
        (word("UCC"), nets::tetrahedron()),
        (with("UCP", &cos_half), nets::cube()),
    ] {
        {
            let (_, normals) = limit(&net, &plan, 0);
            let job = json!({ "input": net.input(), "plan": plan, "levels": 6 });
            let result = json_with(job, &json!({ "normals": "area" }));
            let area: Vec<[f64; 3]> = serde_json::from_value(result["normals"].clone()).expect("normals");
            for v in 0..net.positions.len() {
                let angle = distance(&normals[v], &area[v]);
                assert!(angle < 1e-3, "{plan}: normal {v} is {:?}, not {:?}", area[v], normals[v]);
            }
        }
    }
}

#[test]
fn limits_turn_and_grow_with_the_mesh() {
    let (c, s) = (cos(0.7), sin(0.7));
    let moved = |p: &[f64; 3]| [3.0 * (c * p[0] - s * p[2]) + 5.0, 3.0 * p[1] - 2.0, 3.0 * (s * p[0] + c * p[2]) + 1.0];
    let turned = |p: &[f64; 3]| [c * p[0] - s * p[2], p[1], s * p[0] + c * p[2]];
    for net in nets() {
        for plan in plans() {
            let other = Net { positions: net.positions.iter().map(moved).collect(), ..net.clone() };
            let ((a, a_normals), (b, b_normals)) = (limit(&net, &plan, 1), limit(&other, &plan, 1));
            for v in 0..a.positions.len() {
                let off = distance(&moved(&a.positions[v]), &b.positions[v]);
                assert!(off <= 1e-12 * (1.0 + extent(&other)), "{plan}: vertex {v} is off by {off}");
                assert!(distance(&turned(&a_normals[v]), &b_normals[v]) <= 1e-9, "{plan}: normal {v}");
            }
        }
    }
}

#[test]
fn interpolating_plans_stay_where_they_are() {
    let circle = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)" });
    for plan in [word("UCP"), word("UCCP"), with("UCP", &circle)] {
        for net in nets() {
            let job = json!({ "input": net.input(), "plan": plan, "levels": 1 });
            let refined = Net::of(&json(job));
            let (found, _) = limit(&net, &plan, 1);
            for (v, (p, q)) in found.positions.iter().zip(&refined.positions).enumerate() {
                assert!(distance(p, q) <= 1e-12, "{plan}: vertex {v} moves from {q:?} to {p:?}");
            }
        }
    }
}

/// Dual schemes have no children of vertices; their limits lie on the surface of deep levels.
#[test]
fn limits_of_dual_schemes_lie_on_the_surface() {
    for net in nets().into_iter().filter(is_closed) {
        for plan in [word("UD"), word("UDD"), word("UDDD")] {
            let (found, normals) = limit(&net, &plan, 1);
            let deep = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 5 })));
            let centre = |face: &Vec<usize>| {
                let sum =
                    face.iter().fold([0.0; 3], |sum: [f64; 3], &v| [0, 1, 2].map(|k| sum[k] + deep.positions[v][k]));
                sum.map(|x| x / f64::from(u32::try_from(face.len()).expect("small")))
            };
            let centres: Vec<[f64; 3]> = deep.faces.iter().map(centre).collect();
            for (p, normal) in found.positions.iter().zip(&normals) {
                let near = centres.iter().chain(&deep.positions).map(|q| distance(p, q)).fold(f64::INFINITY, f64::min);
                assert!(near <= 5e-3, "{plan}: {p:?} is {near} away");
                assert!((sqrt(normal.iter().map(|x| x * x).sum()) - 1.0).abs() < 1e-12, "{plan}");
            }
        }
    }
}

/// Every output of a mesh uses the requested positions and normals.
#[test]
fn all_writers_take_the_limit() {
    // a library of materials has no positions, and solids are always limits
    for format in FORMATS.iter().filter(|format| format.name() != "mtl" && !format.is_of_limit()) {
        let name = format.name();
        let has_normals = name != "3mf";
        let bytes = |positions: &str, normals: &str| {
            let mut output = json!({ "format": name, "positions": positions });
            if has_normals {
                output["normals"] = json!(normals);
            }
            if name == "apng" {
                output["frames"] = json!(2);
            }
            if ["svg", "pdf"].contains(&name) {
                output["sections"] = json!([{ "point": [0, 0, 0.1], "normal": [0, 0, 1] }]);
            }
            let job = json!({
                "input": nets::cube().input(), "plan": { "preset": "catmull-clark" }, "levels": 2, "outputs": [output]
            });
            render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
        };
        assert_ne!(bytes("refined", "none"), bytes("limit", "none"), "{name}");
        if !has_normals {
            continue;
        }
        // stencils give tangents of the limit, but no normals weighted by area
        let kinds: &[&str] = if format.is_of_weights() { &["none", "limit"] } else { &["none", "area", "limit"] };
        let normals: Vec<_> = kinds.iter().map(|normals| bytes("refined", normals)).collect();
        let shows = !["svg", "pdf"].contains(&name);
        for (j, normal) in normals.iter().enumerate() {
            for (i, other) in normals[..j].iter().enumerate() {
                assert_eq!(other != normal, shows, "{name}: {i}, {j}");
            }
        }
    }
}

/// The normal of a triangle of STL is that of the limit at its corners, on its side of a sharp edge.
#[test]
fn triangles_of_stl_have_the_normals_of_their_corners() {
    let net = nets::cube();
    let (mut input, ring) = (net.input(), &net.faces[0]);
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    input["mesh"]["creases"] = edges.map(|edge| json!({ "edge": edge, "sharpness": 10 })).collect();
    let plan = json!({ "preset": "catmull-clark" });
    let output = |format: &str| {
        let job = json!({
            "input": input, "plan": plan, "levels": 2,
            "outputs": [{ "format": format, "normals": "limit", "positions": "limit" }]
        });
        render(&job).unwrap_or_else(|faults| panic!("{faults:?}")).0
    };
    let obj = String::from_utf8(output("obj")).expect("text");
    let vectors = |tag: &str| -> Vec<[f64; 3]> {
        let lines = obj.lines().filter_map(|line| line.strip_prefix(tag)?.strip_prefix(' '));
        let vector = |line: &str| -> Vec<f64> { line.split(' ').map(|x| x.parse().expect("a number")).collect() };
        lines.map(|line| vector(line).try_into().expect("three numbers")).collect()
    };
    let normals = vectors("vn");
    let faces = obj.lines().filter_map(|line| line.strip_prefix("f ")).map(|line| -> Vec<[f64; 3]> {
        let normal = |corner: &str| corner.rsplit('/').next().expect("a normal").parse::<usize>().expect("a number");
        line.split(' ').map(|corner| normals[normal(corner) - 1]).collect()
    });
    let expected = faces.flat_map(|face| [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]);
    let stl = output("stl");
    let triangles = stl[84..].chunks_exact(50);
    assert_eq!(triangles.len(), 2 * 6 * 16);
    for (triangle, corners) in triangles.zip(expected) {
        let found =
            [0, 1, 2].map(|k| f64::from(f32::from_le_bytes(triangle[4 * k..4 * k + 4].try_into().expect("four"))));
        let sum = [0, 1, 2].map(|k| corners.iter().map(|normal| normal[k]).sum::<f64>());
        let length = sqrt(sum.iter().map(|x| x * x).sum());
        assert!(distance(&found, &sum.map(|x| x / length)) <= 1e-6, "{found:?} {sum:?}");
    }
}

#[test]
fn any_number_of_threads_finds_the_same_limits() {
    let plan = with("UCP", &json!({ "alpha": 1, "kernel": "cos(alpha/2)", "delta": 0.3 }));
    let job = json!({ "input": nets::mixed().input(), "plan": plan, "levels": 3,
        "outputs": [{ "format": "ply", "positions": "limit", "normals": "limit" }] });
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start");
        pool.install(|| render(&job)).expect("it has a limit").0
    };
    let [one, two, eight] = [1, 2, 8].map(with_threads);
    assert!(one == two && two == eight);
}
