//! Refines face-corner values (texture coordinates and channels with seams) as meshes of their own, by the scheme of
//! the mesh.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::apply::{Points, advance};
use super::error::RefineError;
use super::start::{carried, mesh_net};
use super::sweep::Sweep;
use super::swept::swept;
use super::vertex_order::VertexOrder;
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::stepper::Stepper;
use crate::scheme::tags::Boundary;
use crate::shape::attachments::Places;
use crate::shape::creases::{INFINITE_SHARPNESS, Sharp};
use crate::shape::directions::Directions;
use crate::shape::mesh::Mesh;
use crate::shape::numbering::Numbering;
use crate::shape::seams::Seams;
use crate::shape::topology::{Topology, index};
use crate::watch::Watch;

/// Refined face-corner values: the places are the vertices of a mesh with the faces of the refined mesh.
#[derive(Debug)]
pub struct RefinedPlaces {
    /// Values of the places, `n_places x width`.
    pub(super) points: Numbers,
    /// Number of values per place.
    pub(super) width: usize,
    /// The topology of the places before refinement.
    pub(super) base: Arc<Topology>,
    /// The order in which the values are stored.
    pub(super) order: VertexOrder,
}

impl RefinedPlaces {
    /// Returns the values of a place, indexed in the documented order.
    pub(super) fn row(&self, place: usize) -> &[f64] {
        let at = self.order.place(place);
        &self.points[self.width * at..self.width * (at + 1)]
    }
}

/// Refines everything of a mesh that has seams
/// ([`Attachments::places`](crate::shape::attachments::Attachments::places)) by the steps of a plan; linearly
/// interpolated values follow the upsamplings only.
///
/// # Errors
/// [`RefineError`].
pub fn refined_places(
    mesh: &Mesh,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Vec<RefinedPlaces>, RefineError> {
    refined_places_by(&seam_sweeps(mesh, plan, steps), mesh, plan, steps, watch)
}

/// Returns the sweep of each attribute with seams, or `None` for those that are not refined patch by patch.
pub(super) fn seam_sweeps(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> Vec<Option<Sweep>> {
    let sweep =
        |places: Places<'_>| Sweep::of(&seam_net(mesh, places.seams, plan), plan, &followed(places.seams, steps));
    mesh.attachments.places().map(sweep).collect()
}

/// Returns the steps that face-corner values follow: all steps, or linear upsamplings only.
pub(super) fn followed<'a>(seams: &Seams, steps: &'a [Scheduled]) -> Cow<'a, [Scheduled]> {
    if seams.linear { steps.iter().filter_map(Scheduled::linear).collect() } else { steps.into() }
}

