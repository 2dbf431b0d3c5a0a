//! The edge points of Kobbelt's interpolating scheme, applied after U.

use super::around;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Nets, Operator, Role};
use crate::scheme::stencil::FourPoint;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, Topology, index};

/// The rule along lines of edges.
const EDGE_RULE: FourPoint = FourPoint::CUBIC;

/// The edge points of Kobbelt: `E' = 9/16 (a + b) - 1/16 (a* + b*)` with the points `a*`, `b*` that continue the edge
/// beyond its ends `a` and `b`.
///
/// Beyond an interior vertex `p` of valence 4 this is the end of the opposite edge. At valence n it is the virtual
/// point `4/n sum l - (l[i-1] + l[i] + l[i+1]) + 1/9 (k[i-2] + k[i-1] + k[i] + k[i+1]) - 4/(9n) sum k` for the edge to
/// `l[i]`, with the neighbours `l` around `p` and the vertices `k[i]` opposite `p` in the face between `l[i]` and
/// `l[i+1]`: the one choice, symmetric in the neighbours, for which both directions across a face give the same face
/// point. Where a face is no quad, twice its centroid less `p` stands for `k`.
///
/// A boundary edge goes on along the boundary; an inner edge that ends on the boundary, and any edge at a corner, is
/// reflected: `a* = 2 a - b`.
#[derive(Debug)]
pub struct KobbeltEdges;

static FACTS: Facts = Facts {
    name: "kobbelt-edges",
    doc: "The edge points of Kobbelt after U: 9/16 (a + b) - 1/16 (a* + b*), where a* and b* continue the edge beyond \
     its ends: the next vertex at valence 4, a virtual point at other valences, the next vertex of the boundary on \
     boundaries, the reflected one at corners. Used by the preset kobbelt.",
    source: "Kobbelt, Computer Graphics Forum 15 (1996), 409-420, section 3; ends as of clamped polygons",
    nets: Nets::Meshes("kobbelt refines meshes; for polygons use four-point"),
    role: Role::Smooth,
    reaches_farther: true,
    ..Facts::USUAL
};

impl Operator for KobbeltEdges {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn admits(&self, net: &MeshNet) -> Result<(), StepError> {
        around::check("kobbelt", &net.mesh.base)
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.parent.clone().ok_or_else(around::not_upsampled)?;
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
    out.add(a, EDGE_RULE.near);
    out.add(b, EDGE_RULE.near);
    let [forward, backward] = parent.halves(e);
    for (end, other, outgoing) in [(a, b, forward), (b, a, backward)] {
        let is_inner = parent.boundary_edges(end as usize).is_none();
        if is_inner && !net.tags.is_corner(end as usize) {
            beyond(parent, outgoing, out);
        } else if backward == NONE {
            EDGE_RULE.add_beyond(parent, &net.tags, e, end == b, out);
        } else {
            EDGE_RULE.beyond(end, other, None, |v, weight| out.add(v, weight));
        }
    }
}

/// Adds the point that continues the edge of an outgoing half-edge beyond the interior vertex that it leaves.
fn beyond(parent: &Topology, outgoing: u32, out: &mut Rows) {
    let around = |half_edge: u32| parent.twin(parent.previous(half_edge));
    let across = around(around(outgoing));
    let end_of = |half_edge: u32| parent.vertex(parent.next(half_edge));
    if across != outgoing && around(around(across)) == outgoing {
        return out.add(end_of(across), EDGE_RULE.far);
    }
    if across == outgoing {
        return out.add(end_of(around(outgoing)), EDGE_RULE.far);
    }
    let p = parent.vertex(outgoing);
    let n = parent.ring(p as usize).count();
    let mut half_edge = outgoing;
    for i in 0..n {
        let [neighbour, diagonal] = virtual_point(i, n);
        out.add(end_of(half_edge), EDGE_RULE.far * neighbour);
        opposite(parent, half_edge, EDGE_RULE.far * diagonal, |half_edge| parent.vertex(half_edge), out);
        half_edge = around(half_edge);
    }
}

/// Returns the weights, in the virtual point beyond a vertex of valence `n`, of neighbour `i`, counted from the other
/// end of the edge, and of the opposite vertex in the face after it.
fn virtual_point(i: usize, n: usize) -> [f64; 2] {
    let taken = f64::from(i == 0 || i == 1 || i == n - 1);
    let neighbour = ratio(4, n) - taken;
    let taken = [0, 1, n - 2, n - 1].iter().filter(|&&at| at == i).count();
    [neighbour, ratio(taken, 9) - ratio(4, 9 * n)]
}

/// Adds the point opposite that of a half-edge of a quad; in other faces, twice the centroid minus that point. `point`
/// returns the point of a half-edge: its start, or that of its edge.
pub(super) fn opposite(parent: &Topology, half_edge: u32, weight: f64, point: impl Fn(u32) -> u32, out: &mut Rows) {
    let face = parent.face_of(half_edge);
    if parent.face(face).len() == 4 {
        out.add(point(parent.next(parent.next(half_edge))), weight);
    } else {
        out.add(index(parent.n_vertices() + parent.n_edges() + face), 2.0 * weight);
        out.add(point(half_edge), -weight);
    }
}
