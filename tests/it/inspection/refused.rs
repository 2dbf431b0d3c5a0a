//! Refused inspections, and the reasons.

use serde_json::{Value, json};

use crate::support::nets;
use crate::support::render;

fn refuses(input: &Value, options: &Value, pointer: &str, detail: &str) {
    let mut output = json!({ "format": "png", "width": 64, "height": 48 });
    for (name, value) in options.as_object().expect("options") {
        output[name] = value.clone();
    }
    let faults = render(&json!({ "input": input, "outputs": [output] })).expect_err("it is refused");
    assert_eq!(faults[0].pointer, format!("/outputs/0/{pointer}"), "{faults:?}");
    assert!(faults[0].detail.contains(detail), "{faults:?}");
}

#[test]
fn what_an_inspection_cannot_show_is_refused() {
    let mut cube = nets::cube().input();
    cube["mesh"]["channels"] = json!({ "pair": vec![[1, 2]; 8] });
    let curve = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1]] } });
    let curved = json!({ "shading": "mean-curvature" });
    let with = |options: &Value, name: &str, value: Value| {
        let mut options = options.clone();
        options[name] = value;
        options
    };
    for (input, options, pointer, detail) in [
        (&curve, curved.clone(), "shading", "curves have no surface"),
        (&cube, with(&curved, "color_by", json!("faces")), "color_by", "colours of its own"),
        (&cube, with(&curved, "color", json!("#123")), "color", "are numbers"),
        (&cube, with(&curved, "range", json!([1])), "range", "two numbers"),
        (&cube, with(&curved, "range", json!([2, 1])), "range", "two numbers"),
        (&cube, with(&curved, "stripes", json!(4)), "stripes", "reflection-lines and isophotes"),
        (&cube, with(&curved, "color_map", json!("rainbow")), "color_map", "expected one of even"),
        (&cube, json!({ "shading": "zebra", "stripes": 0 }), "stripes", "from 1 to 256"),
        (&cube, json!({ "shading": "zebra", "stripe_direction": [0, 0, 0] }), "stripe_direction", "has no direction"),
        (&cube, json!({ "range": [0, 1] }), "range", "colours are numbers under"),
        (&cube, json!({ "color_bar": true }), "color_bar", "colours are numbers under"),
        (&cube, json!({ "component": 0 }), "component", "\"color_by\" is \"channel\""),
        (&cube, json!({ "color_by": "channel", "channel": "pair", "component": 2 }), "component", "components 0 to 1"),
    ] {
        refuses(input, &options, pointer, detail);
    }
    let job = json!({ "input": curve, "outputs": [{ "format": "stats", "curvature": true }] });
    assert_eq!(render(&job).expect_err("it is refused")[0].pointer, "/outputs/0/curvature");
}
