//! A refined mesh as a source for the writers, in the documented order.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::normals::Normals;
use super::unfolded::Unfolded;
use super::uvs::RefinedUvs;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::shape::attachments::Attachments;
use crate::shape::creases::{INFINITE_SHARPNESS, Tags};
use crate::shape::order::Order;
use crate::shape::source::{FaceChunk, MeshSource, NormalSource, Origin, OriginSource, UvSource};
use crate::shape::topology::{NONE, Topology, index};

/// A refined mesh: positions in the order of construction, and the way from there to the documented order.
#[derive(Debug)]
pub struct RefinedMesh {
    points: Vec<f64>,
    /// Normals of the limit, if there are any, in the same order.
    normals: Option<Normals>,
    base: Arc<Topology>,
    /// `None` when the mesh was not split since its base: then the orders agree.
    order: Option<Order>,
    shown: Shown,
    attachments: Arc<Attachments>,
    /// The numbers of each channel, in the order of construction.
    channels: Vec<Vec<f64>>,
    uvs: Option<RefinedUvs>,
    /// Edges that are still sharp, numbered in the order of construction.
    sharpness: Option<Arc<Sharpness>>,
    /// What is tagged of it, as long as it is the input.
    tags: Tags,
    /// For each of the last vertices of the input, which were added to it: the vertex it was split from.
    split_from: Arc<[u32]>,
    /// Pieces of each edge of the base: those of edge `e` have the numbers `e x pieces ..` in its direction.
    pieces: usize,
}

/// The faces that are shown: runs of consecutive ones.
#[derive(Debug)]
struct Shown {
    /// For each run its first number among the shown faces and its first face.
    runs: Vec<(usize, usize)>,
    n: usize,
    n_half_edges: usize,
}

impl RefinedMesh {
    /// The mesh of a net with its points in the order of construction, `n x 3`.
    pub fn new(net: &MeshNet, points: Vec<f64>) -> Self {
        let order = net.mesh.order();
        let shown = Shown::new(&net.mesh.base, order.as_ref(), &net.tags.holes);
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
        }
    }

    /// The same mesh with what it carries: for each channel its numbers in the order of construction, and the texture
    /// coordinates.
    pub(super) fn carrying(
        self,
        attachments: Arc<Attachments>,
        channels: Vec<Vec<f64>>,
        uvs: Option<RefinedUvs>,
    ) -> Self {
        Self { attachments, channels, uvs, ..self }
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
        self.points.as_chunks().0[self.constructed(v)]
    }

    /// The numbers that vertex `v` carries in a channel.
    pub(super) fn numbers(&self, channel: usize, v: usize) -> &[f64] {
        let (width, at) = (self.attachments.channels[channel].width, self.constructed(v));
        &self.channels[channel][width * at..width * (at + 1)]
    }

    fn constructed(&self, v: usize) -> usize {
        self.order.as_ref().map_or(v, |order| order.constructed(v) as usize)
    }

    /// The vertex at a place with texture coordinates, both numbered in the documented order: bases, inner points of
    /// their edges, inner points of the faces that they have in common.
    pub(super) fn vertex_at(&self, place: usize) -> usize {
        let Some(uvs) = &self.uvs else { return place };
        let (places, inner) = (&uvs.base, self.pieces - 1);
        let on_edges = places.n_vertices();
        if place < on_edges {
            return places.ring(place).next().map_or(0, |corner| self.base.vertex(corner) as usize);
        }
        let first = self.base.n_vertices();
        let Some(inside) = (place - on_edges).checked_sub(places.n_edges() * inner) else {
            let (edge, at) = ((place - on_edges) / inner, (place - on_edges) % inner);
            let corner = places.halves(edge)[0];
            let edge = self.base.edge(corner) as usize;
            let forward = self.base.halves(edge)[0] == corner;
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
        self.normals.as_ref().map_or([0.0; 3], |normals| normals.of_vertices[self.constructed(v)])
    }

    /// Sharp pieces of edges of the base: the edge, and the number of the piece in its direction. In the limit only those
    /// are sharp that stay so for ever.
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

    /// The ends of sharp edges as places with texture coordinates; what is parted on seams needs no other parting.
    pub(super) fn sharp_places(&self) -> Vec<[u32; 2]> {
        let Some(uvs) = &self.uvs else { return Vec::new() };
        let ends = |(edge, piece): (usize, usize)| {
            let corner = self.base.halves(edge)[0];
            let place = uvs.base.edge(corner) as usize;
            let forward = uvs.base.halves(place)[0] == corner;
            let piece = if forward { piece } else { self.pieces - 1 - piece };
            (!uvs.base.is_boundary_edge(place)).then(|| self.piece(&uvs.base, place, piece))
        };
        self.sharp_pieces().filter_map(ends).collect()
    }

    /// The shown faces in `range` of one of the meshes with these faces.
    fn list(&self, base: &Topology, order: Option<&Order>, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        match order {
            None => range.for_each(|f| out.push(base.face(self.shown.face(f)))),
            Some(order) => {
                let size = order.face_size();
                out.sizes.resize(range.len(), index(size));
                out.vertices.resize(size * range.len(), 0);
                let faces = out.vertices.par_chunks_exact_mut(size);
                let start = range.start;
                faces.with_min_len(4096).enumerate().for_each(|(i, face)| {
                    order.face(self.shown.face(start + i), face);
                });
            }
        }
    }

    /// The same mesh with normals in the order of construction, if there are any.
    #[must_use]
    pub fn with_normals(self, normals: Option<Normals>) -> Self {
        Self { normals, ..self }
    }

    /// Positions of all vertices in the documented order, model units.
    pub fn all_positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::new();
        self.positions(0..self.n_vertices(), &mut positions);
        positions
    }
}

