//! A refined mesh as its texture coordinates see it: a vertex for each place, so that vertices on seams are there more
//! than once.

use std::ops::Range;

use rayon::prelude::*;

use super::RefinedMesh;
use crate::shape::attachments::Attachments;
use crate::shape::source::{FaceChunk, MeshSource, Origin};
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
        self.0.n_uvs()
    }

    fn n_faces(&self) -> usize {
        self.0.n_faces()
    }

    fn n_corners(&self) -> usize {
        self.0.n_corners()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.gathered(range, |v| self.0.position(v), out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.0.uv_faces(range, out);
    }

    fn normals(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) -> bool {
        self.0.has_normals() && {
            self.gathered(range, |v| self.0.normal(v), out);
            true
        }
    }

    fn side_normal(&self, place: u32, next: u32) -> Option<[f64; 3]> {
        let [vertex, next] = [place, next].map(|place| index(self.0.vertex_at(place as usize)));
        self.0.side_normal(vertex, next)
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.0.sharp_places()
    }

    fn is_unfolded(&self) -> bool {
        true
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

    fn n_uvs(&self) -> usize {
        self.0.n_uvs()
    }

    fn uvs(&self, range: Range<usize>, out: &mut Vec<[f64; 2]>) {
        self.0.uvs(range, out);
    }

    fn uv_faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.0.uv_faces(range, out);
    }

    fn input_cells(&self) -> [usize; 3] {
        self.0.input_cells()
    }

    fn face_origin(&self, face: usize) -> u32 {
        self.0.face_origin(face)
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        self.0.faces_of(face)
    }

    fn vertex_origin(&self, place: usize) -> Origin {
        self.0.vertex_origin(self.0.vertex_at(place))
    }
}
