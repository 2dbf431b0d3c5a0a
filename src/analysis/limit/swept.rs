//! Limits of meshes that are refined patch by patch: the masks of the few kinds of points that occur there, computed on
//! small nets.

use std::sync::Arc;

use super::continuity::{check, smoothness};
use super::disc::{Centre, NEAREST, RingCount};
use super::error::{LimitError, Unlimited};
use super::impulse::ImpulseSmoothness;
use super::mask::{Finder, LimitMask, Masks};
use super::on_net::CycleOnNet;
use super::regular::Starts;
use super::request::LimitRequest;
use super::sector::Sectors;
use super::vertex_parameters::CommonParameters;
use super::walk::WholeNet;
use crate::refine::{Program, RefinedMesh, Stencil, StencilReach, Stencils, TracedRows, mesh_net};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// Refines a mesh patch by patch and computes the requested parts of its limit; `ahead` are the steps that would refine
/// it further. Returns `None` if this is not possible: the mesh must be refined patch by patch, the limit of a point
/// must depend on few points around it and, on triangles and beside sharp edges and boundaries, on the next ones only,
/// and every vertex with faces must have a normal if normals are requested.
///
/// # Errors
/// [`LimitError`] if the refinement fails or is stopped.
pub(super) fn refine_swept(
    mesh: &Mesh,
    plan: &Plan,
    (steps, ahead): (&[Scheduled], &[Scheduled]),
    request: LimitRequest,
    watch: &Watch,
) -> Result<Option<RefinedMesh>, LimitError> {
    let program = Program::of(mesh, plan, steps);
    let [limits, normals] = match stencils(&program, mesh, plan, ahead, request, watch) {
        Ok(Some(found)) => found,
        Err(stopped @ Unlimited::Stopped(_)) => return Err(stopped.into()),
        // limits by rows of the whole net name the reason more exactly
        Ok(None) | Err(_) => return Ok(None),
    };
    let refined = program.refine(mesh, plan, steps, watch)?;
    Ok(program.at_limit(refined, limits.as_ref(), normals.as_ref(), watch).map_err(Unlimited::Stopped)?)
}

/// Returns the rows of the requested limit positions and normals over the points of the refined mesh, each `None` if it
/// is not requested. Returns `None` if [`refine_swept`] does.
///
/// # Errors
/// [`LimitError`].
pub(super) fn trace_swept(
    mesh: &Mesh,
    plan: &Plan,
    (steps, ahead): (&[Scheduled], &[Scheduled]),
    request: LimitRequest,
    watch: &Watch,
) -> Result<Option<[Option<TracedRows>; 2]>, LimitError> {
    if refine_swept(mesh, plan, (steps, ahead), request, watch)?.is_none() {
        return Ok(None);
    }
    let program = Program::of(mesh, plan, steps);
    let (Some(sweep), Some(found)) = (program.points(), stencils(&program, mesh, plan, ahead, request, watch)?) else {
        return Ok(None);
    };
    let [limits, normals] = found.map(|found| found.map(|found| sweep.traced(&found, watch)).transpose());
    Ok(Some([limits.map_err(Unlimited::Stopped)?, normals.map_err(Unlimited::Stopped)?]))
}

