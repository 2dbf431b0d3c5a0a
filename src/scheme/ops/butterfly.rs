//! The edge points of the modified butterfly scheme, applied after U on triangles.

use super::around;
use super::cosines::cosine;
use crate::math::functions::ratio;
use crate::math::parameter::{Default, Parameter};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Nets, Operator};
use crate::scheme::stencil::{FourPoint, TriangleEdgeMask};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, Topology, index};

/// The edge points of the modified butterfly scheme, with `16 w` times the displacement from the middle of the edge; at
/// `w = 1/16`:
///
/// - both ends of valence 6: `1/2 (a + b) + 1/8 (c + d) - 1/16 (four far vertices)`, with the vertices `c`, `d`
///   opposite the edge and those beyond the other four edges of its two triangles;
/// - an inner end `p` of valence n other than 6: `3/4 p + sum s[j] e[j]` over its neighbours, counted from the other
///   end, `s[j] = (1/4 + cos(2 pi j/n) + 1/2 cos(4 pi j/n))/n`; for n = 3 `(5, -1, -1)/12`, for n = 4
///   `(3, 0, -1, 0)/8`; the mean of both where both ends are such;
/// - boundary edges: `9/16 (a + b) - 1/16 (a* + b*)` with the next vertices on the boundary, or the reflection
///   `2 a - b` at a corner;
/// - ends on the boundary, and those with two faces all around, count as of valence 6; a far vertex beyond a boundary
///   edge `(a, c)` of the triangle `(a, b, c)` is `a + c - b`.
#[derive(Debug)]
pub struct ButterflyEdges;

impl ButterflyEdges {
    /// The tension.
    pub const W: Parameter = Parameter::number(
        "w",
        [-1e3, 1e3],
        Default::Number(1.0 / 16.0),
        "Tension: what edge points are off the middles of their edges at 1/16 is multiplied by 16 w.",
    );
}

static FACTS: Facts = Facts {
    name: "butterfly-edges",
    doc: "The edge points of the modified butterfly scheme after U on triangles: 1/2 (a + b) + 2w (c + d) - w (four \
     far vertices) where both ends have valence 6, weights of the ring of an end of another valence, the four-point \
     rule on boundaries. Used by the preset butterfly.",
    source: "Zorin, Schroeder and Sweldens, SIGGRAPH 1996, 189-192; Dyn, Levin and Gregory, ACM TOG 9 (1990), 160-169",
    nets: Nets::Meshes("butterfly refines meshes of triangles; for polygons use four-point"),
    parameters: &[ButterflyEdges::W],
    symmetric: true,
    ..Facts::USUAL
};

impl Operator for ButterflyEdges {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn admits(&self, net: &MeshNet) -> Result<(), StepError> {
        around::check("butterfly", &net.mesh.base)
    }

    fn on_mesh(&self, net: &MeshNet, values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.halved_triangles().cloned().ok_or_else(around::not_upsampled)?;
        if net.mesh.pieces.len() == 1 {
            self.admits(net)?;
        }
        let (n, n_v, strength) = (net.mesh.n_vertices(), parent.n_vertices(), 16.0 * values.settings.number(&Self::W));
        let old = net.clone();
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row < n_v {
                out.add(index(row), 1.0);
            } else {
                edge_row(&old, &parent, row - n_v, strength, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

/// The mask of an edge point, `1/2 (a + b) + 2w (c + d) - w (four far vertices)`; `strength` is `16 w`.
fn edge_mask(strength: f64) -> TriangleEdgeMask {
    let unit = strength / 16.0;
    TriangleEdgeMask { ends: 0.5, opposite: 2.0 * unit, far: Some(-unit) }
}

fn edge_row(net: &MeshNet, parent: &Topology, e: usize, strength: f64, out: &mut Rows) {
    let ends = parent.ends(e);
    let [forward, backward] = parent.halves(e);
    if backward == NONE {
        let rule = FourPoint::new(strength / 16.0);
        for (end, onward) in [(ends[0], false), (ends[1], true)] {
            out.add(end, rule.near);
            rule.add_beyond(parent, &net.tags, e, onward, out);
        }
        return;
    }
    // outgoing half-edges of extraordinary ends
    let extraordinary = |v: u32| {
        let n = parent.ring(v as usize).count();
        n > 2 && n != 6 && parent.boundary_edges(v as usize).is_none()
    };
    let rings = [(ends[0], forward), (ends[1], backward)].map(|(v, half_edge)| extraordinary(v).then_some(half_edge));
    let n_rings = rings.iter().flatten().count();
    if n_rings == 0 {
        return edge_mask(strength).add(parent, e, out);
    }
    ends.iter().for_each(|&v| out.add(v, 0.5 - 0.5 * strength));
    rings.iter().flatten().for_each(|&half_edge| ring_row(parent, half_edge, strength / ratio(n_rings, 1), out));
}

/// Returns the weight of neighbour `j` of an extraordinary vertex of valence `n`, counted from the other end of the
/// edge.
fn ring_weight(j: usize, n: usize) -> f64 {
    match (n, j) {
        (3, 0) => ratio(5, 12),
        (3, _) => -ratio(1, 12),
        (4, 0) => ratio(3, 8),
        (4, 2) => -ratio(1, 8),
        (4, _) => 0.0,
        _ => (0.25 + cosine(j, n) + 0.5 * cosine(2 * j, n)) / ratio(n, 1),
    }
}

/// Adds the edge point that an interior vertex predicts from its ring, on the edge of one of its outgoing half-edges.
fn ring_row(parent: &Topology, outgoing: u32, scale: f64, out: &mut Rows) {
    let v = parent.vertex(outgoing);
    let n = parent.ring(v as usize).count();
    out.add(v, 0.75 * scale);
    let mut half_edge = outgoing;
    for j in 0..n {
        out.add(parent.vertex(parent.next(half_edge)), scale * ring_weight(j, n));
        half_edge = parent.twin(parent.previous(half_edge));
    }
}
