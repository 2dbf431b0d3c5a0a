//! M3: memory forecasts hold. The bytes that a job is forecast to need are at least those that it holds at its peak,
//! and not many times more.

use planish::job::limits::Limits;
use planish::job::run;
use planish::watch::Watch;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, peak};

/// Allowed excess over the forecast in bytes: the least that any computation takes of the server's memory. Rows of one
/// chunk and buffers of writers do not shrink with the net.
const SLACK: u128 = 1 << 20;
/// Number of bytes from which the parts that do not shrink with the net are negligible.
const LARGE: u128 = 4 << 20;
/// The same for limits: the impulses that determine them are counted as 10 MiB if a word has many operators.
const LARGE_LIMIT: u128 = 16 << 20;

/// Checks that the first output of a job takes no more bytes than forecast, and not far fewer if the job is large.
fn holds(name: &str, job: &Value) {
    holds_from(LARGE, name, job);
}

/// Does the same for jobs that are large from `large` bytes on.
fn holds_from(large: u128, name: &str, job: &Value) {
    let read = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    let admitted = Limits::default().admit(read).unwrap_or_else(|refusal| panic!("{name}: {refusal:?}"));
    let output = &admitted.job().outputs[0];
    let (result, taken) = peak(|| run(&admitted, output, &mut std::io::sink(), &Watch::new()));
    result.unwrap_or_else(|error| panic!("{name}: {error}"));
    let said = admitted.estimate().memory_bytes;
    let taken = u128::from(taken) + admitted.estimate().outputs[0].1.bytes();
    let name = format!("{name} as {}", job["outputs"][0]);
    assert!(taken <= said + SLACK, "{name} takes {taken} bytes and said {said}");
    assert!(taken < large || said <= 3 * taken + SLACK, "{name} takes {taken} bytes and said {said}");
}

fn job(input: &Value, plan: &Value, levels: u32, output: &Value) -> Value {
    json!({ "input": input, "plan": plan, "levels": levels, "outputs": [output] })
}

fn word(text: &str) -> Value {
    json!({ "word": text })
}

fn preset(name: &str) -> Value {
    json!({ "preset": name })
}

fn stats() -> Value {
    json!({ "format": "stats" })
}

#[test]
fn m3_distances_from_another_surface_hold_what_they_say() {
    let picture = json!({ "format": "png", "width": 64, "height": 48, "shading": "distance" });
    let net = nets::torus(8, 8).input();
    for (levels, of_other) in [(5, 2), (2, 5), (4, 4)] {
        let mut job = job(&net, &preset("catmull-clark"), levels, &picture);
        job["distance_to"] = json!({ "input": net, "plan": { "preset": "catmull-clark" }, "levels": of_other });
        holds("distances", &job);
    }
}

#[test]
fn m3_words_with_and_without_duals_hold_what_they_say() {
    let (open, closed, mixed) = (nets::grid(8, 8), nets::torus(8, 8), nets::mixed());
    let cases: [(&Net, &str, u32); 14] = [
        (&open, "UC", 5),
        (&closed, "UC", 4),
        (&open, "UCP", 4),
        (&open, "UCCC", 4),
        (&mixed, "U3C", 4),
        (&open, "UD", 5),
        (&closed, "UD", 5),
        (&open, "UCD", 5),
        (&closed, "UCD", 4),
        (&open, "UDD", 5),
        (&closed, "UDDP", 4),
        (&open, "U3D", 3),
        (&mixed, "UD", 7),
        (&open, "DU", 5),
    ];
    for (net, text, levels) in cases {
        holds(text, &job(&net.input(), &word(text), levels, &stats()));
    }
    let triangles = nets::octahedron().input();
    for text in ["UC", "UDD"] {
        let plan = json!({ "word": text, "parameters": { "split": "triangle" } });
        holds(text, &job(&triangles, &plan, 6, &stats()));
    }
}

#[test]
fn m3_schemes_hold_what_they_say() {
    let (open, triangles) = (nets::grid(8, 8).input(), nets::octahedron().input());
    for name in ["catmull-clark", "doo-sabin", "kobbelt"] {
        holds(name, &job(&open, &preset(name), 4, &stats()));
    }
    for name in ["loop", "sqrt-3", "butterfly"] {
        holds(name, &job(&triangles, &preset(name), 6, &stats()));
    }
}

