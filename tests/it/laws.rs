//! Laws: identities that hold for every input, tested on small and on random ones.

mod averaging;
mod butterfly;
mod circles;
mod compensation_alpha;
mod creases;
mod curves;
mod doo_sabin;
mod exact_lines;
mod incenter;
mod interpolating;
mod invariance;
mod lanes;
mod latitude;
mod limits;
mod masks;
mod meshes;
pub(crate) mod outlooks;
mod own;
mod own_compensation;
mod own_parameters;
mod paths;
mod polynomials;
mod repetition;
mod root_three;
mod sentences;
mod sharp_normals;
mod spellings;
mod surface_tolerance;
mod sweeps;
mod ternary;
mod tolerance;
mod triangles;
mod warnings;

use serde_json::{Value, json};

use crate::support::{self, nets::Net};

/// Returns the points of a polygon after some levels of a plan.
fn refined<const D: usize>(points: &[[f64; D]], closed: bool, plan: &Value, levels: u32) -> Vec<[f64; D]>
where
    [f64; D]: serde::Serialize + serde::de::DeserializeOwned,
{
    let polygon = json!({ "points": points.iter().map(|p| json!(p)).collect::<Vec<_>>(), "closed": closed });
    refined_polygon(&polygon, plan, levels)
}

fn refined_polygon<const D: usize>(polygon: &Value, plan: &Value, levels: u32) -> Vec<[f64; D]>
where
    [f64; D]: serde::de::DeserializeOwned,
{
    let result = support::json(json!({ "input": { "polygon": polygon }, "plan": plan, "levels": levels }));
    serde_json::from_value(result["points"].clone()).expect("points of the dimension given")
}

fn refined_mesh(net: &Net, plan: &Value, levels: u32) -> Net {
    Net::of(&support::json(json!({ "input": net.input(), "plan": plan, "levels": levels })))
}

/// Returns a word without parameters.
fn word(text: &str) -> Value {
    json!({ "word": text })
}

/// Returns a word with kernel cos(alpha/2) and compensation 1/cos(alpha/2).
fn semi_stationary(text: &str, alpha: &str, delta: f64) -> Value {
    json!({ "word": text, "parameters": {
        "alpha": alpha, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": delta,
    } })
}

/// Returns a word with awkward constants.
fn static_word(text: &str) -> Value {
    json!({ "word": text, "parameters": { "kernel": 1.7, "compensation": "1/3", "delta": -0.3 } })
}

/// Returns plans for polygons, also for open ones with clamped ends.
fn curve_plans() -> Vec<Value> {
    let mut plans: Vec<Value> = ["U", "UD", "UC", "UDDD", "UCP", "UUCPD(UC)", "D(UC)", "C", "D"].map(word).into();
    plans.extend(["UD", "UC", "UCCP", "U(UCDDP)", "UDCD"].map(static_word));
    plans.extend(["UC", "UCP", "UDC", "UUCPD"].map(|text| semi_stationary(text, "2*pi/5", 0.7)));
    plans
}

/// Returns plans for closed and open meshes.
fn mesh_plans() -> Vec<Value> {
    let mut plans: Vec<Value> = ["U", "UC", "UCP", "C", "UCCP"].map(word).into();
    plans.extend(["UC", "UCP", "U(UCP)"].map(static_word));
    plans.push(semi_stationary("UCP", "pi/3", 0.4));
    plans.push(json!({ "preset": "catmull-clark" }));
    plans.push(json!({ "preset": "catmull-clark", "boundary": "edge-only" }));
    plans.push(json!({ "preset": "kobbelt" }));
    plans.push(json!({ "preset": "kobbelt", "boundary": "edge-only" }));
    plans.push(json!({ "preset": "repeated-averaging", "parameters": { "degree": 5 } }));
    plans.push(json!({ "preset": "push-back", "parameters": { "delta": "(valence-4)/valence", "compensation": 0 } }));
    plans
}
