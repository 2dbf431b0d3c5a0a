//! Mesh files as bodies: the query gives the rest of the job, and the answer is that of the equal job in JSON.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use planish::input::READERS;
use serde_json::{Value, json};

use super::jobs::mesh;
use super::server::{Answer, Server, settings, story};

/// Returns a file of a format with a cube.
async fn cube(server: &Server, format: &str) -> Vec<u8> {
    if format == "off" {
        return b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n".to_vec();
    }
    let job = json!({ "input": mesh(0)["input"], "outputs": [{ "format": format }] });
    server.render(&job).await.ok().body.to_vec()
}

async fn post(server: &Server, query: &str, media_type: &str, body: &[u8]) -> Answer {
    server.post_text(&format!("/v1/render?{query}"), body, &[("content-type", media_type)]).await
}

/// Checks that a query beside a file has the answer of this job, to which the file is added.
async fn check(server: &Server, query: &str, mut job: Value) {
    let file = cube(server, "obj").await;
    job["input"]["text"] = json!({ "format": "obj", "data": String::from_utf8(file.clone()).unwrap() });
    let told = server.render(&job).await.ok();
    let asked = post(server, query, "model/obj", &file).await.ok();
    assert_eq!(asked.header("content-location"), told.header("content-location"), "{query}");
    assert_eq!(asked.header("etag"), told.header("etag"), "{query}");
    assert_eq!(asked.body, told.body, "{query}");
}

#[test]
fn a_file_of_every_reader_has_the_answer_of_the_equal_job() {
    story(settings(), async |server| {
        for reader in READERS {
            let file = cube(server, reader.name).await;
            let text = json!({ "format": reader.name, "data": STANDARD.encode(&file), "encoding": "base64" });
            let job = json!({ "input": { "text": text, "weld": 0 }, "plan": { "preset": "catmull-clark" },
                "levels": 2, "outputs": [{ "format": "glb" }] });
            let told = server.render(&job).await.ok();
            let query = "preset=catmull-clark&levels=2&format=glb&input.weld=0";
            let asked = post(server, query, reader.media_type, &file).await.ok();
            assert_eq!(asked.header("content-location"), told.header("content-location"), "{}", reader.name);
            assert_eq!(asked.body, told.body, "{}", reader.name);
        }
    });
}

#[test]
fn a_material_stands_in_the_query_field_by_field() {
    story(settings(), async |server| {
        let look = json!({ "color": [1, 0.5, 0, 0.5], "roughness": 0.25, "double_sided": false });
        let job = json!({ "input": { "material": look }, "outputs": [{ "format": "glb" }] });
        let query = "format=glb&input.material.color=1,0.5,0,0.5&input.material.roughness=0.25\
            &input.material.double_sided=false";
        check(server, query, job).await;
        let job = json!({ "input": { "material": { "color": "#ff8000" } }, "outputs": [{ "format": "glb" }] });
        check(server, "format=glb&input.material.color=%23ff8000", job).await;
        for (query, place) in [
            ("input.material.color=red", "?input.material.color"),
            ("input.material.rough=1", "?input.material.rough"),
            ("input.material.metallic=2", "?input.material.metallic"),
        ] {
            let file = cube(server, "obj").await;
            let problem = post(server, query, "model/obj", &file).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], place, "{query}: {problem}");
        }
    });
}

#[test]
fn what_programs_send_without_being_told_a_type_is_read_by_its_first_bytes() {
    story(settings(), async |server| {
        for reader in READERS.iter().filter(|reader| reader.name != "gltf") {
            let file = cube(server, reader.name).await;
            for untold in ["application/x-www-form-urlencoded", "application/octet-stream"] {
                post(server, "format=stl", untold, &file).await.ok();
            }
            let path = "/v1/render?format=stl";
            server.ask(axum::http::Method::POST, path, &[], file.clone()).await.ok();
        }
        let form = "application/x-www-form-urlencoded";
        let job = mesh(1).to_string();
        for (unknown, meant) in [
            (&b"a=b&c=d"[..], "model/obj"),
            (job.as_bytes(), "application/json"),
            (b"\x89PNG\r\n\x1a\n", "model/obj"),
            (b"", "model/obj"),
        ] {
            let problem = post(server, "format=stl", form, unknown).await.problem(415, "unsupported-media-type");
            let told = format!("curl says so with -H 'Content-Type: {meant}'");
            assert!(problem["detail"].as_str().unwrap().contains(&told), "{problem}");
        }
    });
}

