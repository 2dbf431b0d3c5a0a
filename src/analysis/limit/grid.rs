//! Walks on grids of quads, and the mask of a vertex there.

use super::disc::{Centre, Located, RingCount};
use super::error::Unlimited;
use super::mask::{LimitMask, Masks};
use super::regular::Regular;
use super::walk::WholeNet;
use crate::scheme::surroundings::Surroundings;
use crate::shape::topology::{Topology, index};

/// Visits the vertices within some rings of vertex `v` of a grid of quads: `v` itself, then sector by sector the
/// vertices `i` steps along the sector's first side and `j` to the left of it, `1 <= i <= rings`, `0 <= j <= rings`.
pub(super) fn grid(topology: &Topology, v: usize, rings: usize, mut each: impl FnMut(u32)) {
    each(index(v));
    for first in topology.ring(v) {
        let mut along = first;
        for i in 1..=rings {
            let mut side = along;
            for j in 1..=rings {
                each(topology.vertex(topology.next(side)));
                let opposite = topology.next(topology.next(side));
                if j < rings {
                    side = topology.twin(opposite);
                } else {
                    each(topology.vertex(opposite));
                }
            }
            if i < rings {
                along = topology.next(topology.twin(topology.next(along)));
            }
        }
    }
}

/// Returns the mask of a vertex of a grid, in the order of [`grid`].
pub(super) fn regular_mask(
    rings: RingCount,
    masks: &Masks<'_>,
    surroundings: Option<Surroundings>,
) -> Result<LimitMask, Unlimited> {
    let (net, middle) = Regular::Quads.grid(rings, false);
    let (topology, whole) = (&net.mesh.base, WholeNet { surroundings, ..WholeNet::of(&net, &net.mesh.base) });
    let Located { disc, vertices, .. } = whole.disc(Centre::Vertex(index(middle)), rings).ok_or(Unlimited::Size)?;
    let mask = masks.of(0, &disc)?;
    let mut order = Vec::new();
    grid(topology, middle, rings.support, |vertex| order.push(vertices.iter().position(|&u| u == vertex)));
    let sorted = |weights: &Vec<f64>| order.iter().map(|at| at.map_or(0.0, |at| weights[at])).collect::<Vec<_>>();
    let both = |tangents: &Result<[Vec<f64>; 2], _>| {
        tangents.as_ref().map(|[t, u]| [sorted(t), sorted(u)]).map_err(|why| *why)
    };
    Ok(LimitMask { position: sorted(&mask.position), tangents: mask.tangents.iter().map(both).collect() })
}
