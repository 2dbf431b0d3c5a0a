//! Identities of mesh schemes: the common part of Catmull-Clark and push-back, and data without effect.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{mesh_plans, refined_mesh, semi_stationary, static_word, word};
use crate::support;
use crate::support::nets::{self, Net, distance, same_surface};

const TOLERANCE: f64 = 1e-12;

fn assert_same_points(found: &Net, expected: &Net, what: &str) {
    assert_eq!(found.positions.len(), expected.positions.len(), "{what}");
    for (i, (p, q)) in found.positions.iter().zip(&expected.positions).enumerate() {
        assert!(distance(p, q) <= TOLERANCE, "{what}: vertex {i} is {p:?} and {q:?}");
    }
    assert_eq!(found.faces, expected.faces, "{what}");
}

fn quad_meshes() -> [Net; 5] {
    [nets::cube(), nets::torus(4, 3), nets::grid(3, 2), nets::grid(1, 1), refined_mesh(&nets::mixed(), &word("U"), 1)]
}

fn with_boundary(mut plan: Value, boundary: &str) -> Value {
    plan["boundary"] = json!(boundary);
    plan
}

fn catmull_clark(boundary: &str) -> Value {
    json!({ "preset": "catmull-clark", "boundary": boundary })
}

fn catmull_clark_as_push_back(boundary: &str) -> Value {
    json!({ "preset": "push-back", "boundary": boundary, "parameters": {
        "kernel": 1, "compensation": 0, "delta": "(valence-4)/valence",
    } })
}

#[test]
fn catmull_clark_is_push_back_on_quad_meshes() {
    for boundary in ["edge-and-corner", "edge-only"] {
        for net in quad_meshes() {
            for levels in 1..=3 {
                let [a, b] = [catmull_clark(boundary), catmull_clark_as_push_back(boundary)];
                assert_same_points(&refined_mesh(&net, &a, levels), &refined_mesh(&net, &b, levels), boundary);
            }
        }
    }
}

/// Beside faces other than quads, the edge points of the first level differ, which is why Catmull-Clark has an operator
/// of its own.
#[test]
fn catmull_clark_is_not_push_back_beside_triangles() {
    let [a, b] = [catmull_clark("edge-only"), catmull_clark_as_push_back("edge-only")]
        .map(|plan| refined_mesh(&nets::prism(3), &plan, 1));
    let vertices_and_faces = |net: &Net| [&net.positions[..6], &net.positions[15..]].concat();
    for (p, q) in vertices_and_faces(&a).iter().zip(&vertices_and_faces(&b)) {
        assert!(distance(p, q) <= TOLERANCE, "{p:?} and {q:?}");
    }
    let differences = a.positions[6..15].iter().zip(&b.positions[6..15]).map(|(p, q)| distance(p, q));
    assert!(differences.fold(0.0, f64::max) > 1e-3);
}

/// In the middle of a grid, push-back with delta 0 is the tensor product of the curve scheme.
#[test]
fn regular_regions_are_tensor_products() {
    let (n, half) = (9_usize, 8_usize);
    let net = nets::grid(n - 1, n - 1);
    for plan in [word("UC"), static_word("UC"), semi_stationary("UCC", "pi/3", 0.0)] {
        let fine = refined_mesh(&net, &plan, 1);
        let row = |points: &[[f64; 3]]| super::refined(points, true, &plan, 1);
        // refine the rows, then the columns; the seam of the closed curves is outside the compared part
        let rows: Vec<Vec<[f64; 3]>> = net.positions.chunks(n).map(row).collect();
        let column = |i: usize| super::refined(&rows.iter().map(|row| row[i]).collect::<Vec<_>>(), true, &plan, 1);
        let expected: Vec<[f64; 3]> = (6..=10).flat_map(|i| column(i)[6..=10].to_vec()).collect();
        let near = |p: &[f64; 3]| fine.positions.iter().any(|q| distance(p, q) <= TOLERANCE);
        assert_eq!(expected.len(), 25);
        assert!(expected.iter().all(near), "{plan}, {half} faces a side");
    }
}

#[test]
fn delta_one_interpolates_on_meshes() {
    let plans =
        [word("UCP"), word("UCCP"), semi_stationary("UCP", "pi/6", 1.0), with_boundary(word("UCP"), "edge-only")];
    for net in [nets::cube(), nets::tetrahedron(), nets::mixed(), nets::prism(5), nets::grid(2, 3)] {
        for plan in &plans {
            let fine = refined_mesh(&net, plan, 2);
            for (p, q) in net.positions.iter().zip(&fine.positions) {
                assert!(distance(p, q) <= TOLERANCE, "{plan}: {p:?} moved to {q:?}");
            }
        }
    }
}

#[test]
fn corners_of_meshes_stay_exactly() {
    for plan in mesh_plans() {
        let mut mesh = nets::mixed().to_json();
        mesh["corners"] = json!([{ "vertex": 1, "sharpness": 10 }, { "vertex": 7, "sharpness": 1e300 }]);
        let result = support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 3 }));
        let fine = Net::of(&result);
        for corner in [1, 7] {
            assert_eq!(fine.positions.get(corner), nets::mixed().positions.get(corner), "{plan}");
        }
    }
}

