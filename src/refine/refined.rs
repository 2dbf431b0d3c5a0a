//! A refined mesh as a source for the writers, in the documented order.

use std::ops::Range;
use std::sync::Arc;

use super::normals::Normals;
use super::shown::Shown;
use super::uvs::RefinedUvs;
use super::vertex_order::VertexOrder;
use crate::kept::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::shape::attachments::Attachments;
use crate::shape::creases::{INFINITE_SHARPNESS, Tags};
use crate::shape::order::Order;
use crate::shape::source::{FaceChunk, MeshSource, NormalSource, Origin, OriginSource, UvSource};
use crate::shape::topology::{NONE, Topology, index};

/// A refined mesh: the values of its vertices, and the way from the order in which they are kept to the documented one.
#[derive(Debug)]
pub struct RefinedMesh {
    pub(super) points: Numbers,
    /// Normals of the limit, if there are any, in the same order.
    normals: Option<Normals>,
    pub(super) base: Arc<Topology>,
    pub(super) order: VertexOrder,
    pub(super) shown: Shown,
    pub(super) attachments: Arc<Attachments>,
    /// The values of each channel, in the same order.
    pub(super) channels: Vec<Numbers>,
    pub(super) uvs: Option<Arc<RefinedUvs>>,
    /// The mesh in its other frames, without channels.
    frames: Vec<RefinedMesh>,
    /// Edges that are still sharp, numbered in the order of construction.
    sharpness: Option<Arc<Sharpness>>,
    /// What is tagged of it, as long as it is the input.
    tags: Tags,
    /// For each of the last vertices of the input, which were added to it: the vertex it was split from.
    split_from: Arc<[u32]>,
    /// Pieces of each edge of the base: those of edge `e` have the numbers `e x pieces ..` in its direction.
    pieces: usize,
}

impl RefinedMesh {
    /// The mesh of a net with its points in the order of construction, `n x 3`.
    pub fn new(net: &MeshNet, points: Numbers) -> Self {
        Self::ordered(net, VertexOrder::constructed(net), points)
    }

    /// The mesh of a net with its points in the documented order already, `n x 3`: nothing will be gathered. Of the
    /// connectivity only the base and how its faces were split matters, not the topology before the last split.
    /// Channels and normals are to be in the documented order, too.
    pub fn documented(net: &MeshNet, points: Numbers) -> Self {
        Self::ordered(net, VertexOrder::documented(net), points)
    }

