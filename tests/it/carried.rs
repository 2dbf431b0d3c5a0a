//! The data that a mesh carries: channels, groups, materials, origins, unit and up axis.

mod cage;
mod files;
mod frames;
mod glass;
mod isolines;
mod laws;
mod left_out;
mod libraries;
mod looks;
mod morphs;
mod of_job;
mod read;
mod refused;
mod seams;
mod shown;
mod uv_fans;
mod uv_weights;
mod uvs;

use serde_json::{Value, json};

use crate::support::{self, nets::Net, render};

/// Returns a job on a mesh with additional fields.
fn job(net: &Net, extra: &Value, plan: &Value, levels: u32) -> Value {
    let mut mesh = net.to_json();
    for (name, value) in extra.as_object().expect("fields of a mesh") {
        mesh[name] = value.clone();
    }
    json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels })
}

/// Returns the JSON result with origins.
fn told(mut job: Value) -> Value {
    job["outputs"] = json!([{ "format": "json", "ids": true }]);
    serde_json::from_slice(&bytes(&job)).expect("the json output is JSON")
}

fn bytes(job: &Value) -> Vec<u8> {
    render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

/// Returns the bytes of a job in the format and options of `output`.
fn written(job: &Value, output: &Value) -> Vec<u8> {
    let mut job = job.clone();
    job["outputs"] = json!([output]);
    bytes(&job)
}

fn text(job: &Value, output: &Value) -> String {
    String::from_utf8(written(job, output)).expect("a text format")
}

fn indices(value: &Value) -> Vec<usize> {
    serde_json::from_value(value.clone()).unwrap_or_else(|_| panic!("{value} is no list of indices"))
}

/// Returns the pointers and sentences of a refusal.
fn refusal(job: &Value) -> Vec<(String, String)> {
    support::faults(job.clone()).into_iter().map(|fault| (fault.pointer, fault.detail)).collect()
}
