#[allow(dead_code)]
#[path = "../it/support/mod.rs"]
mod support;
#[allow(dead_code)]
mod laws {
    use serde_json::{Value, json};
    #[path = "/work/main/tests/it/laws/paths.rs"]
    mod paths;
    /// A word without parameters.
fn word(text: &str) -> Value {
    json!({ "word": text })
}

/// A word with kernel cos(alpha/2) and compensation 1/cos(alpha/2).
fn semi_stationary(text: &str, alpha: &str, delta: f64) -> Value {
    json!({ "word": text, "parameters": {
        "alpha": alpha, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": delta,
    } })
}

/// A word with awkward constants.
fn static_word(text: &str) -> Value {
    json!({ "word": text, "parameters": { "kernel": 1.7, "compensation": "1/3", "delta": -0.3 } })
}

/// Plans for polygons that may be open with clamped ends.
fn curve_plans() -> Vec<Value> {
    let mut plans: Vec<Value> = ["U", "UD", "UC", "UDDD", "UCP", "UUCPD(UC)", "D(UC)", "C", "D"].map(word).into();
    plans.extend(["UD", "UC", "UCCP", "U(UCDDP)", "UDCD"].map(static_word));
    plans.extend(["UC", "UCP", "UDC", "UUCPD"].map(|text| semi_stationary(text, "2*pi/5", 0.7)));
    plans
}

/// Plans for closed and open meshes.
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

}
