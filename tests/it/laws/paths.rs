//! Meshes are refined along two paths, by rows of whole nets and patch by patch: every point has the same bits.

use std::sync::{Arc, Mutex};

use planish::analysis::limit::{LimitRequest, refine_mesh_to_limit, to_limit_by_rows};
use planish::job::Input;
use planish::refine::{RefinedMesh, is_swept, refine_by_rows, refine_mesh};
use planish::shape::source::{CarriedSource, FaceChunk, MeshSource};
use planish::watch::{Stage, Watch};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{semi_stationary, static_word, word};
use crate::support::nets::{self, Net};
use crate::support::parsed;

/// Returns plans that are swept unless the mesh prevents it.
fn plans() -> Vec<Value> {
    let mut plans = vec![
        json!({ "preset": "catmull-clark" }),
        json!({ "preset": "catmull-clark", "parameters": { "creasing": "chaikin" } }),
        json!({ "preset": "bilinear" }),
        static_word("UP"),
        word("UC"),
        word("UCC"),
        word("UCCC"),
        word("UCCCC"),
        static_word("UCCP"),
        static_word("UCPC"),
        semi_stationary("UCP", "pi/3", 0.5),
        semi_stationary("UCCP", "1/2", 0.4),
        json!({ "word": "UCCP", "parameters": { "delta": "1/valence", "compensation": 0.7 } }),
    ];
    for plan in &mut plans {
        plan["boundary"] = json!("edge-only");
    }
    plans
}

/// Returns plans for triangles that are swept unless the mesh prevents it; the last one only on closed meshes.
fn triangle_plans() -> Vec<Value> {
    let mut plans = vec![
        json!({ "preset": "loop" }),
        word("U"),
        word("UC"),
        word("UCC"),
        static_word("UP"),
        static_word("UCP"),
        semi_stationary("UCCP", "1/2", 0.4),
        json!({ "word": "UCP", "parameters": { "delta": "1/valence", "compensation": 0.7 } }),
        json!({ "preset": "butterfly", "parameters": { "w": 0.05 } }),
    ];
    for plan in &mut plans {
        plan["boundary"] = json!("edge-only");
        if plan.get("word").is_some() {
            plan["parameters"]["split"] = json!("triangle");
        }
    }
    plans
}

/// Returns a job of a net with sharp edges and corners, a plan and its levels.
fn job(net: &Net, extras: &Value, plan: &Value, levels: usize) -> Value {
    let mut mesh = net.to_json();
    for (name, value) in extras.as_object().expect("an object") {
        mesh[name] = value.clone();
    }
    json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels, "outputs": [{ "format": "json" }] })
}

/// Returns the mesh of each path, and whether the first one is swept.
fn both(job: &Value) -> (RefinedMesh, RefinedMesh, bool) {
    let job = parsed(&serde_json::to_vec(job).expect("JSON")).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let Input::Mesh(mesh) = &*job.input else { panic!("it is a mesh") };
    let (plan, steps) = (&job.plan, job.steps());
    let (swept, stages) = observed(|watch| refine_mesh(mesh, plan, steps, watch).expect("a step for every net"));
    let whole = refine_by_rows(mesh, plan, steps, &Watch::new()).expect("a step for every net");
    assert_eq!(is_swept(mesh, plan, steps), stages.contains(&Stage::Sweep), "what is told beforehand is done");
    (swept, whole, stages.last() == Some(&Stage::Sweep))
}

/// Returns the result of a function of a watch, and its stages: a sweep that gives up continues with rows.
fn observed<T>(of: impl FnOnce(&Watch) -> T) -> (T, Vec<Stage>) {
    let (watch, stages) = (Watch::new(), Arc::new(Mutex::new(Vec::new())));
    let seen = stages.clone();
    watch.observe(move |stage| seen.lock().expect("no other panic").push(stage));
    let found = of(&watch);
    let stages = stages.lock().expect("no other panic").clone();
    (found, stages)
}

