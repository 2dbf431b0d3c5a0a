//! Non-manifold faces: refused under a plan, cut into manifold pieces on request, and otherwise drawn and converted as
//! they are.

use planish::shape::check::{FaceList, NonManifold, Winding};
use planish::shape::mesh::{Mesh, MeshInput};
use planish::shape::topology::Topology;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support;
use crate::support::nets::Net;

/// Returns three wings at one edge.
fn wings() -> Value {
    let positions = json!([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 1, 0], [-1, -1, 0]]);
    json!({ "mesh": { "positions": positions, "faces": [[0, 1, 2], [1, 0, 3], [0, 1, 4]] } })
}

/// Returns three quads that form a Moebius strip.
fn one_sided() -> Value {
    let positions = json!([[0, 0, 0], [0, 0, 1], [2, 0, 0], [2, 0, 1], [1, 2, 0], [1, 2, 1]]);
    json!({ "mesh": { "positions": positions, "faces": [[0, 2, 3, 1], [2, 4, 5, 3], [4, 1, 0, 5]] } })
}

fn with(mut input: Value, field: &str, value: Value) -> Value {
    input[field] = value;
    input
}

fn refined(input: &Value) -> Value {
    let plan = json!({ "preset": "catmull-clark" });
    support::json(json!({ "input": input, "plan": plan, "levels": 1 }))
}

