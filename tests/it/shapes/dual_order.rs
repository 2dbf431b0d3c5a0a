//! D on meshes: one vertex per face, with the face's number; one face per interior vertex, in the order of the
//! vertices, counter-clockwise from the lowest.

use proptest::prelude::*;
use serde_json::json;

use crate::support;
use crate::support::nets::{self, Net, distance};

/// Returns the dual, found by walking: the face after `f` around `v` is the one across the edge from `v` to its
/// predecessor.
fn dual(net: &Net) -> Net {
    let centre = |face: &Vec<usize>| {
        let n = f64::from(u32::try_from(face.len()).expect("small"));
        [0, 1, 2].map(|i| face.iter().map(|&v| net.positions[v][i]).sum::<f64>() / n)
    };
    let after = |f: usize, v: usize| {
        let face = &net.faces[f];
        let at = face.iter().position(|u| *u == v)?;
        let before = face[(at + face.len() - 1) % face.len()];
        net.faces.iter().position(|g| (0..g.len()).any(|j| g[j] == v && g[(j + 1) % g.len()] == before))
    };
    let mut faces = Vec::new();
    for v in 0..net.positions.len() {
        let Some(lowest) = net.faces.iter().position(|face| face.contains(&v)) else { continue };
        let mut cycle = vec![lowest];
        let closed = loop {
            match after(cycle[cycle.len() - 1], v) {
                None => break false,
                Some(f) if f == lowest => break true,
                Some(f) => cycle.push(f),
            }
        };
        if closed && cycle.len() > 2 {
            faces.push(cycle);
        }
    }
    Net { positions: net.faces.iter().map(centre).collect(), faces }
}

fn refined(net: &Net, word: &str, levels: u32) -> Net {
    Net::of(&support::json(json!({ "input": net.input(), "plan": { "word": word }, "levels": levels })))
}

fn check(found: &Net, expected: &Net, what: &str) {
    assert_eq!(found.faces, expected.faces, "{what}");
    assert_eq!(found.positions.len(), expected.positions.len(), "{what}");
    for (p, q) in found.positions.iter().zip(&expected.positions) {
        assert!(distance(p, q) < 1e-13, "{what}: {p:?} is not {q:?}");
    }
}

#[test]
fn the_dual_of_a_cube_is_an_octahedron() {
    let net = nets::cube();
    let found = refined(&net, "D", 1);
    check(&found, &dual(&net), "cube");
    assert_eq!(found.faces.iter().map(Vec::len).collect::<Vec<_>>(), [3; 8]);
    assert_eq!(found.faces[0], [0, 2, 4], "counter-clockwise around vertex 0, from the lowest face");
}

#[test]
fn duals_keep_the_numbers_of_faces_and_the_order_of_vertices() {
    for net in [nets::cube(), nets::tetrahedron(), nets::torus(4, 3), nets::prism(5), nets::grid(4, 3)] {
        check(&refined(&net, "D", 1), &dual(&net), "D");
        check(&refined(&net, "UD", 1), &dual(&refined(&net, "U", 1)), "UD");
        check(&refined(&net, "UUD", 1), &dual(&refined(&net, "UU", 1)), "UUD");
        let once = refined(&net, "UD", 1);
        check(&refined(&net, "UD", 2), &dual(&refined(&once, "U", 1)), "UD twice");
    }
}

#[test]
fn two_duals_of_a_closed_mesh_have_its_connectivity() {
    for net in [nets::cube(), nets::torus(4, 3), nets::prism(5)] {
        let twice = refined(&net, "UDD", 1);
        let once = refined(&net, "UC", 1);
        assert_eq!(twice.positions.len(), once.positions.len());
        assert_eq!(twice.faces.len(), once.faces.len());
        check(&twice, &dual(&dual(&refined(&net, "U", 1))), "UDD");
        // if all faces are quads, the mean of the means is the mean of the loop centres
        for (p, q) in twice.positions.iter().zip(&once.positions) {
            assert!(distance(p, q) < 1e-13, "{p:?} is not {q:?}");
        }
    }
}

#[test]
fn boundary_vertices_make_no_face() {
    let found = refined(&nets::grid(3, 2), "D", 1);
    assert_eq!(found.faces, [[0, 1, 4, 3], [1, 2, 5, 4]]);
    assert_eq!(found.positions.len(), 6);
    let faults = support::faults(json!({ "input": nets::grid(1, 1).input(), "plan": { "word": "D" }, "levels": 1 }));
    assert_eq!(faults[0].pointer, "/plan");
    assert!(faults[0].detail.contains("D needs a vertex all of whose faces meet in a full ring"), "{faults:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_dual_of_a_split_mesh_is_what_walking_finds(net in nets::manifold()) {
        let split = refined(&net, "U", 1);
        let expected = dual(&split);
        prop_assume!(!expected.faces.is_empty());
        let result = support::json(json!({ "input": net.input(), "plan": { "word": "UD" }, "levels": 1 }));
        let found = Net::of(&result);
        let (own, split_off) = found.positions.split_at(expected.positions.len());
        for (p, q) in own.iter().zip(&expected.positions) {
            prop_assert!(distance(p, q) < 1e-13, "{:?} is not {:?}", p, q);
        }
        prop_assert_eq!(found.faces.len(), expected.faces.len());
        for (face, expected) in found.faces.iter().zip(&expected.faces) {
            prop_assert_eq!(face.len(), expected.len());
            for (&v, &number) in face.iter().zip(expected) {
                // where fans of the dual met in a vertex, all but one got a copy
                let copied = v >= own.len() && split_off.get(v - own.len()) == own.get(number);
                prop_assert!(v == number || copied, "{} is not {}", v, number);
            }
        }
    }
}
