//! Every class of error: its status, its kind, its pointer, and the remedy.

use axum::http::Method;
use serde_json::{Value, json};

use super::jobs::{cube, mesh, polygon, square, with};
use super::server::{rest, settings, story};

#[test]
fn text_that_is_not_json_is_400_with_line_and_column() {
    story(settings(), async |server| {
        let half = mesh(2).to_string();
        let half = &half[..half.len() / 2];
        let nan = r#"{"input": {"polygon": {"points": [[NaN, 0]]}}}"#;
        for path in ["/v1/render", "/v1/estimate", "/v1/validate"] {
            for text in [half, nan, "", "{", "input", r#"{"input": {}} x"#, "\u{feff}{}"] {
                let problem = server.post_text(path, text, &[]).await.problem(400, "not-json");
                let detail = problem["detail"].as_str().unwrap();
                assert!(detail.contains("line 1 column"), "{path} {text:?}: {detail}");
            }
            server.post_text(path, &b"{\"input\": \"\xff\"}"[..], &[]).await.problem(400, "not-json");
            // as editors and shells of some systems write files
            for (text, remedy) in [
                (&b"\xef\xbb\xbf{}"[..], "JSON is UTF-8 without one"),
                (b"\xff\xfe{\0}\0", "it is UTF-16, JSON is UTF-8"),
            ] {
                let problem = server.post_text(path, text, &[]).await.problem(400, "not-json");
                let detail = problem["detail"].as_str().unwrap();
                assert!(detail.ends_with(remedy), "{path}: {detail}");
            }
        }
    });
}

