//! Invalid carried data is refused with its pointer.

use serde_json::{Value, json};

use super::{job, refusal};
use crate::support::{nets, render};

fn places(extra: &Value) -> Vec<String> {
    let question = job(&nets::grid(2, 1), extra, &json!({ "word": "U" }), 1);
    refusal(&question).into_iter().map(|(pointer, _)| pointer).collect()
}

fn channel(name: &str, rows: &Value) -> Value {
    json!({ "channels": { name: rows } })
}

#[test]
fn channels_that_do_not_fit_are_named() {
    let six = json!([0, 1, 2, 3, 4, 5]);
    for (extra, place) in [
        (channel("w", &json!([0, 1, 2])), "/input/mesh/channels/w"),
        (channel("w", &json!([0, 1, 2, 3, 4, [5]])), ""),
        (channel("w", &json!([0, 1, 2, [3, 4], 4, 5])), "/input/mesh/channels/w"),
        (channel("w", &json!([[], [], [], [], [], []])), "/input/mesh/channels/w/0"),
        (channel("w", &json!([[1, 2, 3, 4, 5]])), "/input/mesh/channels/w/0"),
        (channel("w", &json!(["1"])), "/input/mesh/channels/w/0"),
        (channel("1w", &six), "/input/mesh/channels/1w"),
        (channel("a/b", &six), "/input/mesh/channels/a~1b"),
        (channel("x", &six), "/input/mesh/channels/x"),
        (channel("NX", &six), "/input/mesh/channels/NX"),
        (channel("color", &six), "/input/mesh/channels/color"),
        (channel("origin", &six), "/input/mesh/channels/origin"),
        (channel("Origin", &json!(vec![[0, 1]; 6])), "/input/mesh/channels/Origin"),
        (channel("origin", &json!(vec![[0, 1, 2, 3]; 6])), "/input/mesh/channels/origin"),
        (channel("s", &json!(vec![[0, 1]; 6])), ""),
        (json!({ "channels": { "w": six, "W": six } }), "/input/mesh/channels/W"),
        (json!({ "channels": { "w_1": six, "w": vec![[0, 1]; 6] } }), "/input/mesh/channels/w"),
        (json!({ "channels": [six] }), "/input/mesh/channels"),
    ] {
        if place.is_empty() {
            render(&{
                let mut question = job(&nets::grid(2, 1), &extra, &json!({ "word": "U" }), 1);
                question["outputs"] = json!([{ "format": "json" }]);
                question
            })
            .expect("a list of one number is a number");
        } else {
            assert_eq!(places(&extra), [place], "{extra}");
        }
    }
}

#[test]
fn a_channel_is_given_once() {
    let text = r#"{"input":{"mesh":{"positions":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]],
        "channels":{"w":[1,2,3],"w":[1,2,3]}}},"outputs":[{"format":"json"}]}"#;
    let faults = crate::support::parsed(text.as_bytes()).expect_err("it is given twice");
    assert_eq!(faults[0].pointer, "/input/mesh/channels/w");
    assert!(faults[0].detail.contains("duplicate field \"w\""), "{faults:?}");
}

#[test]
fn too_many_channels_are_refused_however_wide() {
    let many = |n: usize, width: usize| {
        let channels =
            (0..n).map(|i| (format!("c{i}"), json!(vec![vec![0; width]; 6]))).collect::<serde_json::Map<_, _>>();
        json!({ "channels": channels })
    };
    assert_eq!(places(&many(65, 1)), ["/input/mesh/channels"]);
    assert_eq!(places(&many(33, 4)), ["/input/mesh/channels"]);
    let allowed = job(&nets::grid(2, 1), &many(64, 2), &json!({ "word": "U" }), 1);
    assert_eq!(super::told(allowed)["channels"].as_object().map(serde_json::Map::len), Some(64));
}

#[test]
fn names_of_faces_that_do_not_fit_are_named() {
    let named = |name: &str, faces: Value| json!({ "name": name, "faces": faces });
    for (sets, place) in [
        (json!([named("a", json!([0, 2]))]), "/0/faces/1"),
        (json!([named("a", json!([0])), named("b", json!([1, 0]))]), "/1/faces/1"),
        (json!([named("a", json!([0])), named("a", json!([1]))]), "/1/name"),
        (json!([named("", json!([0]))]), "/0/name"),
        (json!([named("a b", json!([0]))]), "/0/name"),
        (json!([named("a\nb", json!([0]))]), "/0/name"),
        (json!([named(&"x".repeat(65), json!([0]))]), "/0/name"),
        (json!([{ "faces": [0] }]), "/0/name"),
        (json!((0..257).map(|i| named(&i.to_string(), json!([]))).collect::<Vec<_>>()), ""),
    ] {
        for kind in ["groups", "materials"] {
            assert_eq!(places(&json!({ kind: sets })), [format!("/input/mesh/{kind}{place}")], "{sets}");
        }
    }
}

#[test]
fn schemes_with_faces_of_their_own_refuse_what_belongs_to_faces() {
    let (net, triangles) = (nets::torus(4, 3), nets::tetrahedron());
    for (net, plan, place) in [
        (&net, json!({ "word": "UD" }), "/plan/word"),
        (&net, json!({ "preset": "doo-sabin" }), "/plan/preset"),
        (&triangles, json!({ "preset": "sqrt-3" }), "/plan/preset"),
    ] {
        for kind in ["groups", "materials"] {
            let sets = json!({ kind: [{ "name": "a", "faces": [0] }] });
            let found = refusal(&job(net, &sets, &plan, 1));
            assert_eq!(found[0].0, place);
            assert!(found[0].1.contains("cannot carry groups and materials"), "{found:?}");
        }
        let mut question = job(net, &json!({}), &plan, 1);
        question["outputs"] = json!([{ "format": "ply", "ids": true }]);
        let found = render(&question).expect_err("faces of their own have no origin");
        assert!(found[0].detail.contains("cannot carry ids"), "{found:?}");
    }
}

#[test]
fn units_and_axes_are_those_of_the_list() {
    for (field, value) in [("unit", "yd"), ("up", "x")] {
        let mut question = job(&nets::cube(), &json!({}), &json!({ "word": "U" }), 1);
        question["input"][field] = json!(value);
        assert_eq!(refusal(&question)[0].0, format!("/input/{field}"));
    }
}
