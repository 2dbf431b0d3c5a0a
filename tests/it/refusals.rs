//! Refusals that an independent tester met: each reports every fault, and where it is.

use planish::job::limits::Limits;
use planish::job::{RunError, run};
use planish::watch::Watch;
use planish::wire::JobRequest;
use planish::wire::read::{ReadError, read};
use serde_json::{Value, json};

use crate::support::{self, parsed, render};

fn places(job: &Value) -> Vec<String> {
    render(job).expect_err("the job is refused").into_iter().map(|fault| fault.pointer).collect()
}

fn triangle(outputs: &Value) -> Value {
    json!({
        "input": { "mesh": { "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]] } },
        "plan": { "preset": "catmull-clark" }, "levels": 1, "outputs": outputs,
    })
}

#[test]
fn a_text_that_breaks_off_is_no_json_whatever_stands_before() {
    for text in ["[1,2", "{\"input\":5,", "{\"foo\":1,", "{} {}", "[[[[", "{\"input\":1e999,"] {
        let refused = read::<JobRequest>(text.as_bytes()).expect_err("it is no job");
        assert!(matches!(refused, ReadError::NotJson(_)), "{text}: {refused:?}");
    }
    for text in ["[1,2]", "{\"input\":5}", "{\"foo\":1}", "{\"input\":1e999}"] {
        let refused = read::<JobRequest>(text.as_bytes()).expect_err("it is no job");
        assert!(matches!(refused, ReadError::Unfit(_)), "{text}: {refused:?}");
    }
}

#[test]
fn faults_of_plan_and_outputs_come_together() {
    let mut job = triangle(&json!([{ "format": "gif" }, { "format": "png", "width": 1 }]));
    job["levels"] = json!(99);
    job["plan"] = json!({ "word": "X", "parameters": { "foo": 1 } });
    let expected =
        ["/outputs/0/format", "/outputs/1/width", "/levels", "/plan/word", "/plan/parameters/foo"].map(String::from);
    assert_eq!(places(&job), expected);
}

#[test]
fn a_huge_index_is_named_as_it_was_written() {
    let mut job = triangle(&json!([{ "format": "stl" }]));
    job["input"]["mesh"]["faces"] = json!([[0, 1, 4_294_967_296_u64]]);
    let faults = render(&job).expect_err("there is no such vertex");
    assert_eq!(faults[0].pointer, "/input/mesh/faces/0/2");
    assert!(faults[0].detail.contains("4294967296"), "{}", faults[0].detail);
}

#[test]
fn pictures_that_would_be_blank_are_refused() {
    assert_eq!(places(&triangle(&json!([{ "format": "png", "show": [] }]))), ["/outputs/0/show"]);
    assert_eq!(places(&triangle(&json!([{ "format": "png", "show": ["curve"] }]))), ["/outputs/0/show"]);
    assert_eq!(places(&triangle(&json!([{ "format": "png", "color": "transparent" }]))), ["/outputs/0/color"]);
    for size in [1e300, 1e-300] {
        let mut job = triangle(&json!([{ "format": "png" }]));
        job["input"]["mesh"]["positions"] = json!([[0, 0, 0], [size, 0, 0], [0, size, 0]]);
        assert_eq!(places(&job), ["/outputs/0"]);
    }
}

#[test]
fn operators_of_polygons_are_refused_on_meshes_at_their_word() {
    for word in ["UA", "U3A", "A"] {
        let mut job = triangle(&json!([{ "format": "stl" }]));
        job["plan"] = json!({ "word": word });
        assert_eq!(places(&job), ["/plan/word"], "{word}");
    }
}

#[test]
fn type_names_of_the_implementation_stay_inside() {
    for (text, says) in [
        ("{\"input\":{},\"plan\":\"chaikin\"}", "expected an object"),
        ("{\"input\":5}", "expected an object"),
        ("{\"input\":{\"polygon\":{\"points\":[[0],[1]],\"closed\":3}}}", "expected true or false"),
    ] {
        let Err(ReadError::Unfit(faults)) = read::<JobRequest>(text.as_bytes()) else {
            panic!("{text} is JSON, but no job")
        };
        assert!(faults[0].detail.contains(says) && !faults[0].detail.contains("Request"), "{}", faults[0].detail);
    }
}

/// Returns the pointer of the fault that computing an output reports.
fn place_of_run(job: &Value, output: usize) -> String {
    let job = parsed(job.to_string().as_bytes()).expect("it shows late");
    let admitted = Limits::default().admit(job).expect("it is small");
    let output = &admitted.job().outputs[output];
    match run(&admitted, output, &mut Vec::new(), &Watch::new()) {
        Err(RunError::Impossible(fault)) => admitted.job().entries(output).fault(fault).pointer,
        other => panic!("{other:?}"),
    }
}

#[test]
fn faults_of_a_computation_point_at_the_output_that_was_computed() {
    let mut job = triangle(&json!([{ "format": "obj" }, { "format": "stl" }, { "format": "png" }]));
    job["input"]["mesh"]["positions"] = json!([[0, 0, 0], [1e300, 0, 0], [0, 1e300, 0]]);
    assert_eq!(place_of_run(&job, 1), "/outputs/1");
    assert_eq!(place_of_run(&job, 2), "/outputs/2");
}

#[test]
fn faults_of_a_computation_point_at_the_polygon_as_it_is_written() {
    let job = |input: Value| {
        json!({
            "input": input, "plan": { "word": "U" }, "levels": 1, "outputs": [{ "format": "json" }]
        })
    };
    let polygon =
        |weight: f64| json!({ "points": [[0, 0, 1], [1, 0, weight], [1, 1, 1]], "closed": true, "rational": true });
    assert_eq!(place_of_run(&job(json!({ "polygon": polygon(-1.0) })), 0), "/input/polygon");
    assert_eq!(place_of_run(&job(json!({ "polygons": [polygon(-1.0)] })), 0), "/input/polygons/0");
    assert_eq!(place_of_run(&job(json!({ "polygons": [polygon(1.0), polygon(-1.0)] })), 0), "/input/polygons/1");
}

#[test]
fn faults_of_parameters_point_at_the_entry_that_carries_them() {
    let mut job = triangle(&json!([{ "format": "obj" }]));
    job["plan"] = json!({ "word": "UC", "parameters": { "kernel": 1 } });
    job["input"]["mesh"]["parameters"] = json!({ "kernel": [1, -1, 1] });
    assert_eq!(places(&job), ["/input/mesh/parameters/kernel/1"]);
    let data = job["input"]["mesh"].to_string();
    job["input"] = json!({ "text": { "format": "json", "data": data } });
    let faults = render(&job).expect_err("there is no average");
    assert_eq!(faults[0].pointer, "/input/text/data");
    assert!(faults[0].detail.contains("/parameters/kernel/1"), "{}", faults[0].detail);
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "parameters": { "kernel": [1, 1, -1] } });
    for (input, place) in [
        (json!({ "polygon": polygon }), "/input/polygon/parameters/kernel/2"),
        (json!({ "polygons": [polygon] }), "/input/polygons/0/parameters/kernel/2"),
    ] {
        job["input"] = input;
        job["outputs"] = json!([{ "format": "json" }]);
        assert_eq!(places(&job), [place]);
    }
}

