//! Meshes under refinement.

use std::sync::Arc;

use super::act::act_on;
use super::apply::Points;
use super::error::RefineError;
use super::refined::RefinedMesh;
use super::start::mesh_net;
use super::sweep::Outline;
use super::swept::swept;
use super::uvs::{RefinedUvs, refine_uvs_by_rows, refined_uvs};
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Refines a mesh with its channels, all by the same rows, and its texture coordinates by the same scheme.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    let (net, points) = (mesh_net(mesh, plan), numbers(mesh));
    let refined = match swept(&net, &points, plan, steps, watch)? {
        Some((net, numbers)) => {
            let mut numbers = numbers.into_iter();
            let refined = RefinedMesh::documented(&net, numbers.next().unwrap_or_default());
            let uvs = refined_uvs(mesh, plan, steps, watch)?;
            carrying(mesh, &net, refined, numbers.collect(), uvs)
        }
        None => refine_by_rows(mesh, plan, steps, watch)?,
    };
    Ok(if steps.is_empty() { refined.with_tags(mesh.tags()) } else { refined })
}

/// Whether a mesh is refined patch by patch.
pub fn is_swept(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> bool {
    Outline::of(&mesh_net(mesh, plan), plan, steps).is_some()
}

/// Refines a mesh by rows of whole nets: the definition of what every other path makes.
///
/// # Errors
/// [`RefineError`].
pub fn refine_by_rows(
    mesh: &Mesh,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<RefinedMesh, RefineError> {
    let (net, points) = act_on(mesh_net(mesh, plan), numbers(mesh), plan, steps, watch)?;
    let uvs = refine_uvs_by_rows(mesh, plan, steps, watch)?;
    Ok(assembled(mesh, &net, points.into_iter().map(|points| points.now).collect(), uvs))
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
    carrying(mesh, net, RefinedMesh::new(net, points), numbers.map(Into::into).collect(), uvs)
}

/// The mesh of a net with what the input carries besides its positions.
pub(super) fn carrying(
    mesh: &Mesh,
    net: &MeshNet,
    refined: RefinedMesh,
    channels: Vec<Numbers>,
    uvs: Option<RefinedUvs>,
) -> RefinedMesh {
    let refined = refined.carrying(mesh.attachments.clone(), channels, uvs);
    // a connectivity of its own tells no origins in the input
    let stays = Arc::ptr_eq(&net.mesh.base, &mesh.topology);
    if stays { refined.split_from(mesh.split_from.clone()) } else { refined }
}
