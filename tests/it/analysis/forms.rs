//! Analyses as reports and figures.

use planish::job::Form;
use planish::watch::Watch;
use planish::wire::analysis::AnalysisAnswer;
use serde_json::{Value, json};

use super::question;

fn written(asked: &Value, form: Form) -> Vec<u8> {
    let watch = Watch::new();
    let inquiry = question(asked).resolve(form, &watch).unwrap();
    let mut bytes = Vec::new();
    AnalysisAnswer::of(&inquiry, &watch).unwrap().write(form, &mut bytes, &watch).unwrap();
    bytes
}

fn text(asked: &Value, form: Form) -> String {
    String::from_utf8(written(asked, form)).unwrap()
}

fn questions() -> Vec<Value> {
    let functions = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)" });
    vec![
        json!({ "plan": { "preset": "four-point" }, "matrices": true }),
        json!({ "plan": { "word": "UCP", "parameters": functions }, "nodes": 1000 }),
        json!({ "plan": { "preset": "ternary-c4" }, "nodes": 1000,
            "scan": { "parameter": "eta", "from": 0, "to": "1/54", "steps": 6 } }),
        json!({ "plan": { "preset": "catmull-clark" }, "valences": [3, 5] }),
    ]
}

#[test]
fn reports_say_what_the_numbers_do() {
    let [stationary, changing, scan, surface] = questions().try_into().unwrap();
    let report = text(&stationary, Form::Markdown);
    for part in [
        "# A curve scheme of arity 2",
        "| limits | C1 (proved), not C2 (proved) |",
        "| Hoelder exponent | 2 |",
        "| support | [-3, 3], width 6 |",
        "- mask, indices -3 to 3: -1/16, 0, 9/16, 1, 9/16, 0, -1/16",
        "| 1 | 2 | 0.75 |",
        "### product",
        "| 9/16 | 9/16 | -1/16 | 0 | -1/16 |",
    ] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
    let report = text(&changing, Form::Markdown);
    for part in ["Limits are C1 (proved).", "theorem 1 | yes", "# The static limit", "## Levels"] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
    let report = text(&scan, Form::Markdown);
    for part in ["# eta from 0 to 1/54 in 6 steps", "| 1/162 | 5 | C4 | C5 |", "## Where C^k is proved"] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
    let report = text(&surface, Form::Markdown);
    for part in ["## Valences", "\n| 5 | "] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
    for report in questions().iter().map(|question| text(question, Form::Markdown)) {
        // each row of a table has as many cells as its head
        let mut width = None;
        for line in report.lines() {
            let cells = line.starts_with('|').then(|| line.replace("\\|", "").matches('|').count());
            assert!(width.is_none() || cells.is_none() || width == cells, "{line}");
            width = cells;
        }
    }
}

#[test]
fn figures_are_the_same_bytes_each_time_and_of_one_page() {
    for question in questions() {
        let drawn = text(&question, Form::Svg);
        assert!(drawn.starts_with("<svg") && drawn.contains("width=\"960\"") && drawn.ends_with("</svg>\n"), "{drawn}");
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{question}");
        assert_eq!(drawn, text(&question, Form::Svg));
        let picture = image::load_from_memory(&written(&question, Form::Png)).unwrap().to_rgb8();
        assert_eq!(picture.width(), 960);
        let inked = picture.pixels().filter(|pixel| pixel.0 != [255; 3]).count();
        assert!(inked > 5000, "{question}: {inked} pixels");
    }
}

#[test]
fn figures_have_derivatives_as_far_as_they_are_continuous() {
    let drawn = text(&json!({ "plan": { "preset": "cubic-b-spline" } }), Form::Svg);
    for part in
        ["Mask", "Basic limit function", "First derivative", "Second derivative", "Local eigenvalues", "limits are C2"]
    {
        assert!(drawn.contains(part), "{part} is not in the figure");
    }
    assert!(!drawn.contains("Third derivative"));
}

#[test]
fn reports_tell_what_is_found_of_an_input() {
    let square = json!({ "polygon": { "points": [[0, 0], [4, 0], [4, 4], [0, 4]], "closed": true } });
    let report =
        text(&json!({ "plan": { "preset": "four-point", "parameters": { "w": 1 } }, "input": square }), Form::Markdown);
    assert!(report.contains("## The input") && report.contains("- warning: "), "{report}");
    let spline = json!({ "plan": { "preset": "cubic-b-spline" }, "input": square });
    assert!(
        text(&spline, Form::Markdown)
            .contains("| Level | At most so far from the limit, model units |\n|---|---|\n| 0 |")
    );
    let functions = json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "delta": 0 });
    let changing = json!({ "plan": { "word": "UCP", "parameters": functions }, "input": square, "nodes": 1000 });
    assert_eq!(text(&changing, Form::Markdown).matches("## The input").count(), 1);
    let tetrahedron = json!({ "mesh": {
        "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    } });
    let report = text(&json!({ "plan": { "preset": "loop" }, "input": tetrahedron }), Form::Markdown);
    for part in ["## The input", "| Extraordinary, of valence | Vertices | Faces | C1 |", "| 3 | 4 | 0 | proved |"] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
}
