//! Tests that the least disc around a vertex with many faces is found without all walks, and that masks do not depend
//! on the order of requests.

use super::disc::{Centre, Located, RingCount};
use super::mask::{Finder, Masks};
use super::mesh::scheduled;
use super::on_net::CycleOnNet;
use super::regular::Starts;
use super::vertex_parameters::CommonParameters;
use super::walk::WholeNet;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::scheme::presets::PRESETS;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::topology::{Topology, index};
use crate::watch::Watch;

/// Returns a net of faces of these sizes around vertex 0.
fn around(sizes: &[u32]) -> MeshNet {
    let n = index(sizes.len());
    let mut faces = FaceList::default();
    let mut vertices = n + 1;
    for (i, &size) in (0..n).zip(sizes) {
        let between = vertices..vertices + size - 3;
        vertices = between.end;
        faces.push([0, 1 + i].into_iter().chain(between).chain([1 + (i + 1) % n]));
    }
    let checked = Topology::of_faces(vertices as usize, faces, Winding::Refuse).expect("a fan is a manifold");
    MeshNet::new(checked.topology.into(), &[], &[], Boundary::EdgeOnly)
}

/// Returns the least of the discs of all starts, the first of equal ones.
fn least_of_all(whole: &WholeNet<'_>, centre: Centre, rings: RingCount) -> Option<Located> {
    let walks = whole.starts(centre).enumerate();
    let found =
        walks.map(|(rotation, start)| Located { rotation, ..whole.walk(centre, start, rings).expect("a small disc") });
    found.reduce(|least, found| if found.disc < least.disc { found } else { least })
}

#[test]
fn the_least_disc_is_that_of_all_starts_whatever_comes_again_around_a_vertex() {
    let units: [&[u32]; 8] =
        [&[3], &[4], &[4, 3], &[3, 4], &[4, 4, 3], &[5, 3, 4, 3], &[3, 3, 4, 3, 4], &[4, 3, 3, 4, 3, 5]];
    let rings = RingCount { support: 1, disc: 1 };
    for (unit, times) in units.into_iter().flat_map(|unit| (1..=6).map(move |times| (unit, times))) {
        for odd in [None, Some(5)] {
            let sizes: Vec<u32> = unit.iter().copied().cycle().take(unit.len() * times).chain(odd).collect();
            if sizes.len() < 3 {
                continue;
            }
            let net = around(&sizes);
            let whole = WholeNet::of(&net, &net.mesh.base);
            for centre in [Centre::Vertex(0), Centre::Face(0)] {
                let expected = least_of_all(&whole, centre, rings).expect("there is a face");
                let found = whole.least_disc(centre, rings, &Watch::new()).expect("nobody says stop");
                let found = found.expect("a small disc");
                let all = |found: Located| (found.disc, found.vertices, found.half_edges, found.rotation);
                assert_eq!(all(found), all(expected), "{sizes:?} around {centre:?}");
            }
        }
    }
}

#[test]
fn a_vertex_that_looks_the_same_from_all_its_faces_takes_two_walks() {
    let net = around(&[3; 500]);
    let whole = WholeNet::of(&net, &net.mesh.base);
    let watch = Watch::new();
    let found =
        whole.least_disc(Centre::Vertex(0), RingCount { support: 1, disc: 1 }, &watch).expect("nobody says stop");
    assert_eq!(found.map(|found| found.rotation), Some(0));
    assert!(watch.done() <= 2 * 501, "{} rows", watch.done());
}

/// Compares the masks of the discs that levels make around a vertex; returns their number, or `None` without a limit.
fn compared(plan: &Plan, net: &MeshNet) -> Option<usize> {
    let (steps, at) = scheduled(plan, 0).ok()?;
    let topology = net.mesh.topology();
    let on_net = CycleOnNet::of(plan, net, &topology, &steps[at..], &Watch::new()).ok()?;
    let rings = on_net.rings(Starts { is_open: true, others: false }).ok()?;
    let finder = Finder::new(&on_net.cycle, rings, false);
    let mut discs = vec![WholeNet::of(net, &topology).disc(Centre::Vertex(1), rings)?.disc];
    while discs.len() < 8 {
        let next = on_net.cycle.step(on_net.cycle.settled, discs.last()?, rings).ok()?;
        discs.push(next.disc);
    }
    let of = |masks: &Masks<'_>, disc| masks.of(usize::MAX, disc).ok();
    for first in &discs {
        let masks = Masks::new(&finder, CommonParameters::default());
        of(&masks, first)?;
        for disc in &discs {
            let alone = of(&Masks::new(&finder, CommonParameters::default()), disc);
            assert_eq!(of(&masks, disc), alone, "{plan:?}");
        }
    }
    Some(discs.len() * discs.len())
}

/// Some schemes turn the surroundings of a vertex at each level, so that its disc recurs after two levels.
#[test]
fn masks_are_the_same_whichever_is_asked_for_first() {
    let mut n_compared = 0;
    for preset in PRESETS {
        let input = PlanInput { preset: Some(preset.name.to_owned()), ..PlanInput::default() };
        let subject = Subject { is_mesh: true, is_open: true, ..Subject::default() };
        let Ok(plan) = Plan::resolve(&input, subject) else { continue };
        for sizes in [[3; 5].as_slice(), &[3; 7], &[4; 3], &[4, 3, 4]] {
            n_compared += compared(&plan, &around(sizes)).unwrap_or_default();
        }
    }
    assert!(n_compared >= 1_000, "only {n_compared} masks");
}
