//! Requests that compute nothing: estimate and validate.

use serde_json::json;

use super::jobs::{cube, formats, mesh, polygon, with};
use super::server::{settings, story};

#[test]
fn the_estimate_of_every_format_is_what_comes_out() {
    story(settings(), async |server| {
        for (is_mesh, job) in [(true, mesh(2)), (false, polygon(3))] {
            for format in formats(is_mesh) {
                let job = with(job.clone(), format.name());
                let estimate = server.post("/v1/estimate", &job).await.ok().json();
                let made = server.render(&job).await.ok();
                let output = &estimate["outputs"][0];
                let length = made.body.len() as u64;
                match (output["bytes"]["exact"].as_u64(), output["bytes"]["at_most"].as_u64()) {
                    (Some(exact), None) => assert_eq!(exact, length, "{}", format.name()),
                    (None, Some(bound)) => assert!(length <= bound, "{}: {length} > {bound}", format.name()),
                    _ => panic!("{estimate}"),
                }
                assert_eq!(made.header("etag"), format!("\"{}\"", output["key"].as_str().unwrap()));
            }
        }
    });
}

#[test]
fn an_estimate_counts_every_level_and_runs_nothing() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let estimate = server.post("/v1/estimate", &mesh(3)).await.ok().json();
        drop(held);
        let faces: Vec<u64> =
            estimate["levels"].as_array().unwrap().iter().map(|level| level["faces"].as_u64().unwrap()).collect();
        assert_eq!(faces, [6, 24, 96, 384]);
        assert_eq!(estimate["levels"][3]["vertices"], 386);
        assert_eq!(estimate["levels"][3]["edges"], 768);
        assert_eq!(estimate["outputs"][0]["format"], "glb", "the default of meshes");
        for field in ["time_ms", "memory_bytes"] {
            assert!(estimate[field].as_u64().unwrap() > 0, "{estimate}");
        }
        let job = server.post_with("/v1/render", &mesh(3), &[("prefer", "wait=0")]).await;
        assert!(job.status == 200 || job.json()["id"] == estimate["id"]);
    });
}

#[test]
fn an_estimate_and_the_timing_tell_the_path_that_a_job_takes() {
    story(settings(), async |server| {
        for (word, path) in [("UC", "sweep"), ("U3C", "rows")] {
            let mut job = mesh(2);
            job["plan"] = json!({ "word": word });
            assert_eq!(server.post("/v1/estimate", &job).await.ok().json()["path"], path);
            let made = server.render(&job).await.ok();
            assert_eq!(made.header("server-timing").contains("desc=\"sweep\""), path == "sweep", "{word}");
        }
        let estimate = server.post("/v1/estimate", &polygon(3)).await.ok().json();
        assert_eq!(estimate["path"], "rows", "curves have one path");
    });
}

#[test]
fn an_estimate_takes_many_outputs_and_refuses_what_cannot_be() {
    story(settings(), async |server| {
        let mut job = mesh(1);
        job["outputs"] = json!([{ "format": "glb" }, { "name": "figure", "format": "png" }]);
        let estimate = server.post("/v1/estimate", &job).await.ok().json();
        assert_eq!(estimate["outputs"][1]["name"], "figure");
        server.post("/v1/estimate", &mesh(40)).await.problem(422, "too-large");
        server.post("/v1/estimate", &with(polygon(1), "stl")).await.problem(422, "invalid-job");
    });
}

/// A shape that a format cannot hold, here a face with more corners than one byte counts, is refused before it is
/// computed.
#[test]
fn an_estimate_refuses_what_its_format_cannot_count_as_a_render_does() {
    story(settings(), async |server| {
        let n = 300;
        let parabola = |i: i32| [f64::from(i), f64::from(i * i), 0.0];
        let mesh =
            json!({ "positions": (0..n).map(parabola).collect::<Vec<_>>(), "faces": [(0..n).collect::<Vec<_>>()] });
        let job = json!({ "input": { "mesh": mesh }, "levels": 0, "outputs": [{ "format": "ply" }] });
        for path in ["/v1/estimate", "/v1/render"] {
            let problem = server.post(path, &job).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], "/outputs/0/face_sizes", "{path}: {problem}");
        }
    });
}

#[test]
fn a_valid_mesh_is_described() {
    story(settings(), async |server| {
        let answer = server.post("/v1/validate", &json!({ "input": cube() })).await.ok().json();
        assert_eq!((&answer["valid"], &answer["errors"]), (&json!(true), &json!([])));
        let report = &answer["report"];
        let expected = json!({ "vertices": 8, "edges": 12, "faces": 6, "components": 1, "euler_characteristic": 2,
            "manifold": true, "closed": true, "boundary_loops": [], "valences": { "3": 8 }, "face_sizes": { "4": 6 },
            "isolated_vertices": [], "degenerate_faces": [], "coincident_vertices": [] });
        for (name, value) in expected.as_object().unwrap() {
            assert_eq!(&report[name], value, "{name}");
        }
    });
}

