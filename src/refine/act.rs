//! Steps of a plan applied to a mesh, with errors that name its own vertices.

use super::apply::{Points, advance};
use super::error::RefineError;
use super::origins;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::watch::Watch;

/// Applies steps to a net and its points; errors name the vertices of the input.
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
