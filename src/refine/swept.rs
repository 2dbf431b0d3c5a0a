//! Refines the points of a net by a sweep, where its plan allows one.

use super::act::act_on;
use super::apply::Points;
use super::error::RefineError;
use super::sweep::Sweep;
use super::vertex_order::VertexOrder;
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::watch::{Stage, Watch};

/// Returns the net after all steps, as far as it is tracked (see [`MeshNet::after_splits`]), and all points in the
/// documented order. Returns `None` if the steps have no sweep, or if a coordinate is no longer finite, so that
/// refinement by rows can name the level.
///
/// # Errors
/// [`RefineError`].
pub(super) fn swept(
    net: MeshNet,
    points: Vec<Points>,
    plan: &Plan,
    steps: &[Scheduled],
    sweep: Option<&Sweep>,
    watch: &Watch,
) -> Result<Option<(MeshNet, Vec<Numbers>)>, RefineError> {
    let Some(sweep) = sweep else { return Ok(None) };
    watch.enter(Stage::Sweep);
    let (net, points) = act_on(net, points, plan, &steps[..sweep.steps_before()], watch)?;
    let order = VertexOrder::constructed(&net);
    let mut numbers = Vec::with_capacity(points.len());
    for points in points {
        let swept = sweep.refine(&order.ordered(points.now, points.width), points.width, watch)?;
        if !swept.finite {
            watch.enter(Stage::Refine);
            return Ok(None);
        }
        numbers.push(swept.points);
    }
    Ok(Some((net.after_splits(sweep.tile(), sweep.splits() - net.mesh.pieces.len()), numbers)))
}
