//! The edge points of Kobbelt's interpolating scheme, applied after U.

use super::around;
use super::upsample::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Operator, Role};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::shape::topology::{NONE, Topology, index};

/// Weight of the two ends of an edge.
const NEAR: f64 = 9.0 / 16.0;
/// Weight of the two points beyond the ends.
const FAR: f64 = -1.0 / 16.0;

/// The edge points of Kobbelt: `E' = 9/16 (a + b) - 1/16 (a* + b*)` with the points `a*`, `b*` that continue the edge
/// beyond its ends `a` and `b`.
///
/// Beyond an interior vertex `p` of valence 4 this is the end of the opposite edge. At valence n it is the virtual point
/// `4/n sum l - (l[i-1] + l[i] + l[i+1]) + 1/9 (k[i-2] + k[i-1] + k[i] + k[i+1]) - 4/(9n) sum k` for the edge to `l[i]`,
/// with the neighbours `l` around `p` and the vertices `k[i]` opposite `p` in the face between `l[i]` and `l[i+1]`: the
/// one choice, symmetric in the neighbours, for which both directions across a face give the same face point. Where a
/// face is no quad, twice its centroid less `p` stands for `k`.
///
/// A boundary edge goes on along the boundary; an inner edge that ends on the boundary, and any edge at a corner, is
/// reflected: `a* = 2 a - b`.
#[derive(Debug)]
pub struct KobbeltEdges;

static FACTS: Facts = Facts {
    name: "kobbelt-edges",
    doc: "The edge points of Kobbelt after U: 9/16 (a + b) - 1/16 (a* + b*), where a* and b* continue the edge beyond its \
     ends: the next vertex at valence 4, a virtual point at other valences, the next vertex of the boundary on \
     boundaries, the reflected one at corners. Used by the preset kobbelt.",
    source: "Kobbelt, Computer Graphics Forum 15 (1996), 409-420, section 3; ends as of clamped polygons",
    role: Role::Smooth,
    reaches_farther: true,
    ..Facts::USUAL
};

impl Operator for KobbeltEdges {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn on_polygon(&self, _: &PolygonNet, _: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::WrongNet("kobbelt refines meshes; for polygons use four-point"))
    }

    fn admits(&self, net: &MeshNet) -> Result<(), StepError> {
        around::check("kobbelt", &net.mesh.base)
    }

    fn on_mesh(&self, net: &MeshNet, _: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.parent.clone().ok_or(StepError::NoAnchor)?;
        if net.mesh.pieces.len() == 1 {
            self.admits(net)?;
        }
        let (n, n_v, n_e) = (net.mesh.n_vertices(), parent.n_vertices(), parent.n_edges());
        let old = net.clone();
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row < n_v || row >= n_v + n_e {
                out.add(index(row), 1.0);
            } else {
                edge_row(&old, &parent, row - n_v, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

fn edge_row(net: &MeshNet, parent: &Topology, e: usize, out: &mut Rows) {
    let [a, b] = parent.ends(e);
    out.add(a, NEAR);
    out.add(b, NEAR);
    let [forward, backward] = parent.halves(e);
    for (end, other, outgoing) in [(a, b, forward), (b, a, backward)] {
        let v = end as usize;
        match parent.boundary_edges(v) {
            _ if net.tags.is_corner(v) => reflected(end, other, out),
            None => beyond(parent, outgoing, out),
            Some([onward, _]) if backward == NONE && end == b => out.add(parent.ends(onward as usize)[1], FAR),
            Some([_, from]) if backward == NONE => out.add(parent.ends(from as usize)[0], FAR),
            Some(_) => reflected(end, other, out),
        }
    }
}

fn reflected(end: u32, other: u32, out: &mut Rows) {
    out.add(end, 2.0 * FAR);
    out.add(other, -FAR);
}

/// What continues, beyond the interior vertex it leaves, the edge of an outgoing corner.
fn beyond(parent: &Topology, outgoing: u32, out: &mut Rows) {
    let around = |corner: u32| parent.twin(parent.previous(corner));
    let across = around(around(outgoing));
    let end_of = |corner: u32| parent.vertex(parent.next(corner));
    if across != outgoing && around(around(across)) == outgoing {
        return out.add(end_of(across), FAR);
    }
    if across == outgoing {
        return out.add(end_of(around(outgoing)), FAR);
    }
    let p = parent.vertex(outgoing);
    let n = parent.ring(p as usize).count();
    let mut corner = outgoing;
    for i in 0..n {
        let taken = f64::from(i == 0 || i == 1 || i == n - 1);
        out.add(end_of(corner), FAR * (ratio(4, n) - taken));
        let taken = [0, 1, n - 2, n - 1].iter().filter(|&&at| at == i).count();
        opposite(parent, corner, FAR * (ratio(taken, 9) - ratio(4, 9 * n)), out);
        corner = around(corner);
    }
}

/// The vertex opposite a corner of a quad; in other faces twice the centroid less the corner's vertex.
fn opposite(parent: &Topology, corner: u32, weight: f64, out: &mut Rows) {
    let face = parent.face_of(corner);
    if parent.face(face).len() == 4 {
        out.add(parent.vertex(parent.next(parent.next(corner))), weight);
    } else {
        out.add(index(parent.n_vertices() + parent.n_edges() + face), 2.0 * weight);
        out.add(parent.vertex(corner), -weight);
    }
}
