//! Refines meshes and moves their vertices to their limits.

use std::sync::Arc;

use super::cycle::LEVELS_AHEAD;
use super::error::{LimitError, Unlimited};
use super::limits::{VertexLimits, limits, without_normals};
use super::request::LimitRequest;
use super::swept::refine_swept;
use crate::fault::Fault;
use crate::refine::{RefinedMesh, act_on, assembled, mesh_net, numbers, refined_places};
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::watch::{Stage, Watch};

/// Refines a mesh in all its frames by `levels` levels and computes the limit positions and normals that are requested.
/// Also returns warnings about normals that do not exist.
///
/// # Errors
/// [`LimitError`], also where there is no limit.
pub fn refine_mesh_to_limit(
    mesh: &Mesh,
    plan: &Plan,
    levels: u32,
    request: LimitRequest,
    watch: &Watch,
) -> Result<(RefinedMesh, Vec<String>), LimitError> {
    let (refined, mut warnings) = at_one_frame(&mesh.at_frame(Some(0)), plan, levels, request, watch)?;
    let mut frames = Vec::with_capacity(mesh.frames.len());
    for frame in 1..=mesh.frames.len() {
        let alone = Mesh { attachments: Arc::default(), ..mesh.at_frame(Some(frame)).into_owned() };
        let (frame, found) = at_one_frame(&alone, plan, levels, request, watch)?;
        frames.push(refined.moved(frame));
        warnings.extend(found);
    }
    warnings.sort_unstable();
    warnings.dedup();
    Ok((refined.with_frames(frames), warnings))
}

/// Refines a mesh with a single frame, patch by patch if possible.
fn at_one_frame(
    mesh: &Mesh,
    plan: &Plan,
    levels: u32,
    request: LimitRequest,
    watch: &Watch,
) -> Result<(RefinedMesh, Vec<String>), LimitError> {
    let (steps, at) = scheduled(plan, levels)?;
    let steps = steps.split_at(at);
    if let Some(refined) = refine_swept(mesh, plan, steps, request, watch)? {
        return Ok((refined, Vec::new()));
    }
    // the attempt to refine patch by patch may have entered another stage
    watch.enter(Stage::Refine);
    by_rows(mesh, plan, steps, request, watch)
}

/// Returns the steps of `levels` levels and of the [`LEVELS_AHEAD`] levels after them that limits use, and the number
/// of the former.
pub(super) fn scheduled(plan: &Plan, levels: u32) -> Result<(Vec<Scheduled>, usize), Unlimited> {
    let later = |fault: Fault| Unlimited::Later(fault.detail);
    let steps = plan.schedule(levels + LEVELS_AHEAD).map_err(later)?;
    Ok((steps, plan.word.prefix.len() + levels as usize * plan.word.cycle.len()))
}

/// Refines a mesh by the rows of whole nets and computes its limits by the masks of all vertices. This defines the
/// result of [`refine_mesh_to_limit`] up to rounding.
///
/// # Errors
/// [`LimitError`], also where there is no limit.
pub fn to_limit_by_rows(
    mesh: &Mesh,
    plan: &Plan,
    levels: u32,
    request: LimitRequest,
    watch: &Watch,
) -> Result<(RefinedMesh, Vec<String>), LimitError> {
    let (steps, at) = scheduled(plan, levels)?;
    by_rows(mesh, plan, steps.split_at(at), request, watch)
}

/// Refines a mesh by rows and computes its limits by masks, given the steps of the levels and those ahead of them.
fn by_rows(
    mesh: &Mesh,
    plan: &Plan,
    (steps, ahead): (&[Scheduled], &[Scheduled]),
    request: LimitRequest,
    watch: &Watch,
) -> Result<(RefinedMesh, Vec<String>), LimitError> {
    let (net, points) = act_on(mesh_net(mesh, plan), numbers(mesh), plan, steps, watch)?;
    let found = match limits(plan, &net, &points, ahead, request, watch) {
        Err(error) if !request.positions && !matches!(error, Unlimited::Stopped(_)) => {
            VertexLimits { warning: Some(without_normals(error)), ..VertexLimits::default() }
        }
        found => found?,
    };
    let refined = || points.into_iter().map(|points| points.now).collect::<Vec<_>>();
    let places = refined_places(mesh, plan, steps, watch)?;
    let mesh = assembled(mesh, &net, found.points.unwrap_or_else(refined), places).with_normals(found.normals);
    Ok((mesh, found.warning.into_iter().collect()))
}
