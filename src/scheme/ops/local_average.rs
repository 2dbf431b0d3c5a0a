//! C on meshes whose kernel varies by vertex, or differs along longitude lines.

use std::sync::Arc;

use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Blend, Creases, Rule};
use crate::scheme::local_mesh::MeshLocal;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::step::Action;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{Topology, index};

/// The sources of vertex weights.
struct Gains {
    local: Arc<MeshLocal>,
    directions: Option<Arc<Directions>>,
}

impl Gains {
    /// Returns the weight of vertex `v` relative to the point of its edge `e`.
    fn of(&self, v: u32, e: u32) -> f64 {
        let longitude =
            self.local.kernel_longitude.as_ref().filter(|_| {
                self.directions.as_ref().is_some_and(|directions| directions.of(e) == Direction::Longitude)
            });
        longitude.unwrap_or(&self.local.kernel)[v as usize]
    }
}

/// Returns the first C after an upsampling of `parent`: each quad has the loop centre
/// `(g h V + h E1 + g E2 + F) / ((1 + g) (1 + h))` with the weights g, h of its vertex relative to its edge points.
pub(super) fn rows(net: &MeshNet, parent: &Arc<Topology>, local: &Arc<MeshLocal>) -> Action {
    let directions = net.since.anchor.as_ref().and_then(|anchor| anchor.directions.clone());
    let gains = Gains { local: local.clone(), directions };
    let (n_v, n_e, n) = (parent.n_vertices(), parent.n_edges(), net.mesh.n_vertices());
    let creases = Creases::of_parent(net);
    let (net, parent) = (net.clone(), parent.clone());
    let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
        if row < n_v {
            match Blend::of(row, &parent, &net.tags, creases.as_ref()).before {
                Rule::Corner => out.add(index(row), 1.0),
                Rule::Crease(edges) => {
                    for e in edges {
                        let g = gains.of(index(row), e);
                        out.add(index(row), 0.5 * g / (1.0 + g));
                        out.add(index(n_v) + e, 0.5 / (1.0 + g));
                    }
                }
                Rule::Smooth => {
                    let share = ratio(1, parent.ring(row).count());
                    parent.ring(row).for_each(|half_edge| quad(&parent, half_edge, &gains, share, out));
                }
            }
        } else if row < n_v + n_e {
            let e = row - n_v;
            if parent.is_boundary_edge(e) || creases.as_ref().is_some_and(|creases| creases.edge(e) > 0.0) {
                for v in parent.ends(e) {
                    let g = gains.of(v, index(e));
                    out.add(v, 0.5 * g / (1.0 + g));
                    out.add(index(row), 0.5 / (1.0 + g));
                }
            } else {
                for half_edge in parent.halves(e) {
                    quad(&parent, half_edge, &gains, 0.25, out);
                    quad(&parent, parent.next(half_edge), &gains, 0.25, out);
                }
            }
        } else {
            let half_edges = parent.half_edges(row - n_v - n_e);
            let share = ratio(1, half_edges.len());
            half_edges.for_each(|half_edge| quad(&parent, half_edge, &gains, share, out));
        }
    });
    Action::Blend(Box::new(rows))
}

/// Adds `share` times the loop centre of the child quad of a corner.
fn quad(parent: &Topology, half_edge: u32, gains: &Gains, share: f64, out: &mut Rows) {
    let [v, e1, f, e2] = parent.child_quad(half_edge);
    let g = gains.of(v, parent.edge(half_edge));
    let h = gains.of(v, parent.edge(parent.previous(half_edge)));
    let share = share / ((1.0 + g) * (1.0 + h));
    out.add(v, share * g * h);
    out.add(e1, share * h);
    out.add(f, share);
    out.add(e2, share * g);
}