#[test]
fn m3_formats_hold_what_they_say() {
    let open = nets::grid(8, 8).input();
    for format in ["json", "glb", "gltf", "obj", "ply", "stl", "usda", "3mf", "png"] {
        let output = json!({ "format": format });
        holds("catmull-clark", &job(&open, &preset("catmull-clark"), 4, &output));
        holds("doo-sabin", &job(&open, &preset("doo-sabin"), 4, &output));
        holds("UD", &job(&open, &word("UD"), 4, &output));
    }
    let planes = json!([{ "point": [3.7, 2.5, 0.3], "normal": [0.1, 0, 1] }]);
    let outputs = [
        json!({ "format": "json", "isolines": true }),
        json!({ "format": "json", "sections": planes }),
        json!({ "format": "svg", "sections": planes }),
        json!({ "format": "ply", "normals": "area" }),
        json!({ "format": "usda", "normals": "area" }),
        json!({ "format": "3mf", "parts": "components" }),
        json!({ "format": "png", "show": ["surface", "wireframe"] }),
        json!({ "format": "png", "show": ["surface", "isolines"] }),
        json!({ "format": "png", "show": ["points"] }),
        json!({ "format": "png", "shading": "flat", "width": 1024, "height": 1024 }),
        json!({ "format": "png", "shading": "hidden-line" }),
        json!({ "format": "png", "shading": "gaussian-curvature" }),
        json!({ "format": "png", "shading": "distance" }),
        json!({ "format": "stats", "curvature": true }),
    ];
    for output in outputs {
        holds("UC", &job(&open, &word("UC"), 4, &output));
    }
}

#[test]
fn m3_meshes_that_are_refined_while_they_are_written_hold_what_they_say_at_any_level() {
    let limits = Limits { max_held_bytes: 0, ..Limits::default() };
    let crease = json!([{ "edge": [0, 1], "sharpness": 2 }]);
    let mut creased = nets::cube().input();
    creased["mesh"]["creases"] = crease;
    for (name, input) in [("cube", nets::cube().input()), ("mixed", nets::mixed().input()), ("creased", creased)] {
        for (format, levels) in [("ply", 4), ("ply", 8), ("obj", 6), ("stl", 7)] {
            let job = job(&input, &preset("catmull-clark"), levels, &json!({ "format": format }));
            let admitted = limits.admit(parsed(job.to_string().as_bytes()).expect("a job")).expect("within the limits");
            let output = &admitted.job().outputs[0];
            let (result, taken) = peak(|| run(&admitted, output, &mut std::io::sink(), &Watch::new()));
            result.unwrap_or_else(|error| panic!("{name}: {error}"));
            let said = admitted.estimate().memory_bytes;
            assert!(admitted.estimate().on_demand && u128::from(taken) <= said, "{name} takes {taken} and said {said}");
            assert!(said < 512 << 20, "{name} as {format} said {said}");
        }
    }
}

#[test]
fn m3_limits_hold_what_they_say() {
    let (open, triangles) = (nets::grid(8, 8).input(), nets::octahedron().input());
    for output in [json!({ "format": "ply", "positions": "limit" }), json!({ "format": "ply", "normals": "limit" })] {
        for plan in [preset("catmull-clark"), preset("doo-sabin"), word("UCD")] {
            holds_from(LARGE_LIMIT, &plan.to_string(), &job(&open, &plan, 4, &output));
        }
        for (name, levels) in [("loop", 5), ("butterfly", 5), ("sqrt-3", 5)] {
            holds_from(LARGE_LIMIT, name, &job(&triangles, &preset(name), levels, &output));
        }
    }
    let mut own = nets::cube().input();
    own["mesh"]["parameters"] = json!({ "delta": [1, 1, 0, 0, 1, 1, 0, 0] });
    holds_from(LARGE_LIMIT, "own", &job(&own, &word("UCP"), 4, &json!({ "format": "ply", "positions": "limit" })));
}

#[test]
fn m3_what_is_refined_along_holds_what_it_says() {
    let cube = nets::cube();
    let with = |name: &str, value: Value| {
        let mut input = cube.input();
        input["mesh"][name] = value;
        input
    };
    let values: Vec<[u32; 2]> = (0..8).map(|i| [i, i * i % 5]).collect();
    let edges = [[0, 1], [1, 3], [3, 2], [2, 0]].map(|edge| json!({ "edge": edge, "sharpness": 10 }));
    let inputs = [
        with("channels", json!({ "heat": [0, 1, 2, 3, 4, 5, 6, 7], "wind": values.repeat(1) })),
        with("uvs", json!({ "values": values, "faces": cube.faces, "interpolation": "corners-plus1" })),
        with("uvs", json!({ "values": values, "faces": cube.faces, "interpolation": "all" })),
        with("creases", json!(edges)),
    ];
    for input in &inputs {
        for format in ["json", "glb"] {
            holds("catmull-clark", &job(input, &preset("catmull-clark"), 6, &json!({ "format": format })));
        }
    }
    holds("creases", &job(&inputs[3], &preset("catmull-clark"), 6, &json!({ "format": "stl" })));
    let own = with("parameters", json!({ "delta": [1, 1, 0, 0, 1, 1, 0, 0] }));
    holds("own", &job(&own, &word("UCP"), 5, &json!({ "format": "ply" })));
    let perturbed =
        json!({ "word": "UC", "seed": 11, "parameters": { "perturbation": { "amplitude": 0.9, "decay": 0.49 } } });
    holds("perturbed", &job(&cube.input(), &perturbed, 5, &json!({ "format": "ply" })));
}

