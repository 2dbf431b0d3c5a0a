//! Stencils give the bits of the JSON output of the same job if they are applied as in docs/stencils.md.

mod applied;
mod laws;
mod normals;
mod refused;

use std::fs;
use std::path::{Path, PathBuf};

use planish::job::Job;
use planish::job::limits::Limits;
use serde_json::{Value, json};

use crate::support::{parsed, render};
use applied::{Table, control, same_bits};

/// Maximum number of bytes of the stencils of examples that are compared here; tests/e2e/stencils compares all. Half of
/// it would omit a third of them; twice of it would take twice as long.
const SMALL: u128 = 1_500_000;

/// Returns the smaller example jobs with their names, and options with frame 0 if the mesh has frames. The outputs are
/// removed, and `distance_to`, which belongs to them.
fn examples() -> Vec<(String, Value, Value)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("api/examples/jobs");
    let mut paths: Vec<_> =
        fs::read_dir(folder).expect("there are examples").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let job = |path: &PathBuf| {
        let mut job: Value = serde_json::from_slice(&fs::read(path).expect("it can be read")).expect("it is JSON");
        let entries = job.as_object_mut().expect("a job is an object");
        entries.retain(|name, _| name != "outputs" && name != "distance_to");
        let name = path.file_stem().expect("it has a name").to_string_lossy().into_owned();
        let options = if job["input"]["mesh"].get("frames").is_some() { json!({ "frame": 0 }) } else { json!({}) };
        (name, job, options)
    };
    let is_small = |(_, job, options): &(String, Value, Value)| {
        let job = parsed(&serde_json::to_vec(&asking(job, &with(options, "stencils"))).expect("JSON"));
        job.is_ok_and(|job| most_bytes(&job) <= SMALL)
    };
    paths.iter().map(job).filter(is_small).collect()
}

/// Returns options with a format.
fn with(options: &Value, format: &str) -> Value {
    let mut output = options.clone();
    output["format"] = format.into();
    output
}

/// Returns a job with one output.
fn asking(job: &Value, output: &Value) -> Value {
    let mut job = job.clone();
    job["outputs"] = json!([output]);
    job
}

/// Returns the bytes of an output, or the first fault as text.
fn bytes_of(job: &Value, output: &Value) -> Result<Vec<u8>, String> {
    let rendered = render(&asking(job, output));
    rendered.map(|(bytes, _)| bytes).map_err(|faults| faults[0].to_string())
}

/// Returns the upper bound of the bytes of a job.
fn most_bytes(job: &Job) -> u128 {
    Limits::default().estimate(job).expect("it is small").outputs[0].1.bytes()
}

/// Checks that the stencils of a job, with these options, give its JSON output. Fails with the first fault if one of
/// the two is refused.
fn agrees(name: &str, job: &Value, options: &Value) -> Result<(), String> {
    let text = bytes_of(job, &with(options, "stencils"))?;
    let binary = bytes_of(job, &with(options, "stencils-bin")).expect("both forms are served");
    for (form, bytes) in [("stencils", &text), ("stencils-bin", &binary)] {
        let asked = serde_json::to_vec(&asking(job, &with(options, form))).expect("JSON");
        let most = most_bytes(&parsed(&asked).expect("it was made"));
        assert!(bytes.len() as u128 <= most, "{name}: {} bytes as {form}, of {most} at most", bytes.len());
    }
    let table = Table::of_text(&text);
    assert_eq!(table, Table::of_arrays(&binary), "{name}: the two forms differ");
    let expected: Value = serde_json::from_slice(&bytes_of(job, &with(options, "json"))?).expect("json is JSON");
    let points = control(job, table.columns);
    same_bits(name, &table, &points, &expected);
    Ok(())
}

#[test]
fn examples_have_the_bits_of_json() {
    let all = examples();
    assert!(all.len() > 50, "only {} examples are small", all.len());
    for (name, job, options) in all {
        agrees(&name, &job, &options).unwrap_or_else(|why| panic!("{name}: {why}"));
    }
}

#[test]
fn examples_have_the_bits_of_json_in_the_limit() {
    let (mut limits, mut normals) = (0, 0);
    for (name, job, options) in examples() {
        let mut limit = options.clone();
        limit["positions"] = "limit".into();
        if bytes_of(&job, &with(&limit, "json")).is_ok() {
            agrees(&name, &job, &limit).unwrap_or_else(|why| panic!("{name}: {why}"));
            limits += 1;
        }
        if job["input"].get("mesh").is_some() {
            for mut options in [options, limit] {
                options["normals"] = "limit".into();
                normals += usize::from(agrees(&name, &job, &options).is_ok());
            }
        }
    }
    assert!(limits > 30 && normals > 20, "{limits} limits, {normals} with normals");
}