#[test]
fn each_fault_of_a_mesh_is_named_with_its_index() {
    story(settings(), async |server| {
        let mut input = cube();
        input["mesh"]["faces"][2][1] = json!(77);
        input["mesh"]["faces"][4] = json!([1, 1, 2]);
        let question = json!({ "input": input, "plan": { "word": "UC" }, "levels": 1 });
        let answer = server.post("/v1/validate", &question).await.ok().json();
        assert_eq!(answer["valid"], false);
        assert_eq!(answer["errors"][0]["pointer"], "/input/mesh/faces/2/1", "{answer}");
        assert!(answer["errors"][1]["pointer"].as_str().unwrap().starts_with("/input/mesh/faces/4"), "{answer}");
        assert!(answer.get("report").is_none());
    });
}

#[test]
fn winding_is_refused_or_repaired_as_asked() {
    story(settings(), async |server| {
        let mut input = cube();
        input["mesh"]["faces"][1].as_array_mut().unwrap().reverse();
        let mut question = json!({ "input": input, "plan": { "word": "UC" }, "levels": 1 });
        let refused = server.post("/v1/validate", &question).await.ok().json();
        assert_eq!(refused["valid"], false, "{refused}");
        question["input"]["orient"] = json!("repair");
        let repaired = server.post("/v1/validate", &question).await.ok().json();
        assert_eq!(repaired["valid"], true, "{repaired}");
        assert!(!repaired["warnings"].as_array().unwrap().is_empty(), "{repaired}");
    });
}

/// Without a plan and outputs, a mesh is checked as one that is to be refined.
#[test]
fn an_input_alone_is_looked_at_as_one_that_is_to_be_refined() {
    story(settings(), async |server| {
        let fin = json!({ "mesh": { "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]],
                                    "faces": [[0, 1, 2], [1, 0, 3], [0, 1, 4]] } });
        let alone = server.post("/v1/validate", &json!({ "input": fin })).await.ok().json();
        assert_eq!((&alone["valid"], &alone["errors"][0]["pointer"]), (&false.into(), &"/input/mesh/faces/2".into()));
        // for conversion, it is cut apart
        let question = json!({ "input": fin, "outputs": [{ "format": "glb" }] });
        let converted = server.post("/v1/validate", &question).await.ok().json();
        assert_eq!(converted["valid"], true, "{converted}");
        assert!(!converted["warnings"].as_array().unwrap().is_empty(), "{converted}");
    });
}

/// The faults of all parts of a job are reported together.
#[test]
fn a_question_looks_at_the_whole_job() {
    story(settings(), async |server| {
        let pointers = async |job: &serde_json::Value| -> Vec<String> {
            let answer = server.post("/v1/validate", job).await.ok().json();
            let errors = answer["errors"].as_array().unwrap();
            assert_eq!(answer["valid"], errors.is_empty(), "{answer}");
            errors.iter().map(|error| error["pointer"].as_str().unwrap().to_owned()).collect()
        };
        let plan = json!({ "preset": "catmull-clark" });
        let fine = json!({ "spec": 1, "input": cube(), "plan": plan, "levels": 2, "outputs": [{ "format": "glb" }] });
        assert_eq!(pointers(&fine).await, [""; 0]);
        for (part, value, pointer) in [
            ("/spec", json!(2), "/spec"),
            ("/plan/preset", json!("catmul-clark"), "/plan/preset"),
            ("/levels", json!(65), "/levels"),
            ("/levels", json!(null), "/levels"),
            ("/outputs/0/format", json!("stencil"), "/outputs/0/format"),
            ("/outputs/0/format", json!("gbl"), "/outputs/0/format"),
        ] {
            let mut wrong = fine.clone();
            *wrong.pointer_mut(part).unwrap() = value;
            assert_eq!(pointers(&wrong).await, [pointer], "{wrong}");
        }
        let mut input = cube();
        input["mesh"]["faces"][2][1] = json!(77);
        let outputs = json!([{ "format": "png", "width": 1 }, { "format": "svg" }]);
        let plan = json!({ "word": "UX", "parameters": { "dleta": 1 } });
        let wrong = json!({ "spec": 2, "input": input, "plan": plan, "outputs": outputs });
        let expected = ["/spec", "/input/mesh/faces/2/1", "/outputs/0/width", "/levels", "/plan/word"];
        assert_eq!(pointers(&wrong).await, [&expected[..], &["/plan/parameters/dleta"]].concat());
    });
}

/// Returns a tube of squares with tagged lines.
fn tube() -> serde_json::Value {
    let square = |z: f64| [[1.0, 0.0, z], [0.0, 1.0, z], [-1.0, 0.0, z], [0.0, -1.0, z]];
    let positions: Vec<[f64; 3]> = [0.0, 1.0, 3.0, 4.0].into_iter().flat_map(square).collect();
    let all = |n: usize| (0..n).flat_map(|u| (0..4).map(move |i| [4 * u + i, 4 * u + (i + 1) % 4]));
    let faces: Vec<_> = all(3).map(|[a, b]| [a, b, b + 4, a + 4]).collect();
    let longitude: Vec<_> = all(3).map(|[a, _]| [a, a + 4]).collect();
    json!({ "mesh": { "positions": positions, "faces": faces, "latitude": all(4).collect::<Vec<_>>(),
        "longitude": longitude } })
}

