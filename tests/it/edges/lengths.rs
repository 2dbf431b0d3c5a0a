//! What an answer repeats of a request is short, however long the request was.

use serde_json::{Value, json};

use crate::http::jobs::{polygon, with};
use crate::http::server::{settings, story};

/// Longest answer to a request that is refused, bytes.
const MOST_BYTES: usize = 64 << 10;

/// A job with one thing changed.
fn changed(change: impl FnOnce(&mut Value)) -> Value {
    let mut job = with(polygon(1), "svg");
    job["plan"]["parameters"] = json!({});
    change(&mut job);
    job
}

/// A text of nearly as many bytes as a body may have, out of one piece again and again.
fn long(piece: &str) -> String {
    piece.repeat((3 << 20) / piece.len())
}

#[test]
fn l_a_long_key_or_value_anywhere_is_shortened_in_the_answer() {
    // a text that escapes make longer, one that looks like a message of our own, and a plain one
    for piece in ["x", "\u{1}", "é", "`, expected ", "\", expected "] {
        let text = long(piece);
        let key = |at: &str| {
            let name = text.clone();
            changed(|job| {
                job.pointer_mut(at).unwrap().as_object_mut().unwrap().insert(name, json!(1));
            })
        };
        let value = |at: &'static str, name: &'static str| {
            let text = text.clone();
            changed(move |job| job.pointer_mut(at).unwrap()[name] = json!(text))
        };
        let mesh = json!({ "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]],
            "groups": [{ "name": text, "faces": [0] }] });
        let twice = format!(r#"{{"input":{{}},"plan":{{"parameters":{{"{0}":1,"{0}":2}}}}}}"#, "k".repeat(1 << 20));
        let requests = [
            key("").to_string(),
            key("/input").to_string(),
            key("/input/polygon").to_string(),
            key("/plan/parameters").to_string(),
            key("/outputs/0").to_string(),
            value("", "levels").to_string(),
            value("/input", "polygon").to_string(),
            value("/input", "up").to_string(),
            value("/input/polygon", "closed").to_string(),
            value("/plan", "preset").to_string(),
            value("/plan", "boundary").to_string(),
            value("/plan", "seed").to_string(),
            value("/plan/parameters", "w").to_string(),
            value("/outputs/0", "format").to_string(),
            value("/outputs/0", "name").to_string(),
            value("/outputs/0", "width").to_string(),
            value("/outputs/0", "background").to_string(),
            changed(|job| job["plan"] = json!({ "word": text })).to_string(),
            changed(|job| job["input"] = json!({ "mesh": mesh })).to_string(),
            changed(|job| job["input"] = json!({ "text": { "format": text, "data": "" } })).to_string(),
            changed(|job| job["input"] = json!({ "text": { "format": "obj", "data": text } })).to_string(),
            changed(|job| job["input"] = json!({ "text": { "format": "ply", "data": text } })).to_string(),
            changed(|job| {
                job["input"] = json!({ "text": { "format": "gltf", "data": json!({ &text: 1 }).to_string() } })
            })
            .to_string(),
            changed(|job| {
                job["input"] = json!({ "text": { "format": "json", "data": json!({ &text: 1 }).to_string() } })
            })
            .to_string(),
            twice,
        ];
        story(settings(), async |server| {
            for (i, request) in requests.into_iter().enumerate() {
                let answer = server.post_text("/v1/estimate", request, &[]).await;
                let n = answer.body.len();
                assert!(matches!(answer.status, 400 | 413 | 422), "request {i} of {piece:?}: {}", answer.status);
                assert!(n <= 4 << 10, "request {i} of {piece:?} is answered by {n} bytes");
            }
        });
    }
}

#[test]
fn l_an_answer_is_bounded_however_many_faults_there_are() {
    story(settings(), async |server| {
        // each of the polygons is at fault, and says so with a long name
        let wrong = json!({ "points": [[0, 0], [1]] });
        let job = json!({ "input": { "polygons": vec![wrong; 4000] }, "plan": { "preset": "chaikin" }, "levels": 1,
            "outputs": [{ "format": "svg" }] });
        let answer = server.post("/v1/estimate", &job).await;
        let problem = answer.problem(422, "invalid-job");
        assert!(answer.body.len() <= MOST_BYTES, "{} bytes", answer.body.len());
        let listed = problem["errors"].as_array().unwrap().len();
        let said = problem["detail"].as_str().unwrap();
        assert!(said.contains("3999 more") && said.contains(&format!("the first {listed}")), "{said}");
        assert_eq!(problem["errors"][1]["pointer"], "/input/polygons/1/points/1");
    });
}

#[test]
fn l_headers_and_addresses_are_shortened_in_the_answer() {
    story(settings(), async |server| {
        let text = "x".repeat(20_000);
        let job = with(polygon(1), "svg").to_string();
        for header in ["content-type", "content-encoding", "host"] {
            let answer = server.post_text("/v1/render", job.clone(), &[(header, &text)]).await;
            assert!((400..500).contains(&answer.status), "{header}: {}", answer.status);
            assert!(answer.body.len() <= 2 << 10, "{header}: {} bytes", answer.body.len());
        }
        for path in ["", "v1/jobs/", "v1/artifacts/", "v1/presets/", "docs/problems/"] {
            let answer = server.get(&format!("/{path}{text}")).await;
            assert_eq!(answer.status, 404, "{path}");
            assert!(answer.body.len() <= 2 << 10, "{path}: {} bytes", answer.body.len());
        }
        let method = axum::http::Method::from_bytes("M".repeat(5000).as_bytes()).unwrap();
        let answer = server.ask(method, "/v1/render", &[], Vec::new()).await;
        answer.problem(405, "method-not-allowed");
        assert!(answer.body.len() <= 2 << 10, "{} bytes", answer.body.len());
    });
}
