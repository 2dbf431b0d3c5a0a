//! Analyses of schemes: reference rows, known facts, laws, and requests that are equivalent.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod boundaries;
mod claims;
mod facts;
mod forms;
mod laws;
mod matrices;
mod papers;
mod polygons;
mod rows;
mod same;
mod scans;
mod surfaces;
mod tubes;

use planish::fault::Fault;
use planish::job::Form;
use planish::watch::Watch;
use planish::wire::analysis::{AnalysisAnswer, AnalysisRequest};
use planish::wire::read::read;
use serde_json::{Value, json};

fn question(question: &Value) -> AnalysisRequest {
    read(question.to_string().as_bytes()).unwrap()
}

/// Returns the answer to an analysis request.
fn asked(asked: &Value) -> Value {
    let watch = Watch::new();
    let analysis = question(asked).resolve(Form::Json, &watch).unwrap_or_else(|faults| panic!("{asked}: {faults:?}"));
    serde_json::to_value(AnalysisAnswer::of(&analysis, &watch).unwrap()).unwrap()
}

fn refused(asked: &Value) -> Vec<Fault> {
    question(asked).resolve(Form::Json, &Watch::new()).map(|_| ()).expect_err("a refusal")
}

fn key(asked: &Value) -> String {
    question(asked).resolve(Form::Json, &Watch::new()).unwrap().key(Form::Json).to_string()
}

/// Returns the analysis of a preset, with a small search.
fn preset(name: &str, parameters: &Value) -> Value {
    asked(&json!({ "plan": { "preset": name, "parameters": parameters }, "nodes": 20_000 }))
}

/// Returns the analysis of a word, with a small search.
fn word(word: &str, parameters: &Value) -> Value {
    asked(&json!({ "plan": { "word": word, "parameters": parameters }, "nodes": 20_000 }))
}

/// Returns the proved and the disproved order of smoothness.
fn smoothness(answer: &Value) -> (i64, Option<i64>) {
    let smoothness = &answer["smoothness"];
    (smoothness["proved_c"].as_i64().unwrap(), smoothness["disproved_c"].as_i64())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list")).iter().map(|x| x.as_f64().unwrap()).collect()
}

fn texts(value: &Value) -> Vec<String> {
    value
        .as_array()
        .unwrap_or_else(|| panic!("{value} is no list"))
        .iter()
        .map(|x| x.as_str().unwrap().into())
        .collect()
}