fn warnings(result: &Value) -> Vec<&str> {
    result["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

const SPLIT_TWO: &str = "2 vertices were split from others, which joined several fans of faces: 5 from 0, 6 from 1";

#[test]
fn without_a_plan_faces_are_taken_as_they_are_and_what_is_wrong_is_counted() {
    let result = support::json(json!({ "input": wings() }));
    let crowded = "1 edge has more than two faces, and the mesh is cut there: (0, 1)";
    assert_eq!(warnings(&result), [crowded, SPLIT_TWO]);
    let net = Net::of(&result);
    assert_eq!(net.faces, [[0, 1, 2], [1, 0, 3], [5, 6, 4]]);
    assert_eq!(net.positions[5..], [net.positions[0], net.positions[1]]);
    for format in ["glb", "gltf", "obj", "ply", "stl", "png", "stats"] {
        let job = json!({ "input": wings(), "outputs": [{ "format": format }] });
        let (bytes, report) = support::render(&job).expect("it is written");
        assert!(!bytes.is_empty() && report.warnings[0] == crowded, "{format}: {:?}", report.warnings);
    }
}

#[test]
fn under_a_plan_they_are_refused_unless_they_are_to_be_cut() {
    let plan = json!({ "preset": "catmull-clark" });
    let faults = support::faults(json!({ "input": wings(), "plan": plan, "levels": 1 }));
    assert_eq!(faults[0].pointer, "/input/mesh/faces/2");
    assert!(faults[0].detail.ends_with("\"non_manifold\": \"split\" cuts the mesh there"), "{}", faults[0]);
    let cut = refined(&with(wings(), "non_manifold", json!("split")));
    // both sides of the remaining edge, three quads per triangle
    assert_eq!(Net::of(&cut).faces.len(), 9);
    assert_eq!(warnings(&cut).len(), 2, "the edges where it is cut are no gaps that welding would close");
    let faults = support::faults(json!({ "input": with(wings(), "non_manifold", json!("refuse")) }));
    assert_eq!(faults.len(), 1);
}

#[test]
fn faces_that_cannot_be_oriented_are_cut_where_they_disagree() {
    for (orient, opposed) in [("refuse", "1 edge has"), ("repair", "1 edge has")] {
        let input = with(with(one_sided(), "non_manifold", json!("split")), "orient", json!(orient));
        let result = refined(&input);
        let warning = format!("{opposed} two faces that run the same way, and the mesh is cut there");
        assert!(warnings(&result)[0].starts_with(&warning), "{:?}", warnings(&result));
        assert_eq!(Net::of(&result).faces.len(), 12);
    }
    let result = support::json(json!({ "input": one_sided() }));
    assert_eq!(Net::of(&result).faces.len(), 3);
}

#[test]
fn a_vertex_that_a_face_visits_again_is_split() {
    let positions = json!([[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]]);
    let input = json!({ "mesh": { "positions": positions, "faces": [[0, 1, 2, 0, 3, 4]] } });
    let result = support::json(json!({ "input": input }));
    assert_eq!(warnings(&result)[0], "1 face visits a vertex more than once, which is split there: 0");
    assert_eq!(Net::of(&result).faces, [[0, 1, 2, 5, 3, 4]]);
}

#[test]
fn creases_and_corners_stay_on_all_parts() {
    let mut input = with(wings(), "non_manifold", json!("split"));
    input["mesh"]["creases"] = json!([{ "edge": [0, 1], "sharpness": 10 }]);
    input["mesh"]["corners"] = json!([{ "vertex": 1, "sharpness": 10 }]);
    let net = Net::of(&refined(&input));
    assert_eq!([net.positions[1], net.positions[6]], [[0., 0., 1.]; 2]);
}

/// Returns any faces over a few vertices, some of which meet themselves.
fn soup() -> impl Strategy<Value = (usize, Vec<Vec<u32>>)> {
    (3_usize..7).prop_flat_map(|n| {
        let vertex = 0..u32::try_from(n).unwrap_or(3);
        let face = prop::collection::vec(vertex, 3..7);
        (Just(n), prop::collection::vec(face, 1..14))
    })
}

fn list(faces: &[Vec<u32>]) -> FaceList {
    faces.iter().map(|face| face.iter().copied()).collect()
}

fn cut(n: usize, faces: &[Vec<u32>], winding: Winding) -> Mesh {
    // each vertex has a different position
    let positions = (0..n).map(|v| [f64::from(u32::try_from(v).unwrap_or(0)), 0.5, 0.25]).collect();
    let non_manifold = NonManifold::Split;
    Mesh::new(MeshInput { positions, faces: list(faces), winding, non_manifold, ..MeshInput::default() })
        .expect("any faces are cut")
}

fn faces_of(topology: &Topology) -> Vec<Vec<u32>> {
    (0..topology.n_faces()).map(|f| topology.face(f).to_vec()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_faces_become_a_manifold_with_the_same_places_at_their_corners((n, faces) in soup()) {
        for winding in [Winding::Refuse, Winding::Repair] {
            let mesh = cut(n, &faces, winding);
            let found = faces_of(&mesh.topology);
            let place = |v: u32| mesh.positions[3 * v as usize];
            prop_assert_eq!(found.len(), faces.len());
            for (found, given) in found.iter().zip(&faces) {
                let mut places: Vec<f64> = found.iter().map(|&v| place(v)).collect();
                let given: Vec<f64> = given.iter().map(|&v| f64::from(v)).collect();
                if winding == Winding::Repair && places != given {
                    places.reverse();
                }
                prop_assert_eq!(&places, &given);
            }
            // the faces by themselves are the same manifold, and none of it is cut again
            let n_cut = mesh.topology.n_vertices();
            let checked = Topology::of_faces(n_cut, list(&found), Winding::Refuse);
            let checked = checked.expect("the pieces are manifolds");
            prop_assert!(checked.split_from.is_empty() && checked.reversed.is_empty());
            prop_assert_eq!(&checked.topology, &*mesh.topology);
            let again = cut(n_cut, &found, winding);
            prop_assert!(again.repairs.is_empty() && again.topology == mesh.topology);
        }
    }

    #[test]
    fn a_manifold_is_not_cut(net in crate::support::nets::manifold()) {
        let n = net.positions.len();
        let faces: Vec<Vec<u32>> =
            net.faces.iter().map(|face| face.iter().map(|&v| u32::try_from(v).unwrap_or(0)).collect()).collect();
        let checked = Topology::of_faces(n, list(&faces), Winding::Refuse).expect("it is a manifold");
        prop_assert_eq!(&*cut(n, &faces, Winding::Refuse).topology, &checked.topology);
    }
}
