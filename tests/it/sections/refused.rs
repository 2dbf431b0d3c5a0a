//! Refused sections, and the pointers of their faults.

use planish::job::limits::Limits;
use planish::job::{RunError, run};
use planish::watch::Watch;
use serde_json::{Value, json};

use super::plane;
use crate::support::nets;
use crate::support::{parsed, render};

/// Returns the pointers and messages of the faults of one output of a cube, or of a square polygon.
fn faults(is_mesh: bool, output: &Value) -> Vec<(String, String)> {
    let square = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1]], "closed": true } });
    let input = if is_mesh { nets::cube().input() } else { square };
    let found = render(&json!({ "input": input, "outputs": [output] })).expect_err("it is refused");
    found.into_iter().map(|fault| (fault.pointer, fault.detail)).collect()
}

#[test]
fn every_fault_of_a_plane_is_told_at_its_place() {
    let good = plane([0.0; 3], [1.0; 3]);
    for (planes, expected) in [
        (json!([]), vec![("/outputs/0/sections", "0 entries; expected 1 to 64")]),
        (json!(vec![good.clone(); 65]), vec![("/outputs/0/sections", "65 entries; expected 1 to 64")]),
        (json!(good), vec![("/outputs/0/sections", "expected a list of 1 to 64 objects, got an object")]),
        (
            json!([good, { "point": [0, 0, 0], "normal": [0, 0, "1-1"] }, 7]),
            vec![
                ("/outputs/0/sections/1/normal", "[0, 0, 0] has no direction"),
                ("/outputs/0/sections/2", "expected an object, got a number"),
            ],
        ),
        (
            json!([{ "point": [0, 0], "offset": 1 }]),
            vec![
                ("/outputs/0/sections/0/offset", "unknown option \"offset\"; known here: point, normal"),
                ("/outputs/0/sections/0/point", "2 entries; expected three numbers"),
                ("/outputs/0/sections/0/normal", "\"normal\" is required"),
            ],
        ),
    ] {
        for format in ["json", "svg"] {
            let found = faults(true, &json!({ "format": format, "sections": planes }));
            let found: Vec<_> = found.iter().map(|(place, detail)| (place.as_str(), detail.as_str())).collect();
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn curves_have_no_sections() {
    for format in ["json", "svg"] {
        let found = faults(false, &json!({ "format": format, "sections": [plane([0.0; 3], [1.0; 3])] }));
        assert_eq!(found[0].0, "/outputs/0/sections");
    }
}

#[test]
fn a_drawing_of_sections_shows_nothing_else() {
    let planes = json!([plane([0.0; 3], [1.0; 3])]);
    let found = faults(true, &json!({ "format": "svg", "sections": planes, "show": ["control"] }));
    assert_eq!(found[0].0, "/outputs/0/show");
    let found = faults(true, &json!({ "format": "svg", "sections": planes, "color": "#ff000080" }));
    assert_eq!(found[0].0, "/outputs/0/color");
}

#[test]
fn a_stopped_watch_ends_the_cutting() {
    for format in ["json", "svg"] {
        let output = json!({ "format": format, "sections": [plane([0.5; 3], [1.0; 3])] });
        let text = json!({ "input": nets::cube().input(), "outputs": [output] }).to_string();
        let admitted = Limits::default().admit(parsed(text.as_bytes()).expect("a job")).expect("it is small");
        let output = admitted.job().outputs[0].clone();
        let watch = Watch::new();
        watch.stop();
        let end = run(&admitted, &output, &mut Vec::new(), &watch);
        assert!(matches!(end, Err(RunError::Stopped(_))), "{end:?}");
    }
}
