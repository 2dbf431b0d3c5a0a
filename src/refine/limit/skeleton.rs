//! Steps of patches whose vertices carry numbers of their own: the connectivity once, the numbers again and again.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::Unlimited;
use super::cycle::{Child, Cycle};
use super::matrix::{Record, Weights};
use super::own::Own;
use super::patch::{Found, Patch, Rings};
use crate::refine::values;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Perturbation;
use crate::shape::numbering::Numbering;
use crate::shape::topology::Topology;

/// A patch as a net, and where its child lies in the net after a level.
#[derive(Debug)]
struct Skeleton {
    net: MeshNet,
    origins: Vec<u32>,
    child: Found,
    /// The topology after the level.
    refined: Arc<Topology>,
}

/// The skeletons that were met.
#[derive(Debug)]
pub(super) struct Skeletons<'a> {
    cycle: &'a Cycle<'a>,
    rings: Rings,
    known: Mutex<BTreeMap<Patch, Arc<Skeleton>>>,
}

impl<'a> Skeletons<'a> {
    /// None yet.
    pub(super) fn new(cycle: &'a Cycle<'a>, rings: Rings) -> Self {
        Self { cycle, rings, known: Mutex::default() }
    }

    /// One level on a patch whose vertices carry these numbers; those of the child's vertices.
    pub(super) fn step(&self, level: usize, patch: &Patch, own: &Own) -> Result<(Child, Own), Unlimited> {
        self.followed(level, patch, (own, None)).map(|(child, (own, _))| (child, own))
    }

    /// One level on a patch whose vertices carry these numbers, and are perturbed by those in the whole net; the same of
    /// the child.
    pub(super) fn followed(
        &self,
        level: usize,
        patch: &Patch,
        (own, noise): (&Own, Option<(&Numbering, Perturbation)>),
    ) -> Result<(Child, (Own, Option<Numbering>)), Unlimited> {
        let skeleton = self.skeleton(patch, own)?;
        let directions = skeleton.net.directions.as_deref().cloned();
        let attributes = own.first().are_there().then(|| own.attributes(&skeleton.origins));
        let mut net = skeleton.net.clone().carrying(attributes, directions);
        net.numbering = noise.map(|(numbering, _)| Arc::new(numbering.with_origins(&skeleton.origins)));
        let mut record = Record::new(Weights::Exact);
        for step in self.cycle.level(level) {
            let mut values = values(self.cycle.plan, step);
            if let (Some(sources), Some((_, perturbation))) = (&mut values.sources, noise) {
                sources.noise = Some(perturbation.at(self.cycle.upsamplings(level, step)));
            }
            let next = step.letter.operator.on_mesh(&net, &values).map_err(Unlimited::from)?;
            record.add(next.action)?;
            net = next.net;
        }
        let Found { patch: child, vertices, corners, turn } = &skeleton.child;
        let matrix = record.matrix(&vertices[..child.support], &skeleton.origins, patch.support);
        let matrix = matrix.ok_or(Unlimited::Reach)?;
        let own = net.attributes.as_ref().map_or_else(Own::default, |attributes| Own::of(attributes, vertices));
        let numbering = net.numbering.map(|numbering| numbering.part(&skeleton.refined, vertices, corners));
        Ok((Child { patch: child.clone(), matrix, turn: *turn }, (own, numbering)))
    }

    fn skeleton(&self, patch: &Patch, own: &Own) -> Result<Arc<Skeleton>, Unlimited> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(skeleton) = known().get(patch) {
            return Ok(skeleton.clone());
        }
        let (net, origins) = patch.net(self.cycle.frame).ok_or(Unlimited::Reach)?;
        let (child, refined) = self.cycle.child(patch, own, self.rings)?;
        let skeleton = Arc::new(Skeleton { net, origins, child, refined });
        // whoever comes first, all find the same
        Ok(known().entry(patch.clone()).or_insert(skeleton).clone())
    }
}
