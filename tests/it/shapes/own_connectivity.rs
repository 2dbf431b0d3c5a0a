//! Connectivities of Doo-Sabin and sqrt 3: their closed forms equal the topology of a face list of the same faces, in
//! the documented order.

use planish::shape::check::{FaceList, Winding};
use planish::shape::face_centre_split::BoundarySplit;
use planish::shape::topology::{NONE, Topology};
use proptest::prelude::*;

use crate::support::nets::{self, Net};

fn index(n: usize) -> u32 {
    u32::try_from(n).expect("a small net")
}

fn topology(net: &Net) -> Topology {
    let mut faces = FaceList::default();
    for face in &net.faces {
        faces.push(face.iter().map(|&v| index(v)));
    }
    Topology::of_faces(net.positions.len(), faces, Winding::Refuse).expect("a manifold").topology
}

fn faces(topology: &Topology) -> Vec<Vec<u32>> {
    (0..topology.n_faces()).map(|f| topology.face(f).to_vec()).collect()
}

/// Checks that every query agrees with the topology of the same faces; edges are compared by their ends.
fn check(found: &Topology) -> Result<(), TestCaseError> {
    let mut list = FaceList::default();
    (0..found.n_faces()).for_each(|f| list.push(found.face(f).iter().copied()));
    let built = Topology::of_faces(found.n_vertices(), list, Winding::Refuse);
    let checked = built.map_err(|faults| TestCaseError::fail(format!("{faults:?}")))?;
    prop_assert!(checked.split_from.is_empty(), "a vertex joins several fans");
    let expected = checked.topology;
    prop_assert_eq!(found.n_edges(), expected.n_edges());
    for corner in 0..index(found.n_half_edges()) {
        prop_assert_eq!(found.twin(corner), expected.twin(corner), "twin of {}", corner);
        prop_assert_eq!(found.next(corner), expected.next(corner));
        prop_assert_eq!(found.face_of(corner), expected.face_of(corner));
        let [first, second] = found.halves(found.edge(corner) as usize);
        prop_assert!(first == corner || second == corner);
    }
    for v in 0..found.n_vertices() {
        let boundary =
            |topology: &Topology| topology.boundary_edges(v).map(|edges| edges.map(|e| topology.halves(e as usize)[0]));
        prop_assert_eq!(boundary(found), boundary(&expected), "boundary at {}", v);
        let mut rings = [found, &expected].map(|topology| topology.ring(v).collect::<Vec<_>>());
        if boundary(found).is_none() {
            rings.iter_mut().for_each(|ring| ring.sort_unstable());
        }
        prop_assert_eq!(&rings[0], &rings[1], "ring of {}", v);
        prop_assert_eq!(found.is_isolated(v), expected.is_isolated(v));
    }
    Ok(())
}

fn euler(topology: &Topology) -> isize {
    let isolated = (0..topology.n_vertices()).filter(|&v| topology.is_isolated(v)).count();
    (topology.n_vertices() - isolated + topology.n_faces()).cast_signed() - topology.n_edges().cast_signed()
}

/// Whether no inner vertex has only two faces.
fn has_rings(topology: &Topology) -> bool {
    (0..topology.n_vertices()).all(|v| topology.boundary_edges(v).is_some() || topology.ring(v).count() != 2)
}

/// Returns the boundary vertices with one face.
fn lone(topology: &Topology) -> Vec<u32> {
    let lone = (0..topology.n_vertices()).filter(|&v| topology.boundary_edges(v).is_some());
    lone.filter(|&v| topology.ring(v).count() == 1).map(index).collect()
}

#[test]
fn cutting_a_square_gives_the_documented_order() {
    let square = topology(&nets::grid(1, 1));
    let cut = square.cut_corners_first(&[]).expect("a manifold");
    // vertices: 0 to 3 inside, then near the start and the end of the edges 0-1, 1-3, 3-2, 2-0
    let quads = [[0, 1, 2, 3], [0, 4, 5, 1], [1, 6, 7, 2], [2, 8, 9, 3], [3, 10, 11, 0]];
    let triangles = [[0, 11, 4], [1, 5, 6], [3, 9, 10], [2, 7, 8]];
    let expected: Vec<Vec<u32>> =
        quads.iter().map(|f| f.to_vec()).chain(triangles.iter().map(|f| f.to_vec())).collect();
    assert_eq!(faces(&cut), expected);
    let fixed = square.cut_corners_first(&[0, 1, 2, 3]).expect("a manifold");
    assert_eq!(faces(&fixed)[5..], [[0, 11, 12, 4], [1, 5, 13, 6], [3, 9, 14, 10], [2, 7, 15, 8]]);
}

#[test]
fn cutting_a_tetrahedron_gives_the_documented_order() {
    let cut = topology(&nets::tetrahedron()).cut_corners();
    assert_eq!(faces(&cut)[..4], [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]);
    // the edge from 0 to 2 of the first face is also in the last one, from 2 to 0
    assert_eq!(faces(&cut)[4], [0, 10, 9, 1]);
    assert_eq!(faces(&cut)[10], [0, 3, 10], "counter-clockwise around vertex 0");
    assert_eq!((cut.n_vertices(), cut.n_edges(), cut.n_faces()), (12, 24, 14));
}

#[test]
fn splitting_a_triangle_gives_the_documented_order() {
    let triangle = topology(&Net { positions: vec![[0.0; 3]; 3], faces: vec![vec![0, 1, 2]] });
    let once = triangle.split_at_face_centres(BoundarySplit::Whole);
    assert_eq!(faces(&once), [[0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let twice = once.split_at_face_centres(BoundarySplit::Thirds);
    // 4, 5, 6 next to the starts of the edges 0-1, 1-2, 2-0, then 7, 8, 9 next to their ends
    let expected = [[4, 7, 3], [1, 5, 7], [3, 9, 4], [5, 8, 3], [2, 6, 8], [3, 7, 5], [6, 9, 3], [0, 4, 9], [3, 8, 6]];
    assert_eq!(faces(&twice), expected);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn cut_corners_are_what_their_faces_say(net in nets::manifold(), keep in any::<bool>()) {
        let start = topology(&net);
        prop_assume!(has_rings(&start));
        let fixed = if keep { lone(&start) } else { Vec::new() };
        let mut cut = start.cut_corners_first(&fixed).expect("a manifold");
        check(&cut)?;
        prop_assert_eq!(euler(&cut), euler(&start));
        for _ in 0..2 {
            cut = cut.cut_corners();
            check(&cut)?;
            prop_assert_eq!(euler(&cut), euler(&start));
            // boundary vertices have two faces, except for the fixed corners
            prop_assert_eq!(lone(&cut).len(), fixed.len());
        }
    }

    #[test]
    fn sqrt_3_splits_are_what_their_faces_say(net in nets::triangles()) {
        let start = topology(&net);
        prop_assume!(has_rings(&start));
        let mut split = start.clone();
        for boundary in [BoundarySplit::Whole, BoundarySplit::Thirds, BoundarySplit::Whole, BoundarySplit::Thirds] {
            let before = split.n_boundary();
            split = split.split_at_face_centres(boundary);
            check(&split)?;
            prop_assert_eq!(euler(&split), euler(&start));
            prop_assert_eq!(split.n_boundary(), if boundary == BoundarySplit::Whole { before } else { 3 * before });
        }
        prop_assert!((0..split.n_edges()).all(|e| split.halves(e)[0] != NONE));
    }
}
