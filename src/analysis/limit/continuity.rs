//! Whether a plan has a limit, and how smooth that is where the net is regular.

use super::cost;
use super::cycle::{AHEAD, Cycle};
use super::error::Unlimited;
use super::impulse::{Impulse, Smoothness};
use super::patch_rules::PatchRules;
use super::regular::Regular;
use super::vertex_parameters::{self, CommonParameters};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Whether a plan can have a limit, as far as its word tells.
///
/// # Errors
/// [`Unlimited`].
pub fn check(plan: &Plan) -> Result<(), Unlimited> {
    let cycle = &plan.word.cycle;
    if !cycle.iter().any(|letter| letter.facts().children.refine()) {
        return Err(Unlimited::NoUpsampling);
    }
    if cost::is_beyond(cycle) { Err(Unlimited::Fine) } else { Ok(()) }
}

/// How smooth the limit is where it is regular, with each of these parameters at all vertices.
pub(super) fn smoothness(
    impulse: Impulse<'_>,
    parameters: Vec<CommonParameters>,
    tangents: bool,
    watch: &Watch,
) -> Result<Smoothness, Unlimited> {
    let mut smoothness = Smoothness::Smooth;
    for common in if parameters.is_empty() { vec![CommonParameters::default()] } else { parameters } {
        smoothness = smoothness.min(Impulse { common, ..impulse }.smoothness(tangents, watch)?);
    }
    if smoothness == Smoothness::Rough { Err(Unlimited::Rough) } else { Ok(smoothness) }
}

/// Whether a plan whose cycle starts with an upsampling, and perturbs nothing, has a continuous limit on a net.
///
/// # Errors
/// [`Unlimited`], also where that cannot be told.
pub(in crate::analysis) fn check_continuous(plan: &Plan, net: &MeshNet) -> Result<(), Unlimited> {
    check(plan)?;
    let steps = plan.schedule(AHEAD).map_err(|fault| Unlimited::Later(fault.detail))?;
    let parameters = net.annotations.attributes.as_deref().map_or_else(Vec::new, vertex_parameters::extremes);
    let alphas: Vec<f64> = parameters.iter().filter_map(CommonParameters::alpha).chain([plan.alpha]).collect();
    let ahead = (&steps[plan.word.prefix.len()..], plan.word.cycle.len());
    let cycle = Cycle::new(plan, ahead, PatchRules::of(plan, &net.mesh.base), &alphas, &Watch::new());
    let (regular, tagged) = (Regular::of(&cycle, &net.mesh.base)?, net.annotations.directions.is_some());
    let (support, common) = (cost::support(&plan.word.cycle), CommonParameters::default());
    let impulse = Impulse { cycle: &cycle, regular, tagged, common, support };
    smoothness(impulse, parameters, false, &Watch::new()).map(drop)
}
