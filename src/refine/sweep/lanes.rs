//! Latitude and longitude tags of nets whose tags look the same everywhere.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::scheme::rules::LatitudeRule;
use crate::shape::attributes::Attributes;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{Topology, index};

/// The error for nets whose tags or vertex parameters vary from place to place, or whose plan uses them in a way that a
/// sweep does not support.
pub(super) struct Uneven;

/// The tags of a net all of whose faces have two latitude and two longitude edges in turn, and whose vertices have the
/// same alpha. Around a patch or a vertex, latitude edges lie along every other direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Lanes {
    /// The bits of the alpha that all vertices share, if they have one.
    alpha: Option<u64>,
    /// Whether the first direction is that of longitude edges.
    pub(super) turned: bool,
}

impl Lanes {
    /// Returns the lanes of a net, or `None` if it has no tags.
    pub(super) fn of(net: &MeshNet, plan: &Plan) -> Result<Option<Self>, Uneven> {
        let (attributes, directions) = (net.annotations.attributes.as_deref(), net.annotations.directions.as_deref());
        let Some(directions) = directions else {
            return attributes.map_or(Ok(None), |_| Err(Uneven));
        };
        let is_alone = attributes.is_none_or(|carried| carried.arrays()[1..].iter().all(|(_, array)| array.is_none()));
        let alphas = attributes.and_then(|carried| carried.alpha.as_deref());
        let alpha = alphas.and_then(|alphas| alphas.first()).map(|alpha| alpha.to_bits());
        let is_common = alphas.into_iter().flatten().all(|own| Some(own.to_bits()) == alpha);
        let is_known = plan
            .latitude
            .as_ref()
            .is_some_and(|latitude| latitude.rule == LatitudeRule::Difference && latitude.kernel_longitude.is_none());
        let all = is_alone && is_common && is_known && alternate(&net.mesh.base, directions);
        if all { Ok(Some(Self { alpha, turned: false })) } else { Err(Uneven) }
    }

    /// Returns lanes of a net all of whose vertices have this alpha, in radians.
    #[cfg(test)]
    pub(super) fn with_alpha(alpha: f64) -> Self {
        Self { alpha: Some(alpha.to_bits()), turned: false }
    }

    /// Returns the same lanes with `turned` set: whether the first direction is that of longitude edges.
    pub(super) fn seen(self, turned: bool) -> Self {
        Self { turned, ..self }
    }

    /// Returns the net with these tags; `is_odd` tells for each edge whether it lies along an odd direction.
    pub(super) fn carried(self, net: MeshNet, is_odd: impl Fn(usize) -> bool) -> MeshNet {
        let topology = &net.mesh.base;
        let direction = |e| if is_odd(e) == self.turned { Direction::Latitude } else { Direction::Longitude };
        let directions = Directions::of_edges((0..topology.n_edges()).map(direction).collect());
        let alpha = self.alpha.map(|bits| vec![f64::from_bits(bits); topology.n_vertices()]);
        let attributes = alpha.map(|alpha| Attributes { alpha: Some(alpha), ..Attributes::default() });
        net.carrying(attributes, Some(directions))
    }
}

/// Returns whether all faces are quads with latitude and longitude edges in turn, and no longitude edge lies on the
/// boundary, where latitude lines would end.
fn alternate(topology: &Topology, directions: &Directions) -> bool {
    let of_face = |f: usize| {
        let mut edges = topology.half_edges(f).map(|half_edge| directions.of(topology.edge(half_edge)));
        [edges.next(), edges.next(), edges.next(), edges.next()].map(Option::unwrap_or_default)
    };
    let in_turns = |f: usize| {
        let [a, b, c, d] = of_face(f);
        a == c && b == d && a != b && a != Direction::Untagged && b != Direction::Untagged
    };
    let ends_no_line = |e: usize| !topology.is_boundary_edge(e) || directions.of(index(e)) == Direction::Latitude;
    topology.is_quads() && (0..topology.n_faces()).all(in_turns) && (0..topology.n_edges()).all(ends_no_line)
}
