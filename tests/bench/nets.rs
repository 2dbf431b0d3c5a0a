//! The nets that are measured.

use planish::fault::Fault;
use planish::math::parameter::Literal;
use planish::refine::{RefinedMesh, refine_mesh};
use planish::scheme::plan::{Plan, PlanInput, Scheduled, Subject};
use planish::shape::check::FaceList;
use planish::shape::mesh::{Mesh, MeshInput};
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
