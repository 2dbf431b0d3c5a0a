//! The face points of Kobbelt's interpolating scheme, applied after its edge points.

use super::around;
use super::kobbelt_edges::opposite;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Nets, Operator, Role};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, Topology, index};

/// The face points of Kobbelt: the four-point rule across the face, from edge points to edge points, in the mean of its
/// directions: `F' = 1/n sum (E[j] + (E[j] - E*[j]) / 8)`, where `E*[j]` is the edge point that lies across the
/// neighbour at side j.
///
/// In a quad this is the mean of `9/16 (E[0] + E[2]) - 1/16 (E*[0] + E*[2])` and the same with 1 and 3, which agree
/// wherever the mesh is regular or has one extraordinary vertex. Across a face that is no quad lies `2 c - E[j]` with
/// its centroid `c`; across a boundary edge the reflection of what lies on this side of it.
#[derive(Debug)]
pub struct KobbeltFaces;

static FACTS: Facts = Facts {
    name: "kobbelt-faces",
    doc: "The face points of Kobbelt after his edge points: 1/n sum (E + (E - E*) / 8) over the sides of the face, \
     with the edge point E* across the neighbour at each side: in quads the four-point rule from edge points to edge \
     points. Used by the preset kobbelt.",
    source: "Kobbelt, Computer Graphics Forum 15 (1996), 409-420, section 3",
    nets: Nets::Meshes("kobbelt refines meshes; for polygons use four-point"),
    role: Role::Smooth,
    ..Facts::USUAL
};

impl Operator for KobbeltFaces {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.parent.clone().ok_or_else(around::not_upsampled)?;
        let (n, before) = (net.mesh.n_vertices(), parent.n_vertices() + parent.n_edges());
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row < before {
                out.add(index(row), 1.0);
            } else {
                face_row(&parent, row - before, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

fn face_row(parent: &Topology, face: usize, out: &mut Rows) {
    let share = ratio(1, parent.face(face).len());
    for side in parent.half_edges(face) {
        let here = index(parent.n_vertices()) + parent.edge(side);
        let neighbour = parent.twin(side);
        if neighbour == NONE {
            // E - E* is E[across] - E if E* is the reflection 2 E - E[across]
            out.add(here, share * 7.0 / 8.0);
            across(parent, side, share / 8.0, out);
        } else {
            out.add(here, share * 9.0 / 8.0);
            across(parent, neighbour, -share / 8.0, out);
        }
    }
}

/// Adds the point that lies opposite an edge across the face.
fn across(parent: &Topology, half_edge: u32, weight: f64, out: &mut Rows) {
    let n_v = index(parent.n_vertices());
    opposite(parent, half_edge, weight, |half_edge| n_v + parent.edge(half_edge), out);
}
