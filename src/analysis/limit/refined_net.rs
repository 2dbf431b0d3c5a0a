//! The neighbourhoods of a net in the order of construction.

use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::disc::{Centre, Disc, Located, RingCount};
use super::grid::grid;
use super::neighbourhoods::Neighbourhoods;
use super::vertex_parameters::VertexParameters;
use super::walk::WholeNet;
use crate::math::rows::Rows;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::surroundings::Surroundings;
use crate::shape::numbering::Numbering;
use crate::shape::topology::{Topology, index};
use crate::watch::{Stopped, Watch};

/// A net whose vertices and points are in the order of construction.
#[derive(Debug)]
pub(super) struct RefinedNet {
    net: MeshNet,
    /// The explicit topology of the net.
    topology: Arc<Topology>,
    /// For each vertex what took its place, or `None` for a vertex without faces. The whole field is `None` if the
    /// vertices are those of the net itself.
    centres: Option<Vec<Option<Centre>>>,
    /// What rules need to know of the net beyond a disc, if anything.
    surroundings: Option<Surroundings>,
    numbering: OnceLock<Numbering>,
}

impl RefinedNet {
    /// Creates the neighbourhoods of a net with this topology. `centres` are what took the place of the original
    /// vertices, if these are not the net's own.
    pub(super) fn new(
        net: MeshNet,
        topology: Arc<Topology>,
        centres: Option<Vec<Option<Centre>>>,
        surroundings: Option<Surroundings>,
    ) -> Self {
        Self { net, topology, centres, surroundings, numbering: OnceLock::new() }
    }

    fn whole(&self) -> WholeNet<'_> {
        WholeNet { surroundings: self.surroundings, ..WholeNet::of(&self.net, &self.topology) }
    }
}

impl Neighbourhoods for RefinedNet {
    fn n_vertices(&self) -> usize {
        self.centres.as_ref().map_or(self.n_points(), Vec::len)
    }

    fn n_points(&self) -> usize {
        self.topology.n_vertices()
    }

    fn centre(&self, v: usize) -> Option<Centre> {
        match &self.centres {
            Some(centres) => centres[v],
            None => (!self.topology.is_isolated(v)).then(|| Centre::Vertex(index(v))),
        }
    }

    fn leaves_out(&self) -> bool {
        self.centres.is_some()
    }

    fn disc(&self, centre: Centre, rings: RingCount) -> Option<Located> {
        self.whole().disc(centre, rings)
    }

    fn parameters(&self, points: &[u32]) -> VertexParameters {
        VertexParameters::of(&self.net, points)
    }

    fn numbering(&self, found: &Located) -> Numbering {
        let whole = self.numbering.get_or_init(|| Numbering::of(&self.topology));
        whole.of_submesh(&self.topology, &found.vertices, &found.half_edges)
    }

    fn middles(&self, but: usize, rings: RingCount, watch: &Watch) -> Result<Vec<Disc>, Stopped> {
        let mut seen = BTreeSet::from([but]);
        let first = |f: &usize| !carries(&self.net) && seen.insert(self.topology.face(*f).len());
        let least = |f: usize| self.whole().least_disc(Centre::Face(index(f)), rings, watch);
        let found = (0..self.topology.n_faces()).filter(first).map(least).collect::<Result<Vec<_>, _>>()?;
        Ok(found.into_iter().flatten().map(|found| found.disc).collect())
    }

    fn near_extraordinary(&self, rings: RingCount) -> Vec<bool> {
        if carries(&self.net) { vec![true; self.n_points()] } else { near_extraordinary(&self.whole(), rings) }
    }

    fn add_on_grid(&self, point: u32, rings: usize, weights: &[f64], out: &mut Rows) {
        let mut weights = weights.iter();
        grid(&self.topology, point as usize, rings, |u| weights.next().into_iter().for_each(|&w| out.add(u, w)));
    }
}

/// Returns whether vertices of a net carry parameters or edges carry directions.
pub(super) fn carries(net: &MeshNet) -> bool {
    net.annotations.attributes.is_some() || net.annotations.directions.is_some()
}

/// Returns for each vertex whether a vertex fewer than `rings.disc` rings away is not a regular vertex of a grid of
/// smooth quads.
fn near_extraordinary(whole: &WholeNet<'_>, rings: RingCount) -> Vec<bool> {
    let topology = whole.topology;
    let extraordinary = |v: usize| {
        let quads = || topology.ring(v).all(|half_edge| topology.half_edges(topology.face_of(half_edge)).len() == 4);
        topology.is_isolated(v)
            || topology.boundary_edges(v).is_some()
            || topology.ring(v).take(5).count() != 4
            || !quads()
            || whole.corners.binary_search(&index(v)).is_ok()
    };
    let mut near: Vec<bool> =
        (0..topology.n_vertices()).into_par_iter().with_min_len(4096).map(extraordinary).collect();
    if let Some(sharpness) = whole.sharpness {
        let ends = sharpness.edges().iter().flat_map(|&(e, _)| topology.ends(e as usize));
        ends.chain(sharpness.vertices().iter().map(|&(v, _)| v)).for_each(|v| near[v as usize] = true);
    }
    topology.faces_within(rings.disc - 1, &mut near);
    near
}