    fn ordered(net: &MeshNet, order: VertexOrder, points: Numbers) -> Self {
        let shown = Shown::new(&net.mesh.base, order.order(), &net.tags.holes);
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
            tags: Tags::default(),
            split_from: Arc::default(),
            pieces,
            uvs: None,
            frames: Vec::new(),
        }
    }

    /// The same mesh with what it carries: for each channel its values in the order of the points, and the texture
    /// coordinates.
    pub(super) fn carrying(
        self,
        attachments: Arc<Attachments>,
        channels: Vec<Numbers>,
        uvs: Option<Arc<RefinedUvs>>,
    ) -> Self {
        Self { attachments, channels, uvs, ..self }
    }

    /// This mesh at the points of another one of the same net.
    #[must_use]
    pub fn moved(&self, other: Self) -> Self {
        Self { uvs: self.uvs.clone(), ..other }
    }

    /// The same mesh with its other frames.
    #[must_use]
    pub fn with_frames(self, frames: Vec<Self>) -> Self {
        Self { frames, ..self }
    }

    /// The same mesh with the tags of the input that it is.
    #[must_use]
    pub(super) fn with_tags(self, tags: Tags) -> Self {
        Self { tags, ..self }
    }

    /// The same mesh, of an input whose last vertices were split from these.
    #[must_use]
    pub(super) fn split_from(self, split_from: Arc<[u32]>) -> Self {
        Self { split_from, ..self }
    }

    /// Position of vertex `v`, numbered in the documented order.
    pub(super) fn position(&self, v: usize) -> [f64; 3] {
        self.points.as_chunks().0[self.order.place(v)]
    }

    /// The numbers that vertex `v` carries in a channel.
    pub(super) fn numbers(&self, channel: usize, v: usize) -> &[f64] {
        let (width, at) = (self.attachments.channels[channel].width, self.order.place(v));
        &self.channels[channel][width * at..width * (at + 1)]
    }

    /// The vertex at a place with texture coordinates, both numbered in the documented order: bases, inner points of
    /// their edges, inner points of the faces that they have in common.
    pub(super) fn vertex_at(&self, place: usize) -> usize {
        let Some(uvs) = &self.uvs else { return place };
        let (places, inner) = (&uvs.base, self.pieces - 1);
        let on_edges = places.n_vertices();
        if place < on_edges {
            return places.ring(place).next().map_or(0, |half_edge| self.base.vertex(half_edge) as usize);
        }
        let first = self.base.n_vertices();
        let Some(inside) = (place - on_edges).checked_sub(places.n_edges() * inner) else {
            let (edge, at) = ((place - on_edges) / inner, (place - on_edges) % inner);
            let half_edge = places.halves(edge)[0];
            let edge = self.base.edge(half_edge) as usize;
            let forward = self.base.halves(edge)[0] == half_edge;
            return first + edge * inner + if forward { at } else { inner - 1 - at };
        };
        first + self.base.n_edges() * inner + inside
    }

    /// Whether there are normals.
    pub(super) fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// The normal of vertex `v`, zero where there is none.
    pub(super) fn normal(&self, v: usize) -> [f64; 3] {
        self.normals.as_ref().map_or([0.0; 3], |normals| normals.of_vertices.as_chunks().0[self.order.place(v)])
    }

    /// Sharp pieces of edges of the base: the edge, and the number of the piece in its direction. In the limit only
    /// those are sharp that stay so for ever.
    fn sharp_pieces(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let sharp = self.sharpness.iter().flat_map(|sharpness| sharpness.edges());
        let least = if self.normals.is_some() { INFINITE_SHARPNESS } else { 0.0 };
        sharp
            .filter(move |&&(_, sharpness)| sharpness >= least)
            .map(|&(e, _)| (e as usize / self.pieces, e as usize % self.pieces))
    }

    /// The ends of a piece of an edge of one of the meshes with these faces.
    fn piece(&self, base: &Topology, edge: usize, piece: usize) -> [u32; 2] {
        [piece, piece + 1].map(|at| self.along(base, edge, at))
    }

    /// The vertex so many pieces along an edge of one of the meshes with these faces.
    fn along(&self, base: &Topology, edge: usize, at: usize) -> u32 {
        let [start, end] = base.ends(edge);
        match at {
            0 => start,
            at if at == self.pieces => end,
            at => index(base.n_vertices() + edge * (self.pieces - 1) + at - 1),
        }
    }

    /// The ends of sharp edges as places with texture coordinates; what seams split is not split again.
    pub(super) fn sharp_places(&self) -> Vec<[u32; 2]> {
        let Some(uvs) = &self.uvs else { return Vec::new() };
        let ends = |(edge, piece): (usize, usize)| {
            let half_edge = self.base.halves(edge)[0];
            let place = uvs.base.edge(half_edge) as usize;
            let forward = uvs.base.halves(place)[0] == half_edge;
            let piece = if forward { piece } else { self.pieces - 1 - piece };
            (!uvs.base.is_boundary_edge(place)).then(|| self.piece(&uvs.base, place, piece))
        };
        self.sharp_pieces().filter_map(ends).collect()
    }

    /// The shown faces in `range` of one of the meshes with these faces.
    pub(super) fn list(&self, base: &Topology, order: Option<&Order>, range: Range<usize>, out: &mut FaceChunk) {
        let runs = self.shown.runs(range);
        if let Some(order) = order {
            return order.faces(runs, out);
        }
        out.clear();
        runs.flatten().for_each(|f| out.push(base.face(f)));
    }

    /// The same mesh with normals in the order of the points, if there are any.
    #[must_use]
    pub fn with_normals(self, normals: Option<Normals>) -> Self {
        Self { normals, ..self }
    }

    /// Bytes that it holds, but for the attachments of its input and what the allocator keeps free.
    pub fn bytes(&self) -> usize {
        let normals = self.normals.as_ref().map_or(0, Normals::bytes);
        let uvs = self.uvs.as_ref().map_or(0, |uvs| uvs.points.bytes() + uvs.base.bytes());
        let numbers = self.channels.iter().map(Numbers::bytes).sum::<usize>() + self.points.bytes();
        let frames: usize = self.frames.iter().map(Self::bytes).sum();
        let sharp = |sharpness: &Arc<Sharpness>| sharpness.edges().len() + sharpness.vertices().len();
        let sharp = self.sharpness.as_ref().map_or(0, sharp) * 2 * size_of::<(u32, f64)>();
        size_of::<Self>() + sharp + numbers + normals + uvs + frames + self.base.bytes() + self.order.bytes()
    }

    /// Positions of all vertices in the documented order, model units.
    pub fn all_positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::new();
        self.positions(0..self.n_vertices(), &mut positions);
        positions
    }
}