/// Returns the value with a decimal point in each number.
fn pointed(value: &Value) -> Value {
    match value {
        Value::Number(n) => json!(n.as_f64()),
        Value::Array(list) => list.iter().map(pointed).collect(),
        Value::Object(map) => map.iter().map(|(name, value)| (name.clone(), pointed(value))).collect(),
        other => other.clone(),
    }
}

/// JSON has one type of number, and "integer" in a schema is any number without a fraction.
#[test]
fn whole_numbers_may_be_written_with_a_point() {
    let mut plain = json!({ "spec": 1, "levels": 2, "plan": { "preset": "catmull-clark" }, "input": { "mesh": {
        "positions": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]],
        "faces": [[0, 1, 2, 3], [1, 4, 5, 2]], "holes": [1],
        "corners": [{ "vertex": 2, "sharpness": 10 }], "creases": [{ "edge": [1, 2], "sharpness": 3 }],
        "groups": [{ "name": "a", "faces": [0] }], "materials": [{ "name": "b", "faces": [1] }],
        "uvs": { "values": [[0, 0]], "faces": [[0, 0, 0, 0], [0, 0, 0, 0]] },
    } } });
    plain["outputs"] = json!([{ "format": "json" }]);
    let pointed = pointed(&plain);
    assert!(pointed.to_string().contains("[1.0,4.0,5.0,2.0]"), "{pointed}");
    let id =
        |job: &Value| support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}")).id();
    assert_eq!(id(&pointed), id(&plain));
    for (pointer, value) in [
        ("/input/mesh/faces/1/2", json!(5.5)),
        ("/input/mesh/faces/1/2", json!(1e300)),
        ("/input/mesh/holes/0", json!(-1.0)),
        ("/input/mesh/corners/0/vertex", json!(0.5)),
        ("/levels", json!(2.5)),
        ("/spec", json!("1")),
    ] {
        let mut wrong = plain.clone();
        *wrong.pointer_mut(pointer).expect("it is there") = value;
        let faults = support::parsed(wrong.to_string().as_bytes()).expect_err("it is refused");
        assert!(faults[0].pointer == pointer && faults[0].detail.contains("a whole number"), "{faults:?}");
    }
}

#[test]
fn a_plan_is_named_by_texts() {
    for (plan, pointer) in [
        (json!({ "preset": null, "word": "UC" }), "/plan/preset"),
        (json!({ "preset": "catmull-clark", "word": null }), "/plan/word"),
    ] {
        let faults = support::faults(json!({ "input": { "polygon": { "points": [[0], [1]] } }, "plan": plan }));
        assert!(faults[0].pointer == pointer && faults[0].detail.contains("null"), "{faults:?}");
    }
}