#[test]
fn vertices_with_one_face_stay_unless_boundaries_are_edge_only() {
    let net = nets::grid(2, 2);
    for plan in [word("UC"), word("UCP"), catmull_clark("edge-only"), static_word("UCCP")] {
        let kept = refined_mesh(&net, &with_boundary(plan.clone(), "edge-and-corner"), 2);
        let smooth = refined_mesh(&net, &with_boundary(plan.clone(), "edge-only"), 2);
        for corner in [0, 2, 6, 8] {
            assert_eq!(kept.positions.get(corner), net.positions.get(corner), "{plan}");
            if plan["word"] != "UCP" {
                assert!(distance(&smooth.positions[corner], &net.positions[corner]) > 1e-3, "{plan}");
            }
        }
    }
}

/// A boundary is the curve of the curve scheme for the boundary polygon.
#[test]
fn boundaries_follow_the_curve_scheme() {
    let net = nets::mixed();
    let rim = [0, 1, 5, 6, 7, 2, 3, 4].map(|v: usize| net.positions[v]);
    for plan in [word("UC"), static_word("UCP"), semi_stationary("UCCP", "1", 0.5)] {
        let surface = refined_mesh(&net, &with_boundary(plan.clone(), "edge-only"), 3);
        for p in super::refined(&rim, true, &plan, 3) {
            assert!(surface.positions.iter().any(|q| distance(&p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
        }
    }
}

#[test]
fn holes_change_what_is_shown_and_nothing_else() {
    for plan in mesh_plans() {
        let mut mesh = nets::mixed().to_json();
        let whole = Net::of(&support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 2 })));
        mesh["holes"] = json!([1]);
        let shown = Net::of(&support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 2 })));
        assert_eq!(shown.positions, whole.positions, "{plan}");
        // the quad becomes 16 faces, the triangle 12, the pentagon 20, if a level splits
        let splits = plan["word"].as_str() != Some("C");
        let hidden = if !splits {
            1..2
        } else if plan["word"] == "U(UCP)" {
            64..112
        } else {
            16..28
        };
        let rest: Vec<_> = whole.faces[..hidden.start].iter().chain(&whole.faces[hidden.end..]).cloned().collect();
        assert_eq!(shown.faces, rest, "{plan}");
    }
}

#[test]
fn boundary_none_hides_the_faces_that_touch_the_boundary() {
    let net = nets::grid(4, 3);
    let all = refined_mesh(&net, &catmull_clark("edge-only"), 2);
    let shown = refined_mesh(&net, &catmull_clark("none"), 2);
    assert_eq!(shown.positions, all.positions);
    let inner = [5, 6].map(|f| all.faces[16 * f..16 * f + 16].to_vec()).concat();
    assert_eq!(shown.faces, inner);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn where_a_face_starts_does_not_matter(
        net in distinct_manifold(),
        turns in proptest::collection::vec(0..7_usize, 64),
    ) {
        let mut turned = net.clone();
        for (face, turn) in turned.faces.iter_mut().zip(turns.iter().cycle()) {
            let by = turn % face.len();
            face.rotate_left(by);
        }
        for plan in mesh_plans() {
            let (a, b) = (refined_mesh(&net, &plan, 2), refined_mesh(&turned, &plan, 2));
            prop_assert_eq!(same_surface(&a, &b, TOLERANCE), Ok(()), "{}", plan);
        }
    }

    #[test]
    fn renumbering_the_vertices_renumbers_their_images(net in nets::manifold(), seed in any::<u64>()) {
        let n = net.positions.len();
        let mut image: Vec<usize> = (0..n).collect();
        image.sort_by_key(|&v| (v as u64 + 1).wrapping_mul(seed | 1).rotate_left(29));
        let mut renamed = net.clone();
        for (v, &to) in image.iter().enumerate() {
            renamed.positions[to] = net.positions[v];
        }
        renamed.faces.iter_mut().flatten().for_each(|v| *v = image[*v]);
        for plan in mesh_plans() {
            let (a, b) = (refined_mesh(&net, &plan, 2), refined_mesh(&renamed, &plan, 2));
            for (v, &to) in image.iter().enumerate() {
                prop_assert_eq!(a.positions.get(v), b.positions.get(to), "{}", plan);
            }
            prop_assert_eq!(&a.positions[n..], &b.positions[n..], "{}", plan);
        }
    }

    #[test]
    fn levels_of_meshes_add_up(net in distinct_manifold()) {
        for plan in [word("UC"), static_word("UCP"), catmull_clark("edge-only"), catmull_clark("edge-and-corner")] {
            let halfway = refined_mesh(&net, &plan, 1);
            let (there, whole) = (refined_mesh(&halfway, &plan, 1), refined_mesh(&net, &plan, 2));
            prop_assert_eq!(same_surface(&there, &whole, TOLERANCE), Ok(()), "{}", plan);
        }
    }
}

/// Returns meshes with distinct refined points, so that points can be matched by position.
fn distinct_manifold() -> impl Strategy<Value = Net> {
    let scattered = nets::manifold().prop_map(|mut net| {
        for (i, p) in (0_u32..).zip(&mut net.positions) {
            p.iter_mut().zip([0.37, 0.73, 1.19]).for_each(|(x, step)| *x += step * f64::from(i * i % 31));
        }
        net
    });
    scattered.prop_filter("points too close to be told apart", |net| {
        mesh_plans().iter().all(|plan| apart(&refined_mesh(net, plan, 2).positions))
    })
}

/// Whether any two points differ by much more than rounding.
fn apart(points: &[[f64; 3]]) -> bool {
    points.iter().enumerate().all(|(i, p)| points[..i].iter().all(|q| distance(p, q) > 1e-6))
}
