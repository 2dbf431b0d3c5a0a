//! Refinement of large meshes while they are written: every byte equals that of a mesh whose points are all in memory.

use planish::job::limits::Limits;
use planish::job::{Input, run};
use planish::refine::{StreamedMesh, refine_mesh};
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::parsed;

/// Returns the bytes of a job under a limit on held bytes, and whether it was refined while it was written.
fn written(job: &Value, max_held_bytes: u64) -> (Vec<u8>, bool) {
    let limits = Limits { max_held_bytes, ..Limits::default() };
    let read = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {job:.400}"));
    let admitted = limits.admit(read).unwrap_or_else(|refusal| panic!("{refusal:?} for {job:.400}"));
    let mut bytes = Vec::new();
    let report = run(&admitted, &admitted.job().outputs[0], &mut bytes, &Watch::new());
    report.unwrap_or_else(|error| panic!("{error} for {job:.400}"));
    (bytes, admitted.estimate().on_demand)
}

fn job(input: &Value, plan: &Value, levels: u32, output: &Value) -> Value {
    json!({ "input": input, "plan": plan, "levels": levels, "outputs": [output] })
}

fn assert_alike(job: &Value) {
    let ((streamed, on_demand), (held, held_on_demand)) = (written(job, 0), written(job, u64::MAX));
    assert!(on_demand && !held_on_demand, "{job:.400}");
    assert!(streamed == held, "{} and {} bytes differ for {job:.400}", streamed.len(), held.len());
}

/// Returns every output that can be written without all points in memory.
fn outputs() -> Vec<Value> {
    vec![
        json!({ "format": "ply" }),
        json!({ "format": "ply", "ids": true, "precision": "f32" }),
        json!({ "format": "ply", "ascii": true }),
        json!({ "format": "obj" }),
        json!({ "format": "obj", "ids": true }),
        json!({ "format": "stl" }),
        json!({ "format": "usda" }),
        json!({ "format": "3mf" }),
        json!({ "format": "stl", "normals": "none" }),
        json!({ "format": "glb", "normals": "none" }),
        json!({ "format": "glb" }),
        json!({ "format": "glb", "normals": "none", "ids": true }),
    ]
}

/// Returns inputs with all data that a sweep supports: holes, an isolated vertex, faces of any size, creases,
/// boundaries.
fn inputs() -> Vec<Value> {
    let with = |net: &Net, name: &str, value: Value| {
        let mut input = net.input();
        input["mesh"][name] = value;
        input
    };
    let sharp = |edge: [u32; 2], sharpness: f64| json!({ "edge": edge, "sharpness": sharpness });
    let mut isolated = nets::cube();
    isolated.positions.insert(3, [9.0, -7.0, 5.0]);
    isolated.faces.iter_mut().flatten().filter(|v| **v >= 3).for_each(|v| *v += 1);
    let mut groups = with(&nets::mixed(), "groups", json!([{ "name": "one", "faces": [1] }]));
    groups["mesh"]["holes"] = json!([0]);
    vec![
        nets::torus(3, 4).input(),
        isolated.input(),
        nets::prism(5).input(),
        nets::mixed().input(),
        groups,
        with(&nets::grid(3, 2), "holes", json!([1])),
        with(&nets::cube(), "creases", json!([sharp([0, 1], 10.0), sharp([1, 3], 10.0), sharp([3, 2], 1.5)])),
    ]
}

#[test]
fn all_formats_and_nets_are_streamed_to_the_bytes_of_held_meshes() {
    for input in inputs() {
        for output in outputs() {
            // normals of creased meshes belong to copies of vertices
            let whole = input["mesh"]["creases"].is_array() && output["format"] == "glb" && output["normals"] != "none";
            if whole {
                continue;
            }
            assert_alike(&job(&input, &json!({ "preset": "catmull-clark" }), 5, &output));
        }
    }
    for plan in [json!({ "word": "UCCP" }), json!({ "word": "UC" }), json!({ "preset": "bilinear" })] {
        assert_alike(&job(&nets::prism(5).input(), &plan, 5, &json!({ "format": "ply" })));
    }
    let open = json!({ "preset": "catmull-clark", "boundary": "none" });
    assert_alike(&job(&nets::grid(4, 4).input(), &open, 4, &json!({ "format": "stl" })));
}

#[test]
fn faces_with_many_rows_are_streamed_band_by_band() {
    let quad = Net {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.5], [1.0, 1.5, 0.0], [0.0, 1.0, -0.3]],
        faces: vec![vec![0, 1, 2, 3]],
    };
    let pentagon = Net {
        positions: vec![[0.0; 3], [2.0, 0.0, 0.5], [3.0, 1.5, 0.0], [1.0, 2.0, -0.3], [-1.0, 1.0, 0.0]],
        faces: vec![vec![0, 1, 2, 3, 4]],
    };
    for (net, levels) in [(quad, 9), (pentagon, 9)] {
        for format in ["ply", "stl", "glb"] {
            assert_alike(&job(
                &net.input(),
                &json!({ "preset": "catmull-clark" }),
                levels,
                &json!({ "format": format }),
            ));
        }
    }
}

