//! The cycle of a plan on a net: the data of a scheme that do not depend on single vertices.

use std::sync::Arc;

use super::cycle::Cycle;
use super::disc::RingCount;
use super::disc_rules::DiscRules;
use super::error::Unlimited;
use super::refined_net::carries;
use super::regular::{Regular, Starts};
use super::vertex_parameters::{CommonParameters, extremes};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::surroundings::Surroundings;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::topology::Topology;
use crate::watch::Watch;

/// A cycle on a net.
#[derive(Debug)]
pub(super) struct CycleOnNet<'a> {
    /// The cycle.
    pub(super) cycle: Cycle<'a>,
    /// The kind of net on which the cycle is regular.
    pub(super) regular: Regular,
    /// Whether the net has latitude or longitude lines.
    pub(super) tagged: bool,
    /// What rules need to know of the net beyond a disc, if anything.
    pub(super) surroundings: Option<Surroundings>,
    /// Parameter sets combined from the smallest and largest values that vertices carry; at least one entry.
    pub(super) extremes: Vec<CommonParameters>,
    /// Whether sharpness evens out along edges, so that a disc must contain all faces around the vertices that
    /// influence the limit.
    evens_out: bool,
}

impl<'a> CycleOnNet<'a> {
    /// Creates the cycle of a plan on a net with this topology. `ahead` are the steps that would refine it, an
    /// upsampling first.
    ///
    /// # Errors
    /// [`Unlimited`] if an operator cannot be applied to a regular net.
    pub(super) fn of(
        plan: &'a Plan,
        net: &MeshNet,
        topology: &Arc<Topology>,
        ahead: &'a [Scheduled],
        watch: &Watch,
    ) -> Result<Self, Unlimited> {
        let extremes = extremes(net.annotations.attributes.as_deref());
        let alphas = extremes.iter().filter_map(CommonParameters::alpha).chain([plan.alpha]);
        let alphas: Vec<f64> = alphas.filter(|_| carries(net)).collect();
        let disc_rules = DiscRules::of(plan, &net.mesh.base);
        let cycle = Cycle::new(plan, (ahead, plan.word.cycle.len()), disc_rules, &alphas, watch);
        let semi_sharp = |&(_, sharpness): &(u32, f64)| sharpness < INFINITE_SHARPNESS;
        let any = net.sharpness.as_ref().is_some_and(|sharpness| sharpness.edges().iter().any(semi_sharp));
        Ok(Self {
            regular: Regular::of(&cycle, topology)?,
            tagged: net.annotations.directions.is_some(),
            surroundings: cycle.surroundings(topology),
            cycle,
            extremes,
            evens_out: any && net.rules.creasing.evens_out(),
        })
    }

    /// Returns the smallest number of rings that determine a limit.
    ///
    /// # Errors
    /// [`Unlimited`] if there are too many.
    pub(super) fn rings(&self, starts: Starts) -> Result<RingCount, Unlimited> {
        let rings = self.regular.rings(&self.cycle, self.tagged, starts)?;
        let least = if self.evens_out { rings.support + 1 } else { 0 };
        Ok(RingCount { disc: rings.disc.max(least), ..rings })
    }
}