#[test]
fn values_have_the_types_that_are_declared() {
    let output = |output: Value| json!({ "input": {}, "outputs": [output] });
    story(settings(), async |server| {
        for query in ["format=ply&output.ascii=true", "format=ply&output.ascii"] {
            check(server, query, output(json!({ "format": "ply", "ascii": true }))).await;
        }
        let picture = json!({ "format": "png", "width": 64, "height": 48, "background": "#ffffff",
            "camera": { "azimuth_deg": 30, "target": [0, 0.5, 0] } });
        let query = "format=png&output.width=64&output.height=48&output.background=%23ffffff\
            &output.camera.azimuth_deg=30&output.camera.target=0,0.5,0";
        check(server, query, output(picture.clone())).await;
        let whole = "format=png&output.width=64&output.height=48&output.background=%23ffffff\
            &output.camera={%22azimuth_deg%22:30,%22target%22:[0,0.5,0]}";
        check(server, whole, output(picture)).await;
        check(server, "format=obj&output.name=1", output(json!({ "format": "obj", "name": "1" }))).await;
        let word = json!({ "input": { "unit": "mm" }, "levels": 2, "outputs": [{ "format": "stats" }], "plan": {
            "word": "UCP", "boundary": "edge-only", "seed": 7,
            "parameters": { "alpha": "pi/6", "kernel": "cos(alpha/2)", "delta": 0.5 } } });
        let query = "word=UCP&parameters.alpha=pi/6&parameters.kernel=cos(alpha/2)&parameters.delta=0.5&levels=2\
            &boundary=edge-only&seed=7&input.unit=mm&format=stats&keep=true";
        check(server, query, word).await;
        let near = json!({ "input": {}, "plan": { "preset": "loop" }, "levels": { "tolerance": 0.1 },
            "outputs": [{ "format": "stats" }] });
        let triangles = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
        let mut job = near;
        job["input"]["text"] = json!({ "format": "obj", "data": String::from_utf8_lossy(triangles) });
        let told = server.render(&job).await.ok();
        let query = "preset=loop&levels.tolerance=0.1&format=stats";
        let asked = post(server, query, "model/obj", triangles).await.ok();
        assert_eq!(asked.header("planish-level"), told.header("planish-level"));
        assert_eq!(asked.body, told.body);
    });
}

#[test]
fn without_a_format_accept_chooses_and_without_a_plan_the_file_is_converted() {
    story(settings(), async |server| {
        let file = cube(server, "obj").await;
        let headers = [("content-type", "model/obj"), ("accept", "model/stl")];
        let answer = server.post_text("/v1/render", file.clone(), &headers).await.ok();
        assert_eq!(answer.header("content-type"), "model/stl");
        assert_eq!(post(server, "", "model/obj", &file).await.ok().header("content-type"), "model/gltf-binary");
    });
}

#[test]
fn faults_point_at_the_parameter_by_its_name() {
    story(settings(), async |server| {
        let file = cube(server, "obj").await;
        for (query, at) in [
            ("levles=3", "?levles"),
            ("preset=catmull-clark&levels=3&levels=4", "?levels"),
            ("preset=catmull-clark&levels=many", "?levels"),
            ("preset=catmull-clark&levels=2&levels.tolerance=1", "?levels.tolerance"),
            ("preset=catmul&levels=1", "?preset"),
            ("preset=catmull-clark&levels=1&parameters.w=1", "?parameters.w"),
            ("word=UCP&levels=1&parameters.delta=x", "?parameters.delta"),
            ("format=gbl", "?format"),
            ("output.width=9", "?format"),
            ("format=png&output.width=9", "?output.width"),
            ("format=png&output.camera.zoom=x", "?output.camera.zoom"),
            ("format=png&output.widht=9", "?output.widht"),
            ("input.unit=ft", "?input.unit"),
            ("boundary=soft&preset=catmull-clark&levels=1", "?boundary"),
            ("output.=3", "?output."),
            ("mesh=3", "?mesh"),
        ] {
            let problem = post(server, query, "model/obj", &file).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], at, "{query}: {problem}");
            assert!(!problem.to_string().contains("/plan/"), "{problem}");
        }
        let problem = post(server, "format=glb", "model/obj", b"f 1 2 3").await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "", "what is wrong in the file has no name: {problem}");
        let problem =
            post(server, "preset=catmull-clark&levels=40", "model/obj", &file).await.problem(422, "too-large");
        assert_eq!(problem["errors"][0]["pointer"], "?levels", "{problem}");
    });
}

