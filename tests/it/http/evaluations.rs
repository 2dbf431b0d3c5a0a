//! Values of limit surfaces over HTTP.

use axum::http::Method;
use serde_json::{Value, json};

use super::jobs::{cube, square};
use super::server::{settings, story};

/// Returns the request to evaluate the limit surface of a cube at some places.
fn asked(at: &Value) -> Value {
    json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "at": at })
}

fn near(found: &Value, wanted: &[f64]) {
    let found: Vec<f64> = found.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    let apart = found.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == wanted.len() && apart < 1e-14, "{found:?}, not {wanted:?}");
}

#[test]
fn a_cube_has_its_known_values_at_a_corner_and_at_the_middle_of_a_face() {
    story(settings(), async |server| {
        let places = json!([[1, 0, 0], [1, 0.5, 0.5]]);
        let found = server.post("/v1/evaluate", &asked(&places)).await.ok().json();
        // the limit of a corner of valence 3, and the centre of a face: (16 f + 4 e + v) / 36 of the first level
        let (positions, normals) = (&found["at"]["positions"], &found["at"]["normals"]);
        near(&positions[0], &[-0.5, -0.5, 0.5]);
        let third = 1.0 / 3.0_f64.sqrt();
        near(&normals[0], &[-third, -third, third]);
        near(&normals[1], &[0.0, 0.0, 1.0]);
        assert_eq!(found["at"].as_object().unwrap().len(), 2, "what was not asked for is left out: {found}");
        let mut all = asked(&places);
        all["values"] = json!(["position", "normal", "derivatives", "second_derivatives", "curvatures"]);
        let found = server.post("/v1/evaluate", &all).await.ok().json();
        let names: Vec<&String> = found["at"].as_object().unwrap().keys().collect();
        assert_eq!(names, ["positions", "normals", "du", "dv", "duu", "duv", "dvv", "principal", "mean", "gaussian"]);
        for name in ["du", "dv", "duu", "duv", "dvv", "principal", "mean", "gaussian"] {
            assert!(found["at"][name][0].is_null(), "{name} at a vertex of valence 3");
            assert!(!found["at"][name][1].is_null(), "{name} in a face");
        }
        assert!(found["at"]["mean"][1].as_f64().unwrap() > 0.0, "it bends away from its normal");
    });
}

/// The default bound on bodies has room for them.
#[test]
fn a_million_places_of_ten_digits_are_one_request() {
    let place = |i: u32| format!("[{},0.{:010},0.{:010}]", i % 6, i, 999_999_999 - i);
    let places = (0..1_000_000).map(place).collect::<Vec<_>>().join(",");
    let mut asked = asked(&json!([]));
    asked["values"] = json!(["curvatures"]);
    let body = asked.to_string().replace("\"at\":[]", &format!("\"at\":[{places}]"));
    story(settings(), async |server| {
        let headers = [("content-type", "application/json")];
        let found = server.ask(Method::POST, "/v1/evaluate", &headers, body.into_bytes()).await.ok().json();
        assert_eq!(found["at"]["mean"].as_array().unwrap().len(), 1_000_000);
    });
}

#[test]
fn the_time_of_an_evaluation_is_not_said_to_be_waiting() {
    story(settings(), async |server| {
        let mut asked = asked(&json!([]));
        asked["closest"] = (0..500).map(|i| json!([0, 0, 0.01 * f64::from(i)])).collect();
        let answer = server.post("/v1/evaluate", &asked).await.ok();
        let timing = answer.header("server-timing");
        let of = |stage: &str| -> f64 {
            let (_, rest) = timing.split_once(&format!("{stage};dur=")).unwrap();
            rest.split([',', ';']).next().unwrap().parse().unwrap()
        };
        assert!(of("refine") > 0.0 && of("encode") > 0.0, "{timing}");
    });
}

