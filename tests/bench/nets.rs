//! The nets that are measured.

use planish::fault::Fault;
use planish::math::parameter::Literal;
use planish::refine::{RefinedMesh, refine_mesh};
use planish::scheme::plan::{Plan, PlanInput, Scheduled, Subject};
use planish::scheme::presets::PRESETS;
use planish::shape::check::FaceList;
use planish::shape::mesh::{Mesh, MeshInput};
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;

/// A cube of `6 n^2` quads, blown up to a sphere.
pub(crate) fn sphere(n: u32) -> Mesh {
    let mut net = Net::default();
    let lattice = |axis: usize, side: u32, i: u32, j: u32| {
        let mut at = [0; 3];
        at[axis] = side * n;
        at[(axis + 1) % 3] = if side == 1 { i } else { j };
        at[(axis + 2) % 3] = if side == 1 { j } else { i };
        at
    };
    for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let corners = around.map(|(i, j)| net.vertex(lattice(axis, side, i, j), n));
            net.faces.push(corners);
        }
    }
    Mesh::new(MeshInput { positions: net.positions, faces: net.faces, ..MeshInput::default() }).expect("a sound mesh")
}

/// The same with each quad cut into two triangles.
pub(crate) fn triangles(n: u32) -> Mesh {
    let quads = sphere(n);
    let mut faces = FaceList::default();
    for f in 0..quads.topology.n_faces() {
        if let &[a, b, c, d] = quads.topology.face(f) {
            faces.push([a, b, c]);
            faces.push([c, d, a]);
        }
    }
    let (positions, _) = quads.positions.as_chunks::<3>();
    Mesh::new(MeshInput { positions: positions.to_vec(), faces, ..MeshInput::default() }).expect("a sound mesh")
}

/// The sphere of quads with some cut into triangles, so that a third of all vertices are extraordinary, and with
/// creases along the edges of the cube, every other one for two and a half levels.
pub(crate) fn mixed(n: usize) -> Mesh {
    let quads = sphere(u32::try_from(n).expect("a coarse mesh"));
    let (topology, (positions, _)) = (&quads.topology, quads.positions.as_chunks::<3>());
    let mut faces = FaceList::default();
    for f in 0..topology.n_faces() {
        let (i, j) = (f % n, f / n % n);
        match *topology.face(f) {
            [a, b, c, d] if (i + 2 * j) % 6 == 0 => {
                [[a, b, c], [c, d, a]].into_iter().for_each(|face| faces.push(face));
            }
            ref face => faces.push(face.iter().copied()),
        }
    }
    // on the edges of the cube two coordinates are the largest
    let on_edge = |&v: &u32| {
        let sizes = positions[v as usize].map(f64::abs);
        let most = sizes.iter().fold(0.0, |most: f64, &x| most.max(x));
        sizes.iter().filter(|&&x| x > most - 1e-9).count() > 1
    };
    let sharp = (0..topology.n_edges()).map(|e| topology.ends(e)).filter(|ends| ends.iter().all(on_edge));
    let crease = |(i, ends): (usize, [u32; 2])| (ends.map(u64::from), if i % 2 == 0 { 2.5 } else { 10.0 });
    let creases = sharp.enumerate().map(crease).collect();
    Mesh::new(MeshInput { positions: positions.to_vec(), faces, creases, ..MeshInput::default() })
        .expect("a sound mesh")
}

/// A cube whose faces are cut into four triangles each, split `levels` times: `24 x 4^levels` triangles.
pub(crate) fn tetrakis(levels: u32) -> Mesh {
    let cube = sphere(1);
    let (positions, _) = cube.positions.as_chunks::<3>();
    let (mut positions, mut faces) = (positions.to_vec(), FaceList::default());
    for f in 0..cube.topology.n_faces() {
        let face = cube.topology.face(f);
        let middle = u32::try_from(positions.len()).expect("a small mesh");
        let mean = |axis: usize| face.iter().map(|&v| positions[v as usize][axis]).sum::<f64>() / 4.0;
        positions.push([0, 1, 2].map(mean));
        (0..4).for_each(|k| faces.push([face[k], face[(k + 1) % 4], middle]));
    }
    let coarse = Mesh::new(MeshInput { positions, faces, ..MeshInput::default() }).expect("a sound mesh");
    let (plan, steps) = plan_of(&coarse, "U", levels);
    let refined = refine_mesh(&coarse, &plan, &steps, &Watch::new()).expect("nobody stops it");
    let mut faces = FaceList::default();
    let mut all = FaceChunk::default();
    refined.faces(0..refined.n_faces(), &mut all);
    all.iter().for_each(|face| faces.push(face.iter().copied()));
    Mesh::new(MeshInput { positions: refined.all_positions(), faces, ..MeshInput::default() }).expect("a sound mesh")
}

