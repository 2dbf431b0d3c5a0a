//! Applies steps of a plan to a mesh and names vertices of the input in errors.

use super::apply::{Points, advance};
use super::error::RefineError;
use super::origins;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::watch::Watch;

/// Applies `steps` to `net` and `points` and returns the refined net and points; errors name vertices of the input.
///
/// # Errors
/// [`RefineError`].
pub fn act_on(
    mut net: MeshNet,
    mut points: Vec<Points>,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<(MeshNet, Vec<Points>), RefineError> {
    advance(&mut net, &mut points, plan, steps, watch).map_err(|error| match error {
        RefineError::Step { level, error } => RefineError::Step { level, error: origins::on_mesh(&net, error) },
        error => error,
    })?;
    Ok((net, points))
}