/// Lines are judged by the plan of the request; a plan that does not fit the mesh makes no circles.
#[test]
fn lines_are_exact_only_under_plans_that_fit() {
    story(settings(), async |server| {
        let ask = async |plan: serde_json::Value| {
            let question = json!({ "input": tube(), "plan": plan });
            let answer = server.post("/v1/validate", &question).await.ok().json();
            answer["report"]["latitude_lines"][1].clone()
        };
        for plan in [json!(null), json!({ "preset": "push-back" }), json!({ "word": "UCPCC" })] {
            assert_eq!(ask(plan.clone()).await["exact"], true, "{plan}");
        }
        let unfit = [
            (json!({ "preset": "catmull-clark" }), "knows no latitude"),
            (json!({ "word": "UD" }), "D cannot carry"),
            (json!({ "word": "U3CP" }), "arity 2 and split quad; here stands U3"),
            (json!({ "word": "UCP", "parameters": { "split": "triangle" } }), "only triangles are split"),
            (json!({ "word": "UX" }), "no operator"),
        ];
        for (plan, reason) in unfit {
            let line = ask(plan.clone()).await;
            let said = line["reason"].as_str().unwrap_or_else(|| panic!("{plan}: {line}"));
            assert!(said.contains("the plan does not fit the mesh") && said.contains(reason), "{plan}: {said}");
            assert_eq!((&line["exact"], line.get("limit_radius")), (&json!(false), None), "{plan}");
        }
    });
}

/// A job that /v1/render refuses as too large is not valid either, and its fault is the same.
#[test]
fn a_job_that_would_be_too_large_is_not_valid() {
    story(settings(), async |server| {
        let job = with(mesh(40), "glb");
        let refused = server.render(&job).await.problem(422, "too-large");
        let answer = server.post("/v1/validate", &job).await.ok().json();
        assert_eq!(answer["valid"], false, "{answer}");
        assert_eq!(answer["errors"], refused["errors"], "{answer}");
        assert_eq!(answer["errors"][0]["pointer"], "/levels", "{answer}");
        assert!(answer["report"]["vertices"].is_u64(), "the mesh is described all the same: {answer}");
        let fitting = server.post("/v1/validate", &with(mesh(4), "glb")).await.ok().json();
        assert_eq!(fitting["valid"], true, "{fitting}");
    });
}

#[test]
fn polygons_are_validated_too() {
    story(settings(), async |server| {
        let fine = json!({ "input": polygon(0)["input"] });
        assert_eq!(server.post("/v1/validate", &fine).await.ok().json()["valid"], true);
        let wrong = json!({ "input": { "polygon": { "points": [[0, 0], [1]] } } });
        let answer = server.post("/v1/validate", &wrong).await.ok().json();
        assert_eq!(answer["errors"][0]["pointer"], "/input/polygon/points/1", "{answer}");
    });
}

#[test]
fn mesh_files_are_validated_and_repairs_told() {
    story(settings(), async |server| {
        let facet = |[a, b, c]: [&str; 3]| {
            format!("facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
        };
        let facets = [["0 0 0", "1 0 0", "1 1 0"], ["0 0 0", "1 1 0", "0 1.0001 0"], ["0 0 0", "0 1 0", "-1 0 0"]];
        let data = format!("solid\n{}endsolid\n", facets.map(facet).concat());
        let text = json!({ "format": "stl", "data": data });
        let input = json!({ "text": text, "weld": 0.01, "pair_quads": true });
        let answer = server.post("/v1/validate", &json!({ "input": input })).await.ok().json();
        assert_eq!(answer["valid"], true, "{answer}");
        let told =
            ["welding merged 1 vertex: 4 into 3", "1 pairs of triangles were joined into quads; 1 triangles are left"];
        assert_eq!(answer["warnings"], json!(told));
        assert_eq!(answer["report"]["face_sizes"], json!({ "3": 1, "4": 1 }));
        let broken = json!({ "input": { "text": { "format": "stl", "data": "solid" } } });
        let answer = server.post("/v1/validate", &broken).await.ok().json();
        assert_eq!(answer["errors"][0]["pointer"], "/input/text/data", "{answer}");
        assert_eq!(
            answer["errors"][0]["detail"],
            "line 1: the file ends where \"facet\" or \"endsolid\" should follow"
        );
    });
}

#[test]
fn the_limits_of_the_server_hold_for_files() {
    let small = planish::config::Settings { max_vertices: 3, ..settings() };
    story(small, async |server| {
        let data = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        let job = json!({ "input": { "text": { "format": "obj", "data": data } }, "outputs": [{ "format": "glb" }] });
        let detail = "line 4: the file has 4 vertices or more; 3 are allowed; send a smaller mesh";
        for path in ["/v1/render", "/v1/estimate"] {
            let problem = server.post(path, &job).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0], json!({ "pointer": "/input/text/data", "detail": detail }));
        }
        let answer = server.post("/v1/validate", &json!({ "input": job["input"] })).await.ok().json();
        assert_eq!(answer["errors"][0]["detail"], detail);
    });
}
