//! Meshes under refinement.

use std::sync::Arc;

use super::apply::{Points, advance};
use super::error::RefineError;
use super::origins;
use super::refined::RefinedMesh;
use super::start::mesh_net;
use super::sweep::Sweep;
use super::uvs::{RefinedUvs, refined_uvs};
use super::vertex_order::VertexOrder;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Refines a mesh with its channels, all by the same rows, and its texture coordinates by the same scheme.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    let net = mesh_net(mesh, plan);
    if let Some(sweep) = Sweep::of(&net, plan, steps)
        && let Some(refined) = swept(mesh, net.clone(), &sweep, plan, steps, watch)?
    {
        return Ok(refined);
    }
    let (net, points) = act_on(net, numbers(mesh), plan, steps, watch)?;
    let uvs = refined_uvs(mesh, plan, steps, watch)?;
    let refined = assembled(mesh, &net, points.into_iter().map(|points| points.now).collect(), uvs);
    Ok(if steps.is_empty() { refined.with_tags(mesh.tags()) } else { refined })
}

/// The same by a sweep; none where a coordinate is no longer finite, so that the other path finds the level.
fn swept(
    mesh: &Mesh,
    net: MeshNet,
    sweep: &Sweep,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Option<RefinedMesh>, RefineError> {
    let (net, points) = act_on(net, numbers(mesh), plan, &steps[..sweep.steps_before()], watch)?;
    let order = VertexOrder::constructed(&net);
    let mut numbers = Vec::with_capacity(points.len());
    for points in points {
        let mut start = Vec::new();
        order.values(&points.now, points.width, 0..points.now.len() / points.width, &mut start);
        let swept = sweep.refine(&start, points.width, watch)?;
        if !swept.finite {
            return Ok(None);
        }
        numbers.push(swept.points);
    }
    let net = net.after_splits(sweep.splits() - net.mesh.pieces.len());
    let mut numbers = numbers.into_iter();
    let refined = RefinedMesh::documented(&net, numbers.next().unwrap_or_default());
    let uvs = refined_uvs(mesh, plan, steps, watch)?;
    let refined = refined.carrying(mesh.attachments.clone(), numbers.collect(), uvs);
    Ok(Some(refined.split_from(mesh.split_from.clone())))
}

/// What is refined of a mesh: its positions, then its channels.
pub fn numbers(mesh: &Mesh) -> Vec<Points> {
    let channels = mesh.attachments.channels.iter().map(|c| Points::new(c.values.clone(), c.width));
    std::iter::once(Points::new(mesh.positions.clone(), 3)).chain(channels).collect()
}

/// The refined mesh of a net, with its positions, channels and texture coordinates.
pub fn assembled(mesh: &Mesh, net: &MeshNet, numbers: Vec<Vec<f64>>, uvs: Option<RefinedUvs>) -> RefinedMesh {
    let mut numbers = numbers.into_iter();
    let points = numbers.next().unwrap_or_default();
    let refined = RefinedMesh::new(net, points).carrying(mesh.attachments.clone(), numbers.collect(), uvs);
    // a connectivity of its own tells no origins in the input
    let stays = Arc::ptr_eq(&net.mesh.base, &mesh.topology);
    if stays { refined.split_from(mesh.split_from.clone()) } else { refined }
}

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
