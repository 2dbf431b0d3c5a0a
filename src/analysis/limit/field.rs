//! The masks of all vertices, or of what took their place in a net: regular ones by walking a grid, the others by their
//! patches.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use super::bounds::{CHUNK, CHUNK_VERTICES, FIRST_CHUNK, MAX_PATCHES, VERTICES_A_ROW};
use super::error::Unlimited;
use super::mask::{Finder, Mask, Masks};
use super::patch::{Centre, Located, Patch, Rings};
use super::regular::Regular;
use super::sector::Sectors;
use super::tangent::NoTangents;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use super::walk::WholeNet;
use crate::math::rows::Rows;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::surroundings::Surroundings;
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::Watch;

/// The class of vertices around which the net is a grid of quads.
const REGULAR: u32 = 0;
/// The class of vertices without faces.
const ISOLATED: u32 = 1;

/// The masks of all vertices of a net, or of others that it came of.
#[derive(Debug)]
pub(super) struct Field {
    net: MeshNet,
    /// For each vertex what took its place, if that was no vertex without faces; `None` where these are the net's own.
    centres: Option<Vec<Option<Centre>>>,
    /// Its topology made explicit.
    topology: Arc<Topology>,
    rings: Rings,
    classes: Vec<u32>,
    masks: Vec<Arc<Mask>>,
    /// The mask on a grid, in the order of [`grid`].
    regular: Option<Mask>,
}

/// What a row of a field is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Functional {
    /// The limit position.
    Position,
    /// One of the two tangents.
    Tangent(usize),
}

impl Field {
    /// Finds the masks of all vertices of the net, or of these.
    pub(super) fn new(
        net: MeshNet,
        centres: Option<Vec<Option<Centre>>>,
        regular: Regular,
        rings: Rings,
        finder: &Finder<'_>,
        watch: &Watch,
    ) -> Result<Self, Unlimited> {
        let topology = net.mesh.topology();
        let surroundings = finder.cycle.surroundings(&topology);
        let whole = WholeNet { surroundings, ..WholeNet::of(&net, &topology) };
        let near = match regular {
            Regular::Quads if !carries(&net) => near_extraordinary(&whole, rings),
            _ => vec![true; topology.n_vertices()],
        };
        let on_grid = near.iter().any(|near| !near);
        let plain = Masks::new(finder, CommonParameters::default());
        let grid = if on_grid { Some(regular_mask(rings, &plain, surroundings)?) } else { None };
        if !carries(&net) {
            middles_settle(&whole, regular, rings, &plain, watch)?;
        }
        let n = centres.as_ref().map_or(topology.n_vertices(), Vec::len);
        let centre = |v: u32| match &centres {
            Some(centres) => centres[v as usize],
            None => (!topology.is_isolated(v as usize)).then_some(Centre::Vertex(v)),
        };
        let is_regular = |v: &u32| matches!(centre(*v), Some(Centre::Vertex(at)) if !near[at as usize]);
        let mut classes = vec![REGULAR; n];
        let rest: Vec<u32> = (0..index(n)).filter(|v| !is_regular(v)).collect();
        let mut known: BTreeMap<(Patch, VertexParameters), u32> = BTreeMap::new();
        let mut left = rest.as_slice();
        let mut chunk = FIRST_CHUNK;
        while !left.is_empty() {
            watch.check().map_err(Unlimited::Stopped)?;
            let (now, later) = left.split_at(chunk.min(left.len()));
            left = later;
            let patch = |&v: &u32| {
                patch(&whole, &net, centre(v), rings)
                    .map(|found| found.map(|(found, parameters)| (found.patch, parameters)))
            };
            let patches: Vec<Option<(Patch, VertexParameters)>> =
                now.par_iter().map(patch).collect::<Result<_, _>>()?;
            let size: usize = patches.iter().flatten().map(|(patch, _)| patch.n_vertices).sum();
            watch.advance(size as u64 / VERTICES_A_ROW + now.len() as u64);
            chunk = (CHUNK_VERTICES * now.len() / size.max(1)).clamp(1, CHUNK.min(2 * chunk));
            for (&v, patch) in now.iter().zip(patches) {
                let next = index(known.len()) + ISOLATED + 1;
                classes[v as usize] = patch.map_or(ISOLATED, |patch| *known.entry(patch).or_insert(next));
            }
            if known.len() > MAX_PATCHES
                && known.keys().filter(|(_, parameters)| !parameters.agree()).count() > MAX_PATCHES
            {
                return Err(Unlimited::Different);
            }
        }
        let mut patches: Vec<((Patch, VertexParameters), u32)> = known.into_iter().collect();
        patches.sort_unstable_by_key(|entry| entry.1);
        let mut common: BTreeMap<CommonParameters, Masks<'_>> = BTreeMap::new();
        common.insert(CommonParameters::default(), plain);
        for ((_, parameters), _) in patches.iter().filter(|((_, parameters), _)| parameters.agree()) {
            common.entry(parameters.first()).or_insert_with(|| Masks::new(finder, parameters.first()));
        }
        let find = |((patch, parameters), _): &((Patch, VertexParameters), u32)| {
            watch.check().map_err(Unlimited::Stopped)?;
            match common.get(&parameters.first()).filter(|_| parameters.agree()) {
                Some(masks) => masks.of(0, patch),
                None => finder.varying(patch, parameters).map(Arc::new),
            }
        };
        let masks = patches.par_iter().map(find).collect::<Result<_, _>>()?;
        Ok(Self { net, centres, topology, rings, classes, masks, regular: grid })
    }

