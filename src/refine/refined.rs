//! A refined mesh with everything that it carries.

use std::ops::Range;
use std::sync::Arc;

use super::normals::Normals;
use super::seams::RefinedPlaces;
use super::shown::ShownFaces;
use super::vertex_order::VertexOrder;
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::shape::attachments::Attachments;
use crate::shape::creases::{CreaseTags, INFINITE_SHARPNESS};
use crate::shape::order::Order;
use crate::shape::source::{FaceChunk, MeshSource};
use crate::shape::topology::{Topology, index};

/// A refined mesh: the values of its vertices, and the map from the order in which they are stored to the documented
/// one.
#[derive(Debug)]
pub struct RefinedMesh {
    pub(super) points: Numbers,
    /// Normals of the limit surface, if requested, in the order of the points.
    pub(super) normals: Option<Normals>,
    pub(super) base: Arc<Topology>,
    pub(super) order: VertexOrder,
    pub(super) shown: ShownFaces,
    pub(super) attachments: Arc<Attachments>,
    pub(super) channels: Vec<RefinedChannel>,
    pub(super) uvs: Option<Arc<RefinedPlaces>>,
    /// The topology whose vertices are the places of all seams together, before refinement.
    pub(super) unfolded: Option<Arc<Topology>>,
    /// The mesh at its other frames, without channels.
    pub(super) frames: Vec<RefinedMesh>,
    /// Edges that are still sharp, indexed in the order of construction.
    sharpness: Option<Arc<Sharpness>>,
    /// The tags of the input, if no step was applied; otherwise empty.
    pub(super) tags: CreaseTags,
    /// For each of the last input vertices, which were added by splitting: the vertex that it was split from.
    pub(super) split_from: Arc<[u32]>,
    /// Number of pieces of each base edge: those of edge `e` have the indices `e x pieces ..` in its direction.
    pub(super) pieces: usize,
}

/// The refined values of a channel.
#[derive(Debug)]
pub(super) enum RefinedChannel {
    /// One value per vertex, in the order of the points.
    Vertices(Numbers),
    /// One value per place, for a channel with seams.
    Places(Arc<RefinedPlaces>),
}

impl RefinedMesh {
    /// Creates the mesh of a net from its points in the order of construction, `n x 3`.
    pub fn new(net: &MeshNet, points: Numbers) -> Self {
        Self::ordered(net, VertexOrder::constructed(net), points)
    }

    /// Creates the mesh of a net from points that are already in the documented order, `n x 3`, so that nothing has to
    /// be reordered. Of the connectivity, only the base and how its faces were split are used, not the topology before
    /// the last split. Channels and normals must be in the documented order, too.
    pub fn documented(net: &MeshNet, points: Numbers) -> Self {
        Self::ordered(net, VertexOrder::documented(net), points)
    }

    fn ordered(net: &MeshNet, order: VertexOrder, points: Numbers) -> Self {
        let shown = ShownFaces::new(&net.mesh.base, order.order(), &net.tags.holes);
        let pieces = net.mesh.pieces.iter().map(|&pieces| pieces as usize).product();
        Self {
            points,
            normals: None,
            base: net.mesh.base.clone(),
            order,
            shown,
            attachments: Arc::default(),
            channels: Vec::new(),
            sharpness: net.sharpness.clone(),
            tags: CreaseTags::default(),
            split_from: Arc::default(),
            pieces,
            uvs: None,
            unfolded: None,
            frames: Vec::new(),
        }
    }

    /// Returns the mesh with its attachments, the values of each channel, and the texture coordinates.
    pub(super) fn carrying(
        self,
        attachments: Arc<Attachments>,
        channels: Vec<RefinedChannel>,
        uvs: Option<Arc<RefinedPlaces>>,
    ) -> Self {
        Self { unfolded: attachments.unfolded.clone(), attachments, channels, uvs, ..self }
    }

    /// Returns `other`, a mesh of the same net at other points, with the texture coordinates and seams of this one.
    #[must_use]
    pub fn moved(&self, other: Self) -> Self {
        Self { uvs: self.uvs.clone(), unfolded: self.unfolded.clone(), ..other }
    }

    /// Returns the mesh with its other frames.
    #[must_use]
    pub fn with_frames(self, frames: Vec<Self>) -> Self {
        Self { frames, ..self }
    }

    /// Returns the mesh with the tags of the input; meant for an input that no step changed.
    #[must_use]
    pub(super) fn with_tags(self, tags: CreaseTags) -> Self {
        Self { tags, ..self }
    }

    /// Returns the mesh with the vertices from which the last vertices of its input were split.
    #[must_use]
    pub(super) fn split_from(self, split_from: Arc<[u32]>) -> Self {
        Self { split_from, ..self }
    }

    /// Returns the position of vertex `v`, indexed in the documented order.
    pub(super) fn position(&self, v: usize) -> [f64; 3] {
        self.points.as_chunks().0[self.order.place(v)]
    }

