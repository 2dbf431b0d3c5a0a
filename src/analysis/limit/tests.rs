//! Disces around vertices with many faces: the least one is found without all walks. Masks: whichever is asked for
//! first, they are the same.

use super::disc::{Centre, Located, Rings};
use super::mask::{Finder, Masks};
use super::mesh::scheduled;
use super::on_net::CycleOnNet;
use super::regular::Starts;
use super::vertex_parameters::CommonParameters;
use super::walk::WholeNet;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::topology::{Topology, index};
use crate::watch::Watch;

/// Faces of these sizes around vertex 0.
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

/// The least of the discs of all starts, the first of several.
fn least_of_all(whole: &WholeNet<'_>, centre: Centre, rings: Rings) -> Option<Located> {
    let walks = whole.starts(centre).enumerate();
    let found =
        walks.map(|(rotation, start)| Located { rotation, ..whole.walk(centre, start, rings).expect("a small disc") });
    found.reduce(|least, found| if found.disc < least.disc { found } else { least })
}

#[test]
fn the_least_disc_is_that_of_all_starts_whatever_comes_again_around_a_vertex() {
    let units: [&[u32]; 8] =
        [&[3], &[4], &[4, 3], &[3, 4], &[4, 4, 3], &[5, 3, 4, 3], &[3, 3, 4, 3, 4], &[4, 3, 3, 4, 3, 5]];
    let rings = Rings { support: 1, disc: 1 };
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
    let found = whole.least_disc(Centre::Vertex(0), Rings { support: 1, disc: 1 }, &watch).expect("nobody says stop");
    assert_eq!(found.map(|found| found.rotation), Some(0));
    assert!(watch.done() <= 2 * 501, "{} rows", watch.done());
}

/// The discs around vertices of sqrt 3 turn from level to level, so that some of them come again after two levels.
#[test]
fn masks_are_the_same_whichever_is_asked_for_first() {
    for (preset, sizes) in [("sqrt-3", [3; 5].as_slice()), ("sqrt-3", &[3; 7]), ("kobbelt", &[4, 3, 4])] {
        let net = around(sizes);
        let input = PlanInput { preset: Some(preset.to_owned()), ..PlanInput::default() };
        let plan =
            Plan::resolve(&input, Subject { is_mesh: true, is_open: true, ..Subject::default() }).expect("a preset");
        let (steps, at) = scheduled(&plan, 0).expect("no level is too many");
        let topology = net.mesh.topology();
        let on_net = CycleOnNet::of(&plan, &net, &topology, &steps[at..], &Watch::new()).expect("it has a limit");
        let rings = on_net.rings(Starts { is_open: true, others: false }).expect("few");
        let finder = Finder::new(&on_net.cycle, rings, false);
        let whole = WholeNet::of(&net, &topology);
        let mut discs = vec![whole.disc(Centre::Vertex(1), rings).expect("a small disc").disc];
        while discs.len() < 8 {
            let last = discs.last().expect("there is one");
            discs.push(on_net.cycle.step(on_net.cycle.settled, last, rings).expect("a level").disc);
        }
        let alone = |disc| Masks::new(&finder, CommonParameters::default()).of(usize::MAX, disc).expect("a limit");
        for first in &discs {
            let masks = Masks::new(&finder, CommonParameters::default());
            masks.of(usize::MAX, first).expect("a limit");
            for disc in &discs {
                assert_eq!(masks.of(usize::MAX, disc).expect("a limit"), alone(disc), "{preset} around {sizes:?}");
            }
        }
    }
}