    /// A net each of whose vertices has its own mask; `None` for those without faces.
    pub(super) fn of_masks(net: MeshNet, topology: Arc<Topology>, rings: Rings, masks: Vec<Option<Arc<Mask>>>) -> Self {
        let mut n = ISOLATED;
        let class = |mask: &Option<Arc<Mask>>| {
            n += u32::from(mask.is_some());
            if mask.is_some() { n } else { ISOLATED }
        };
        let classes = masks.iter().map(class).collect();
        Self {
            net,
            centres: None,
            topology,
            rings,
            classes,
            masks: masks.into_iter().flatten().collect(),
            regular: None,
        }
    }

    /// Why a regular vertex has no tangents, if it has none: then the scheme has none.
    pub(super) fn no_regular_tangents(&self) -> Option<NoTangents> {
        self.regular.as_ref()?.tangents.iter().find_map(|tangents| tangents.as_ref().err().copied())
    }

    /// Why a vertex has no tangents in a sector, if it has none.
    pub(super) fn no_tangents(&self, v: usize, sector: usize) -> Option<NoTangents> {
        self.mask(v)?.tangents[sector].as_ref().err().copied()
    }

    /// The mask of a vertex; `None` for one without faces.
    fn mask(&self, v: usize) -> Option<&Mask> {
        match self.classes[v] {
            ISOLATED => None,
            REGULAR => self.regular.as_ref(),
            class => self.masks.get((class - ISOLATED - 1) as usize).map(|mask| &**mask),
        }
    }

    /// The sectors of all vertices: first one of each vertex, then those beside, vertex after vertex.
    pub(super) fn sectors(&self) -> Vec<(u32, usize)> {
        let n = self.classes.len();
        let beside =
            |v: usize| (1..self.mask(v).map_or(1, |mask| mask.tangents.len())).map(move |sector| (index(v), sector));
        (0..n).map(|v| (index(v), 0)).chain((0..n).flat_map(beside)).collect()
    }

    /// For each half-edge at a vertex, counter-clockwise, the next vertex of its face and its sector.
    pub(super) fn sides(&self, v: usize) -> Vec<(u32, usize)> {
        let rings = Rings { support: 1, patch: 1 };
        let Some(found) = self.centre(v).and_then(|centre| self.whole().patch(centre, rings)) else {
            return Vec::new();
        };
        let sectors = Sectors::of(&found.patch);
        let faces = found.patch.central_faces().enumerate();
        faces.map(|(i, face)| (found.vertices[face[1] as usize], sectors.of_face(i))).collect()
    }

