//! Steps of discs whose vertices carry parameters: the connectivity is computed once and reused for other parameters.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::cycle::{Child, Cycle};
use super::disc::{Disc, Located, RingCount};
use super::error::Unlimited;
use super::record::{CycleRecord, WeightMode};
use super::vertex_parameters::VertexParameters;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Perturbation;
use crate::scheme::stepper::Stepper;
use crate::shape::numbering::Numbering;
use crate::shape::topology::Topology;

/// A disc as a net, and the location of its child in the net after a level.
#[derive(Debug)]
struct Skeleton {
    net: MeshNet,
    origins: Vec<u32>,
    child: Located,
    /// The topology after the level.
    refined: Arc<Topology>,
}

/// A level on a disc as a sequence of actions.
#[derive(Debug)]
pub(super) struct TracedLevel {
    skeleton: Arc<Skeleton>,
    record: CycleRecord,
    n_columns: usize,
}

impl TracedLevel {
    /// Returns the disc around the centre's child.
    pub(super) fn disc(&self) -> &Disc {
        &self.skeleton.child.disc
    }

    /// Returns the index of the face at the centre that becomes face 0 of the child.
    pub(super) fn rotation(&self) -> usize {
        self.skeleton.child.rotation
    }

    /// Returns the points of the child's support.
    fn wanted(&self) -> &[u32] {
        &self.skeleton.child.vertices[..self.disc().support]
    }

    /// Turns a row over the child's points into one over the disc's points: multiplies by the matrix of the level
    /// without making it.
    pub(super) fn times_row(&self, row: &[f64]) -> Result<Vec<f64>, Unlimited> {
        let product = self.record.times_row(row, self.wanted(), &self.skeleton.origins, self.n_columns);
        product.ok_or(Unlimited::Reach)
    }

    /// Returns the child with the matrix of the level.
    pub(super) fn child(&self) -> Result<Child, Unlimited> {
        Child::new(&self.skeleton.child, &self.record, &self.skeleton.origins, self.n_columns)
    }
}

/// The skeletons computed so far, by disc.
#[derive(Debug)]
pub(super) struct Skeletons<'a> {
    cycle: &'a Cycle<'a>,
    rings: RingCount,
    known: Mutex<BTreeMap<Disc, Arc<Skeleton>>>,
}

impl<'a> Skeletons<'a> {
    /// Creates an empty set.
    pub(super) fn new(cycle: &'a Cycle<'a>, rings: RingCount) -> Self {
        Self { cycle, rings, known: Mutex::default() }
    }

    /// Applies one level to a disc whose vertices carry parameters; also returns the parameters of the child's
    /// vertices.
    pub(super) fn step(
        &self,
        level: usize,
        disc: &Disc,
        parameters: &VertexParameters,
    ) -> Result<(TracedLevel, VertexParameters), Unlimited> {
        self.followed(level, disc, (parameters, None)).map(|(traced, (parameters, _))| (traced, parameters))
    }

    /// Applies one level to a disc whose vertices carry parameters and perturbations; also returns the child's
    /// parameters and numbering. The numbering is that of the whole net, which the perturbations depend on.
    pub(super) fn followed(
        &self,
        level: usize,
        disc: &Disc,
        (parameters, noise): (&VertexParameters, Option<(&Numbering, Perturbation)>),
    ) -> Result<(TracedLevel, (VertexParameters, Option<Numbering>)), Unlimited> {
        let skeleton = self.skeleton(disc, parameters)?;
        let mut net = parameters.carried_by(skeleton.net.clone(), &skeleton.origins);
        net.annotations.numbering = noise.map(|(numbering, _)| Arc::new(numbering.with_origins(&skeleton.origins)));
        let mut record = CycleRecord::new(WeightMode::Exact);
        for step in self.cycle.level(level) {
            let mut sources = self.cycle.plan.sources(step);
            if let (Some(sources), Some((_, perturbation))) = (&mut sources, noise) {
                sources.noise = Some(perturbation.at(self.cycle.upsamplings(level, step)));
            }
            let next = Stepper::new(self.cycle.plan).next_from(&net, step, sources)?;
            record.add(next.action)?;
            net = next.net;
        }
        let Located { vertices, half_edges, .. } = &skeleton.child;
        let parameters = VertexParameters::of(&net, vertices);
        let numbering =
            net.annotations.numbering.map(|numbering| numbering.of_submesh(&skeleton.refined, vertices, half_edges));
        Ok((TracedLevel { skeleton, record, n_columns: disc.support }, (parameters, numbering)))
    }

    fn skeleton(&self, disc: &Disc, parameters: &VertexParameters) -> Result<Arc<Skeleton>, Unlimited> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(skeleton) = known().get(disc) {
            return Ok(skeleton.clone());
        }
        let (net, origins) = disc.net(self.cycle.disc_rules).ok_or(Unlimited::Reach)?;
        let (child, refined) = self.cycle.child(disc, parameters, self.rings)?;
        let skeleton = Arc::new(Skeleton { net, origins, child, refined });
        // another thread may have inserted an equal skeleton
        Ok(known().entry(disc.clone()).or_insert(skeleton).clone())
    }
}