#[test]
fn m3_curves_hold_what_they_say() {
    let points: Vec<[u32; 2]> = (0..1000).map(|i| [i % 17, i % 23]).collect();
    let input = json!({ "polygon": { "points": points, "closed": true } });
    for format in ["json", "svg", "png", "stats"] {
        for text in ["UCCC", "UD"] {
            holds(text, &job(&input, &word(text), 6, &json!({ "format": format })));
        }
    }
}

/// Returns jobs whose meshes are swept, twenty kinds and more.
fn swept_jobs() -> Vec<(&'static str, Value)> {
    let (open, closed, triangles) = (nets::grid(16, 16), nets::torus(12, 12), nets::octahedron());
    let catmull_clark = preset("catmull-clark");
    let with = |net: &Net, name: &str, value: Value| {
        let mut input = net.input();
        input["mesh"][name] = value;
        input
    };
    let n = closed.positions.len();
    let channels = with(&closed, "channels", json!({ "heat": vec![0.5; n], "wind": vec![[1, 2, 3]; n] }));
    let values: Vec<[f64; 2]> = open.positions.iter().map(|p| [p[0], p[1]]).collect();
    let uvs = |kind: &str| with(&open, "uvs", json!({ "values": values, "faces": open.faces, "interpolation": kind }));
    let creases = closed.edges().iter().step_by(7).map(|&(a, b)| json!({ "edge": [a, b], "sharpness": 10 })).collect();
    let creased = with(&closed, "creases", creases);
    let frames = with(&closed, "frames", json!(vec![closed.positions.clone(); 5]));
    let named = |format: &str| json!({ "format": format });
    let of = |format: &str, name: &str, value: &str| json!({ "format": format, name: value });
    let mut jobs = Vec::new();
    for format in ["ply", "stl", "obj", "glb", "gltf", "json", "stats", "png"] {
        jobs.push(("closed", job(&closed.input(), &catmull_clark, 5, &named(format))));
    }
    for output in [
        of("glb", "normals", "none"),
        of("ply", "normals", "area"),
        of("ply", "precision", "f32"),
        json!({ "format": "ply", "ids": true }),
        json!({ "format": "glb", "ids": true }),
    ] {
        jobs.push(("options", job(&closed.input(), &catmull_clark, 5, &output)));
    }
    for (format, plan, levels) in [("ply", word("UCCP"), 5), ("glb", word("UCCC"), 5), ("stl", preset("bilinear"), 6)] {
        jobs.push(("open", job(&open.input(), &plan, levels, &named(format))));
    }
    for format in ["ply", "glb", "json"] {
        jobs.push(("channels", job(&channels, &catmull_clark, 5, &named(format))));
        jobs.push(("linear uvs", job(&uvs("all"), &catmull_clark, 4, &named(format))));
        jobs.push(("smooth uvs", job(&uvs("none"), &catmull_clark, 4, &named(format))));
        jobs.push(("creases", job(&creased, &catmull_clark, 5, &named(format))));
    }
    jobs.push(("frames", job(&frames, &catmull_clark, 4, &named("glb"))));
    jobs.push(("frames", job(&frames, &catmull_clark, 4, &of("glb", "normals", "none"))));
    jobs.push(("one frame", job(&frames, &catmull_clark, 5, &json!({ "format": "ply", "frame": 2 }))));
    for name in ["loop", "butterfly"] {
        jobs.push((name, job(&triangles.input(), &preset(name), 7, &named("ply"))));
        jobs.push((name, job(&triangles.input(), &preset(name), 7, &named("glb"))));
    }
    jobs
}

#[test]
fn m3_swept_jobs_hold_what_they_say() {
    for (name, job) in swept_jobs() {
        let read = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        let admitted = Limits::default().admit(read).unwrap_or_else(|refusal| panic!("{name}: {refusal:?}"));
        assert!(admitted.job().is_swept());
        let output = &admitted.job().outputs[0];
        let (result, taken) = peak(|| run(&admitted, output, &mut std::io::sink(), &Watch::new()));
        result.unwrap_or_else(|error| panic!("{name}: {error}"));
        let estimate = admitted.estimate();
        let (taken, said) = (u128::from(taken) + estimate.outputs[0].1.bytes(), estimate.memory_bytes);
        let name = format!("{name} as {} takes {taken} bytes and said {said}", job["outputs"][0]);
        assert!(taken <= said && said <= 2 * taken, "{name}");
    }
}
