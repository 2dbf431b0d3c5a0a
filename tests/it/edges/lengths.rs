//! The part of a request that an answer repeats is short, however long the request is.

use serde_json::{Value, json};

use crate::http::jobs::{polygon, square, with};
use crate::http::server::{settings, story};

/// Maximum length in bytes of the answer to a refused request.
const MAX_BYTES: usize = 64 << 10;

/// Returns a job with one change.
fn changed(change: impl FnOnce(&mut Value)) -> Value {
    let mut job = with(polygon(1), "svg");
    job["plan"]["parameters"] = json!({});
    change(&mut job);
    job
}

/// Returns a text of about a mebibyte that repeats one piece.
fn long(piece: &str) -> String {
    piece.repeat((1 << 20) / piece.len())
}

/// Returns jobs with the text as a name, one for each kind of place.
fn with_name(text: &str) -> Vec<Value> {
    ["", "/input", "/input/polygon", "/plan/parameters", "/outputs/0"]
        .map(|at| {
            changed(|job| drop(job.pointer_mut(at).unwrap().as_object_mut().unwrap().insert(text.to_owned(), json!(1))))
        })
        .to_vec()
}

/// Returns jobs with the text as a value, one for each kind of field.
fn with_value(text: &str) -> Vec<Value> {
    let fields = [
        ("", "levels"),
        ("/input", "polygon"),
        ("/input", "up"),
        ("/input/polygon", "closed"),
        ("/plan", "preset"),
        ("/plan", "boundary"),
        ("/plan", "seed"),
        ("/plan/parameters", "w"),
        ("/outputs/0", "format"),
        ("/outputs/0", "name"),
        ("/outputs/0", "width"),
        ("/outputs/0", "background"),
    ];
    fields.map(|(at, name)| changed(|job| job.pointer_mut(at).unwrap()[name] = json!(text))).to_vec()
}

/// Returns jobs with the text inside a word, a mesh or a mesh file.
fn with_inside(text: &str) -> Vec<Value> {
    let mesh = json!({ "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]],
        "groups": [{ "name": text, "faces": [0] }] });
    let object = json!({ text: 1 }).to_string();
    let files = [(text, ""), ("obj", text), ("ply", text), ("gltf", &object), ("json", &object)];
    let inputs = files.map(|(format, data)| json!({ "text": { "format": format, "data": data } }));
    let inputs = inputs.into_iter().chain([json!({ "mesh": mesh })]);
    let word = changed(|job| job["plan"] = json!({ "word": text }));
    inputs.map(|input| changed(|job| job["input"] = input)).chain([word]).collect()
}

#[test]
fn l_a_long_key_or_value_anywhere_is_shortened_in_the_answer() {
    let twice = format!(r#"{{"input":{{}},"plan":{{"parameters":{{"{0}":1,"{0}":2}}}}}}"#, "k".repeat(1 << 20));
    // a text that escaping lengthens, two that resemble our own messages, and plain ones
    let texts = ["x", "\u{1}", "é", "`, expected ", "\", expected "].map(long);
    let jobs = texts.iter().flat_map(|text| [with_name(text), with_value(text), with_inside(text)].concat());
    story(settings(), async |server| {
        for request in jobs.map(|job| job.to_string()).chain([twice]) {
            let answer = server.post_text("/v1/estimate", request, &[]).await;
            let n = answer.body.len();
            assert!(matches!(answer.status, 400 | 413 | 422), "{}: {}", answer.status, &answer.text()[..n.min(1000)]);
            assert!(n <= 4 << 10, "{n} bytes");
        }
    });
}

#[test]
fn l_an_answer_is_bounded_however_many_faults_there_are() {
    story(settings(), async |server| {
        // each of the outputs is invalid, and its fault names all options of the format
        let mut wrong = json!({ "format": "png" });
        (0..20).for_each(|i| wrong[format!("nonsense{i}")] = json!(i));
        let job = json!({ "input": square(), "plan": { "preset": "chaikin" }, "levels": 1,
            "outputs": vec![wrong; 64] });
        let answer = server.post("/v1/estimate", &job).await;
        let problem = answer.problem(422, "invalid-job");
        assert!(answer.body.len() <= MAX_BYTES, "{} bytes", answer.body.len());
        let listed = problem["errors"].as_array().unwrap().len();
        let said = problem["detail"].as_str().unwrap();
        assert!(said.contains(&format!("the first {listed}")), "{said}");
        assert_eq!(problem["errors"][1]["pointer"], "/outputs/0/nonsense1");
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
