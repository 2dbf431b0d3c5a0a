//! Every fault of a mesh or polygon names its place, the value, and the bound.

use planish::fault::Fault;
use planish::shape::check::FaceList;
use planish::shape::mesh::{Mesh, MeshInput};
use planish::shape::polygon::Polygon;
use serde_json::{Value, json};

use crate::support;

/// Returns a square in the plane with one more vertex.
fn positions() -> Value {
    json!([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 2, 0]])
}

fn check_input(input: &Value, expected: &[(&str, &str)]) {
    let found = support::faults(json!({ "input": input }));
    let found: Vec<_> = found.iter().map(|fault| (fault.pointer.as_str(), fault.detail.as_str())).collect();
    assert_eq!(found, expected, "{input}");
}

/// Checks the faults of a mesh over the vertices above; pointers are below the mesh.
fn check(fields: Value, expected: &[(&str, &str)]) {
    let mut mesh = json!({ "positions": positions(), "faces": [[0, 1, 2, 3]] });
    if let Value::Object(fields) = fields {
        fields.into_iter().for_each(|(name, value)| mesh[name] = value);
    }
    let expected: Vec<_> = expected.iter().map(|(at, detail)| (format!("/input/mesh{at}"), *detail)).collect();
    let expected: Vec<_> = expected.iter().map(|(at, detail)| (at.as_str(), *detail)).collect();
    check_input(&json!({ "mesh": mesh, "non_manifold": "refuse" }), &expected);
}

#[test]
fn faces_are_told_apart_by_their_faults() {
    check(json!({ "faces": [] }), &[("/faces", "there is no face; a mesh has at least one")]);
    check(json!({ "faces": [[0, 1, 2], [3, 4]] }), &[("/faces/1", "a face of 2 vertices; a face has at least 3")]);
    check(json!({ "faces": [[]] }), &[("/faces/0", "a face of 0 vertices; a face has at least 3")]);
    check(json!({ "faces": [[0, 1, 5]] }), &[("/faces/0/2", "there is no vertex 5; the mesh has 5, counted from 0")]);
    check(
        json!({ "faces": [[0, 1, 2, 1]] }),
        &[(
            "/faces/0",
            "vertex 1 occurs twice; a face visits each of its vertices once; \"non_manifold\": \"split\" parts it",
        )],
    );
}

/// An index that does not fit in 32 bits is quoted as the client wrote it.
#[test]
fn huge_indices_are_out_of_range() {
    for huge in [4_294_967_295_u64, 4_294_967_296, u64::MAX] {
        let found =
            support::faults(json!({ "input": { "mesh": { "positions": positions(), "faces": [[0, 1, huge]] } } }));
        assert_eq!(found[0].pointer, "/input/mesh/faces/0/2");
        assert!(found[0].detail.contains("the mesh has 5, counted from 0"), "{found:?}");
    }
}

#[test]
fn an_edge_has_at_most_two_faces() {
    check(
        json!({ "faces": [[0, 1, 2], [1, 0, 3], [0, 1, 4]] }),
        &[(
            "/faces/2",
            "edge (0, 1) has 3 faces (0, 1, 2); at most 2 are allowed; \"non_manifold\": \"split\" cuts the mesh there",
        )],
    );
}

#[test]
fn neighbours_run_along_their_edge_in_opposite_directions() {
    check(
        json!({ "faces": [[0, 1, 2], [0, 2, 3], [1, 2, 4]] }),
        &[(
            "/faces/2",
            "faces 0 and 2 run along edge (1, 2) in the same direction; turn one of them, or set \"orient\": \
             \"repair\"",
        )],
    );
}

#[test]
fn a_one_sided_strip_is_refused_naming_an_edge() {
    // three quads that form a Moebius strip
    let faces = json!([[0, 2, 3, 1], [2, 4, 5, 3], [4, 1, 0, 5]]);
    let positions = json!([[0, 0, 0], [0, 0, 1], [2, 0, 0], [2, 0, 1], [1, 2, 0], [1, 2, 1]]);
    for orient in ["refuse", "repair"] {
        let input =
            json!({ "mesh": { "positions": positions, "faces": faces }, "orient": orient, "non_manifold": "refuse" });
        let found = support::faults(json!({ "input": input }));
        let [fault] = found.as_slice() else { panic!("one fault, not {found:?}") };
        assert!(fault.pointer.starts_with("/input/mesh/faces/"), "{fault}");
        assert!(fault.detail.starts_with("the faces cannot be oriented: around edge ("), "{fault}");
        assert!(
            fault
                .detail
                .ends_with("they form a one-sided strip; cut the mesh along it, or set \"non_manifold\": \"split\""),
            "{fault}"
        );
    }
}

#[test]
fn corners_and_holes_name_what_exists() {
    check(
        json!({ "corners": [{ "vertex": 5, "sharpness": 10 }] }),
        &[("/corners/0/vertex", "there is no vertex 5; the mesh has 5, counted from 0")],
    );
    check(
        json!({ "corners": [{ "vertex": 0, "sharpness": 0 }, { "vertex": 1, "sharpness": -1 }] }),
        &[("/corners/1/sharpness", "-1 is no sharpness; 0 is smooth, 10 or more infinitely sharp")],
    );
    check(json!({ "holes": [0, 1] }), &[("/holes/1", "there is no face 1; the mesh has 1, counted from 0")]);
}

