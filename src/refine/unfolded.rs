//! A refined mesh as its texture coordinates see it: a vertex for each place, so that vertices on seams are there more
//! than once.

use std::ops::Range;

use rayon::prelude::*;

use super::refined::RefinedMesh;
use crate::shape::attachments::Attachments;
use crate::shape::source::{FaceChunk, MeshSource, NormalSource, Origin, OriginSource, UvSource};
use crate::shape::topology::index;

/// The faces are those of the mesh, in their order; vertices without a face are not there.
#[derive(Debug)]
pub(super) struct Unfolded<'a>(pub(super) &'a RefinedMesh);

impl Unfolded<'_> {
    /// Rows of the places in `range`, found by the vertex each is at.
    fn gathered<T: Send>(&self, range: Range<usize>, row: impl Fn(usize) -> T + Sync, out: &mut Vec<T>) {
        let places = range.into_par_iter().with_min_len(4096);
        places.map(|place| row(self.0.vertex_at(place))).collect_into_vec(out);
    }
}

impl MeshSource for Unfolded<'_> {
    fn n_vertices(&self) -> usize {
        self.0.n_points()
    }

    fn n_faces(&self) -> usize {
        self.0.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.0.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.gathered(range, |v| self.0.position(v), out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        UvSource::faces(self.0, range, out);
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.0.sharp_places()
    }

    fn normals(&self) -> Option<&dyn NormalSource> {
        self.0.has_normals().then_some(self)
    }

    fn uvs(&self) -> Option<&dyn UvSource> {
        Some(self)
    }

    fn attachments(&self) -> &Attachments {
        self.0.attachments()
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        let mut rows = Vec::new();
        self.gathered(range, |v| self.0.numbers(channel, v), &mut rows);
        out.clear();
        rows.iter().for_each(|row| out.extend_from_slice(row));
    }
}

impl NormalSource for Unfolded<'_> {
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.gathered(range, |v| self.0.normal(v), out);
    }

    fn on_side(&self, place: u32, next: u32) -> Option<[f64; 3]> {
        let [vertex, next] = [place, next].map(|place| index(self.0.vertex_at(place as usize)));
        self.0.on_side(vertex, next)
    }
}

impl UvSource for Unfolded<'_> {
    fn n_points(&self) -> usize {
        self.0.n_points()
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<[f64; 2]>) {
        self.0.values(range, out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        UvSource::faces(self.0, range, out);
    }

    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        None
    }
}

impl OriginSource for Unfolded<'_> {
    fn input_cells(&self) -> [usize; 3] {
        self.0.input_cells()
    }

    fn vertex_origin(&self, place: usize) -> Origin {
        self.0.vertex_origin(self.0.vertex_at(place))
    }

    fn face_origin(&self, face: usize) -> u32 {
        self.0.face_origin(face)
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        self.0.faces_of(face)
    }
}

impl UvSource for RefinedMesh {
    fn n_points(&self) -> usize {
        self.uvs.as_ref().map_or(0, |uvs| uvs.points.len() / 2)
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<[f64; 2]>) {
        out.clear();
        if let Some(uvs) = &self.uvs {
            uvs.order.points(uvs.points.as_chunks().0, range, out);
        }
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        if let Some(uvs) = &self.uvs {
            self.list(&uvs.base, uvs.order.order(), range, out);
        }
    }

    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        Some(Box::new(Unfolded(self)))
    }
}
