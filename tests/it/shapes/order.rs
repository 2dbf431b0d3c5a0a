//! The documented order of refined meshes, on the preset bilinear and words over U, where every point has a closed
//! form.
//!
//! With n pieces per edge, 2^levels for bilinear: the input's vertices; then by input edge (numbered by first
//! appearance) its n - 1 inner points in the direction of that appearance; then by input face its inside: for a quad
//! the grid row by row, origin at corner 0, first axis towards corner 1; for another face the centre, the spokes from
//! each edge's midpoint to the centre, and the grids of the quads at its corners. Faces by input face, row by row.

use std::collections::BTreeSet;

use planish::job::Input;
use planish::math::functions::sqrt;
use planish::refine::{Points, RefinedMesh, act_on, mesh_net};
use planish::shape::source::{FaceChunk, MeshSource, OriginSource};
use planish::watch::Watch;
use serde_json::json;

use crate::support;
use crate::support::nets::{self, Net, distance};

pub(super) type Point = [f64; 3];

pub(super) fn mix(a: Point, b: Point, t: f64) -> Point {
    [0, 1, 2].map(|i| (1.0 - t) * a[i] + t * b[i])
}

/// Returns the point of the patch with these corners at `(u, v)`, u towards corner 1, v towards corner 3.
fn on_patch([a, b, c, d]: [Point; 4], u: f64, v: f64) -> Point {
    mix(mix(a, b, u), mix(d, c, u), v)
}

pub(super) fn fraction(i: usize, n: usize) -> f64 {
    f64::from(u32::try_from(i).expect("small")) / f64::from(u32::try_from(n).expect("small"))
}

fn centre(corners: &[Point]) -> Point {
    [0, 1, 2].map(|i| corners.iter().map(|p| p[i]).sum::<f64>() / fraction(corners.len(), 1))
}

/// Returns the patch at corner `j` of a face: corner, midpoint of the edge after it, centre, midpoint of the edge
/// before it.
fn part(corners: &[Point], j: usize) -> [Point; 4] {
    let n = corners.len();
    let middle = |j: usize| mix(corners[j % n], corners[(j + 1) % n], 0.5);
    [corners[j], middle(j), centre(corners), middle(j + n - 1)]
}

pub(super) fn corners(net: &Net, face: &[usize]) -> Vec<Point> {
    face.iter().map(|&v| net.positions[v]).collect()
}

/// Returns the input's vertices and the points on its edges.
pub(super) fn expected_on_edges(net: &Net, n: usize) -> Vec<Point> {
    let mut positions = net.positions.clone();
    let mut seen = BTreeSet::new();
    for face in &net.faces {
        for j in 0..face.len() {
            let (a, b) = (face[j], face[(j + 1) % face.len()]);
            if seen.insert((a.min(b), a.max(b))) {
                positions.extend((1..n).map(|i| mix(net.positions[a], net.positions[b], fraction(i, n))));
            }
        }
    }
    positions
}

/// Returns the positions in the documented order.
fn expected_positions(net: &Net, n: usize) -> Vec<Point> {
    let mut positions = expected_on_edges(net, n);
    for face in net.faces.iter().filter(|_| n > 1) {
        let corners = corners(net, face);
        if let Ok(patch) = <[Point; 4]>::try_from(corners.clone()) {
            positions.extend(inside(patch, n));
        } else {
            positions.push(centre(&corners));
            for j in 0..corners.len() {
                let middle = part(&corners, j)[1];
                positions.extend((1..n / 2).map(|i| mix(middle, centre(&corners), fraction(i, n / 2))));
            }
            positions.extend((0..corners.len()).flat_map(|j| inside(part(&corners, j), n / 2)));
        }
    }
    positions
}

/// Returns the inner points of a patch with `n` cells per side, row by row.
fn inside(patch: [Point; 4], n: usize) -> Vec<Point> {
    let places = (1..n).flat_map(|j| (1..n).map(move |i| (i, j)));
    places.map(|(i, j)| on_patch(patch, fraction(i, n), fraction(j, n))).collect()
}

/// Returns the corners of the faces in the documented order.
fn expected_faces(net: &Net, n: usize) -> Vec<Vec<Point>> {
    if n == 1 {
        return net.faces.iter().map(|face| corners(net, face)).collect();
    }
    net.faces
        .iter()
        .flat_map(|face| {
            let corners = corners(net, face);
            match <[Point; 4]>::try_from(corners.clone()) {
                Ok(patch) => cells(patch, n),
                Err(_) => (0..corners.len()).flat_map(|j| cells(part(&corners, j), n / 2)).collect(),
            }
        })
        .collect()
}

/// Returns the corners of the cells of a patch with `n` cells per side, row by row.
fn cells(patch: [Point; 4], n: usize) -> Vec<Vec<Point>> {
    let cell = |i: usize, j: usize| {
        let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        around.map(|(i, j)| on_patch(patch, fraction(i, n), fraction(j, n))).to_vec()
    };
    (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| cell(i, j)).collect()
}

fn check(net: &Net) {
    for levels in 0..=4 {
        let job = json!({ "input": net.input(), "plan": { "preset": "bilinear" }, "levels": levels });
        check_job(job, &expected_positions(net, 1 << levels), &expected_faces(net, 1 << levels));
    }
}

