//! Changes that make a manifold, and input that is accepted as it is.

use serde_json::{Value, json};

use crate::support;
use crate::support::nets::{self, Net};

/// Returns the checked mesh with its warnings.
fn understood(input: &Value) -> (Net, Vec<String>) {
    let result = support::json(json!({ "input": input }));
    let warnings = serde_json::from_value(result.get("warnings").cloned().unwrap_or_else(|| json!([])));
    (Net::of(&result), warnings.expect("warnings are texts"))
}

#[test]
fn a_good_mesh_is_taken_as_it_is() {
    for net in [nets::cube(), nets::tetrahedron(), nets::mixed(), nets::grid(3, 2), nets::torus(4, 3), nets::prism(5)] {
        assert_eq!(understood(&net.input()), (net, Vec::new()));
    }
}

#[test]
fn a_vertex_that_joins_fans_is_split_into_one_a_fan() {
    let positions =
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [-1., 0., 0.], [-1., -1., 0.], [0., 0., 1.], [0., 1., 1.]];
    let faces = json!([[0, 1, 2], [3, 4, 0], [5, 6, 0]]);
    let (net, warnings) = understood(&json!({ "mesh": { "positions": positions, "faces": faces } }));
    // the fan of the lowest corner keeps the number; the others get the next ones, at the same position
    assert_eq!(net.faces, [[0, 1, 2], [3, 4, 7], [5, 6, 8]]);
    assert_eq!(net.positions[..7], positions);
    assert_eq!(net.positions[7..], [positions[0]; 2]);
    assert_eq!(warnings, ["2 vertices were split from others, which joined several fans of faces: 7 from 0, 8 from 0"]);
}

#[test]
fn two_closed_surfaces_that_touch_in_a_vertex_come_apart() {
    let mut net = nets::tetrahedron();
    let second = nets::tetrahedron();
    // the second one shares vertex 3 and has its own 4, 5, 6
    let image = [3, 4, 5, 6];
    net.positions.extend_from_slice(&second.positions[1..]);
    net.faces.extend(second.faces.iter().map(|face| face.iter().map(|&v| image[v]).collect()));
    let (found, warnings) = understood(&net.input());
    assert_eq!(found.positions.len(), 8);
    assert_eq!(found.positions.get(7), found.positions.get(3));
    assert_eq!(warnings.len(), 1);
    assert!(found.faces[..4].iter().flatten().all(|v| *v < 4));
    assert!(found.faces[4..].iter().flatten().all(|v| *v > 3));
}

/// Returns two cubes that share vertex 6: as a client gives them, and with the second cube's corner split off as vertex
/// 15. Tags of the shared vertex are on both vertices there.
fn touching_cubes() -> [Net; 2] {
    let second = [[6, 10, 9, 8], [11, 12, 13, 14], [6, 8, 12, 11], [8, 9, 13, 12], [9, 10, 14, 13], [10, 6, 11, 14]];
    let first = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let positions = [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
        [3, 1, 1],
        [3, 3, 1],
        [1, 3, 1],
        [1, 1, 3],
        [3, 1, 3],
        [3, 3, 3],
        [1, 3, 3],
    ];
    let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.map(f64::from)).collect();
    let split = second.map(|face| face.map(|v| if v == 6 { 15 } else { v }));
    let net = |second: &[[usize; 4]; 6], positions: &[[f64; 3]]| Net {
        positions: positions.to_vec(),
        faces: first.iter().chain(second).map(|face| face.to_vec()).collect(),
    };
    let more: Vec<[f64; 3]> = positions.iter().copied().chain([positions[6]]).collect();
    [net(&second, &positions), net(&split, &more)]
}

/// Both parts of a split vertex have its tags: as if a client had split the vertex and tagged all parts.
#[test]
fn what_is_tagged_at_a_split_vertex_holds_for_all_its_parts() {
    let corner = |sharpness: f64| json!([{ "vertex": 6, "sharpness": sharpness }]);
    let corners = |sharpness: f64| json!([6, 15].map(|v| json!({ "vertex": v, "sharpness": sharpness })));
    let creases =
        |ends: &[[usize; 2]]| json!(ends.iter().map(|e| json!({ "edge": e, "sharpness": 10 })).collect::<Vec<_>>());
    let rings = [[[6, 10], [10, 9], [9, 8], [8, 6]], [[15, 10], [10, 9], [9, 8], [8, 15]]];
    let up = [[[6, 11], [10, 14], [9, 13], [8, 12]], [[15, 11], [10, 14], [9, 13], [8, 12]]];
    let cases = [
        ("catmull-clark", json!({ "corners": corner(10.0) }), json!({ "corners": corners(10.0) })),
        ("catmull-clark", json!({ "corners": corner(1.5) }), json!({ "corners": corners(1.5) })),
        ("push-back", json!({ "corners": corner(10.0) }), json!({ "corners": corners(10.0) })),
        ("push-back", json!({ "creases": creases(&rings[0]) }), json!({ "creases": creases(&rings[1]) })),
        ("push-back", json!({ "holes": [6, 7] }), json!({ "holes": [6, 7] })),
        (
            "push-back",
            json!({ "latitude": rings[0], "longitude": up[0] }),
            json!({ "latitude": rings[1], "longitude": up[1] }),
        ),
    ];
    let refined = |net: &Net, preset: &str, tags: &Value| {
        let mut input = net.input();
        for (name, tag) in tags.as_object().expect("tags have names") {
            input["mesh"][name] = tag.clone();
        }
        support::json(json!({ "input": input, "plan": { "preset": preset }, "levels": 2 }))
    };
    for (preset, given, split) in cases {
        let [shared, apart] = touching_cubes();
        let (found, expected) = (refined(&shared, preset, &given), refined(&apart, preset, &split));
        let untagged = refined(&shared, preset, &json!({}));
        for part in ["positions", "faces"] {
            assert!(found[part] == expected[part], "{preset}, {given}: {part}");
        }
        assert!(
            found["positions"] != untagged["positions"] || found["faces"] != untagged["faces"],
            "{preset}, {given}"
        );
    }
}

