//! The limit surface: positions and normals of refined meshes.

mod arities;
mod cost;
mod dual;
mod formulas;
mod laws;
mod levels;
mod pairs;
mod perturbed;
mod refusals;
mod root_three;
mod sides;
mod slow;
mod varying;

use serde_json::{Value, json};

use crate::support::nets::Net;
use crate::support::{json_with, render};

/// Returns the limit positions, as a net, and the limit normals after some levels of a plan.
fn limit(net: &Net, plan: &Value, levels: u32) -> (Net, Vec<[f64; 3]>) {
    let job = json!({ "input": net.input(), "plan": plan, "levels": levels });
    let result = json_with(job, &json!({ "positions": "limit", "normals": "limit" }));
    let normals = serde_json::from_value(result["normals"].clone()).expect("normals are lists of numbers");
    (Net::of(&result), normals)
}

/// Returns the warnings for a mesh with limit normals.
fn warnings(net: &Net, plan: &Value, levels: u32) -> Vec<String> {
    let job = json!({ "input": net.input(), "plan": plan, "levels": levels,
        "outputs": [{ "format": "obj", "normals": "limit" }] });
    render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).1.warnings
}
