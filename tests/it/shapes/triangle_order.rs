//! The documented order of split triangle meshes, on words over U with `split: triangle`, where every point has a
//! closed form.
//!
//! With n pieces per edge: the input's vertices; then by input edge (numbered by first appearance) its n - 1 inner
//! points in the direction of that appearance; then by input face its (n - 1)(n - 2)/2 inner points, row by row, origin
//! at corner 0, first axis towards corner 1. Faces by input face, row by row, upward and downward ones from left to
//! right.

use serde_json::json;

use super::order::{Point, applications, check_job, corners, expected_on_edges, fraction, scattered};
use crate::support;
use crate::support::nets::{self, Net};

/// Returns the point `i` of `n` steps towards corner 1 and `j` towards corner 2.
fn on_triangle(corners: &[Point], i: usize, j: usize, n: usize) -> Point {
    let [u, v] = [fraction(i, n), fraction(j, n)];
    [0, 1, 2].map(|k| (1.0 - u - v) * corners[0][k] + u * corners[1][k] + v * corners[2][k])
}

fn expected_positions(net: &Net, n: usize) -> Vec<Point> {
    let mut positions = expected_on_edges(net, n);
    for face in &net.faces {
        let corners = corners(net, face);
        for j in 1..n {
            positions.extend((1..n - j).map(|i| on_triangle(&corners, i, j, n)));
        }
    }
    positions
}

fn expected_faces(net: &Net, n: usize) -> Vec<Vec<Point>> {
    let mut faces = Vec::new();
    for face in &net.faces {
        let corners = corners(net, face);
        let at = |places: [(usize, usize); 3]| places.map(|(i, j)| on_triangle(&corners, i, j, n)).to_vec();
        for j in 0..n {
            for i in 0..n - j {
                faces.push(at([(i, j), (i + 1, j), (i, j + 1)]));
                if i + j + 1 < n {
                    faces.push(at([(i + 1, j + 1), (i, j + 1), (i + 1, j)]));
                }
            }
        }
    }
    faces
}

fn check(net: &Net) {
    let powers = (0..6).map(|levels| ("U", levels, 1_usize << levels));
    for (word, levels, n) in powers.chain(applications()) {
        let plan = json!({ "word": word, "parameters": { "split": "triangle" } });
        let job = json!({ "input": net.input(), "plan": plan, "levels": levels });
        check_job(job, &expected_positions(net, n), &expected_faces(net, n));
    }
}

#[test]
fn closed_triangle_meshes_come_out_in_the_documented_order() {
    check(&scattered(nets::tetrahedron()));
    check(&scattered(nets::triangulated(nets::torus(3, 3))));
}

#[test]
fn open_triangle_meshes_come_out_in_the_documented_order() {
    check(&scattered(nets::triangulated(nets::grid(2, 2))));
    check(&scattered(Net { faces: vec![vec![2, 0, 1]], ..nets::tetrahedron() }));
}

#[test]
fn isolated_vertices_take_part_in_the_order() {
    let mut net = nets::triangulated(nets::grid(1, 1));
    net.positions.push([0.0; 3]);
    check(&scattered(net));
}

/// For every scheme, the order is that of U: faces and counts agree, and only positions differ.
#[test]
fn all_schemes_that_split_triangles_share_the_order() {
    for net in [nets::tetrahedron(), nets::triangulated(nets::grid(2, 1))] {
        for levels in 0..=3 {
            let of = |plan: serde_json::Value| {
                Net::of(&support::json(json!({ "input": net.input(), "plan": plan, "levels": levels })))
            };
            let word = |word: &str| json!({ "word": word, "parameters": { "split": "triangle" } });
            let linear = of(word("U"));
            for plan in [json!({ "preset": "loop" }), word("UC"), word("UCP")] {
                let other = of(plan.clone());
                assert_eq!(other.faces, linear.faces, "{plan}");
                assert_eq!(other.positions.len(), linear.positions.len(), "{plan}");
            }
        }
    }
}