impl Shown {
    fn new(base: &Topology, order: Option<&Order>, holes: &[u32]) -> Self {
        let all = order.map_or(base.n_faces(), Order::n_faces);
        let first = |f: usize| if f == base.n_faces() { all } else { order.map_or(f, |order| order.first_face(f)) };
        let corners = |f: usize| base.face(f).len();
        let mut runs = Vec::new();
        let (mut n, mut n_half_edges, mut from) = (0, 0, 0);
        let hidden = holes.iter().map(|&f| f as usize).chain([base.n_faces()]);
        for hole in hidden {
            if hole > from {
                runs.push((n, first(from)));
                n += first(hole) - first(from);
                n_half_edges += (from..hole).map(corners).sum::<usize>();
            }
            from = hole + 1;
        }
        let n_half_edges = order.map_or(n_half_edges, |order| order.face_size() * n);
        Self { runs, n, n_half_edges }
    }

    /// The number that face `face` has among the shown ones, or that of the first shown one after it.
    fn number(&self, face: usize) -> usize {
        let run = self.runs.partition_point(|(_, first)| *first <= face);
        let end = self.runs.get(run).map_or(self.n, |(number, _)| *number);
        let number = run.checked_sub(1).map_or(0, |run| self.runs[run].0 + face - self.runs[run].1);
        number.min(end)
    }

    fn face(&self, shown: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= shown) - 1;
        let (first_shown, first) = self.runs[run];
        first + shown - first_shown
    }
}

/// The points in `range` in the documented order.
fn ordered<const W: usize>(points: &[[f64; W]], order: Option<&Order>, range: Range<usize>, out: &mut Vec<[f64; W]>) {
    match order {
        None => {
            out.clear();
            out.extend_from_slice(&points[range]);
        }
        Some(grid) => {
            range
                .into_par_iter()
                .with_min_len(4096)
                .map(|v| points[grid.constructed(v) as usize])
                .collect_into_vec(out);
        }
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
        ordered(self.points.as_chunks::<3>().0, self.order.as_ref(), range, out);
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.sharp_pieces().map(|(edge, piece)| self.piece(&self.base, edge, piece)).collect()
    }

    fn tags(&self) -> Tags {
        self.tags.clone()
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.list(&self.base, self.order.as_ref(), range, out);
    }

    fn normals(&self) -> Option<&dyn NormalSource> {
        self.normals.is_some().then_some(self)
    }

    fn uvs(&self) -> Option<&dyn UvSource> {
        self.uvs.is_some().then_some(self)
    }

    fn attachments(&self) -> &Attachments {
        &self.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        let (values, width) = (&self.channels[channel], self.attachments.channels[channel].width);
        let Some(order) = &self.order else {
            out.extend_from_slice(&values[width * range.start..width * range.end]);
            return;
        };
        out.resize(width * range.len(), 0.0);
        let rows = out.par_chunks_exact_mut(width).with_min_len(4096);
        rows.zip(range).for_each(|(row, v)| {
            let at = order.constructed(v) as usize * width;
            row.copy_from_slice(&values[at..at + width]);
        });
    }
}

impl NormalSource for RefinedMesh {
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        if let Some(normals) = &self.normals {
            ordered(&normals.of_vertices, self.order.as_ref(), range, out);
        }
    }

    fn on_side(&self, vertex: u32, next: u32) -> Option<[f64; 3]> {
        let [vertex, next] = [vertex, next].map(|v| index(self.constructed(v as usize)));
        self.normals.as_ref()?.on_side(vertex, next)
    }
}

impl UvSource for RefinedMesh {
    fn n_points(&self) -> usize {
        self.uvs.as_ref().map_or(0, |uvs| uvs.points.len() / 2)
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<[f64; 2]>) {
        out.clear();
        if let Some(uvs) = &self.uvs {
            ordered(uvs.points.as_chunks().0, uvs.order.as_ref(), range, out);
        }
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        if let Some(uvs) = &self.uvs {
            self.list(&uvs.base, uvs.order.as_ref(), range, out);
        }
    }

    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        Some(Box::new(Unfolded(self)))
    }
}

impl OriginSource for RefinedMesh {
    fn input_cells(&self) -> [usize; 3] {
        [self.base.n_vertices(), self.base.n_edges(), self.base.n_faces()]
    }

    fn vertex_origin(&self, vertex: usize) -> Origin {
        let origin = match &self.order {
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
        index(self.order.as_ref().map_or(face, |order| order.base_face(face)))
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        let first = |f: usize| match &self.order {
            None => f,
            Some(order) if f == self.base.n_faces() => order.n_faces(),
            Some(order) => order.first_face(f),
        };
        self.shown.number(first(face))..self.shown.number(first(face + 1))
    }

    fn isoline(&self, edge: usize, out: &mut Vec<u32>) -> bool {
        out.clear();
        out.extend((0..=self.pieces).map(|at| self.along(&self.base, edge, at)));
        let corners = self.base.halves(edge).into_iter().filter(|&corner| corner != NONE);
        corners.map(|corner| self.base.face_of(corner)).any(|face| !self.faces_of(face).is_empty())
    }
}
