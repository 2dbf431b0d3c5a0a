//! A control mesh as a source: all its faces, hidden ones included, with its attachments.

use std::ops::Range;

use crate::shape::attachments::Attachments;
use crate::shape::creases::CreaseTags;
use crate::shape::mesh::Mesh;
use crate::shape::seams::Seams;
use crate::shape::source::{CarriedSource, FaceChunk, MeshSource, OriginSource, PlaceSource};

/// A control mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct ControlSource<'a>(pub(super) &'a Mesh);

impl ControlSource<'_> {
    /// Returns the hidden faces, ascending.
    pub(super) fn holes(&self) -> &[u32] {
        &self.0.holes
    }
}

impl MeshSource for ControlSource<'_> {
    fn n_vertices(&self) -> usize {
        self.0.topology.n_vertices()
    }

    fn n_faces(&self) -> usize {
        self.0.topology.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.0.topology.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.extend_from_slice(&self.0.positions.as_chunks().0[range]);
    }

    fn held_positions(&self) -> Option<&[[f64; 3]]> {
        Some(self.0.positions.as_chunks().0)
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        range.for_each(|f| out.push(self.0.topology.face(f)));
    }
}

impl CarriedSource for ControlSource<'_> {
    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        let uvs = self.0.attachments.uvs.as_ref()?;
        Some(Box::new(ControlPlaces { seams: &uvs.seams, values: &uvs.values, width: 2 }))
    }

    fn channel_places(&self, channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        let channel = &self.0.attachments.channels[channel];
        let (values, width) = (&channel.values, channel.width);
        Some(Box::new(ControlPlaces { seams: channel.seams.as_ref()?, values, width }))
    }

    fn attachments(&self) -> &Attachments {
        &self.0.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        let channel = &self.0.attachments.channels[channel];
        if channel.seams.is_none() {
            out.extend_from_slice(&channel.values[range.start * channel.width..range.end * channel.width]);
        }
    }

    fn tags(&self) -> CreaseTags {
        self.0.tags()
    }
}

impl OriginSource for ControlSource<'_> {
    fn input_cells(&self) -> [usize; 3] {
        let topology = &self.0.topology;
        [topology.n_vertices(), topology.n_edges(), topology.n_faces()]
    }
}

/// Values of the corners of a control mesh.
struct ControlPlaces<'a> {
    seams: &'a Seams,
    values: &'a [f64],
    width: usize,
}

impl PlaceSource for ControlPlaces<'_> {
    fn n_places(&self) -> usize {
        self.seams.topology.n_vertices()
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        out.extend_from_slice(&self.values[range.start * self.width..range.end * self.width]);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        range.for_each(|f| out.push(self.seams.topology.face(f)));
    }
}
