//! Decides whether a plan has a limit, and how smooth it is where the net is regular.

use super::cost;
use super::cycle::LEVELS_AHEAD;
use super::error::Unlimited;
use super::impulse::{Impulse, ImpulseSmoothness};
use super::on_net::CycleOnNet;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Checks whether a plan can have a limit, as far as its word shows.
///
/// # Errors
/// [`Unlimited::NoUpsampling`] and [`Unlimited::Fine`].
pub fn check(plan: &Plan) -> Result<(), Unlimited> {
    let cycle = &plan.word.cycle;
    if !cycle.iter().any(|letter| letter.facts().children.refine()) {
        return Err(Unlimited::NoUpsampling);
    }
    if cost::is_beyond(cycle) { Err(Unlimited::Fine) } else { Ok(()) }
}

/// Returns how smooth the limit is where the net is regular: the least smoothness over the extreme parameters that all
/// vertices may carry. `support` is the number of rings that influence the limit.
///
/// # Errors
/// [`Unlimited`], also if the limit is not continuous.
pub(super) fn smoothness(
    on_net: &CycleOnNet<'_>,
    support: usize,
    tangents: bool,
    watch: &Watch,
) -> Result<ImpulseSmoothness, Unlimited> {
    let mut smoothness = ImpulseSmoothness::Smooth;
    for &common in &on_net.extremes {
        smoothness = smoothness.min(Impulse { on_net, common, support }.smoothness(tangents, watch)?);
    }
    if smoothness == ImpulseSmoothness::Rough { Err(Unlimited::Rough) } else { Ok(smoothness) }
}

/// Checks that a plan has a continuous limit on an unrefined net. The cycle must start with an upsampling and perturb
/// nothing.
///
/// # Errors
/// [`Unlimited`], also if continuity cannot be decided.
pub(in crate::analysis) fn check_continuous(plan: &Plan, net: &MeshNet) -> Result<(), Unlimited> {
    check(plan)?;
    let steps = plan.schedule(LEVELS_AHEAD).map_err(|fault| Unlimited::Later(fault.detail))?;
    let watch = Watch::new();
    let on_net = CycleOnNet::of(plan, net, &net.mesh.base, &steps[plan.word.prefix.len()..], &watch)?;
    smoothness(&on_net, cost::support(&plan.word.cycle), false, &watch).map(drop)
}
