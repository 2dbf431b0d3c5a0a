//! Refines meshes by rows of whole nets, and attaches channels, texture coordinates and frames to the result.

use std::sync::Arc;

use super::act::act_on;
use super::apply::Points;
use super::error::RefineError;
use super::refined::{RefinedChannel, RefinedMesh};
use super::seams::{RefinedPlaces, followed, refine_places_by_rows, seam_net};
use super::start::mesh_net;
use super::sweep::SweepOutline;
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::attachments::{Channel, Places};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Returns whether the vertices of `mesh` are refined patch by patch.
pub fn is_swept(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> bool {
    SweepOutline::of(&mesh_net(mesh, plan), plan, steps).is_some()
}

/// Returns the greatest number of rounds for which the vertices or face-corner values of a mesh are refined by rows
/// before the sweep takes over, or `None` if any of them is not refined patch by patch.
pub fn swept_from(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> Option<usize> {
    let before = SweepOutline::of(&mesh_net(mesh, plan), plan, steps)?.before();
    mesh.attachments.places().try_fold(before, |before, Places { seams, .. }| {
        Some(before.max(SweepOutline::of(&seam_net(mesh, seams, plan), plan, &followed(seams, steps))?.before()))
    })
}

/// Refines a mesh by rows of whole nets. This path is the reference: every other path must give the same result.
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
    let places = refine_places_by_rows(mesh, plan, steps, watch)?;
    Ok(assembled(mesh, &net, points.into_iter().map(|points| points.now).collect(), places))
}

/// Returns the point sets that belong to the vertices of a mesh: positions, then channels without seams, then the
/// positions of the other frames.
pub fn numbers(mesh: &Mesh) -> Vec<Points> {
    let channels = mesh
        .attachments
        .channels
        .iter()
        .filter(|channel| channel.seams.is_none())
        .map(|c| Points::new(c.values.clone(), c.width));
    let frames = mesh.frames.iter().map(|frame| Points::new(frame.clone(), 3));
    std::iter::once(Points::new(mesh.positions.clone(), 3)).chain(channels).chain(frames).collect()
}

/// Assembles the refined mesh from its net, its values in the order of [`numbers`], and its refined face-corner
/// values.
pub fn assembled(mesh: &Mesh, net: &MeshNet, numbers: Vec<Vec<f64>>, places: Vec<RefinedPlaces>) -> RefinedMesh {
    carrying(mesh, net, RefinedMesh::new, numbers.into_iter().map(Into::into).collect(), places)
}

/// Assembles the refined mesh of a net; `ordered` builds a mesh from the net and one set of points.
pub(super) fn carrying(
    mesh: &Mesh,
    net: &MeshNet,
    ordered: impl Fn(&MeshNet, Numbers) -> RefinedMesh,
    numbers: Vec<Numbers>,
    places: Vec<RefinedPlaces>,
) -> RefinedMesh {
    let mut numbers = numbers.into_iter();
    let refined = ordered(net, numbers.next().unwrap_or_default());
    let mut places = places.into_iter().map(Arc::new);
    let uvs = mesh.attachments.uvs.as_ref().and_then(|_| places.next());
    let channel = |channel: &Channel| match &channel.seams {
        Some(_) => places.next().map(RefinedChannel::Places),
        None => numbers.next().map(RefinedChannel::Vertices),
    };
    let channels = mesh.attachments.channels.iter().filter_map(channel).collect();
    let refined = refined.carrying(mesh.attachments.clone(), channels, uvs);
    let frames: Vec<_> = numbers.map(|points| refined.moved(ordered(net, points))).collect();
    let refined = refined.with_frames(frames);
    // vertices of the input have origins only if the base of the net is the input's own topology
    let stays = Arc::ptr_eq(&net.mesh.base, &mesh.topology);
    if stays { refined.split_from(mesh.split_from.clone()) } else { refined }
}
