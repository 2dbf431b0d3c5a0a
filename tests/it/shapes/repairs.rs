//! What is changed to make a manifold, and what is taken as it is.

use serde_json::{Value, json};

use crate::support;
use crate::support::nets::{self, Net};

/// The mesh as it was understood, with its warnings.
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
    // the fan of the lowest corner keeps the number; the others get the next ones, at the same place
    assert_eq!(net.faces, [[0, 1, 2], [3, 4, 7], [5, 6, 8]]);
    assert_eq!(net.positions[..7], positions);
    assert_eq!(net.positions[7..], [positions[0]; 2]);
    assert_eq!(
        warnings,
        [
            "vertex 0 joined several fans of faces; vertex 7 was split from it",
            "vertex 0 joined several fans of faces; vertex 8 was split from it"
        ]
    );
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
    // each component agrees in itself: nothing is to be turned, although they disagree with each other
    assert_eq!(understood(&json!({ "mesh": net.to_json(), "orient": "repair" })), (net.clone(), Vec::new()));
    assert_eq!(understood(&net.input()), (net, Vec::new()));
}

/// Faces as cycles that start at their lowest vertex.
fn same_cycles(net: &Net) -> Vec<Vec<usize>> {
    let start = |face: &Vec<usize>| {
        let mut face = face.clone();
        let lowest = (0..face.len()).min_by_key(|&i| face[i]).expect("a face has vertices");
        face.rotate_left(lowest);
        face
    };
    net.faces.iter().map(start).collect()
}
