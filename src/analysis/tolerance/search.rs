//! Searches for the first level that is within a tolerance of the limit surface.

use super::bounds::{LEAST_MESH_TOLERANCE, MAX_MESH_WORK, MAX_NET_FACES, MAX_SEARCH_LEVEL};
use super::budget::Budget;
use super::placed::VertexPlacement;
use super::spline::Spline;
use super::walk::LevelWalk;
use crate::analysis::curve::Reached;
use crate::analysis::no_level::NoLevel;
use crate::refine::{Points, act_on, mesh_net};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Memory that a search takes per face of the largest net, in bytes.
/// A cube with one corner a million times as far away as the others takes 550 MiB at [`MAX_NET_FACES`] faces, 2.2 KiB
/// per face, so that a quarter is spare. Half of it promises less than is taken; twice of it lets half as many searches
/// run at once.
const BYTES_A_FACE: u64 = 3 << 10;
/// Allowance for rounding that is added to a bound, relative to the greatest coordinate.
/// It is 45 times the spacing of numbers there, nearly three roundings for each of 16 levels. Half of it allows for
/// half of these; twice of it adds a 50th of [`LEAST_MESH_TOLERANCE`] to every bound.
const BOUND_ROUNDING: f64 = 1e-14;

/// Checks whether a level can be searched for, as far as that is known without a search.
///
/// # Errors
/// [`NoLevel`] with the reason why not.
pub fn check(mesh: &Mesh, plan: &Plan, tolerance: f64) -> Result<(), NoLevel> {
    Spline::of(plan, mesh)?;
    check_size(mesh, tolerance).map(|_| ())
}

/// Returns the greatest absolute coordinate of a mesh.
///
/// # Errors
/// [`NoLevel`] if the tolerance is less than [`LEAST_MESH_TOLERANCE`] of it.
fn check_size(mesh: &Mesh, tolerance: f64) -> Result<f64, NoLevel> {
    let size = mesh.positions.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if tolerance >= LEAST_MESH_TOLERANCE * size {
        return Ok(size);
    }
    let least = size * LEAST_MESH_TOLERANCE;
    Err(NoLevel::Refused(format!(
        "{tolerance} is below what rounding leaves of coordinates of {size}; ask for at least {least}"
    )))
}

/// Returns an upper bound of the memory that a search takes, in bytes.
pub fn search_bytes(mesh: &Mesh) -> u64 {
    let faces = mesh.topology.n_half_edges().max(mesh.topology.n_faces()).max(MAX_NET_FACES);
    BYTES_A_FACE.saturating_mul(faces as u64)
}

/// Returns the first level at which a mesh is known to be within `tolerance`, in model units, of its limit surface for
/// all given placements of its vertices, and the bound that is known there.
///
/// # Errors
/// [`NoLevel`] if there is no such level within the limits of a search, and when `watch` says stop.
pub fn reach(
    mesh: &Mesh,
    plan: &Plan,
    placed: &[VertexPlacement],
    tolerance: f64,
    watch: &Watch,
) -> Result<Reached, NoLevel> {
    let spline = Spline::of(plan, mesh)?;
    let size = check_size(mesh, tolerance)?;
    let budget = &Budget::of(watch, MAX_MESH_WORK);
    let points = vec![Points::new(mesh.positions.clone(), 3)];
    let (net, mut points) = act_on(mesh_net(mesh, plan), points, &spline.plan, &spline.prefix, watch)?;
    let mut walk = LevelWalk::new(net, points.remove(0));
    for level in 0..=MAX_SEARCH_LEVEL {
        if walk.is_ready(&spline) {
            let mut most = 0.0;
            for &placed in placed {
                most = walk.bound(&spline, placed, tolerance, BOUND_ROUNDING * size, budget)?.max(most);
            }
            let bound = most + BOUND_ROUNDING * size;
            if bound <= tolerance {
                return Ok(Reached { level, bound });
            }
        }
        budget.check()?;
        walk.leave(&spline, tolerance, budget)?;
        let faces = walk.level.faces_after(spline.rounds.len() + usize::from(spline.halved));
        if faces > MAX_NET_FACES {
            return Err(NoLevel::Refused(format!(
                "level {} has {faces} faces near which distances are not bounded in advance; up to {MAX_NET_FACES} are \
                 looked at: ask for a coarser tolerance, or give \"levels\" as a number",
                level + 1
            )));
        }
        walk.on(&spline, watch)?;
    }
    Err(NoLevel::Refused(format!(
        "no level up to {MAX_SEARCH_LEVEL} is known to be within {tolerance} of the limit; ask for a coarser tolerance"
    )))
}