fn assert_same(found: &RefinedMesh, expected: &RefinedMesh, what: &Value) {
    assert_eq!((found.n_vertices(), found.n_faces()), (expected.n_vertices(), expected.n_faces()), "{what}");
    let bits = |mesh: &RefinedMesh| mesh.all_positions().into_iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
    let (mine, theirs) = (bits(found), bits(expected));
    let differing: Vec<usize> = (0..mine.len()).filter(|&v| mine[v] != theirs[v]).collect();
    let first = differing.first().map(|&v| (found.all_positions()[v], expected.all_positions()[v]));
    assert!(differing.is_empty(), "{} points such as {:?} are {first:?} in {what}", differing.len(), differing.first());
    let faces = |mesh: &RefinedMesh| {
        let mut faces = FaceChunk::default();
        mesh.faces(0..mesh.n_faces(), &mut faces);
        faces.iter().map(<[u32]>::to_vec).collect::<Vec<_>>()
    };
    assert_eq!(faces(found), faces(expected), "{what}");
    assert_eq!(found.sharp_edges(), expected.sharp_edges(), "{what}");
    for channel in 0..expected.attachments().channels.len() {
        let (mut mine, mut theirs) = (Vec::new(), Vec::new());
        found.channel(channel, 0..found.n_vertices(), &mut mine);
        expected.channel(channel, 0..expected.n_vertices(), &mut theirs);
        assert_eq!(mine, theirs, "{what}");
    }
    let uvs = |mesh: &RefinedMesh| {
        let (mut values, mut faces) = (Vec::new(), FaceChunk::default());
        if let Some(uvs) = mesh.uvs() {
            uvs.values(0..uvs.n_places(), &mut values);
            uvs.faces(0..mesh.n_faces(), &mut faces);
        }
        (values.into_iter().map(f64::to_bits).collect::<Vec<_>>(), faces)
    };
    assert_eq!(uvs(found), uvs(expected), "{what}");
}

pub(super) fn compare(net: &Net, extras: &Value, plan: &Value, levels: usize) -> bool {
    let job = job(net, extras, plan, levels);
    let (swept, whole, is_swept) = both(&job);
    assert_same(&swept, &whole, &job);
    is_swept
}

#[test]
fn closed_nets_of_quads_are_swept_to_the_bits_of_whole_nets() {
    for (net, levels) in [(nets::torus(3, 4), 3), (nets::cube(), 4), (nets::prism(5), 4), (nets::tetrahedron(), 4)] {
        for plan in plans() {
            assert!(compare(&net, &json!({}), &plan, levels), "{plan} is not swept");
        }
    }
}

/// Four patches are refined as a stack until their grids have become large; channels of one and of two numbers in
/// stacks of as many grids.
#[test]
fn many_large_patches_are_swept_to_the_bits_of_whole_nets() {
    let net = nets::torus(3, 4);
    let heat: Vec<usize> = (0..net.positions.len()).map(|v| v * v % 7).collect();
    let place: Vec<[usize; 2]> = (0..net.positions.len()).map(|v| [v, v * v % 5]).collect();
    let extras = json!({ "channels": { "heat": heat, "place": place } });
    for plan in [json!({ "preset": "catmull-clark" }), word("UCCP")] {
        assert!(compare(&net, &extras, &plan, 6), "{plan} is not swept");
    }
}