#[test]
fn the_same_file_with_another_query_is_another_request() {
    story(settings(), async |server| {
        let file = cube(server, "obj").await;
        for _ in 0..3 {
            let one = post(server, "preset=catmull-clark&levels=1&format=stl", "model/obj", &file).await.ok();
            let two = post(server, "preset=catmull-clark&levels=2&format=stl", "model/obj", &file).await.ok();
            assert_eq!(one.body.len(), 84 + 50 * 48);
            assert_eq!(two.body.len(), 84 + 50 * 192);
        }
    });
}

#[test]
fn a_file_whose_result_takes_longer_is_a_job_that_can_be_made_again() {
    story(settings(), async |server| {
        let file = cube(server, "ply").await;
        let held = server.hold().await;
        let headers = [("content-type", "model/ply"), ("prefer", "wait=0")];
        let path = "/v1/render?preset=catmull-clark&levels=2&format=obj";
        let later = server.post_text(path, file.clone(), &headers).await;
        assert_eq!(later.status, 202, "{}", later.text());
        drop(held);
        let job = server.settled(later.header("location")).await;
        assert_eq!(job["state"], "done", "{job}");
        let place = job["outputs"][0]["href"].as_str().unwrap().to_owned();
        let made = server.get(&place).await.ok();
        let key = planish::job::key::Key::parse(job["outputs"][0]["key"].as_str().unwrap()).unwrap();
        server.app.desk.tiers.remove(&key).unwrap();
        assert_eq!(server.get(&place).await.ok().body, made.body);
    });
}

#[test]
fn a_job_with_a_query_for_mesh_files_is_refused_and_not_answered_as_something_else() {
    story(settings(), async |server| {
        let job = serde_json::to_vec(&mesh(1)).unwrap();
        let told = [("content-type", "application/json")];
        for path in ["/v1/render", "/v1/estimate", "/v1/validate"] {
            server.post_text(path, &job[..], &told).await.ok();
            let answer = server.post_text(&format!("{path}?levels=3&output.width=9"), &job[..], &told).await;
            assert_eq!(answer.status, 422, "{path}: {}", answer.text());
            let errors = answer.json()["errors"].clone();
            let beside = "it stands beside a mesh file as the body; a job says it itself, at";
            let expected = json!([{ "pointer": "?levels", "detail": format!("{beside} /levels") },
                                  { "pointer": "?output.width", "detail": format!("{beside} /outputs/0/width") }]);
            assert_eq!(errors, expected, "{path}");
        }
        server.post_text("/v1/render?keep=true", &job[..], &told).await.ok();
        let link = format!("/v1/render?job={}", base64::engine::general_purpose::URL_SAFE_NO_PAD.encode(&job));
        server.get(&link).await.ok();
        server.get(&format!("{link}&_=17")).await.ok();
        assert_eq!(server.get(&format!("{link}&levels=3")).await.status, 422);
        // unknown or repeated parameters are not ignored
        let twice = [
            server.post_text("/v1/render?keep=true&keep=true", &job[..], &told).await,
            server.post_text("/v1/jobs?priority=batch&priority=batch", &job[..], &told).await,
            server.get(&format!("{link}&keep=true&keep=true")).await,
            server.get("/v1/jobs?limit=1&limit=2").await,
        ];
        for answer in twice {
            let problem = answer.problem(422, "invalid-job");
            assert!(problem["errors"][0]["detail"].as_str().unwrap().contains("given twice"), "{problem}");
        }
        let unknown = server.post_text("/v1/render?kepp=true", &job[..], &told).await;
        let problem = unknown.problem(422, "invalid-job");
        assert!(problem["errors"][0]["detail"].as_str().unwrap().contains("did you mean \"keep\"?"), "{problem}");
    });
}