#[test]
fn triangles_are_streamed_to_the_bytes_of_held_meshes() {
    let mut creased = nets::octahedron().input();
    creased["mesh"]["creases"] = json!([{ "edge": [0, 2], "sharpness": 10 }, { "edge": [2, 1], "sharpness": 10 }]);
    let mut open = nets::triangulated(nets::grid(3, 2)).input();
    open["mesh"]["holes"] = json!([2]);
    for (input, schemes) in
        [(nets::octahedron().input(), &["loop", "butterfly"][..]), (creased, &["loop"]), (open, &["loop"])]
    {
        for (output, levels) in [("ply", 4), ("obj", 3), ("ply", 6)] {
            for name in schemes {
                assert_alike(&job(&input, &json!({ "preset": name }), levels, &json!({ "format": output })));
            }
        }
    }
    let large = Net { positions: vec![[0.0; 3], [1.0, 0.0, 0.5], [0.0, 1.5, 0.0]], faces: vec![vec![0, 1, 2]] };
    let output = json!({ "format": "glb", "normals": "none" });
    assert_alike(&job(&large.input(), &json!({ "preset": "loop" }), 9, &output));
}

#[test]
fn what_cannot_be_made_on_demand_is_held() {
    let mut channels = nets::cube().input();
    channels["mesh"]["channels"] = json!({ "heat": [0, 1, 2, 3, 4, 5, 6, 7] });
    let mut creased = nets::cube().input();
    creased["mesh"]["creases"] = json!([{ "edge": [0, 1], "sharpness": 10 }]);
    let (cube, preset) = (nets::cube().input(), |name: &str| json!({ "preset": name }));
    let held = [
        job(&channels, &preset("catmull-clark"), 3, &json!({ "format": "ply" })),
        job(&creased, &preset("catmull-clark"), 3, &json!({ "format": "glb" })),
        job(&cube, &preset("catmull-clark"), 3, &json!({ "format": "ply", "normals": "area" })),
        job(&cube, &preset("catmull-clark"), 3, &json!({ "format": "ply", "positions": "limit" })),
        job(&nets::octahedron().input(), &preset("loop"), 3, &json!({ "format": "stl" })),
        job(&nets::octahedron().input(), &preset("loop"), 3, &json!({ "format": "glb" })),
        job(&cube, &preset("doo-sabin"), 3, &json!({ "format": "ply" })),
        job(&cube, &preset("catmull-clark"), 0, &json!({ "format": "ply" })),
    ];
    for job in held {
        assert!(!written(&job, 0).1, "{job}");
    }
}

#[test]
fn what_is_stopped_gives_no_bytes_of_points_that_were_not_made() {
    struct Stopping(Watch, Vec<u8>);
    impl std::io::Write for Stopping {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.1.extend_from_slice(bytes);
            if self.1.len() > 10_000 {
                self.0.stop();
            }
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let job = job(&nets::cube().input(), &json!({ "preset": "catmull-clark" }), 8, &json!({ "format": "ply" }));
    let whole = written(&job, u64::MAX).0;
    let admitted = Limits { max_held_bytes: 0, ..Limits::default() };
    let admitted = admitted.admit(parsed(job.to_string().as_bytes()).expect("a job")).expect("within the limits");
    let watch = Watch::new();
    let mut out = Stopping(watch.clone(), Vec::new());
    assert!(run(&admitted, &admitted.job().outputs[0], &mut out, &watch).is_err());
    assert!(out.1.len() < whole.len() && whole.starts_with(&out.1), "{} bytes", out.1.len());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_range_of_any_mesh_is_made_on_demand(
        net in nets::manifold(), levels in 3..6_u32, cuts in proptest::collection::vec(0.0..1.0_f64, 2..6),
    ) {
        let job = job(&net.input(), &json!({ "preset": "catmull-clark" }), levels, &json!({ "format": "ply" }));
        let job = parsed(job.to_string().as_bytes()).expect("a job");
        let Input::Mesh(mesh) = &*job.input else { panic!("it is a mesh") };
        let watch = Watch::new();
        let held = refine_mesh(mesh, &job.plan, job.steps(), &watch).expect("a step for every net");
        let streamed = StreamedMesh::of(mesh, &job.plan, job.steps(), &watch).expect("a step for every net");
        let streamed = streamed.expect("it can be swept");
        let source = streamed.on_demand().expect("it makes its points on demand");
        let positions = held.all_positions();
        prop_assert_eq!((streamed.n_vertices(), streamed.n_faces()), (positions.len(), held.n_faces()));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "few")]
        let place = |cut: f64, n: usize| (cut * n as f64) as usize;
        let (mut points, mut faces, mut corners) = (Vec::new(), FaceChunk::default(), Vec::new());
        for pair in cuts.windows(2) {
            let range = |n: usize| place(pair[0].min(pair[1]), n)..place(pair[0].max(pair[1]), n);
            streamed.positions(range(positions.len()), &mut points);
            prop_assert_eq!(&points, &positions[range(positions.len())]);
            held.faces(range(held.n_faces()), &mut faces);
            source.corners(range(held.n_faces()), &mut corners);
            let expected: Vec<_> = faces.vertices.iter().map(|&v| positions[v as usize]).collect();
            prop_assert_eq!(corners.as_flattened(), expected);
        }
    }
}
