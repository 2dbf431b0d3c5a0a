//! Artifacts that contain the description of their job.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use planish::job::limits::{Admitted, Limits};
use planish::job::run;
use planish::output::Size;
use planish::output::described;
use planish::output::description::description;
use planish::watch::Watch;
use planish::wire::JobRequest;
use serde_json::{Value, json};

use crate::http::jobs::{mesh, polygon, with};

fn admitted(job: &Value) -> Admitted {
    let text = job.to_string();
    let mut request: JobRequest = serde_json::from_str(&text).unwrap();
    request.source = Some(text.into());
    let job = request.resolve().unwrap_or_else(|faults| panic!("{faults:?}"));
    Limits::default().admit(job).unwrap()
}

fn made(job: &Value) -> Vec<u8> {
    let (admitted, mut bytes) = (admitted(job), Vec::new());
    run(&admitted, &admitted.job().outputs[0], &mut bytes, &Watch::new()).unwrap();
    match admitted.estimate().outputs[0].1 {
        Size::Exact(length) => assert_eq!(length, bytes.len() as u128, "{job}"),
        Size::AtMost(length) => assert!(length >= bytes.len() as u128, "{job}"),
    }
    bytes
}

/// Returns a job without description for each format that can hold one.
fn jobs() -> impl Iterator<Item = (&'static str, Value)> {
    described().map(|format| {
        let mut job = if format == "svg" { polygon(2) } else { mesh(1) };
        job = with(job, format);
        if format == "apng" {
            job["outputs"][0]["frames"] = 3.into();
            job["outputs"][0]["turntable"] = json!({});
        }
        if format.ends_with("png") {
            job["outputs"][0]["width"] = 64.into();
            job["outputs"][0]["height"] = 48.into();
        }
        (format, job)
    })
}

#[test]
fn every_format_with_room_for_it_tells_its_job_and_the_job_makes_the_same_bytes() {
    let mut told = 0;
    for (format, mut job) in jobs() {
        let bare = made(&job);
        assert_eq!(description(&bare), None, "{format}");
        job["outputs"][0]["describe"] = true.into();
        job["outputs"][0]["name"] = "any".into();
        job["spec"] = 1.into();
        let bytes = made(&job);
        let said: Value = serde_json::from_str(&description(&bytes).unwrap()).unwrap();
        assert_eq!(said["results_version"], planish::job::key::RESULTS_VERSION);
        assert_eq!(said["job"]["input"], job["input"], "{format}");
        assert_eq!(made(&said["job"]), bytes, "{format}: made again it is the same");
        assert_ne!(admitted(&job).job().keys(), admitted(&with(mesh(1), format)).job().keys());
        told += 1;
    }
    assert_eq!(told, 7);
}

#[test]
fn what_is_described_is_read_as_what_it_was() {
    let with_it = |format: &str| {
        let mut job = with(mesh(1), format);
        job["outputs"][0]["describe"] = true.into();
        job["input"]["mesh"]["groups"] = json!([{ "name": "<&>\"é\u{1F600}", "faces": [0] }]);
        made(&job)
    };
    for format in ["obj", "ply", "glb", "gltf"] {
        let bytes = with_it(format);
        let reader = planish::input::named(format).unwrap();
        let alone = planish::input::Alone;
        let file = planish::input::InputFile { bytes: &bytes, beside: &alone };
        let mesh = (reader.read)(&file, &planish::input::ReadLimits::default()).unwrap();
        assert!(mesh.faces.len() >= 24, "{format}");
    }
    let picture = image::load_from_memory(&with_it("png")).unwrap();
    assert_eq!(picture.width(), 1024, "the checksum of the chunk is right");
    let lines = String::from_utf8_lossy(&with_it("obj")).lines().map(str::len).max();
    assert!(lines < Some(1100), "lines are short enough for every reader: {lines:?}");
}

#[test]
fn blanks_names_and_other_outputs_do_not_change_a_description() {
    let mut one = with(mesh(1), "obj");
    one["outputs"][0]["describe"] = true.into();
    let mut other = one.clone();
    other["outputs"] = json!([{ "format": "obj", "name": "first", "describe": true }, { "format": "ply" }]);
    let (one, other) = (admitted(&one), admitted(&other));
    assert_eq!(one.job().keys()[0], other.job().keys()[0]);
}

#[test]
fn formats_without_room_for_it_and_panels_refuse_it() {
    let mut job = with(mesh(1), "stl");
    job["outputs"][0]["describe"] = true.into();
    let request: JobRequest = serde_json::from_value(job).unwrap();
    let faults = request.resolve().unwrap_err();
    assert_eq!(faults[0].pointer, "/outputs/0/describe");
    assert!(faults[0].detail.contains("glb"), "{}", faults[0].detail);
    let panel = json!({ "job": { "input": mesh(0)["input"], "outputs": [{ "format": "png", "describe": true }] } });
    let figure = json!({ "figure": { "panels": [panel] }, "outputs": [{ "format": "png" }] });
    let request: JobRequest = serde_json::from_value(figure).unwrap();
    let faults = request.resolve().unwrap_err();
    assert_eq!(faults[0].pointer, "/figure/panels/0/job/outputs/0/describe");
}

#[test]
fn figures_are_described_as_other_pictures_are() {
    let panel = json!({ "job": { "input": mesh(0)["input"] } });
    for format in ["png", "svg"] {
        let job = json!({ "figure": { "panels": [panel, panel] }, "outputs": [
            { "format": format, "width": 200, "describe": true }] });
        let bytes = made(&job);
        let said: Value = serde_json::from_str(&description(&bytes).unwrap()).unwrap();
        assert_eq!(made(&said["job"]), bytes);
    }
}
