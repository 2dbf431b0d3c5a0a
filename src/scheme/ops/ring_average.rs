//! C on split meshes of any arity, computed from the faces around each vertex.

use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy, symmetric_sum};
use crate::scheme::anchor::{Anchor, CellKind};
use crate::scheme::creases::{Blend, Creases, Rule};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::step::Action;
use crate::shape::topology::{Topology, index};

/// The contribution of each face around a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FaceContribution {
    /// The weighted mean of its vertices.
    Faces,
    /// `mu P + (1 - mu)/2 (A + B)`, weighted, with the neighbours A and B of P in the face.
    Neighbours {
        /// The weight of P.
        mu: f64,
    },
}

/// Returns the mean of the contributions of the faces around each vertex, with the weights that the kernel `f` gives to
/// V, E and F; boundaries and creases follow the curve rule, corners stay.
pub(super) fn rows(net: &MeshNet, around: FaceContribution, f: f64) -> Action {
    let n = net.mesh.n_vertices();
    let topology = net.mesh.topology();
    let weights = RingWeights { labels: net.since.anchor.clone().filter(|_| net.mesh.parent.is_some()), f };
    let creases = Creases::of_net(net, &topology);
    let old = net.clone();
    let rows = RowsBy::new(n, n, move |v, out: &mut Rows| {
        match (Blend::of(v, &topology, &old.tags, creases.as_ref()).before, around) {
            (Rule::Corner, _) => out.add(index(v), 1.0),
            (Rule::Crease(edges), _) => {
                let ends = edges.map(|e| topology.other_end(e as usize, v));
                crease_row(&weights, v, ends, out);
            }
            (Rule::Smooth, FaceContribution::Faces) => faces_row(&topology, &weights, v, out),
            (Rule::Smooth, FaceContribution::Neighbours { mu }) => neighbours_row(&topology, &weights, v, mu, out),
        }
    });
    Action::Blend(Box::new(rows))
}

/// The weights of vertices according to their labels at the last U.
struct RingWeights {
    /// The labels; `None` if there are none, so that all weights are 1.
    labels: Option<Anchor>,
    f: f64,
}

impl RingWeights {
    fn in_faces(&self, v: u32) -> f64 {
        self.labels.as_ref().map_or(1.0, |labels| labels.weight(v as usize, self.f))
    }

    fn on_curves(&self, v: u32) -> f64 {
        let is_vertex = |labels: &Anchor| labels.label(v as usize) == CellKind::Vertex;
        if self.labels.as_ref().is_some_and(is_vertex) { self.f } else { 1.0 }
    }
}

/// Adds the row of the curve rule: the mean of the weighted means with either neighbour.
fn crease_row(weights: &RingWeights, v: usize, [before, after]: [u32; 2], out: &mut Rows) {
    let [a, b, c] = [before, index(v), after].map(|v| weights.on_curves(v));
    let (first, second) = (2.0 * (a + b), 2.0 * (b + c));
    out.add(index(v), b / first + b / second);
    out.group(|out| {
        out.add(before, a / first);
        out.add(after, c / second);
    });
}

fn faces_row(topology: &Topology, weights: &RingWeights, v: usize, out: &mut Rows) {
    let valence = ratio(topology.ring(v).count(), 1);
    for half_edge in topology.ring(v) {
        let face = topology.face(topology.face_of(half_edge));
        let sum: f64 = face.iter().map(|&u| weights.in_faces(u)).sum();
        face.iter().for_each(|&u| out.add(u, weights.in_faces(u) / (sum * valence)));
    }
}

/// Adds a row in which neighbours of equal weight form a group. Around a vertex with six neighbours, all sums are
/// independent of order.
fn neighbours_row(topology: &Topology, weights: &RingWeights, v: usize, mu: f64, out: &mut Rows) {
    let valence = topology.ring(v).count();
    let p = mu * weights.in_faces(index(v));
    // for each face around the vertex: the weights of the vertex, of the preceding neighbour and of the following one
    let share = |half_edge: u32| {
        let neighbours = [topology.next(half_edge), topology.previous(half_edge)];
        let [q, r] = neighbours.map(|half_edge| 0.5 * (1.0 - mu) * weights.in_faces(topology.vertex(half_edge)));
        let sum = (p + q + r) * ratio(valence, 1);
        [p / sum, q / sum, r / sum]
    };
    let shares: Vec<[f64; 3]> = topology.ring(v).map(share).collect();
    out.add(index(v), symmetric_sum(valence, |k| [shares[k][0]])[0]);
    // the neighbour on the edge before a face has weights from this face and from the preceding one
    let neighbours = topology.ring(v).map(|half_edge| topology.vertex(topology.next(half_edge)));
    let total = |k: usize| shares[k][1] + shares[(k + valence - 1) % valence][2];
    let all: Vec<(u32, f64)> = neighbours.enumerate().map(|(k, neighbour)| (neighbour, total(k))).collect();
    for (k, &(_, weight)) in all.iter().enumerate() {
        let alike = |entry: &&(u32, f64)| entry.1.to_bits() == weight.to_bits();
        if !all[..k].iter().any(|entry| alike(&entry)) {
            out.group(|out| all.iter().filter(alike).for_each(|&(neighbour, weight)| out.add(neighbour, weight)));
        }
    }
}