    /// A sector of a vertex in words; its number would be one of a net that the client never sees.
    pub(super) fn describe(&self, v: usize) -> String {
        let by_sector = self.mask(v).is_some_and(|mask| mask.tangents.len() > 1);
        let side = if by_sector { "one side of the sharp edges at " } else { "" };
        let (kind, n) = match self.centre(v) {
            Some(Centre::Edge(half_edge)) if self.topology.twin(half_edge) != NONE => ("an interior vertex", 2),
            Some(Centre::Edge(_)) | None => return format!("{side}a boundary vertex"),
            Some(Centre::Face(f)) => ("an interior vertex", self.topology.face(f as usize).len()),
            Some(Centre::Vertex(v)) => {
                let v = v as usize;
                let kind = if self.net.tags.is_corner(v) {
                    "a corner"
                } else if self.topology.boundary_edges(v).is_some() {
                    "a boundary vertex"
                } else {
                    "an interior vertex"
                };
                (kind, self.topology.ring(v).count())
            }
        };
        format!("{side}{kind} with {n} {}", if n == 1 { "face" } else { "faces" })
    }

    /// What took the place of a vertex; `None` for one without faces.
    fn centre(&self, v: usize) -> Option<Centre> {
        match &self.centres {
            Some(centres) => centres[v],
            None => (!self.is_isolated(v)).then(|| Centre::Vertex(index(v))),
        }
    }

    /// Vertices without faces that are not in the net.
    pub(super) fn left_out(&self) -> impl Iterator<Item = usize> {
        let centres = self.centres.as_deref().unwrap_or_default();
        centres.iter().enumerate().filter(|(_, centre)| centre.is_none()).map(|(v, _)| v)
    }

    /// Number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.classes.len()
    }

    /// Number of points that rows are made of.
    pub(super) fn n_points(&self) -> usize {
        self.topology.n_vertices()
    }

    /// Whether a vertex has no face.
    pub(super) fn is_isolated(&self, v: usize) -> bool {
        self.classes[v] == ISOLATED
    }

    fn whole(&self) -> WholeNet<'_> {
        WholeNet::of(&self.net, &self.topology)
    }

    /// Adds the weights of a vertex for a wish in a sector.
    pub(super) fn row(&self, v: usize, sector: usize, functional: Functional, out: &mut Rows) {
        match (self.centre(v), self.classes[v], &self.regular) {
            (None, ..) if self.centres.is_some() => {}
            (None, ..) => out.add(index(v), if functional == Functional::Position { 1.0 } else { 0.0 }),
            (Some(Centre::Vertex(at)), REGULAR, Some(mask)) => {
                let weights = weights(mask, functional, sector);
                let mut next = 0;
                grid(&self.topology, at as usize, self.rings.support, |vertex| {
                    out.add(vertex, weights[next]);
                    next += 1;
                });
            }
            (Some(centre), class, _) => {
                // the vertices of the first rings come first, whatever rings follow
                let rings = Rings { patch: self.rings.support, ..self.rings };
                let mask = &self.masks[(class - ISOLATED - 1) as usize];
                let vertices = self.whole().patch(centre, rings).map_or_else(Vec::new, |found| found.vertices);
                vertices.iter().zip(weights(mask, functional, sector)).for_each(|(&u, &w)| out.add(u, w));
            }
        }
    }
}

/// The weights of a mask for a wish in a sector; none where there are no tangents.
fn weights(mask: &Mask, functional: Functional, sector: usize) -> &[f64] {
    match functional {
        Functional::Position => &mask.position,
        Functional::Tangent(i) => {
            mask.tangents.get(sector).and_then(|tangents| tangents.as_ref().ok()).map_or(&[], |t| &t[i])
        }
    }
}

/// Whether vertices or edges of a net carry what others do not.
pub(super) fn carries(net: &MeshNet) -> bool {
    net.annotations.attributes.is_some() || net.annotations.directions.is_some()
}

/// The patch around what took the place of a vertex, and the parameters that its vertices carry; `None` for a vertex
/// without faces.
pub(super) fn patch(
    whole: &WholeNet<'_>,
    net: &MeshNet,
    centre: Option<Centre>,
    rings: Rings,
) -> Result<Option<(Located, VertexParameters)>, Unlimited> {
    let Some(centre) = centre else { return Ok(None) };
    let found = whole.patch(centre, rings).ok_or(Unlimited::Size)?;
    let parameters = net
        .annotations
        .attributes
        .as_ref()
        .map_or_else(VertexParameters::default, |attributes| VertexParameters::of(attributes, &found.vertices));
    Ok(Some((found, parameters)))
}

