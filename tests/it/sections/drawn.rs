//! Drawings of sections.

use serde_json::{Value, json};

use super::plane;
use crate::support::nets::{self, Net};
use crate::support::render;

/// Returns the SVG output of an unrefined mesh.
fn svg(net: &Net, planes: &[Value], more: &Value) -> String {
    let mut output = json!({ "format": "svg", "width": 300, "height": 200, "sections": planes });
    for (name, value) in more.as_object().expect("options") {
        output[name] = value.clone();
    }
    let (bytes, _) = render(&json!({ "input": net.input(), "outputs": [output] })).expect("it can be drawn");
    String::from_utf8(bytes).expect("svg is text")
}

/// Returns the points of each group, in pixels.
fn groups(text: &str) -> Vec<Vec<[f64; 2]>> {
    let path =
        |path: &str| -> Vec<f64> { path.split(['M', 'L', ' ']).filter_map(|number| number.parse().ok()).collect() };
    let group = |group: &str| {
        let numbers: Vec<f64> =
            group.split(" d=\"").skip(1).flat_map(|rest| path(rest.split('"').next().unwrap_or_default())).collect();
        numbers.chunks(2).map(|p| [p[0], p[1]]).collect()
    };
    text.split("<g ").skip(1).map(group).collect()
}

/// Returns left, top, right and bottom.
fn frame(places: &[[f64; 2]]) -> [f64; 4] {
    places.iter().fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |f, p| {
        [f[0].min(p[0]), f[1].min(p[1]), f[2].max(p[0]), f[3].max(p[1])]
    })
}

/// Returns a wedge, 4 wide (x), 2 high (y) at its left end and 0 at its right end, 1 deep (z).
fn wedge() -> Net {
    let positions = [[0., 0., 0.], [4., 0., 0.], [0., 2., 0.], [0., 0., 1.], [4., 0., 1.], [0., 2., 1.]].to_vec();
    let faces: [&[usize]; 5] = [&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
    Net { positions, faces: faces.map(<[usize]>::to_vec).to_vec() }
}

#[test]
fn a_section_is_seen_against_its_normal_with_up_up() {
    let found = groups(&svg(&wedge(), &[plane([0.0, 0.0, 0.5], [0.0, 0.0, 1.0])], &json!({})));
    assert_eq!(found.len(), 1);
    let [left, top, right, bottom] = frame(&found[0]);
    assert!(((right - left) / (bottom - top) - 2.0).abs() < 0.01, "{found:?}");
    // centred, with a margin of 6 % of the height
    assert!((left - 12.0).abs() < 0.02 && (right - 288.0).abs() < 0.02, "{left} {right}");
    assert!((top + bottom - 200.0).abs() < 0.02);
    let highest = found[0].iter().find(|place| place[1] <= top).expect("there is one");
    assert!((highest[0] - left).abs() < 1e-9, "the high end is on the left");
    // from behind, it is on the right
    let found = groups(&svg(&wedge(), &[plane([0.0, 0.0, 0.5], [0.0, 0.0, -1.0])], &json!({})));
    let [.., right, _] = frame(&found[0]);
    let highest = found[0].iter().find(|place| place[1] <= top).expect("there is one");
    assert!((highest[0] - right).abs() < 1e-9, "the high end is on the right");
}

#[test]
fn several_sections_stand_side_by_side_at_one_scale() {
    let z = |z: f64| plane([0.0, 0.0, z], [0.0, 0.0, 1.0]);
    let x = |x: f64| plane([x, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let planes = [z(0.25), x(1.0), z(7.0), x(2.0)];
    let found = groups(&svg(&wedge(), &planes, &json!({ "color": "#123456", "background": "transparent" })));
    assert_eq!(found.iter().map(Vec::is_empty).collect::<Vec<_>>(), [false, false, true, false]);
    let sides = |i: usize| {
        let [left, top, right, bottom] = frame(&found[i]);
        [right - left, bottom - top]
    };
    let scale = sides(0)[0] / 4.0;
    for (i, expected) in [(0, [4.0, 2.0]), (1, [1.0, 1.5]), (3, [1.0, 1.0])] {
        assert!(nets::distance(&sides(i), &expected.map(|side| side * scale)) < 0.03, "{i}: {:?}", sides(i));
    }
    // row by row, separate from each other
    assert!(frame(&found[0])[2] < frame(&found[1])[0] && frame(&found[1])[3] < frame(&found[3])[1]);
}

#[test]
fn an_empty_section_is_an_empty_group() {
    let text = svg(&nets::cube(), &[plane([0.0, 0.0, 9.0], [0.0, 0.0, 1.0])], &json!({}));
    assert_eq!(groups(&text), [Vec::<[f64; 2]>::new()]);
    assert!(text.ends_with("</svg>\n"));
}