impl MeshSource for RefinedMesh {
    fn n_vertices(&self) -> usize {
        self.points.len() / 3
    }

    fn n_faces(&self) -> usize {
        self.shown.n
    }

    fn n_half_edges(&self) -> usize {
        self.shown.n_half_edges
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.order.points(self.points.as_chunks().0, range, out);
    }

    fn held_positions(&self) -> Option<&[[f64; 3]]> {
        self.order.is_documented().then_some(self.points.as_chunks().0)
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.sharp_pieces().map(|(edge, piece)| self.piece(&self.base, edge, piece)).collect()
    }

    fn tags(&self) -> Tags {
        self.tags.clone()
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.list(&self.base, self.order.order(), range, out);
    }

    fn normals(&self) -> Option<&dyn NormalSource> {
        self.normals.is_some().then_some(self)
    }

    fn uvs(&self) -> Option<&dyn UvSource> {
        self.uvs.is_some().then_some(self)
    }

    fn frames(&self) -> Vec<&dyn MeshSource> {
        self.frames.iter().map(|frame| frame as &dyn MeshSource).collect()
    }

    fn attachments(&self) -> &Attachments {
        &self.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        self.order.values(&self.channels[channel], self.attachments.channels[channel].width, range, out);
    }
}

impl NormalSource for RefinedMesh {
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        if let Some(normals) = &self.normals {
            self.order.points(normals.of_vertices.as_chunks().0, range, out);
        }
    }

    fn on_side(&self, vertex: u32, next: u32) -> Option<[f64; 3]> {
        let [vertex, next] = [vertex, next].map(|v| index(self.order.place(v as usize)));
        self.normals.as_ref()?.on_side(vertex, next)
    }
}

impl OriginSource for RefinedMesh {
    fn input_cells(&self) -> [usize; 3] {
        [self.base.n_vertices(), self.base.n_edges(), self.base.n_faces()]
    }

    fn vertex_origin(&self, vertex: usize) -> Origin {
        let origin = match self.order.order() {
            None => Origin { dimension: 0, cell: index(vertex) },
            Some(order) => order.origin(vertex),
        };
        let given = self.base.n_vertices() - self.split_from.len();
        let part = (origin.cell as usize).checked_sub(given).filter(|_| origin.dimension == 0);
        let from = part.and_then(|part| self.split_from.get(part));
        from.map_or(origin, |&cell| Origin { cell, ..origin })
    }

    fn face_origin(&self, face: usize) -> u32 {
        let face = self.shown.face(face);
        index(self.order.order().map_or(face, |order| order.base_face(face)))
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        let first = |f: usize| match self.order.order() {
            None => f,
            Some(order) if f == self.base.n_faces() => order.n_faces(),
            Some(order) => order.first_face(f),
        };
        self.shown.number(first(face))..self.shown.number(first(face + 1))
    }

    fn isoline(&self, edge: usize, out: &mut Vec<u32>) -> bool {
        out.clear();
        out.extend((0..=self.pieces).map(|at| self.along(&self.base, edge, at)));
        let half_edges = self.base.halves(edge).into_iter().filter(|&half_edge| half_edge != NONE);
        half_edges.map(|half_edge| self.base.face_of(half_edge)).any(|face| !self.faces_of(face).is_empty())
    }
}