/// Checks that the result of a job has these positions, and faces with these corners, in this order.
pub(super) fn check_job(job: serde_json::Value, positions: &[Point], faces: &[Vec<Point>]) {
    let what = format!("{} {}", job["plan"], job["levels"]);
    let found = Net::of(&support::json(job));
    assert_eq!(found.positions.len(), positions.len(), "{what}");
    for (v, (p, q)) in found.positions.iter().zip(positions).enumerate() {
        assert!(distance(p, q) < 1e-12, "{what}: vertex {v} is {p:?}, not {q:?}");
    }
    assert_eq!(found.faces.len(), faces.len(), "{what}");
    for (f, (face, expected)) in found.faces.iter().zip(faces).enumerate() {
        assert_eq!(face.len(), expected.len(), "{what}: face {f}");
        for (v, q) in face.iter().zip(expected) {
            let p = found.positions[*v];
            assert!(distance(&p, q) < 1e-12, "{what}: face {f} has {p:?}, not {q:?}");
        }
    }
}

/// Words over U with the number of pieces of an edge after the prefix, and the factor of each level.
const WORDS: &[(&str, usize, usize)] = &[
    ("U3", 1, 3),
    ("U4", 1, 4),
    ("U5", 1, 5),
    ("U2U3", 1, 6),
    ("U3U2", 1, 6),
    ("U3(U2)", 3, 2),
    ("U2(U4)", 2, 4),
    ("U2U2(U3)", 4, 3),
];

/// Returns each word with levels, and the number of pieces of an edge after them.
pub(super) fn applications() -> impl Iterator<Item = (&'static str, u32, usize)> {
    let levels = |&(word, start, each): &(&'static str, usize, usize)| {
        (0..4).map(move |levels| (word, levels, (0..levels).fold(start, |n, _| n * each)))
    };
    WORDS.iter().flat_map(levels).filter(|&(_, _, n)| n <= 27)
}

#[test]
fn splits_of_any_arity_come_out_in_the_documented_order() {
    for net in [nets::cube(), nets::grid(2, 1), nets::torus(3, 3), nets::mixed(), nets::prism(5)].map(scattered) {
        let quads = net.faces.iter().all(|face| face.len() == 4);
        for (word, levels, n) in applications() {
            // other faces are first split into quads
            let halved = !quads && n > 1 && !word.starts_with("U2");
            let n = if halved { 2 * n } else { n };
            let job = json!({ "input": net.input(), "plan": { "word": word }, "levels": levels });
            check_job(job, &expected_positions(&net, n), &expected_faces(&net, n));
        }
    }
}

/// Returns the net with scattered vertices, so that no two refined points coincide.
pub(super) fn scattered(net: Net) -> Net {
    let irrational = |i: usize, k: u32| (sqrt(f64::from(k)) * fraction(3 * i + 1, 1)).fract() * 4.0;
    let positions = (0..net.positions.len()).map(|i| [irrational(i, 2), irrational(i, 3), irrational(i, 5)]).collect();
    Net { positions, ..net }
}

#[test]
fn an_open_mixed_mesh_comes_out_in_the_documented_order() {
    check(&scattered(nets::mixed()));
}

#[test]
fn quad_meshes_come_out_in_the_documented_order() {
    check(&scattered(nets::cube()));
    check(&scattered(nets::grid(3, 2)));
    check(&scattered(nets::torus(3, 3)));
}

#[test]
fn polyhedra_come_out_in_the_documented_order() {
    check(&scattered(nets::tetrahedron()));
    check(&scattered(nets::prism(5)));
    check(&scattered(nets::prism(6)));
}

#[test]
fn isolated_vertices_take_part_in_the_order() {
    let mut net = nets::mixed();
    net.positions.push([0.0; 3]);
    check(&scattered(net));
}

/// For every scheme, the order is that of bilinear: faces and counts agree, and only positions differ.
#[test]
fn all_schemes_that_split_share_the_order() {
    for net in [nets::mixed(), nets::prism(5), nets::cube()] {
        for levels in 0..=3 {
            let of = |plan: &serde_json::Value| {
                Net::of(&support::json(json!({ "input": net.input(), "plan": plan, "levels": levels })))
            };
            let bilinear = of(&json!({ "preset": "bilinear" }));
            for plan in [json!({ "preset": "catmull-clark" }), json!({ "word": "UCP" }), json!({ "word": "UCC" })] {
                let other = of(&plan);
                assert_eq!(other.faces, bilinear.faces, "{plan}");
                assert_eq!(other.positions.len(), bilinear.positions.len(), "{plan}");
            }
        }
    }
}

#[test]
fn a_mesh_handed_over_in_the_documented_order_is_the_one_that_would_be_gathered() {
    for plan in [json!({ "preset": "catmull-clark" }), json!({ "word": "UU3C" })] {
        let text =
            json!({ "input": nets::prism(5).input(), "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
        let job = support::parsed(text.to_string().as_bytes()).expect("a valid job");
        let Input::Mesh(mesh) = &*job.input else { unreachable!("the input is a mesh") };
        let (steps, points) = (job.plan.schedule(2).expect("no functions"), Points::new(mesh.positions.clone(), 3));
        let refined = act_on(mesh_net(mesh, &job.plan), vec![points], &job.plan, &steps, &Watch::new());
        let (mut net, points) = refined.expect("a plan for any mesh");
        let gathered = RefinedMesh::new(&net, points[0].now.clone().into());
        // the documented order does not require the topology before the last split
        net.mesh.parent = Some(net.mesh.base.clone());
        let documented = RefinedMesh::documented(&net, gathered.all_positions().into_flattened().into());
        assert_eq!(documented.all_positions(), gathered.all_positions());
        let faces = |mesh: &RefinedMesh| {
            let mut faces = FaceChunk::default();
            mesh.faces(0..mesh.n_faces(), &mut faces);
            faces
        };
        assert_eq!(faces(&documented), faces(&gathered));
        let origins = |mesh: &RefinedMesh| (0..mesh.n_vertices()).map(|v| mesh.vertex_origin(v)).collect::<Vec<_>>();
        assert_eq!(origins(&documented), origins(&gathered));
    }
}
