//! Every kind of JSON value in every field: a value that does not fit is answered by 422 with a pointer to the field,
//! never by "not JSON", and no value is accepted that the schema of the request forbids.

use serde_json::{Value, json};

use super::schema::Document;
use crate::http::jobs::{polygon, with};
use crate::http::server::{Server, settings, story};

/// Returns valid jobs that together have every field of jobs.
fn samples() -> Vec<Value> {
    let positions = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]];
    let faces = [[0, 1, 4, 3], [1, 2, 5, 4]];
    let uvs = json!({ "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": [[0, 1, 2, 3], [0, 1, 2, 3]],
        "interpolation": "boundaries" });
    // one pixel
    let image = "data:image/png;base64,\
        iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    let look = json!({ "color": [1, 0, 0, 0.5], "metallic": 0.5, "roughness": 0.5, "double_sided": false,
        "alpha_mode": "mask", "alpha_cutoff": 0.5, "texture": { "image": image, "mag_filter": "nearest",
        "min_filter": "linear", "wrap_s": "repeat", "wrap_t": "mirrored-repeat" } });
    let mut looks = look.clone();
    (looks["name"], looks["faces"]) = ("red".into(), json!([1]));
    let carrying = json!({ "positions": positions, "faces": faces, "corners": [{ "vertex": 0, "sharpness": 10.0 }],
        "creases": [{ "edge": [1, 4], "sharpness": 2.0 }], "holes": [1], "channels": { "heat": [0, 1, 2, 3, 4, 5] },
        "groups": [{ "name": "left", "faces": [0] }], "materials": [looks], "uvs": uvs });
    let numbers = json!([1, 1, 1, 1, 1, 1]);
    let tagged = json!({ "positions": positions, "faces": faces, "latitude": [[0, 1]], "longitude": [[1, 4]],
        "parameters": { "alpha": numbers, "kernel": numbers, "compensation": numbers, "delta": numbers } });
    let points = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let curve = json!({ "points": points, "closed": true, "corners": [0], "rational": false, "pinned": [],
        "tangents": null, "parameters": { "alpha": [0, 0, 0, 0], "kernel": [1, 1, 1, 1],
        "compensation": [1, 1, 1, 1], "delta": [0, 0, 0, 0] } });
    let steered = json!({ "points": points, "closed": true, "tangents": [[1, 0], [0, 1], [-1, 0], [0, -1]],
        "pinned": [0], "discrete_curvature": [0, 0, 0, 0], "warnings": [] });
    let result = json!({ "positions": positions, "faces": faces, "normals": [], "ids": {}, "isolines": [],
        "sections": [], "warnings": ["a"] });
    let word = json!({ "word": "UC", "parameters": {}, "ends": "clamped", "seed": 1 });
    let outputs = json!([{ "format": "json", "name": "a" }]);
    let text = json!({ "format": "off", "data": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "encoding": "text" });
    vec![
        json!({ "spec": 1, "input": { "mesh": carrying, "unit": "mm", "up": "z", "orient": "repair", "weld": null,
            "non_manifold": "refuse", "pair_quads": false },
            "plan": { "preset": "catmull-clark", "boundary": "edge-only" }, "levels": 1, "outputs": outputs }),
        json!({ "input": { "mesh": tagged }, "plan": { "preset": "push-back" }, "levels": 1, "outputs": outputs }),
        json!({ "input": { "mesh": { "positions": positions, "faces": faces, "frames": [positions] } },
            "outputs": [{ "format": "json", "name": "a", "frame": 1 }] }),
        json!({ "input": { "mesh": result }, "outputs": outputs }),
        json!({ "input": { "text": text, "weld": 0.0 }, "outputs": outputs }),
        json!({ "input": { "text": { "format": "obj", "data": "v 0 0 0\nv 1 0 0\nv 0 1 0\n\
            vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "mtl": "newmtl red\nKd 1 0 0\n" }, "material": look },
            "outputs": outputs }),
        json!({ "input": { "polygon": curve }, "plan": word, "levels": 1, "outputs": outputs }),
        json!({ "input": { "polygons": [curve] }, "plan": word, "levels": 1, "outputs": outputs }),
        json!({ "input": { "polygon": { "points": points } }, "plan": { "word": "UC" }, "levels": { "tolerance": 0.5 },
            "outputs": outputs }),
        json!({ "input": { "polygon": steered }, "plan": { "preset": "incenter" }, "levels": 1, "outputs": outputs }),
        json!({ "input": { "polygons": [steered] }, "plan": { "preset": "incenter" }, "levels": 1,
            "outputs": outputs }),
    ]
}

/// Returns values of every kind, ordinary and odd.
fn values() -> Vec<Value> {
    let plain = json!([null, false, true, 0, 1, -1, 0.5, 1e300, "", "y", "none", [], [0], [null], {}, { "y": null }]);
    plain.as_array().unwrap().clone()
}

/// Sends each sample with each value at each place that the schema of jobs has.
async fn every_kind_everywhere(server: &Server, path: &str) {
    let document = Document::new();
    for sample in samples() {
        let mut places = Vec::new();
        document.places(document.named("JobRequest"), &sample, "", &mut places);
        for (place, schema, value) in places.iter().flat_map(|(at, s)| values().into_iter().map(move |v| (at, s, v))) {
            let mut request = sample.clone();
            *request.pointer_mut(place).unwrap() = value.clone();
            let answer = server.post(path, &request).await;
            let why = format!("{value} at {place} of {path}: {}", answer.text());
            let refused = answer.status == 422 || (path == "/v1/validate" && answer.json()["valid"] == false);
            assert!(refused || answer.status == 200, "{why}");
            if refused {
                let pointer = answer.json()["errors"][0]["pointer"].as_str().unwrap().to_owned();
                assert!(!pointer.is_empty(), "{why}");
                // without the field that chooses its kind, an input or a plan is invalid as a whole
                let chooses =
                    [("/input", &["mesh", "text", "polygon", "polygons"][..]), ("/plan", &["preset", "word"])];
                let is_none = chooses.iter().any(|(whole, fields)| {
                    pointer == *whole && fields.iter().any(|field| *place == format!("{whole}/{field}"))
                });
                let here = is_none || pointer == *place || pointer.starts_with(&format!("{place}/"));
                assert!(here || document.takes(schema, &value), "the pointer leads elsewhere: {why}");
            } else {
                assert!(document.takes(schema, &value), "the schema forbids it: {why}");
            }
        }
    }
}

#[test]
fn m8_the_samples_have_every_field_there_is() {
    let (document, mut possible, mut places) = (Document::new(), Vec::new(), Vec::new());
    let schema = document.named("JobRequest");
    document.possible(schema, "", &mut possible);
    samples().iter().for_each(|sample| document.places(schema, sample, "", &mut places));
    assert!(possible.len() > 30, "{possible:?}");
    let of_their_own = ["/figure", "/distance_to", "/input/blob"].map(str::to_owned);
    for place in possible.into_iter().filter(|place| !of_their_own.contains(place)) {
        assert!(places.iter().any(|(known, _)| *known == place), "no sample has {place}");
    }
}

#[test]
fn m8_the_samples_are_right_and_fit_their_schema() {
    story(settings(), async |server| {
        let document = Document::new();
        for sample in samples() {
            server.post("/v1/estimate", &sample).await.ok();
            assert!(document.takes(document.named("JobRequest"), &sample), "{sample}");
        }
    });
}

#[test]
fn m8_a_value_of_any_kind_in_any_field_of_a_job_is_taken_by_its_schema_or_told_by_its_place() {
    story(settings(), async |server| every_kind_everywhere(server, "/v1/estimate").await);
}

#[test]
fn m8_and_in_any_field_of_a_question() {
    story(settings(), async |server| every_kind_everywhere(server, "/v1/validate").await);
}

#[test]
fn m8_a_choice_is_written_as_a_text_and_told_with_what_it_may_be() {
    story(settings(), async |server| {
        for value in [json!(false), json!(3), json!([]), json!({}), json!({ "y": null }), json!(["y"]), json!("x")] {
            let mut job = with(polygon(1), "json");
            job["input"]["up"] = value.clone();
            let problem = server.render(&job).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], "/input/up", "{value}: {problem}");
            let said = problem["errors"][0]["detail"].as_str().unwrap();
            assert!(said.ends_with("expected one of \"y\", \"z\""), "{value}: {said}");
        }
    });
}

#[test]
fn m8_options_and_parameters_of_any_kind_are_taken_or_told_by_their_place() {
    story(settings(), async |server| {
        for format in planish::output::FORMATS
            .iter()
            .filter(|format| crate::http::jobs::formats(false).iter().any(|f| f.name() == format.name()))
        {
            for (option, value) in
                format.facts().parameters.iter().flat_map(|p| values().into_iter().map(|v| (p.name, v)))
            {
                let mut job = with(polygon(1), format.name());
                job["outputs"][0][option] = value.clone();
                let answer = server.post("/v1/estimate", &job).await;
                let why = format!("{value} as {option} of {}: {}", format.name(), answer.text());
                let place = format!("/outputs/0/{option}");
                let told = || answer.json()["errors"][0]["pointer"].as_str().is_some_and(|at| at.starts_with(&place));
                assert!(answer.status == 200 || (answer.status == 422 && told()), "{why}");
            }
        }
    });
}
