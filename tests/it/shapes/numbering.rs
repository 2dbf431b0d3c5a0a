//! Parts of nets know the numbers of their vertices, edges and faces in whole nets that are refined along with them.

use planish::shape::check::{FaceList, Winding};
use planish::shape::numbering::Numbering;
use planish::shape::topology::Topology;
use proptest::prelude::*;

use crate::support::nets::{self, Net};

fn number(v: u32) -> u64 {
    v.into()
}

fn topology(net: &Net) -> Topology {
    let mut faces = FaceList::default();
    net.faces.iter().for_each(|face| faces.push(face.iter().map(|&v| u32::try_from(v).expect("small"))));
    Topology::of_faces(net.positions.len(), faces, Winding::Repair).expect("nets are manifolds").topology
}

/// Returns some faces of a topology as a separate topology, in another order and from other corners, with their
/// numbers.
fn part(topology: &Topology, numbering: &Numbering, choices: &[u8]) -> (Topology, Numbering) {
    let choice = |f: usize| usize::from(choices[f % choices.len()]) + f / choices.len();
    let mut chosen: Vec<usize> = (0..topology.n_faces()).filter(|&f| f == 0 || choice(f) % 3 > 0).collect();
    chosen.sort_by_key(|&f| (choice(f) % 7, f));
    let (mut vertices, mut corners, mut faces) = (Vec::new(), Vec::new(), FaceList::default());
    for f in chosen {
        let mut face = topology.face(f).to_vec();
        let turn = choice(f) % face.len();
        face.rotate_left(turn);
        corners.push(topology.half_edges(f).start + u32::try_from(turn).expect("small"));
        let local = face.iter().map(|v| {
            let at = vertices.iter().position(|known| known == v).unwrap_or(vertices.len());
            if at == vertices.len() {
                vertices.push(*v);
            }
            u32::try_from(at).expect("small")
        });
        faces.push(local.collect::<Vec<_>>());
    }
    let n = u32::try_from(vertices.len()).expect("small");
    let checked = Topology::of_faces(vertices.len(), faces, Winding::Refuse).expect("a part is a manifold");
    let origins: Vec<u32> = (0..n).chain(checked.split_from).collect();
    (checked.topology, numbering.of_submesh(topology, &vertices, &corners).with_origins(&origins))
}

/// Compares the elements of the part with those that have their numbers in the whole.
fn check(whole: &Topology, part: &Topology, numbering: &Numbering) -> Result<(), TestCaseError> {
    let small = |number: u64| usize::try_from(number).expect("small");
    for f in 0..part.n_faces() {
        let there: Vec<u64> = whole.face(small(numbering.face(f))).iter().copied().map(number).collect();
        let mut here: Vec<u64> = part.face(f).iter().map(|&v| numbering.vertex(v as usize)).collect();
        let turn = here.iter().position(|v| *v == there[0]);
        prop_assert!(turn.is_some(), "face {}: {:?} is not {:?}", f, here, there);
        here.rotate_left(turn.unwrap_or(0));
        prop_assert_eq!(here, there, "face {}", f);
    }
    for e in 0..part.n_edges() {
        let mut there = whole.ends(small(numbering.edge(part, e))).map(number);
        let mut here = part.ends(e).map(|v| numbering.vertex(v as usize));
        there.sort_unstable();
        here.sort_unstable();
        prop_assert_eq!(here, there, "edge {}", e);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn parts_know_their_numbers_in_whole_nets(
        net in nets::manifold(), choices in proptest::collection::vec(any::<u8>(), 40),
    ) {
        let mut whole = topology(&net);
        let (mut small, mut numbering) = part(&whole, &Numbering::of(&whole), &choices);
        for level in 0..4 {
            check(&whole, &small, &numbering)?;
            let (split, next) = (small.split(), numbering.split(&small));
            whole = whole.split();
            check(&whole, &split, &next)?;
            (small, numbering) = part(&split, &next, &choices[level..]);
        }
    }

    #[test]
    fn whole_nets_know_their_own_numbers(net in nets::manifold()) {
        let whole = topology(&net);
        prop_assert_eq!(Numbering::of(&whole).split(&whole), Numbering::of(&whole.split()));
    }
}