#[test]
fn creases_name_edges_and_give_each_one_sharpness() {
    let crease = |edge: Value, sharpness: f64| json!({ "edge": edge, "sharpness": sharpness });
    check(
        json!({ "creases": [crease(json!([0, 2]), 0.0), crease(json!([1, 1]), 3.0)] }),
        &[
            ("/creases/0/edge", "there is no edge (0, 2); name the two ends of a side of some face"),
            ("/creases/1/edge", "there is no edge (1, 1); name the two ends of a side of some face"),
        ],
    );
    check(
        json!({ "creases": [crease(json!([0, 9]), -0.5), crease(json!([0, 1]), 2.0), crease(json!([1, 0]), 3.0)] }),
        &[
            ("/creases/0/edge/1", "there is no vertex 9; the mesh has 5, counted from 0"),
            ("/creases/0/sharpness", "-0.5 is no sharpness; 0 is smooth, 10 or more infinitely sharp"),
            ("/creases/2/sharpness", "edge (1, 0) has sharpness 2 at /input/mesh/creases/1 and 3 here; give it one"),
        ],
    );
    check(
        json!({ "corners": [{ "vertex": 1, "sharpness": 2 }, { "vertex": 1, "sharpness": 10 }] }),
        &[("/corners/1/sharpness", "vertex 1 has sharpness 2 at /input/mesh/corners/0 and 10 here; give it one")],
    );
}

#[test]
fn all_faults_of_a_mesh_are_told_together() {
    check(
        json!({ "faces": [[0, 1], [0, 1, 9], [2, 2, 3]], "holes": [7] }),
        &[
            ("/holes/0", "there is no face 7; the mesh has 3, counted from 0"),
            ("/faces/0", "a face of 2 vertices; a face has at least 3"),
            ("/faces/1/2", "there is no vertex 9; the mesh has 5, counted from 0"),
            (
                "/faces/2",
                "vertex 2 occurs twice; a face visits each of its vertices once; \"non_manifold\": \"split\" parts it",
            ),
        ],
    );
}

#[test]
fn many_faults_are_counted_rather_than_listed() {
    let found = support::faults(json!({ "input": { "mesh": {
        "positions": positions(), "faces": vec![[0, 1]; 1000],
    } } }));
    assert_eq!(found.len(), 21);
    assert_eq!(found[20], Fault::new("/input/mesh/faces", "and 980 more faults like these"));
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut faces = FaceList::default();
        faces.push([0, 1, 2]);
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, x]];
        let found = Mesh::new(MeshInput { positions, faces, ..MeshInput::default() }).expect_err("it is not finite");
        assert_eq!(found, [Fault::new("/positions/2/2", format!("{x} is not a finite number"))]);
        let found = Polygon::new(&[vec![0.0, x], vec![1.0, 2.0]], false, &[]).expect_err("it is not finite");
        assert_eq!(found, [Fault::new("/points/0/1", format!("{x} is not a finite number"))]);
    }
}

#[test]
fn polygons_are_told_apart_by_their_faults() {
    let check = |polygon: Value, expected: &[(&str, &str)]| check_input(&json!({ "polygon": polygon }), expected);
    check(
        json!({ "points": [[0]] }),
        &[("/input/polygon/points", "an open polygon needs at least 2 points; this one has 1")],
    );
    check(
        json!({ "points": [[0], [1]], "closed": true }),
        &[("/input/polygon/points", "a closed polygon needs at least 3 points; this one has 2")],
    );
    check(
        json!({ "points": [[0, 1], [1], []] }),
        &[
            ("/input/polygon/points/1", "1 coordinates where point 0 has 2; give all points the same"),
            ("/input/polygon/points/2", "0 coordinates; a point has 1 to 4"),
        ],
    );
    check(
        json!({ "points": [[0, 0, 0, 0, 0], [0, 0, 0, 0, 0]] }),
        &[
            ("/input/polygon/points/0", "5 coordinates; a point has 1 to 4"),
            ("/input/polygon/points/1", "5 coordinates; a point has 1 to 4"),
        ],
    );
    check(
        json!({ "points": [[0], [1]], "corners": [0, 2] }),
        &[("/input/polygon/corners/1", "there is no point 2; the polygon has 2, counted from 0")],
    );
}

#[test]
fn one_of_several_polygons_is_named_by_its_place() {
    check_input(
        &json!({ "polygons": [{ "points": [[0], [1]] }, { "points": [[0]] }] }),
        &[("/input/polygons/1/points", "an open polygon needs at least 2 points; this one has 1")],
    );
    let none = [("/input/polygons", "0 polygons; 1 to 4096 are allowed")];
    check_input(&json!({ "polygons": [] }), &none);
    // a plan for polygons fits them, though there are none
    let found = support::faults(json!({ "input": { "polygons": [] }, "plan": { "preset": "chaikin" }, "levels": 1 }));
    assert_eq!(found.iter().map(|fault| (&*fault.pointer, &*fault.detail)).collect::<Vec<_>>(), none);
}

#[test]
fn an_input_is_one_thing() {
    let detail = "give exactly one of \"mesh\", \"text\", \"blob\", \"polygon\" and \"polygons\"";
    check_input(&json!({}), &[("/input", detail)]);
    let polygon = json!({ "points": [[0], [1]] });
    check_input(&json!({ "polygon": polygon, "polygons": [polygon] }), &[("/input", detail)]);
}
