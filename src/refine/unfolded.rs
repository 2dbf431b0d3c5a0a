//! A refined mesh with one vertex per place, so that vertices on seams occur once for each side.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::refined::{RefinedChannel, RefinedMesh};
use super::seams::RefinedPlaces;
use crate::shape::attachments::Attachments;
use crate::shape::order::Order;
use crate::shape::source::{CarriedSource, FaceChunk, MeshSource, NormalSource, Origin, OriginSource, PlaceSource};
use crate::shape::topology::{Topology, index};

/// The unfolded view of a mesh: its faces in their order, without the vertices that have no face.
#[derive(Debug)]
pub(super) struct Unfolded<'a> {
    mesh: &'a RefinedMesh,
    /// The places of all seams together, before refinement.
    base: Arc<Topology>,
    /// The documented order of the places; `None` when it is that of the base.
    order: Option<Order>,
}

impl<'a> Unfolded<'a> {
    /// Returns the unfolded view of `mesh`, or `None` if nothing of it has seams.
    pub(super) fn of(mesh: &'a RefinedMesh) -> Option<Self> {
        let base = mesh.unfolded.clone()?;
        let order = mesh.order.order().map(|order| order.over(&base));
        Some(Self { mesh, base, order })
    }

    /// Returns the vertex of the mesh at a place.
    fn vertex_at(&self, place: usize) -> usize {
        self.mesh.across(&self.base, &self.mesh.base, place)
    }

    /// Writes to `out`, for each place in `range`, the row of the vertex at that place.
    fn gathered<T: Send>(&self, range: Range<usize>, row: impl Fn(usize) -> T + Sync, out: &mut Vec<T>) {
        let places = range.into_par_iter().with_min_len(4096);
        places.map(|place| row(self.vertex_at(place))).collect_into_vec(out);
    }

    /// Writes the values of the places in `range` for an attribute whose seams may be only some of all seams.
    fn values_of(&self, places: &RefinedPlaces, range: Range<usize>, out: &mut Vec<f64>) {
        if Arc::ptr_eq(&self.base, &places.base) {
            return self.mesh.at(places).values(range, out);
        }
        let mut rows = Vec::new();
        let row = |place| places.row(self.mesh.across(&self.base, &places.base, place));
        range.into_par_iter().with_min_len(4096).map(row).collect_into_vec(&mut rows);
        out.clear();
        rows.iter().for_each(|row| out.extend_from_slice(row));
    }
}

impl MeshSource for Unfolded<'_> {
    fn n_vertices(&self) -> usize {
        self.order.as_ref().map_or(self.base.n_vertices(), Order::n_vertices)
    }

    fn n_faces(&self) -> usize {
        self.mesh.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.mesh.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.gathered(range, |v| self.mesh.position(v), out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.mesh.list(&self.base, self.order.as_ref(), range, out);
    }
}

impl CarriedSource for Unfolded<'_> {
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.mesh.sharp_places(&self.base)
    }

    fn normals(&self) -> Option<&dyn NormalSource> {
        self.mesh.has_normals().then_some(self)
    }

    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        Some(Box::new(UnfoldedUvs(self, self.mesh.uvs.as_ref()?)))
    }

    fn attachments(&self) -> &Attachments {
        self.mesh.attachments()
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        let numbers = match &self.mesh.channels[channel] {
            RefinedChannel::Places(places) => return self.values_of(places, range, out),
            RefinedChannel::Vertices(numbers) => numbers,
        };
        let width = self.mesh.attachments().channels[channel].width;
        let row = |v: usize| &numbers[width * self.mesh.order.place(v)..][..width];
        let mut rows = Vec::new();
        self.gathered(range, row, &mut rows);
        out.clear();
        rows.iter().for_each(|row| out.extend_from_slice(row));
    }
}

impl NormalSource for Unfolded<'_> {
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.gathered(range, |v| self.mesh.normal(v), out);
    }

    fn on_side(&self, place: u32, next: u32) -> Option<[f64; 3]> {
        let [vertex, next] = [place, next].map(|place| index(self.vertex_at(place as usize)));
        self.mesh.on_side(vertex, next)
    }
}

/// Texture coordinates indexed like the vertices of the unfolded mesh.
struct UnfoldedUvs<'a>(&'a Unfolded<'a>, &'a RefinedPlaces);

impl PlaceSource for UnfoldedUvs<'_> {
    fn n_places(&self) -> usize {
        self.0.n_vertices()
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<f64>) {
        self.0.values_of(self.1, range, out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.0.faces(range, out);
    }

    fn follow_vertices(&self) -> bool {
        true
    }
}

impl OriginSource for Unfolded<'_> {
    fn input_cells(&self) -> [usize; 3] {
        self.mesh.input_cells()
    }

    fn vertex_origin(&self, place: usize) -> Origin {
        self.mesh.vertex_origin(self.vertex_at(place))
    }

    fn face_origin(&self, face: usize) -> u32 {
        self.mesh.face_origin(face)
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        self.mesh.faces_of(face)
    }
}

/// Refined face-corner values, with the faces of their mesh.
struct OfMesh<'a> {
    mesh: &'a RefinedMesh,
    places: &'a RefinedPlaces,
}

impl RefinedMesh {
    /// Presents some face-corner values of this mesh as a source for the writers.
    pub(super) fn at<'a>(&'a self, places: &'a RefinedPlaces) -> impl PlaceSource + 'a {
        OfMesh { mesh: self, places }
    }
}

impl PlaceSource for OfMesh<'_> {
    fn n_places(&self) -> usize {
        self.places.points.len() / self.places.width
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<f64>) {
        self.places.order.values(&self.places.points, self.places.width, range, out);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.mesh.list(&self.places.base, self.places.order.order(), range, out);
    }
}