/// A net in the making; vertices are places of a lattice.
#[derive(Default)]
struct Net {
    known: std::collections::HashMap<[u32; 3], u32>,
    positions: Vec<[f64; 3]>,
    faces: FaceList,
}

impl Net {
    fn vertex(&mut self, at: [u32; 3], n: u32) -> u32 {
        let next = u32::try_from(self.positions.len()).expect("a coarse mesh");
        *self.known.entry(at).or_insert_with(|| {
            let place = at.map(|x| 2.0 * f64::from(x) / f64::from(n) - 1.0);
            let length = place.iter().map(|x| x * x).sum::<f64>().sqrt();
            self.positions.push(place.map(|x| x / length));
            next
        })
    }
}

/// A preset, ready for closed meshes: its plan, and the steps of so many levels.
pub(crate) fn plan(preset: &str, parameters: &[(&str, &str)], levels: u32) -> (Plan, Vec<Scheduled>) {
    plan_for(Subject { is_mesh: true, ..Subject::default() }, preset, parameters, levels)
}

/// The plan that a mesh has under a preset, or under a word where there is no such preset, and the steps of so many
/// levels. Words over U alone split triangles into triangles.
pub(crate) fn plan_of(mesh: &Mesh, scheme: &str, levels: u32) -> (Plan, Vec<Scheduled>) {
    let is_word = !PRESETS.iter().any(|preset| preset.name == scheme);
    let split = is_word && mesh.topology.first_other_than_triangle().is_none();
    let input = PlanInput {
        preset: (!is_word).then(|| scheme.to_owned()),
        word: is_word.then(|| scheme.to_owned()),
        parameters: split.then(|| ("split".to_owned(), Literal::Text("triangle".to_owned()))).into_iter().collect(),
        ..PlanInput::default()
    };
    let creased = !mesh.creases.is_empty();
    let subject = Subject { is_mesh: true, creased, semi_sharp: creased.then_some("creases"), ..Subject::default() };
    let plan = Plan::resolve(&input, subject).expect("a plan for this mesh");
    let steps = plan.schedule(levels).expect("functions that are finite");
    (plan, steps)
}

/// The same for closed polygons.
pub(crate) fn curve_plan(preset: &str, parameters: &[(&str, &str)], levels: u32) -> (Plan, Vec<Scheduled>) {
    plan_for(Subject::default(), preset, parameters, levels)
}

fn plan_for(subject: Subject, preset: &str, parameters: &[(&str, &str)], levels: u32) -> (Plan, Vec<Scheduled>) {
    let literal = |value: &str| value.parse().map_or_else(|_| Literal::Text(value.to_owned()), Literal::Number);
    let text = |(name, value): &(&str, &str)| ((*name).to_owned(), literal(value));
    let input = PlanInput {
        preset: Some(preset.to_owned()),
        parameters: parameters.iter().map(text).collect(),
        ..PlanInput::default()
    };
    let plan: Result<Plan, Vec<Fault>> = Plan::resolve(&input, subject);
    let plan = plan.expect("a preset of the catalogue");
    let steps = plan.schedule(levels).expect("functions that are finite");
    (plan, steps)
}

/// A refined sphere of `6 n^2 x 4^levels` quads.
pub(crate) fn refined(n: u32, levels: u32) -> RefinedMesh {
    let (plan, steps) = plan("catmull-clark", &[], levels);
    refine_mesh(&sphere(n), &plan, &steps, &Watch::new()).expect("nobody stops it")
}
