//! Legends of names, lines and dots.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::picture;
use crate::support::nets;
use crate::support::render;

/// Returns the colours of the right half of a picture with their numbers of pixels, without greys and rare colours.
fn colors(input: &Value, options: &Value) -> BTreeMap<[u8; 3], usize> {
    let (width, pixels) = picture(input, options);
    let mut found = BTreeMap::new();
    for (i, [r, g, b, _]) in pixels.into_iter().enumerate() {
        let is_grey = r.max(g).max(b) - r.min(g).min(b) < 40;
        if i % width >= width / 2 && !is_grey {
            *found.entry([r, g, b]).or_default() += 1;
        }
    }
    found.retain(|_, n| *n > 30);
    found
}

/// Returns options with the camera so far away that all colours are those of the legend.
fn options(show: &Value) -> Value {
    json!({ "width": 400, "height": 300, "show": show, "camera": { "zoom": 0.01 } })
}

#[test]
fn a_legend_has_a_swatch_for_each_name_and_one_for_faces_without() {
    let mut cube = nets::cube().input();
    cube["mesh"]["groups"] = json!([{ "name": "lid_{1}", "faces": [0] }, { "name": "sides", "faces": [1, 2] }]);
    let mut asked = options(&json!(["surface", "legend"]));
    asked["color_by"] = "groups".into();
    assert_eq!(colors(&cube, &asked).len(), 3);
    cube["mesh"]["groups"] = json!([{ "name": "all", "faces": [0, 1, 2, 3, 4, 5] }]);
    assert_eq!(colors(&cube, &asked).len(), 1);
    // hundreds of names do not fit; the legend shows as many as there is room for
    let faces = |i: usize| if i < 6 { vec![i] } else { Vec::new() };
    let names: Vec<Value> = (0..256).map(|i| json!({ "name": format!("group-{i}"), "faces": faces(i) })).collect();
    cube["mesh"]["groups"] = json!(names);
    assert!((6..40).contains(&colors(&cube, &asked).len()));
}

#[test]
fn a_legend_says_what_lines_and_dots_are_and_stands_above_a_bar_of_numbers() {
    let mut cube = nets::cube().input();
    cube["mesh"]["creases"] = json!([{ "edge": [0, 1], "sharpness": 10 }]);
    let large = |show: Value| {
        let mut large = options(&show);
        (large["width"], large["height"], large["quality"]) = (2048.into(), 1536.into(), "draft".into());
        large
    };
    let lines = colors(&cube, &large(json!(["surface", "creases", "control", "extraordinary", "legend"])));
    assert!(lines.len() >= 3, "{lines:?}");
    let mut measured = large(json!(["surface", "creases", "legend"]));
    measured["shading"] = "mean-curvature".into();
    let both = colors(&cube, &measured);
    measured["show"] = json!(["surface", "creases"]);
    let bar = colors(&cube, &measured);
    assert!(both.len() > bar.len() / 2 && both != bar, "{} {}", both.len(), bar.len());
}

#[test]
fn a_legend_that_has_nothing_to_say_is_refused() {
    let job = json!({ "input": nets::cube().input(), "outputs": [{ "format": "png", "show": ["surface", "legend"] }] });
    let faults = render(&job).expect_err("it is refused");
    assert_eq!(faults[0].pointer, "/outputs/0/show");
    assert!(faults[0].detail.contains("nothing"), "{faults:?}");
}