/// Refines everything of a mesh that has seams by the given sweeps, or by rows where there is no sweep.
///
/// # Errors
/// [`RefineError`].
pub(super) fn refined_places_by(
    sweeps: &[Option<Sweep>],
    mesh: &Mesh,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Vec<RefinedPlaces>, RefineError> {
    let refined = |(places, sweep): (Places<'_>, &Option<Sweep>)| {
        let net = seam_net(mesh, places.seams, plan);
        let points = Points::new(places.values.to_vec(), places.width);
        let found = swept(net, vec![points], plan, &followed(places.seams, steps), sweep.as_ref(), watch)?;
        let Some((net, numbers)) = found else { return by_rows(mesh, places, plan, steps, watch) };
        let order = VertexOrder::documented(&net);
        let points = numbers.into_iter().next().unwrap_or_default();
        Ok(RefinedPlaces { points, width: places.width, base: net.mesh.base, order })
    };
    mesh.attachments.places().zip(sweeps).map(refined).collect()
}

/// Refines everything of a mesh that has seams by rows of the whole net.
///
/// # Errors
/// [`RefineError`].
pub(super) fn refine_places_by_rows(
    mesh: &Mesh,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Vec<RefinedPlaces>, RefineError> {
    mesh.attachments.places().map(|places| by_rows(mesh, places, plan, steps, watch)).collect()
}

fn by_rows(
    mesh: &Mesh,
    places: Places<'_>,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<RefinedPlaces, RefineError> {
    let Places { width, values, seams } = places;
    let (mut net, mut points) = (seam_net(mesh, seams, plan), Points::new(values.to_vec(), width));
    if seams.linear {
        for step in steps.iter().filter_map(Scheduled::linear) {
            // linear steps do not use per-vertex parameters
            let next = Stepper::new(plan).next_from(&net, &step, None).map_err(RefineError::at(&step))?;
            points.act(&next.action, step.level, watch)?;
            net = next.net;
        }
    } else {
        advance(&mut net, std::slice::from_mut(&mut points), plan, steps, watch)?;
    }
    let order = VertexOrder::constructed(&net);
    Ok(RefinedPlaces { points: points.now.into(), width, base: net.mesh.base, order })
}

/// Returns the net of face-corner values before refinement. A place at a vertex that keeps its position keeps its
/// value; sharp edges and vertices have the sharpness that they have in the mesh; seams are boundaries. Places have the
/// parameters of their vertices, and edges the directions of those of the mesh. Perturbations are seeded by vertices of
/// the mesh, so that they agree on both sides of a seam.
pub fn seam_net(mesh: &Mesh, seams: &Seams, plan: &Plan) -> MeshNet {
    let (places, vertices) = (&seams.topology, &mesh.topology);
    let fixed = mesh_net(mesh, plan).tags.corners;
    let mut corners = seams.corners.clone();
    let mut semi_sharp = Sharp::new();
    for place in 0..index(places.n_vertices()) {
        let Some(vertex) = seams.vertex(place, vertices) else { continue };
        if fixed.binary_search(&vertex).is_ok() {
            corners.push(place);
        } else if let Ok(found) = mesh.semi_sharp_corners.binary_search_by_key(&vertex, |&(v, _)| v) {
            semi_sharp.push((place, mesh.semi_sharp_corners[found].1));
        }
    }
    let inside = |&(e, sharpness): &(u32, f64)| {
        let edge = places.edge(vertices.halves(e as usize)[0]);
        (!places.is_boundary_edge(edge as usize)).then_some((edge, sharpness))
    };
    let mut creases: Sharp = mesh.creases.iter().filter_map(inside).collect();
    creases.sort_unstable_by_key(|&(e, _)| e);
    let (fixed, mut following) = following(seams, &creases);
    corners.extend(fixed);
    corners.sort_unstable();
    corners.dedup();
    following.retain(|(place, _)| semi_sharp.binary_search_by_key(place, |&(place, _)| place).is_err());
    semi_sharp.retain(|(place, _)| corners.binary_search(place).is_err());
    let elsewhere = elsewhere(mesh, seams, &creases);
    let sharpness = Sharpness::of(&creases, &semi_sharp);
    let sharpness = sharpness.map(|sharpness| sharpness.following(following).beside(elsewhere));
    let net = MeshNet::new(seams.topology.clone(), &corners, &[], Boundary::EdgeOnly);
    let net = net.with_sharpness(sharpness, plan.rules);
    if seams.linear { net } else { carrying(net, mesh, seams, plan) }
}

/// Returns the net with the vertex parameters and edge directions of the mesh, and with the mesh's vertex numbering if
/// the plan perturbs points.
fn carrying(net: MeshNet, mesh: &Mesh, seams: &Seams, plan: &Plan) -> MeshNet {
    let (places, vertices) = (&seams.topology, &mesh.topology);
    let (attributes, directions) = carried(mesh, plan);
    let numbered = plan.perturbation.is_some() && places != vertices;
    if attributes.is_none() && directions.is_none() && !numbered {
        return net;
    }
    let mut vertex_of = vec![0; places.n_vertices()];
    for corner in 0..index(places.n_half_edges()) {
        vertex_of[places.vertex(corner) as usize] = vertices.vertex(corner);
    }
    let of_places = |array: &[f64]| vertex_of.iter().map(|&v| array[v as usize]).collect();
    let edge_of = |e: usize| vertices.edge(places.halves(e)[0]);
    let of_edges = |directions: Directions| {
        Directions::of_edges((0..places.n_edges()).map(|e| directions.of(edge_of(e))).collect())
    };
    let attributes = attributes.map(|attributes| attributes.changed(of_places));
    let numbering = numbered.then(|| Arc::new(Numbering::of(vertices).with_origins(&vertex_of)));
    let mut net = net.carrying(attributes, directions.map(of_edges));
    net.annotations.numbering = numbering;
    net
}

/// Returns, for each place where a semi-sharp edge ends, the sharpness of the other semi-sharp edges at the same mesh
/// vertex, which lie on a seam or beyond it. Sharpness is a property of the mesh: its decay averages over all edges at
/// a vertex.
fn elsewhere(mesh: &Mesh, seams: &Seams, creases: &Sharp) -> Vec<(u32, f64)> {
    let (places, vertices) = (&seams.topology, &mesh.topology);
    let semi_sharp = |&&(_, sharpness): &&(u32, f64)| sharpness < INFINITE_SHARPNESS;
    let mut around: BTreeMap<u32, Vec<(u32, f64)>> = BTreeMap::new();
    for &(e, sharpness) in mesh.creases.iter().filter(semi_sharp) {
        let edge = places.edge(vertices.halves(e as usize)[0]);
        vertices.ends(e as usize).into_iter().for_each(|v| around.entry(v).or_default().push((edge, sharpness)));
    }
    let ends = creases.iter().filter(semi_sharp).flat_map(|&(edge, _)| places.ends(edge as usize));
    let sharp: BTreeSet<u32> = ends.collect();
    let beside = |place: u32| {
        let away = move |&&(edge, _): &&(u32, f64)| {
            places.is_boundary_edge(edge as usize) || !places.ends(edge as usize).contains(&place)
        };
        let all = seams.vertex(place, vertices).and_then(|v| around.get(&v)).map_or(&[][..], Vec::as_slice);
        all.iter().filter(away).map(move |&(_, sharpness)| (place, sharpness))
    };
    sharp.into_iter().flat_map(beside).collect()
}

/// Splits the pairs of places at one vertex: places that are fixed because an infinitely sharp edge ends at their
/// partner, and places without sharp edges whose sharpness follows the semi-sharp edges at their partner. A following
/// place is fixed in the level in which its partner loses its last sharpness, if the seam stays semi-sharp for longer.
///
/// Source: OpenSubdiv 3.5, which calls such sharpness dependent; checked by comparing values.
fn following(seams: &Seams, creases: &Sharp) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut sharpest = BTreeMap::new();
    for &(e, sharpness) in creases {
        for place in seams.topology.ends(e as usize) {
            let most: &mut f64 = sharpest.entry(place).or_insert(0.0);
            *most = most.max(sharpness);
        }
    }
    let sharpness = |place: u32| sharpest.get(&place).copied().unwrap_or(0.0);
    let pairs = seams.pairs.iter().flat_map(|&[a, b]| [(a, b), (b, a)]);
    let (fixed, others): (Vec<_>, Vec<_>) = pairs.partition(|&(_, other)| sharpness(other) >= INFINITE_SHARPNESS);
    let following = others.into_iter().filter(|&(place, other)| sharpness(place) <= 0.0 && sharpness(other) > 0.0);
    (fixed.into_iter().map(|(place, _)| place).collect(), following.collect())
}
