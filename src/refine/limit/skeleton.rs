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

/// A patch as a net, and where its child lies in the net after a level.
#[derive(Debug)]
struct Skeleton {
    net: MeshNet,
    origins: Vec<u32>,
    child: Found,
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
        let skeleton = self.skeleton(patch, own)?;
        let directions = skeleton.net.directions.as_deref().cloned();
        let mut net = skeleton.net.clone().carrying(Some(own.attributes(&skeleton.origins)), directions);
        let mut record = Record::new(Weights::Exact);
        for step in self.cycle.level(level) {
            let next = step.letter.operator.on_mesh(&net, &values(self.cycle.plan, step)).map_err(Unlimited::from)?;
            record.add(&next.action)?;
            net = next.net;
        }
        let Found { patch: child, vertices, turn } = &skeleton.child;
        let matrix = record.matrix(&vertices[..child.support], &skeleton.origins, patch.support);
        let matrix = matrix.ok_or(Unlimited::Reach)?;
        let own = net.attributes.as_ref().map_or_else(Own::default, |attributes| Own::of(attributes, vertices));
        Ok((Child { patch: child.clone(), matrix, turn: *turn }, own))
    }

    fn skeleton(&self, patch: &Patch, own: &Own) -> Result<Arc<Skeleton>, Unlimited> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(skeleton) = known().get(patch) {
            return Ok(skeleton.clone());
        }
        let (net, origins) = patch.net(self.cycle.plan.rules).ok_or(Unlimited::Reach)?;
        let child = self.cycle.child(patch, own, self.rings)?;
        let skeleton = Arc::new(Skeleton { net, origins, child });
        // whoever comes first, all find the same
        Ok(known().entry(patch.clone()).or_insert(skeleton).clone())
    }
}
