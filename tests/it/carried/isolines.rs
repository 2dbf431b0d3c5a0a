//! The edges of the input on the refined mesh.

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{json_with, render};

/// Returns the edges of a mesh from start to end, in the order of their first appearance in its faces.
fn edges(net: &Net) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    for face in &net.faces {
        for j in 0..face.len() {
            let (a, b) = (face[j], face[(j + 1) % face.len()]);
            if !found.contains(&[a, b]) && !found.contains(&[b, a]) {
                found.push([a, b]);
            }
        }
    }
    found
}

/// Whether no vertex joins several fans, so that the vertices of the job are those of the input.
fn is_manifold(net: &Net) -> bool {
    let job = json!({ "input": net.input(), "outputs": [{ "format": "json" }] });
    render(&job).is_ok_and(|(_, report)| report.warnings.is_empty())
}

fn check(net: &Net, plan: &Value, levels: u32, pieces: usize) -> Result<(), TestCaseError> {
    let job = json!({ "input": net.input(), "plan": plan, "levels": levels });
    let result = json_with(job, &json!({ "isolines": true, "ids": true }));
    let lines: Vec<Vec<usize>> = serde_json::from_value(result["isolines"].clone()).expect("lists of vertices");
    let edges = edges(net);
    prop_assert_eq!(lines.len(), edges.len());
    let sides = Net::of(&result).edges();
    for (e, (line, [start, end])) in lines.iter().zip(edges).enumerate() {
        prop_assert_eq!(line.len(), pieces + 1);
        prop_assert_eq!([line[0], line[pieces]], [start, end]);
        for pair in line.windows(2) {
            prop_assert!(sides.contains(&(pair[0].min(pair[1]), pair[0].max(pair[1]))), "{:?} is no edge", pair);
        }
        for &v in &line[1..pieces] {
            prop_assert_eq!(&result["ids"]["vertices"][v], &json!([1, e]));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn they_run_from_vertex_to_vertex_along_edges(net in nets::manifold(), triangles in nets::triangle_manifold()) {
        if is_manifold(&net) {
            let quads = net.faces.iter().all(|face| face.len() == 4);
            check(&net, &json!({ "preset": "catmull-clark" }), 2, 4)?;
            check(&net, &json!({ "preset": "kobbelt" }), 1, 2)?;
            check(&net, &json!({ "word": "U3C" }), 1, if quads { 3 } else { 6 })?;
        }
        if is_manifold(&triangles) {
            check(&triangles, &json!({ "preset": "loop" }), 2, 4)?;
            check(&triangles, &json!({ "word": "U3C", "parameters": { "split": "triangle" } }), 1, 3)?;
        }
    }
}

#[test]
fn without_levels_they_are_the_edges() {
    let net = nets::mixed();
    let result = json_with(json!({ "input": net.input() }), &json!({ "isolines": true }));
    assert_eq!(result["isolines"], json!(edges(&net)));
}

#[test]
fn schemes_with_faces_of_their_own_have_none() {
    for (plan, triangles) in [("doo-sabin", false), ("sqrt-3", true)] {
        let net = if triangles { nets::octahedron() } else { nets::cube() };
        let job = json!({
            "input": net.input(), "plan": { "preset": plan }, "levels": 1,
            "outputs": [{ "format": "json", "isolines": true }],
        });
        let found = render(&job).expect_err("it is refused");
        assert!(found[0].detail.contains("cannot carry isolines"), "{found:?}");
    }
    let line = json!({
        "input": { "polygon": { "points": [[0], [1]] } }, "outputs": [{ "format": "json", "isolines": true }]
    });
    assert_eq!(render(&line).expect_err("it is refused")[0].pointer, "/outputs/0/isolines");
}

/// Lines whose faces are all hidden are not drawn; holes do not change other lines.
#[test]
fn pictures_show_them_where_a_face_is_shown() {
    let drawn = |holes: &[usize], show: &Value| {
        let mut mesh = nets::grid(3, 1).to_json();
        mesh["holes"] = json!(holes);
        let output =
            json!({ "format": "png", "width": 64, "height": 48, "show": show, "camera": { "elevation_deg": 60 } });
        render(&json!({ "input": { "mesh": mesh }, "outputs": [output] })).expect("it can be drawn").0
    };
    let isolines = json!(["isolines"]);
    assert!(drawn(&[], &isolines) != drawn(&[0], &isolines), "the lines of a hidden face are drawn");
    let blank = drawn(&[0, 1, 2], &json!(["surface"]));
    assert!(drawn(&[0, 1, 2], &isolines) == blank, "lines of hidden faces are drawn");
    assert!(drawn(&[1], &json!(["surface"])) != blank, "the shown faces are drawn");
}