#[test]
fn boundaries_and_creases_are_swept_to_the_bits_of_whole_nets() {
    for boundary in ["edge-only", "edge-and-corner", "none"] {
        for mut plan in plans() {
            plan["boundary"] = json!(boundary);
            for net in [nets::grid(3, 2), nets::cylinder(4, 4), nets::mixed()] {
                assert!(compare(&net, &json!({}), &plan, 4), "{plan} is not swept");
            }
        }
    }
    let creases = [[0, 1], [1, 3], [3, 2]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
    for plan in plans() {
        assert!(
            compare(
                &nets::cube(),
                &json!({ "creases": creases, "corners": [{ "vertex": 5, "sharpness": 10 }] }),
                &plan,
                4
            ),
            "{plan}"
        );
    }
}

#[test]
fn nets_of_triangles_are_swept_to_the_bits_of_whole_nets() {
    let closed = [nets::octahedron(), nets::tetrahedron(), nets::triangulated(nets::torus(4, 5))];
    let open = [nets::triangulated(nets::grid(3, 2)), nets::triangulated(nets::cylinder(4, 4))];
    let plans = triangle_plans();
    for plan in &plans {
        for net in &closed {
            assert!(compare(net, &json!({}), plan, 4), "{plan} is not swept");
        }
    }
    for boundary in ["edge-only", "edge-and-corner", "none"] {
        for (mut plan, net) in
            plans[..plans.len() - 1].iter().cloned().flat_map(|plan| open.iter().map(move |net| (plan.clone(), net)))
        {
            plan["boundary"] = json!(boundary);
            assert!(compare(net, &json!({}), &plan, 4), "{plan} is not swept");
        }
    }
    compare(&open[0], &json!({}), &plans[plans.len() - 1], 3);
    let creases = [[0, 2], [2, 4], [4, 1]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
    for plan in &plans[..plans.len() - 1] {
        let extras = json!({ "creases": creases, "corners": [{ "vertex": 5, "sharpness": 10 }] });
        assert!(compare(&nets::octahedron(), &extras, plan, 4), "{plan}");
    }
}

#[test]
fn semi_sharp_creases_are_swept_from_the_first_level_on() {
    let sharpness = |i: usize| [2.5, 10.0, 0.75][i % 3];
    let schemes = [("catmull-clark", nets::cube()), ("catmull-clark", nets::grid(3, 3)), ("loop", nets::octahedron())];
    for (preset, net) in schemes {
        for modulus in [1, 2, 3] {
            let edges = net.edges().into_iter().enumerate().filter(|(i, _)| i % modulus == 0);
            let creases: Vec<Value> =
                edges.map(|(i, (a, b))| json!({ "edge": [a, b], "sharpness": sharpness(i / modulus) })).collect();
            let extras = json!({ "creases": creases, "corners": [{ "vertex": 4, "sharpness": 1.25 }] });
            // as many levels as the sharpest edge remains sharp
            assert!(compare(&net, &extras, &json!({ "preset": preset }), 2));
            assert!(compare(&net, &extras, &json!({ "preset": preset }), 4));
        }
    }
}

#[test]
fn large_patches_are_swept_block_by_block_to_the_same_bits() {
    let creases = [json!({ "edge": [1, 4], "sharpness": 10 })];
    for plan in [json!({ "preset": "catmull-clark", "boundary": "edge-only" }), static_word("UCCP")] {
        assert!(compare(&nets::grid(2, 1), &json!({ "creases": creases }), &plan, 8));
    }
    let net = nets::triangulated(nets::grid(2, 1));
    for plan in [json!({ "preset": "loop", "boundary": "edge-only" }), triangle_plans().swap_remove(6)] {
        assert!(compare(&net, &json!({ "creases": creases }), &plan, 8));
    }
}

/// Compares limits and normals with those of whole nets; returns whether all were found patch by patch.
fn compare_limits(net: &Net, extras: &Value, plan: &Value, levels: usize) -> bool {
    let value = job(net, extras, plan, levels);
    let job = parsed(&serde_json::to_vec(&value).expect("JSON")).unwrap_or_else(|faults| panic!("{faults:?}"));
    let Input::Mesh(mesh) = &*job.input else { panic!("it is a mesh") };
    let request = LimitRequest { positions: true, normals: true };
    let levels = u32::try_from(levels).expect("few levels");
    let (found, stages) = observed(|watch| refine_mesh_to_limit(mesh, &job.plan, levels, request, watch));
    let expected = to_limit_by_rows(mesh, &job.plan, levels, request, &Watch::new());
    let (Ok((found, warnings)), Ok((expected, others))) = (&found, &expected) else {
        assert_eq!(found.map(|_| ()).map_err(|e| e.to_string()), expected.map(|_| ()).map_err(|e| e.to_string()));
        return false;
    };
    assert_eq!(warnings, others, "{value}");
    let close = |a: &[f64; 3], b: &[f64; 3], size: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= size);
    for (v, (a, b)) in found.all_positions().iter().zip(&expected.all_positions()).enumerate() {
        assert!(close(a, b, 1e-12), "limit {v}: {a:?} and {b:?} in {value}");
    }
    for channel in 0..expected.attachments().channels.len() {
        let (mut mine, mut theirs) = (Vec::new(), Vec::new());
        found.channel(channel, 0..found.n_vertices(), &mut mine);
        expected.channel(channel, 0..expected.n_vertices(), &mut theirs);
        assert_eq!(mine.len(), theirs.len(), "channel {channel} in {value}");
        let apart = mine.iter().zip(&theirs).position(|(a, b)| (a - b).abs() > 1e-11);
        assert_eq!(apart, None, "channel {channel} in {value}");
    }
    let normals = |mesh: &RefinedMesh| {
        let mut normals = Vec::new();
        mesh.normals()?.of_vertices(0..mesh.n_vertices(), &mut normals);
        Some(normals)
    };
    let [Some(mine), Some(theirs)] = [found, expected].map(normals) else { return false };
    for (v, (a, b)) in mine.iter().zip(&theirs).enumerate() {
        assert!(close(a, b, 1e-9), "normal {v}: {a:?} and {b:?} in {value}");
    }
    let mut faces = FaceChunk::default();
    found.faces(0..found.n_faces(), &mut faces);
    for face in faces.iter() {
        for k in 0..face.len() {
            let side = |mesh: &RefinedMesh| mesh.normals().and_then(|n| n.on_side(face[k], face[(k + 1) % face.len()]));
            match (side(found), side(expected)) {
                (Some(a), Some(b)) => assert!(close(&a, &b, 1e-9), "{face:?} at {k}: {a:?} and {b:?} in {value}"),
                (a, b) => assert_eq!(a, b, "{face:?} at {k} in {value}"),
            }
        }
    }
    stages.last() == Some(&Stage::Sweep)
}

#[test]
fn limits_and_normals_of_patches_are_those_of_whole_nets() {
    let sharp = [[0, 1], [1, 3], [3, 2]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
    let extras = json!({ "creases": sharp, "channels": { "heat": [1, 2, 3, 4, 5, 6, 7, 8.5] } });
    for plan in [json!({ "preset": "catmull-clark" }), word("UC"), static_word("UP")] {
        let near = plan["preset"] == "catmull-clark" || plan["word"] == "UC";
        for net in [nets::cube(), nets::torus(3, 4), nets::prism(5), nets::grid(3, 2), nets::mixed()] {
            assert!(compare_limits(&net, &json!({}), &plan, 3) || !near, "{plan}");
        }
        assert!(compare_limits(&nets::cube(), &extras, &plan, 3) || !near, "{plan}");
    }
    let semi_sharp = json!({ "creases": [{ "edge": [0, 1], "sharpness": 3.5 }, { "edge": [1, 3], "sharpness": 0.5 }] });
    assert!(compare_limits(&nets::cube(), &semi_sharp, &json!({ "preset": "catmull-clark" }), 2));
    for plan in triangle_plans() {
        for net in [nets::octahedron(), nets::triangulated(nets::grid(3, 2)), nets::triangulated(nets::torus(4, 5))] {
            assert!(compare_limits(&net, &json!({}), &plan, 3) || plan["preset"] != "loop", "{plan}");
        }
    }
    let creases = [[0, 2], [2, 4], [4, 1]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
    assert!(compare_limits(&nets::octahedron(), &json!({ "creases": creases }), &json!({ "preset": "loop" }), 3));
    // patches that are evaluated in several bands of rows
    assert!(compare_limits(&nets::grid(1, 1), &json!({}), &json!({ "preset": "catmull-clark" }), 7));
}

#[test]
fn limits_that_look_farther_are_those_of_whole_nets() {
    let circles = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    let circles = json!({ "preset": "push-back", "parameters": circles });
    for plan in [circles.clone(), static_word("UCCP"), word("UCC"), semi_stationary("UCP", "pi/3", 0.5)] {
        for net in [nets::cube(), nets::torus(3, 4), nets::prism(5), nets::octahedron()] {
            let channel = json!({ "channels": { "heat": (0..net.positions.len()).collect::<Vec<_>>() } });
            assert!(compare_limits(&net, &channel, &plan, 5), "{plan}");
        }
        // too small patches, boundaries, creases, and a sharp vertex
        for levels in 1..4 {
            compare_limits(&nets::prism(5), &json!({}), &plan, levels);
        }
        compare_limits(&nets::grid(3, 2), &json!({}), &plan, 4);
        compare_limits(&nets::mixed(), &json!({}), &plan, 4);
        compare_limits(&nets::cube(), &json!({ "corners": [{ "vertex": 0, "sharpness": 10 }] }), &plan, 4);
        let sharp = [[0, 1], [1, 3], [3, 2]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
        compare_limits(&nets::cube(), &json!({ "creases": sharp }), &plan, 4);
    }
    // patches that are evaluated in several bands of rows
    assert!(compare_limits(&nets::cube(), &json!({}), &circles, 6));
}

#[test]
fn texture_coordinates_are_swept_to_the_bits_of_whole_nets() {
    for net in [nets::cube(), nets::grid(4, 3), nets::mixed()] {
        // every other face is separated by a seam
        let n = net.positions.len();
        let shift = |f: usize| if f.is_multiple_of(2) { 0 } else { n };
        let places = |(f, face): (usize, &Vec<usize>)| face.iter().map(|v| v + shift(f)).collect::<Vec<_>>();
        let faces: Vec<_> = net.faces.iter().enumerate().map(places).collect();
        let flat = net.positions.iter().map(|p| [p[0] + 0.3 * p[2], p[1] - 0.7 * p[2]]);
        let values: Vec<[f64; 2]> = flat.clone().chain(flat.map(|[u, v]| [u + 0.1, 2.0 * v])).collect();
        for interpolation in ["none", "all", "corners-only", "boundaries"] {
            let uvs = json!({ "values": values, "faces": faces, "interpolation": interpolation });
            for plan in plans() {
                compare(&net, &json!({ "uvs": uvs }), &plan, 3);
            }
        }
    }
}

/// Returns sharpnesses of creases, every second infinite.
fn sharpness() -> impl Strategy<Value = f64> {
    prop_oneof![Just(10.0), 0.0..2.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_net_is_swept_to_the_bits_of_whole_nets(
        net in nets::manifold(), sharp in proptest::collection::vec((any::<bool>(), sharpness()), 40),
        corner in 0..40_usize, plan in 0..plans().len(), semi_sharp in any::<bool>(),
        boundary in 0..3_usize, channel in proptest::collection::vec(-1e3..1e3_f64, 64),
    ) {
        let plans = plans();
        let mut plan = if semi_sharp { plans[plan % 2].clone() } else { plans[plan].clone() };
        plan["boundary"] = json!(["edge-only", "edge-and-corner", "none"][boundary]);
        let creases = net.edges().into_iter().zip(sharp).filter(|(_, (is_sharp, _))| *is_sharp);
        let creases: Vec<Value> = creases
            .map(|((a, b), (_, s))| json!({ "edge": [a, b], "sharpness": if semi_sharp { s } else { 10.0 } }))
            .collect();
        let corner = (corner < net.positions.len()).then(|| json!({ "vertex": corner, "sharpness": 10 }));
        let corners: Vec<Value> = corner.into_iter().collect();
        let values: Vec<f64> = channel.iter().copied().cycle().take(net.positions.len()).collect();
        let extras = json!({ "creases": creases, "corners": corners, "channels": { "heat": values } });
        compare(&net, &extras, &plan, 4);
    }

    #[test]
    fn any_net_of_triangles_is_swept_to_the_bits_of_whole_nets(
        net in nets::triangle_manifold(), sharp in proptest::collection::vec(0..6_usize, 40),
        corner in 0..40_usize, plan in 0..triangle_plans().len(), boundary in 0..3_usize,
        channel in proptest::collection::vec(-1e3..1e3_f64, 64),
    ) {
        let mut plan = triangle_plans().swap_remove(plan);
        plan["boundary"] = json!(["edge-only", "edge-and-corner", "none"][boundary]);
        let is_loop = plan["preset"] == "loop";
        let follows = plan["preset"] != "butterfly";
        let creases = net.edges().into_iter().zip(sharp).filter(|(_, sharp)| *sharp < 2 && follows);
        let sharpness = |kind: usize| if is_loop { [10.0, 1.5][kind] } else { 10.0 };
        let creases: Vec<Value> =
            creases.map(|((a, b), kind)| json!({ "edge": [a, b], "sharpness": sharpness(kind) })).collect();
        let corner = (corner < net.positions.len()).then(|| json!({ "vertex": corner, "sharpness": 10 }));
        let corners: Vec<Value> = corner.into_iter().collect();
        let values: Vec<f64> = channel.iter().copied().cycle().take(net.positions.len()).collect();
        let extras = json!({ "creases": creases, "corners": corners, "channels": { "heat": values } });
        compare(&net, &extras, &plan, 4);
    }
}
