//! Presents a refined mesh to the writers, in the documented order.

use std::ops::Range;

use super::refined::{RefinedChannel, RefinedMesh};
use super::unfolded::Unfolded;
use crate::shape::attachments::Attachments;
use crate::shape::creases::CreaseTags;
use crate::shape::grid::QuadGrid;
use crate::shape::order::Order;
use crate::shape::source::{CarriedSource, FaceChunk, MeshSource, NormalSource, Origin, OriginSource, PlaceSource};
use crate::shape::topology::{NONE, index};

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

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.list(&self.base, self.order.order(), range, out);
    }

    fn quad_grid(&self) -> Option<&QuadGrid> {
        let Some(Order::Quads(grid)) = self.order.order() else { return None };
        grid.is_quads().then_some(grid)
    }

    fn frames(&self) -> Vec<&dyn MeshSource> {
        self.frames.iter().map(|frame| frame as &dyn MeshSource).collect()
    }
}

impl CarriedSource for RefinedMesh {
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.sharp_pieces().map(|(edge, piece)| self.piece(&self.base, edge, piece)).collect()
    }

    fn tags(&self) -> CreaseTags {
        self.tags.clone()
    }

    fn normals(&self) -> Option<&dyn NormalSource> {
        self.normals.is_some().then_some(self)
    }

    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        Some(Box::new(self.at(self.uvs.as_ref()?)))
    }

    fn channel_places(&self, channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        let RefinedChannel::Places(places) = &self.channels[channel] else { return None };
        Some(Box::new(self.at(places)))
    }

    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        Some(Box::new(Unfolded::of(self)?))
    }

    fn attachments(&self) -> &Attachments {
        &self.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        if let RefinedChannel::Vertices(numbers) = &self.channels[channel] {
            self.order.values(numbers, self.attachments.channels[channel].width, range, out);
        }
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