/// Returns the stencils of limit positions and of normals as far as they are requested; `None` if small nets do not
/// determine them.
fn stencils(
    program: &Program,
    mesh: &Mesh,
    plan: &Plan,
    ahead: &[Scheduled],
    request: LimitRequest,
    watch: &Watch,
) -> Result<Option<[Option<Stencils>; 2]>, Unlimited> {
    let is_upsampling = |step: &Scheduled| step.letter.facts().role == Role::Upsample;
    let plain = program.points().filter(|sweep| !sweep.is_tagged());
    let Some(sweep) = plain.filter(|_| ahead.first().is_some_and(is_upsampling)) else { return Ok(None) };
    check(plan)?;
    let (net, topology) = (mesh_net(mesh, plan), sweep.patches());
    let on_net = CycleOnNet::of(plan, &net, topology, ahead, watch)?;
    let rings = on_net.rings(Starts { is_open: topology.n_boundary() > 0, others: false })?;
    let smooth = smoothness(&on_net, rings.support, request.normals, watch)?;
    if on_net.surroundings.is_some() || (request.normals && smooth != ImpulseSmoothness::Smooth) {
        return Ok(None);
    }
    let finder = Finder::new(&on_net.cycle, rings, request.normals);
    let small = SmallNets { rings, masks: Masks::new(&finder, CommonParameters::default()), watch };
    let reach = StencilReach { points: rings.support, faces: rings.disc };
    let mut found = [None, None];
    if request.positions {
        found[0] = sweep.stencils(plan, reach, |net, v| small.position(net, v))?;
    }
    if request.normals {
        found[1] = sweep.stencils(plan, reach, |net, v| small.tangents(net, v))?;
    }
    let all = found[0].is_some() == request.positions && found[1].is_some() == request.normals;
    Ok(all.then_some(found))
}

/// A mask and the vertices to which its weights belong.
type Weighed = (Arc<LimitMask>, Vec<u32>);

/// Computes masks of vertices of small nets.
struct SmallNets<'a> {
    rings: RingCount,
    masks: Masks<'a>,
    watch: &'a Watch,
}

impl SmallNets<'_> {
    /// Returns the mask of a vertex and the vertices to which its weights belong; `None` if the vertex has no mask, for
    /// a reason that limits by rows of the whole net name.
    ///
    /// # Errors
    /// [`Unlimited::Stopped`].
    fn mask(&self, net: &MeshNet, v: u32) -> Result<Option<Weighed>, Unlimited> {
        self.watch.check()?;
        let whole = WholeNet::of(net, &net.mesh.base);
        let Some(found) = whole.disc(Centre::Vertex(v), self.rings) else { return Ok(None) };
        match self.masks.of(0, &found.disc) {
            Ok(mask) => Ok(Some((mask, found.vertices))),
            Err(stopped @ Unlimited::Stopped(_)) => Err(stopped),
            Err(_) => Ok(None),
        }
    }

    /// Returns the stencil of the limit position of a vertex.
    fn position(&self, net: &MeshNet, v: u32) -> Result<Option<Stencil<u32>>, Unlimited> {
        let stencil = |(mask, vertices): Weighed| {
            let weights = vertices.into_iter().zip(mask.position.iter().copied()).collect();
            Stencil { sectors: vec![vec![weights]], sides: Vec::new() }
        };
        Ok(self.mask(net, v)?.map(stencil))
    }

    /// Returns the stencil of the two tangents in each sector of a vertex; `None` if a sector has none.
    fn tangents(&self, net: &MeshNet, v: u32) -> Result<Option<Stencil<u32>>, Unlimited> {
        let Some((mask, vertices)) = self.mask(net, v)? else { return Ok(None) };
        let weights = |tangent: &Vec<f64>| vertices.iter().copied().zip(tangent.iter().copied()).collect();
        let sector = |found: &Result<[Vec<f64>; 2], _>| Some(found.as_ref().ok()?.iter().map(weights).collect());
        let Some(sectors) = mask.tangents.iter().map(sector).collect::<Option<Vec<_>>>() else { return Ok(None) };
        let near = WholeNet::of(net, &net.mesh.base).disc(Centre::Vertex(v), NEAREST);
        let sides = near.filter(|_| sectors.len() > 1).map_or_else(Vec::new, |near| {
            let all = Sectors::of(&near.disc);
            let faces = near.disc.central_faces().enumerate();
            faces.map(|(i, face)| (near.vertices[face[1] as usize], all.of_face(i))).collect()
        });
        Ok(Some(Stencil { sectors, sides }))
    }
}