/// Origins are cells of the input: that of a part is the vertex from which it was split.
#[test]
fn parts_of_a_split_vertex_come_of_that_vertex() {
    let [shared, _] = touching_cubes();
    for levels in 0..3 {
        let job = json!({ "input": shared.input(), "plan": { "preset": "catmull-clark" }, "levels": levels });
        let result = support::json_with(job, &json!({ "ids": true }));
        let vertices: Vec<[usize; 2]> = serde_json::from_value(result["ids"]["vertices"].clone()).expect("pairs");
        let expected: Vec<_> = (0..15).chain([6]).map(|v| [0, v]).collect();
        assert_eq!(vertices[..16], expected, "level {levels}");
        assert!(vertices[16..].iter().all(|[dimension, _]| *dimension > 0), "level {levels}");
    }
}

#[test]
fn isolated_vertices_stay_at_their_place() {
    let mut net = nets::cube();
    net.positions.insert(3, [7.0, 8.0, 9.0]);
    net.faces.iter_mut().flatten().filter(|v| **v >= 3).for_each(|v| *v += 1);
    for plan in [json!({ "word": "UC" }), json!({ "word": "UCP" }), json!({ "preset": "catmull-clark" })] {
        let job = json!({ "input": net.input(), "plan": plan, "levels": 2 });
        let fine = Net::of(&support::json(job));
        assert_eq!(fine.positions.get(3), Some(&[7.0, 8.0, 9.0]), "{plan}");
        assert_eq!(fine.positions.len(), 99);
        assert!(fine.faces.iter().all(|face| !face.contains(&3)));
    }
}

#[test]
fn coincident_positions_and_flat_faces_are_accepted() {
    let mut net = nets::cube();
    net.positions[1] = net.positions[0];
    assert_eq!(understood(&net.input()), (net.clone(), Vec::new()));
    net.positions = vec![[1.0; 3]; 8];
    assert_eq!(understood(&net.input()), (net, Vec::new()));
}

#[test]
fn faces_are_turned_to_agree_with_the_lowest_of_their_component() {
    let mut net = nets::cube();
    let expected = net.clone();
    net.faces[2].reverse();
    net.faces[5].reverse();
    let input = json!({ "mesh": net.to_json(), "orient": "repair" });
    let (found, warnings) = understood(&input);
    assert_eq!(same_cycles(&found), same_cycles(&expected));
    assert_eq!(warnings, ["faces turned to agree with their neighbours: 2, 5"]);
}

#[test]
fn the_lowest_face_decides_even_when_all_others_disagree() {
    let mut net = nets::cube();
    net.faces[0].reverse();
    let (found, _) = understood(&json!({ "mesh": net.to_json(), "orient": "repair" }));
    assert_eq!(found.faces[0], net.faces[0]);
    let mut inside_out = nets::cube();
    inside_out.faces.iter_mut().for_each(|face| face.reverse());
    assert_eq!(same_cycles(&found), same_cycles(&inside_out));
}

#[test]
fn components_are_turned_apart() {
    let mut net = nets::tetrahedron();
    let far: Vec<_> = net.positions.iter().map(|[x, y, z]| [x + 10.0, *y, *z]).collect();
    net.positions.extend(far);
    net.faces.extend(nets::tetrahedron().faces.iter().map(|face| face.iter().rev().map(|v| v + 4).collect::<Vec<_>>()));
    // each component is consistent in itself: nothing is to be reversed, although they disagree with each other
    assert_eq!(understood(&json!({ "mesh": net.to_json(), "orient": "repair" })), (net.clone(), Vec::new()));
    assert_eq!(understood(&net.input()), (net, Vec::new()));
}

/// Returns the faces as cycles that start at their lowest vertex.
fn same_cycles(net: &Net) -> Vec<Vec<usize>> {
    let start = |face: &Vec<usize>| {
        let mut face = face.clone();
        let lowest = (0..face.len()).min_by_key(|&i| face[i]).expect("a face has vertices");
        face.rotate_left(lowest);
        face
    };
    net.faces.iter().map(start).collect()
}