#[test]
fn points_have_their_closest_places() {
    story(settings(), async |server| {
        let mut asked = asked(&json!([[1, 0.5, 0.5]]));
        asked["closest"] = json!([[0, 0, 9], [-8, -8, 8], [0.1, 0.2, 0.9]]);
        let found = server.post("/v1/evaluate", &asked).await.ok().json();
        let closest = &found["closest"];
        // the centre of the upper face, and the corner that the faces 1, 2 and 5 share
        near(&closest["at"][0], &[1.0, 0.5, 0.5]);
        near(&closest["at"][1], &[1.0, 0.0, 0.0]);
        near(
            &closest["positions"][0],
            &serde_json::from_value::<Vec<f64>>(found["at"]["positions"][0].clone()).unwrap(),
        );
        near(&closest["positions"][1], &[-0.5, -0.5, 0.5]);
        near(&json!([closest["distances"][1]]), &[7.5 * 3.0_f64.sqrt()]);
        assert_eq!(closest["uncertain"], 0);
        asked["at"] = json!([closest["at"][2]]);
        let there = server.post("/v1/evaluate", &asked).await.ok().json();
        let (a, b) = (&there["at"]["positions"][0], &closest["positions"][2]);
        near(a, &serde_json::from_value::<Vec<f64>>(b.clone()).unwrap());
    });
}

#[test]
fn the_same_question_is_answered_once() {
    story(settings(), async |server| {
        let first = server.post("/v1/evaluate", &asked(&json!([[0, 0.5, 0.5]]))).await.ok();
        // the default corner is 0, and the order of values has no effect
        let mut same = asked(&json!([[0.0, 0.5, 5e-1, 0]]));
        same["values"] = json!(["normal", "position", "normal"]);
        let second = server.post("/v1/evaluate", &same).await.ok();
        assert_eq!(second.header("cache-status"), "planish; hit");
        assert_eq!((first.header("etag"), &first.body), (second.header("etag"), &second.body));
        let headers = [("content-type", "application/json"), ("if-none-match", first.header("etag"))];
        let third = server.ask(Method::POST, "/v1/evaluate", &headers, same.to_string().into_bytes()).await;
        assert_eq!(third.status, 304);
        let kept = server.get(first.header("content-location")).await.ok();
        assert_eq!(kept.body, first.body);
    });
}

#[test]
fn what_has_no_values_is_refused_at_its_place() {
    story(settings(), async |server| {
        let mut of_loop = asked(&json!([[0, 0, 0]]));
        of_loop["plan"] = json!({ "preset": "doo-sabin" });
        let mut of_curve = asked(&json!([[0, 0, 0]]));
        of_curve["input"] = square();
        of_curve["plan"] = json!({ "preset": "chaikin" });
        let mut nothing = asked(&json!([[0, 0, 0]]));
        nothing["values"] = json!([]);
        let mut broken = asked(&json!([[0, 0, 0]]));
        broken["input"]["mesh"]["faces"][2][1] = 77.into();
        let many = vec![json!([0, 0, 0]); 1_000_001];
        let mut far = asked(&json!([[0, 0, 0]]));
        far["closest"] = json!([[0, 0, 9], [1e200, 0, 0]]);
        let cases = [
            (of_loop, "/plan", "Catmull-Clark"),
            (of_curve, "/input", "only meshes"),
            (nothing, "/values", "name some"),
            (broken, "/input/mesh/faces/2/1", "77"),
            (far, "/closest/1", "at most 1e150"),
            (asked(&json!([])), "/at", "no place"),
            (asked(&json!(many)), "/at", "at most 1000000"),
            (asked(&json!([[0, 0, 0], [6, 0, 0]])), "/at/1/0", "the mesh has 6"),
            (asked(&json!([[0.5, 0, 0]])), "/at/0/0", "0.5"),
            (asked(&json!([[0, 0, 1.5]])), "/at/0/2", "give 0 to 1"),
            (asked(&json!([[0, 0, 0, 1]])), "/at/0/3", "leave the corner out"),
            (asked(&json!([[0, 0]])), "/at/0", "[face, u, v]"),
        ];
        for (asked, pointer, detail) in cases {
            let answer = server.post("/v1/evaluate", &asked).await;
            let problem = answer.problem(422, "invalid-job");
            let fault = &problem["errors"][0];
            assert_eq!(fault["pointer"], pointer, "{problem}");
            assert!(fault["detail"].as_str().unwrap().contains(detail), "{problem}");
        }
    });
}
