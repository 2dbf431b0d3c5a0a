//! Refused stencils, and the reasons.

use serde_json::{Value, json};

use crate::support::render;

fn refusal(job: &Value) -> String {
    let faults = render(job).expect_err("it is refused");
    faults[0].to_string()
}

#[test]
fn plans_that_turn_points_have_no_stencils() {
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "closed": true });
    let job = json!({
        "input": { "polygon": polygon }, "plan": { "preset": "incenter" }, "levels": 2,
        "outputs": [{ "format": "json" }, { "format": "stencils-bin" }],
    });
    let detail = refusal(&job);
    assert!(detail.starts_with("/outputs/1/format: "), "{detail}");
    assert!(detail.contains("no weights make its points; ask for json"), "{detail}");
}

#[test]
fn curves_have_no_normals_to_be_made_of_tangents() {
    let polygon = json!({ "points": [[0, 0], [1, 0], [1, 1]], "closed": true });
    let job = json!({
        "input": { "polygon": polygon }, "plan": { "preset": "chaikin" }, "levels": 2,
        "outputs": [{ "format": "stencils", "normals": "limit" }],
    });
    assert_eq!(refusal(&job), "/outputs/0/normals: curves have no normals; leave it out");
}

#[test]
fn results_with_more_weights_than_may_be_are_refused_before_they_are_made() {
    let job = json!({
        "input": { "mesh": crate::support::nets::torus(64, 64).to_json() },
        "plan": { "preset": "catmull-clark" }, "levels": 6, "outputs": [{ "format": "stencils" }],
    });
    let detail = refusal(&job);
    assert!(detail.starts_with("/levels: ") && detail.contains("ask for at most"), "{detail}");
}
