//! A level of sqrt 3 subdivision.

use super::around;
use super::cosines::cosine;
use super::upsample::not_triangles;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Blend, Rule};
use crate::scheme::forecast::{Census, sum};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Facts, Nets, Operator, Role};
use crate::scheme::stencil::RingMask;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::face_centre_split::BoundarySplit;
use crate::shape::topology::{NONE, Topology, index};

/// Kobbelt's sqrt 3 scheme for triangles: a vertex at the centroid of each face, every inner edge flipped, and the old
/// inner vertices of valence n moved to `(1 - a) p + a/n sum neighbours`, `a = (4 - 2 cos(2 pi/n))/9` (order: see
/// [`Topology::split_at_face_centres`]).
///
/// Boundaries wait every first step and are cut in three every second one, by the ternary cubic B-spline:
/// `(4, 19, 4)/27` for the old vertices, `(1, 16, 10)/27` and `(10, 16, 1)/27` for the new ones. Corners stay, and
/// boundary curves are reflected at them.
#[derive(Debug)]
pub struct RootThree;

static FACTS: Facts = Facts {
    name: "sqrt-3",
    doc: "A level of Kobbelt's sqrt 3 scheme on triangles: centroids of the faces, flipped edges, and old vertices \
     moved by (4 - 2 cos(2 pi/n))/9 of the way to the mean of their n neighbours. Every second level cuts boundary \
     edges in three, by the ternary cubic B-spline (1, 4, 10, 16, 19, 16, 10, 4, 1)/27. Used by the preset sqrt-3.",
    source: "Kobbelt, SIGGRAPH 2000, 103-112",
    nets: Nets::Meshes("sqrt-3 refines meshes of triangles; for polygons use ternary-cubic"),
    role: Role::Smooth,
    children: Children::Vertices,
    rebuilds: true,
    boundary_every: 2,
    ..Facts::USUAL
};

impl Operator for RootThree {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn admits(&self, net: &MeshNet) -> Result<(), StepError> {
        let topology = &net.mesh.base;
        if !net.tags.holes.is_empty() {
            return Err(around::cannot_follow("sqrt-3", "holes (boundary \"none\" makes some)"));
        }
        if let Some(face) = topology.first_other_than_triangle() {
            return Err(not_triangles(face, topology.face(face).len()));
        }
        let two = |&v: &usize| topology.boundary_edges(v).is_none() && topology.ring(v).count() == 2;
        match (0..topology.n_vertices()).find(two) {
            Some(vertex) => Err(around::two_faces("sqrt-3", vertex)),
            None => Ok(()),
        }
    }

    fn census(&self, before: &Census) -> Census {
        let (v, f, b) = (before.count.vertices, before.count.faces, before.boundary);
        let (faces, corners) = (sum(&[(3, f)]), sum(&[(9, f)]));
        let (vertices, boundary) = match boundary(before.rounds) {
            BoundarySplit::Whole => (sum(&[(1, v), (1, f)]), b),
            BoundarySplit::Thirds => (sum(&[(1, v), (1, f), (1, b)]), sum(&[(3, b)])),
        };
        before.after([vertices, faces, corners, 3], boundary)
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        if net.mesh.rounds == 0 {
            self.admits(net)?;
        }
        let (old, boundary) = (net.mesh.base.clone(), boundary(net.mesh.rounds));
        let next = net.after_rebuild(old.split_at_face_centres(boundary), net.tags.corners.to_vec());
        let (n_v, n_f) = (old.n_vertices(), old.n_faces());
        let cut: Vec<u32> = match boundary {
            BoundarySplit::Whole => Vec::new(),
            BoundarySplit::Thirds => (0..old.n_edges()).filter(|&e| old.is_boundary_edge(e)).map(index).collect(),
        };
        let before = net.clone();
        let rows = RowsBy::new(next.mesh.n_vertices(), n_v, move |row, out: &mut Rows| {
            if row < n_v {
                vertex_row(&before, boundary, row, out);
            } else if row < n_v + n_f {
                let face = row - n_v;
                match old
                    .half_edges(face)
                    .find(|&half_edge| boundary == BoundarySplit::Thirds && old.twin(half_edge) == NONE)
                {
                    Some(half_edge) => third_row(&before, old.edge(half_edge), NearerEnd::Start, out),
                    None => old.face(face).iter().for_each(|&v| out.add(v, ratio(1, 3))),
                }
            } else {
                third_row(&before, cut[row - n_v - n_f], NearerEnd::End, out);
            }
        });
        Ok(Step { net: next, action: Action::Blend(Box::new(rows)) })
    }
}

/// Returns how boundaries are treated: they are cut in the last of every [`Facts::boundary_every`] steps.
fn boundary(rounds: u32) -> BoundarySplit {
    if (rounds + 1).is_multiple_of(FACTS.boundary_every) { BoundarySplit::Thirds } else { BoundarySplit::Whole }
}

/// The mask of an interior vertex: `(1 - a) p + a/n sum neighbours` with `a = (4 - 2 cos(2 pi/n))/9`.
fn vertex_mask(valence: usize) -> RingMask {
    let moved = (4.0 - 2.0 * cosine(1, valence)) / 9.0;
    RingMask { own: 1.0 - moved, neighbours: moved / ratio(valence, 1) }
}

/// The mask of a boundary vertex in every second step: (4, 19, 4)/27.
fn curve_mask() -> RingMask {
    RingMask { own: ratio(19, 27), neighbours: ratio(4, 27) }
}

fn vertex_row(net: &MeshNet, boundary: BoundarySplit, v: usize, out: &mut Rows) {
    let old = &net.mesh.base;
    match (Blend::of(v, old, &net.tags, None).before, boundary) {
        (Rule::Corner, _) | (Rule::Crease(_), BoundarySplit::Whole) => out.add(index(v), 1.0),
        (Rule::Crease(edges), BoundarySplit::Thirds) => curve_mask().add_ends(old, v, edges.into_iter(), out),
        (Rule::Smooth, _) => vertex_mask(old.ring(v).count()).add_ends(old, v, old.edges_at(v), out),
    }
}

/// The end of an edge that is nearer to a new point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NearerEnd {
    Start,
    End,
}

/// Adds the row of a point at a third of a boundary edge: `(16 near + 10 far + 1 beyond)/27`, reflected at a corner.
fn third_row(net: &MeshNet, edge: u32, near: NearerEnd, out: &mut Rows) {
    let topology: &Topology = &net.mesh.base;
    let [start, end] = topology.ends(edge as usize);
    let [a, b] = if near == NearerEnd::Start { [start, end] } else { [end, start] };
    if net.tags.is_corner(a as usize) {
        out.add(a, ratio(18, 27));
        out.add(b, ratio(9, 27));
        return;
    }
    out.add(a, ratio(16, 27));
    out.add(b, ratio(10, 27));
    if let Some([onward, from]) = topology.boundary_edges(a as usize) {
        let beyond =
            if near == NearerEnd::Start { topology.ends(from as usize)[0] } else { topology.ends(onward as usize)[1] };
        out.add(beyond, ratio(1, 27));
    }
}