    /// Returns the vertex of `to` that corresponds to vertex `place` of `from`. Both are bases with the faces of this
    /// mesh; vertices are indexed in the documented order of their refinements: base vertices, inner points of edges,
    /// inner points of faces (the same in both).
    pub(super) fn across(&self, from: &Topology, to: &Topology, place: usize) -> usize {
        let inner = self.pieces - 1;
        let on_edges = from.n_vertices();
        if place < on_edges {
            return from.ring(place).next().map_or(0, |half_edge| to.vertex(half_edge) as usize);
        }
        let first = to.n_vertices();
        let Some(inside) = (place - on_edges).checked_sub(from.n_edges() * inner) else {
            let (edge, at) = ((place - on_edges) / inner, (place - on_edges) % inner);
            let half_edge = from.halves(edge)[0];
            let edge = to.edge(half_edge) as usize;
            let forward = to.halves(edge)[0] == half_edge;
            return first + edge * inner + if forward { at } else { inner - 1 - at };
        };
        first + to.n_edges() * inner + inside
    }

    /// Returns whether the mesh has normals.
    pub(super) fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// Returns the normal of vertex `v`, or zero if it has none.
    pub(super) fn normal(&self, v: usize) -> [f64; 3] {
        self.normals.as_ref().map_or([0.0; 3], |normals| normals.of_vertices.as_chunks().0[self.order.place(v)])
    }

    /// Returns the sharp pieces of base edges: the edge, and the index of the piece in its direction. If the mesh has
    /// limit normals, only infinitely sharp edges count.
    pub(super) fn sharp_pieces(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let sharp = self.sharpness.iter().flat_map(|sharpness| sharpness.edges());
        let least = if self.normals.is_some() { INFINITE_SHARPNESS } else { 0.0 };
        sharp
            .filter(move |&&(_, sharpness)| sharpness >= least)
            .map(|&(e, _)| (e as usize / self.pieces, e as usize % self.pieces))
    }

    /// Returns the ends of a piece of edge `edge` of `base`, a topology with the faces of this mesh.
    pub(super) fn piece(&self, base: &Topology, edge: usize, piece: usize) -> [u32; 2] {
        [piece, piece + 1].map(|at| self.along(base, edge, at))
    }

    /// Returns the vertex that is `at` pieces along edge `edge` of `base`, a topology with the faces of this mesh.
    pub(super) fn along(&self, base: &Topology, edge: usize, at: usize) -> u32 {
        let [start, end] = base.ends(edge);
        match at {
            0 => start,
            at if at == self.pieces => end,
            at => index(base.n_vertices() + edge * (self.pieces - 1) + at - 1),
        }
    }

    /// Returns the ends of sharp edge pieces as vertices of the refined `places`. Edges on seams are left out, as they
    /// are split there already.
    pub(super) fn sharp_places(&self, places: &Topology) -> Vec<[u32; 2]> {
        let ends = |(edge, piece): (usize, usize)| {
            let half_edge = self.base.halves(edge)[0];
            let place = places.edge(half_edge) as usize;
            let forward = places.halves(place)[0] == half_edge;
            let piece = if forward { piece } else { self.pieces - 1 - piece };
            (!places.is_boundary_edge(place)).then(|| self.piece(places, place, piece))
        };
        self.sharp_pieces().filter_map(ends).collect()
    }

    /// Writes the shown faces in `range` to `out`, with the vertices of a topology that has the faces of this mesh.
    pub(super) fn list(&self, base: &Topology, order: Option<&Order>, range: Range<usize>, out: &mut FaceChunk) {
        let runs = self.shown.runs(range);
        if let Some(order) = order {
            return order.faces(runs, out);
        }
        out.clear();
        runs.flatten().for_each(|f| out.push(base.face(f)));
    }

    /// Returns the mesh with normals in the order of the points, if there are any.
    #[must_use]
    pub fn with_normals(self, normals: Option<Normals>) -> Self {
        Self { normals, ..self }
    }

    /// Returns the number of bytes that the mesh occupies, without the attachments of its input and spare capacity.
    pub fn bytes(&self) -> usize {
        let normals = self.normals.as_ref().map_or(0, Normals::bytes);
        let of_places = |places: &Arc<RefinedPlaces>| places.points.bytes() + places.base.bytes();
        let uvs = self.uvs.as_ref().map_or(0, of_places);
        let of_channel = |channel: &RefinedChannel| match channel {
            RefinedChannel::Vertices(numbers) => numbers.bytes(),
            RefinedChannel::Places(places) => of_places(places),
        };
        let numbers = self.channels.iter().map(of_channel).sum::<usize>() + self.points.bytes();
        let frames: usize = self.frames.iter().map(Self::bytes).sum();
        let sharp = |sharpness: &Arc<Sharpness>| sharpness.edges().len() + sharpness.vertices().len();
        let sharp = self.sharpness.as_ref().map_or(0, sharp) * 2 * size_of::<(u32, f64)>();
        size_of::<Self>() + sharp + numbers + normals + uvs + frames + self.base.bytes() + self.order.bytes()
    }

    /// Returns the positions of all vertices in the documented order, in model units. The service itself does not call
    /// this; tests and users of the library do.
    pub fn all_positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::new();
        self.positions(0..self.n_vertices(), &mut positions);
        positions
    }
}