/// Returns invalid jobs with a name, the pointer of the fault, and a word of its detail.
fn impossible() -> Vec<(&'static str, Value, &'static str, &'static str)> {
    let changed = |pointer: &str, value: Value| {
        let mut job = mesh(2);
        job["outputs"] = json!([{ "format": "glb" }]);
        let (parent, field) = pointer.rsplit_once('/').unwrap();
        let parent = job.pointer_mut(parent).unwrap();
        match parent.as_array_mut() {
            Some(list) => list[field.parse::<usize>().unwrap()] = value,
            None => parent[field] = value,
        }
        job
    };
    vec![
        ("a wrong field", changed("/level", json!(3)), "/level", "did you mean \"levels\"?"),
        ("a wrong field inside", changed("/input/mesh/vertices", json!([])), "/input/mesh/vertices", "unknown field"),
        ("a wrong option", changed("/outputs/0/colour", json!("red")), "/outputs/0/colour", "option"),
        ("a misspelt format", changed("/outputs/0/format", json!("pgn")), "/outputs/0/format", "did you mean \"png\"?"),
        ("a wrong parameter", changed("/plan/parameters", json!({ "w": 1 })), "/plan/parameters/w", "parameter"),
        ("a wrong type", changed("/levels", json!("two")), "/levels", "whole number"),
        ("a negative count", changed("/levels", json!(-1)), "/levels", "whole number"),
        (
            "a text for a number",
            changed("/input/mesh/positions/3/1", json!("NaN")),
            "/input/mesh/positions/3/1",
            "number",
        ),
        ("null for a number", changed("/input/mesh/positions/3/1", json!(null)), "/input/mesh/positions/3/1", "number"),
        ("two coordinates", changed("/input/mesh/positions/3", json!([1, 2])), "/input/mesh/positions/3", "three"),
        (
            "four coordinates",
            changed("/input/mesh/positions/3", json!([1, 2, 3, 4])),
            "/input/mesh/positions/3",
            "length 4, expected a list of three",
        ),
        (
            "four coordinates in the last place",
            changed("/input/mesh/positions/7", json!([1, 2, 3, [4]])),
            "/input/mesh/positions/7",
            "length 4, expected a list of three",
        ),
        (
            "an edge of five ends",
            changed("/input/mesh/creases", json!([{ "edge": [0, 1, 2, 3, 4], "sharpness": 1 }])),
            "/input/mesh/creases/0/edge",
            "length 5, expected a list of two",
        ),
        (
            "an edge of one end",
            changed("/input/mesh/creases", json!([{ "edge": [0], "sharpness": 1 }])),
            "/input/mesh/creases/0/edge",
            "length 1, expected a list of two",
        ),
        (
            "three ends of a latitude edge",
            changed("/input/mesh/latitude", json!([[0, 1, 2]])),
            "/input/mesh/latitude/0",
            "two",
        ),
        (
            "three ends of a longitude edge",
            changed("/input/mesh/longitude", json!([[1, 2], [1, 2, 3]])),
            "/input/mesh/longitude/1",
            "two",
        ),
        (
            "three texture coordinates",
            changed("/input/mesh/uvs", json!({ "values": [[0, 0, 0]], "faces": [] })),
            "/input/mesh/uvs/values/0",
            "two",
        ),
        (
            "a mesh in a text with four coordinates",
            changed(
                "/input",
                json!({ "text": { "format": "json", "data": r#"{"positions":[[0,0,0,0]],"faces":[]}"# } }),
            ),
            "/input/text/data",
            "in the mesh, /positions/0: invalid length 4, expected a list of three",
        ),
        ("level 40", changed("/levels", json!(40)), "/levels", "at most"),
        ("level 2^32 - 1", changed("/levels", json!(4_294_967_295_u32)), "/levels", "64"),
        ("a face index too large", changed("/input/mesh/faces/2/0", json!(8)), "/input/mesh/faces/2/0", "8"),
        ("a face of two", changed("/input/mesh/faces/2", json!([0, 1])), "/input/mesh/faces/2", "3"),
        ("an unknown preset", changed("/plan/preset", json!("catmul")), "/plan/preset", "catmull-clark"),
        ("an unknown format", changed("/outputs/0/format", json!("fbx")), "/outputs/0/format", "glb"),
        ("no format", changed("/outputs/0", json!({ "name": "a" })), "/outputs/0", "format"),
        ("two outputs", changed("/outputs", json!([{ "format": "glb" }, { "format": "png" }])), "/outputs", "one"),
        ("two inputs", changed("/input/polygon", square()["polygon"].clone()), "/input", "exactly one"),
        ("no input", changed("/input", json!({})), "/input", "exactly one"),
        ("another version", changed("/spec", json!(2)), "/spec", "1"),
        ("preset and word", changed("/plan/word", json!("UC")), "/plan/word", "word"),
        ("a job that is a list", json!([1, { "polygon": { "points": [[0], [1]] } }]), "", "object"),
        ("an input that is a list", changed("/input", json!([cube()["mesh"]])), "/input", "object"),
        ("a mesh that is a list", changed("/input/mesh", json!([[], []])), "/input/mesh", "object"),
        ("a plan that is a list", changed("/plan", json!(["catmull-clark"])), "/plan", "object"),
    ]
}

#[test]
fn json_that_is_no_job_is_422_with_a_pointer_to_the_place() {
    story(settings(), async |server| {
        for (what, job, pointer, word) in impossible() {
            let answer = server.render(&job).await;
            let kind = if what == "level 40" { "too-large" } else { "invalid-job" };
            let problem = answer.problem(422, kind);
            assert_eq!(problem["errors"][0]["pointer"], pointer, "{what}: {problem}");
            let detail = problem["errors"][0]["detail"].as_str().unwrap();
            assert!(detail.contains(word), "{what}: {detail}");
        }
    });
}

#[test]
fn a_number_beyond_f64_is_422_at_its_place() {
    story(settings(), async |server| {
        let text = with(polygon(1), "json").to_string().replace("[1,0]", "[1e999,0]");
        let problem = server.post_text("/v1/render", text, &[]).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/input/polygon/points/1/0", "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains("1.8e308"), "{problem}");
    });
}

#[test]
fn all_faults_are_reported_together() {
    story(settings(), async |server| {
        let mut job = with(mesh(1), "fbx");
        job["spec"] = json!(7);
        job["input"]["mesh"]["faces"][0][0] = json!(80);
        job["input"]["mesh"]["faces"][1][0] = json!(81);
        let problem = server.render(&job).await.problem(422, "invalid-job");
        let pointers: Vec<&str> =
            problem["errors"].as_array().unwrap().iter().map(|error| error["pointer"].as_str().unwrap()).collect();
        assert_eq!(pointers, ["/spec", "/input/mesh/faces/0/0", "/input/mesh/faces/1/0", "/outputs/0/format"]);
    });
}

#[test]
fn a_result_that_would_be_too_large_names_the_level_that_is_not() {
    let settings = planish::config::Settings { max_faces: 1000, ..settings() };
    story(settings, async |server| {
        let problem = server.render(&mesh(4)).await.problem(422, "too-large");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("1,536 faces") && detail.contains("1,000") && detail.contains("3 levels"), "{detail}");
        assert_eq!(problem["errors"][0]["pointer"], "/levels");
        server.render(&mesh(3)).await.ok();
    });
}

#[test]
fn a_page_that_does_not_exist_is_404() {
    story(settings(), async |server| {
        let id = "ab".repeat(32);
        let pages =
            ["/v2", "/v1/rendering", "/v1/presets/nurbs", "/v1/operators/Z", "/v1/operators/UU", "/docs/problems/x"];
        for page in pages {
            server.get(page).await.problem(404, "not-found");
        }
        let artifact = server.get(&format!("/v1/artifacts/{id}.glb")).await.problem(404, "not-found");
        assert!(artifact["detail"].as_str().unwrap().contains("/v1/render"), "{artifact}");
    });
}

#[test]
fn a_method_that_a_page_does_not_know_is_405_with_those_it_knows() {
    story(settings(), async |server| {
        let table = [
            (Method::DELETE, "/v1/render", "POST,GET,HEAD"),
            (Method::PUT, "/v1/render", "POST,GET,HEAD"),
            (Method::HEAD, "/v1/estimate", "POST"),
            (Method::GET, "/v1/validate", "POST"),
            (Method::POST, "/v1/presets", "GET,HEAD"),
            (Method::DELETE, "/v1/presets/chaikin", "GET,HEAD"),
            (Method::POST, "/v1/artifacts/1.glb", "GET,HEAD"),
            (Method::PATCH, "/livez", "GET,HEAD"),
            (Method::from_bytes(b"BREW").unwrap(), "/v1/jobs/1", "GET,HEAD,DELETE"),
        ];
        for (method, path, allowed) in table {
            let answer = server.ask(method.clone(), path, &[], Vec::new()).await;
            assert_eq!(answer.header("allow"), allowed, "{method} {path}");
            if method == Method::HEAD {
                assert_eq!(answer.status, 405);
            } else {
                answer.problem(405, "method-not-allowed");
            }
        }
        let answer = server.get("/v1/estimate").await;
        assert!(answer.json()["detail"].as_str().unwrap().contains("POST"), "it says what to do: {}", answer.text());
    });
}

#[test]
fn a_body_of_another_kind_is_415() {
    story(settings(), async |server| {
        let kinds: [&[(&str, &str)]; 4] = [
            &[("content-type", "application/x-www-form-urlencoded")],
            &[("content-type", "multipart/form-data; boundary=x")],
            &[("content-type", "text/plain")],
            &[("content-type", "")],
        ];
        for coding in ["br", "deflate", "gzip, gzip", "zstd, gzip"] {
            for path in ["/v1/render", "/v1/estimate", "/v1/validate"] {
                let answer = server.post_text(path, mesh(1).to_string(), &[("content-encoding", coding)]).await;
                answer.problem(415, "unsupported-content-coding");
                assert_eq!(answer.header("accept-encoding"), "gzip, zstd", "it says which are read");
            }
        }
        for headers in kinds {
            for path in ["/v1/render", "/v1/estimate", "/v1/validate"] {
                let problem =
                    server.post_text(path, mesh(1).to_string(), headers).await.problem(415, "unsupported-media-type");
                assert!(problem["detail"].as_str().unwrap().contains("JSON") || headers[0].0 == "content-type");
            }
        }
        let none = server.ask(Method::POST, "/v1/render", &[], mesh(1).to_string().into_bytes()).await;
        none.problem(415, "unsupported-media-type");
        for fine in ["application/json", "Application/JSON; charset=utf-8"] {
            server.post_text("/v1/render", mesh(1).to_string(), &[("content-type", fine)]).await.ok();
        }
        server.post_text("/v1/render", mesh(1).to_string(), &[("content-encoding", "Identity")]).await.ok();
    });
}

#[test]
fn a_body_that_breaks_off_is_told_as_such_and_not_as_broken_json() {
    story(settings(), async |server| {
        for (path, media_type, chunk) in [
            ("/v1/render", "application/json", "{\"inp"),
            ("/v1/jobs", "application/json", "{\"inp"),
            ("/v1/blobs", "model/obj", "v 0 0"),
        ] {
            let head = format!("POST {path} HTTP/1.1\r\nhost: {}\r\ncontent-type: {media_type}\r\n", server.address);
            let broken = format!("{head}transfer-encoding: chunked\r\n\r\n5\r\n{chunk}\r\nno length\r\n");
            let answer = rest(server.said(&broken).await).await;
            assert!(answer.starts_with("HTTP/1.1 400 "), "{path}: {answer}");
            assert!(answer.contains("/docs/problems/broken-off") && answer.contains("after 5 bytes"), "{answer}");
        }
    });
}

#[test]
fn a_body_that_is_too_long_is_413_announced_or_not() {
    let settings = planish::config::Settings { max_body_bytes: 1000, ..settings() };
    story(settings, async |server| {
        let body = format!("{}{}", mesh(1), " ".repeat(1000));
        let problem = server.post_text("/v1/render", body.clone(), &[]).await.problem(413, "body-too-long");
        assert!(problem["detail"].as_str().unwrap().contains("1000 bytes"), "{problem}");
        let chunks =
            body.into_bytes().chunks(300).map(|chunk| Ok::<_, std::io::Error>(chunk.to_vec())).collect::<Vec<_>>();
        let chunked = server
            .client
            .post(server.url("/v1/render"))
            .header("content-type", "application/json")
            .body(reqwest::Body::wrap_stream(futures_util::stream::iter(chunks)));
        let answer = super::server::Answer::of(chunked.send().await.unwrap()).await;
        answer.problem(413, "body-too-long");
        server.render(&polygon(1)).await.ok();
    });
}

#[test]
fn addresses_that_are_no_text_are_problems_like_all_others() {
    story(settings(), async |server| {
        for path in
            ["/v1/jobs/%ff", "/v1/artifacts/%ff.glb", "/v1/presets/%ff", "/v1/operators/%c3%28", "/docs/problems/%ff"]
        {
            server.get(path).await.problem(404, "not-found");
        }
    });
}

#[test]
fn every_kind_of_problem_has_a_page() {
    story(settings(), async |server| {
        let problem = server.get("/v1/nothing").await.problem(404, "not-found");
        let page = server.get(problem["type"].as_str().unwrap()).await.ok();
        assert!(page.header("content-type").starts_with("text/html"));
        assert!(page.text().contains(problem["title"].as_str().unwrap()), "{}", page.text());
        let kinds = [
            "not-json",
            "invalid-job",
            "too-large",
            "not-acceptable",
            "body-too-long",
            "unsupported-media-type",
            "gone",
            "method-not-allowed",
            "range-not-satisfiable",
            "too-slow",
            "wrong-host",
            "busy",
            "not-ready",
            "timed-out",
            "cancelled",
            "internal",
        ];
        for kind in kinds {
            server.get(&format!("/docs/problems/{kind}")).await.ok();
        }
    });
}

#[test]
fn trace_ids_differ() {
    story(settings(), async |server| {
        let (one, other) = (server.get("/a").await.json(), server.get("/a").await.json());
        assert_ne!(one["trace_id"], other["trace_id"]);
    });
}