/// Whether points come together in the middle of faces that are not like those of a regular net, one of each size.
///
/// # Errors
/// [`Unlimited::Rough`]; where the middle of a face cannot be followed, nothing is said about it.
fn middles_settle(
    whole: &WholeNet<'_>,
    regular: Regular,
    rings: Rings,
    masks: &Masks<'_>,
    watch: &Watch,
) -> Result<(), Unlimited> {
    let topology = whole.topology;
    let mut seen = BTreeSet::from([if regular == Regular::Quads { 4 } else { 3 }]);
    for f in 0..topology.n_faces() {
        if seen.insert(topology.face(f).len()) {
            let found = whole.least_patch(Centre::Face(index(f)), rings, watch)?;
            let mask = found.map(|found| masks.of(0, &found.patch));
            if let Some(Err(error @ (Unlimited::Rough | Unlimited::Stopped(_)))) = mask {
                return Err(error);
            }
        }
    }
    Ok(())
}

/// For each vertex whether one of the rings around it, but for the rim of the last, is not part of a grid of quads.
fn near_extraordinary(whole: &WholeNet<'_>, rings: Rings) -> Vec<bool> {
    let topology = whole.topology;
    let extraordinary = |v: usize| {
        let quads = || topology.ring(v).all(|half_edge| topology.half_edges(topology.face_of(half_edge)).len() == 4);
        topology.is_isolated(v)
            || topology.boundary_edges(v).is_some()
            || topology.ring(v).take(5).count() != 4
            || !quads()
            || whole.corners.binary_search(&index(v)).is_ok()
    };
    let mut near: Vec<bool> =
        (0..topology.n_vertices()).into_par_iter().with_min_len(4096).map(extraordinary).collect();
    if let Some(sharpness) = whole.sharpness {
        let ends = sharpness.edges().iter().flat_map(|&(e, _)| topology.ends(e as usize));
        ends.chain(sharpness.vertices().iter().map(|&(v, _)| v)).for_each(|v| near[v as usize] = true);
    }
    let mut front: Vec<usize> = (0..near.len()).filter(|&v| near[v]).collect();
    for _ in 1..rings.patch {
        let mut next = Vec::new();
        for v in front {
            for half_edge in topology.ring(v) {
                for &u in topology.face(topology.face_of(half_edge)) {
                    if !std::mem::replace(&mut near[u as usize], true) {
                        next.push(u as usize);
                    }
                }
            }
        }
        front = next;
    }
    near
}

/// The vertices within some rings of vertex `v` of a grid of quads: itself, then sector by sector those `i` steps along
/// the sector's first side and `j` to the left of it, `1 <= i <= rings`, `0 <= j <= rings`.
fn grid(topology: &Topology, v: usize, rings: usize, mut each: impl FnMut(u32)) {
    each(index(v));
    for first in topology.ring(v) {
        let mut along = first;
        for i in 1..=rings {
            let mut side = along;
            for j in 1..=rings {
                each(topology.vertex(topology.next(side)));
                let opposite = topology.next(topology.next(side));
                if j < rings {
                    side = topology.twin(opposite);
                } else {
                    each(topology.vertex(opposite));
                }
            }
            if i < rings {
                along = topology.next(topology.twin(topology.next(along)));
            }
        }
    }
}

/// The mask of a vertex of a grid, in the order of [`grid`].
fn regular_mask(rings: Rings, masks: &Masks<'_>, surroundings: Option<Surroundings>) -> Result<Mask, Unlimited> {
    let (net, middle) = Regular::Quads.grid(rings, false);
    let (topology, whole) = (&net.mesh.base, WholeNet { surroundings, ..WholeNet::of(&net, &net.mesh.base) });
    let Located { patch, vertices, .. } = whole.patch(Centre::Vertex(index(middle)), rings).ok_or(Unlimited::Size)?;
    let mask = masks.of(0, &patch)?;
    let mut order = Vec::new();
    grid(topology, middle, rings.support, |vertex| order.push(vertices.iter().position(|&u| u == vertex)));
    let sorted = |weights: &Vec<f64>| order.iter().map(|at| at.map_or(0.0, |at| weights[at])).collect::<Vec<_>>();
    let both = |tangents: &Result<[Vec<f64>; 2], _>| {
        tangents.as_ref().map(|[t, u]| [sorted(t), sorted(u)]).map_err(|why| *why)
    };
    Ok(Mask { position: sorted(&mask.position), tangents: mask.tangents.iter().map(both).collect() })
}
