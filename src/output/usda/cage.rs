//! A control mesh as a source: all its faces, hidden ones included, with what it carries.

use std::ops::Range;

use super::tokens;
use crate::scheme::operator::Standard;
use crate::scheme::plan::Plan;
use crate::scheme::rules::TriangleRule;
use crate::scheme::sharpness::Creasing;
use crate::scheme::tags::Boundary;
use crate::shape::attachments::Attachments;
use crate::shape::creases::{INFINITE_SHARPNESS, Tags};
use crate::shape::mesh::Mesh;
use crate::shape::seams::{Interpolation, Seams};
use crate::shape::source::{CarriedSource, FaceChunk, MeshSource, OriginSource, PlaceSource};

/// A control mesh under a scheme that OpenSubdiv has.
#[derive(Debug)]
pub(super) struct Cage<'a> {
    mesh: &'a Mesh,
    plan: &'a Plan,
    standard: Standard,
}

impl<'a> Cage<'a> {
    /// The cage of a plan, if it is one of OpenSubdiv's schemes by all its rules.
    pub(super) fn of(mesh: &'a Mesh, plan: &'a Plan) -> Option<Self> {
        let standard = plan.standard()?;
        let semi_sharp = |&(_, sharpness): &(u32, f64)| sharpness < INFINITE_SHARPNESS;
        // USD has no word for another rule by which sharpness becomes less
        let creases_alike = plan.rules.creasing == Creasing::default() || !mesh.creases.iter().any(semi_sharp);
        creases_alike.then_some(Self { mesh, plan, standard })
    }

    /// The token of `subdivisionScheme`.
    pub(super) fn scheme(&self) -> &'static str {
        match self.standard {
            Standard::CatmullClark => "catmullClark",
            Standard::Loop => "loop",
            Standard::Bilinear => "bilinear",
        }
    }

    /// The tokens of the rules that matter to this mesh, with the names of their attributes.
    pub(super) fn rules(&self) -> Vec<(&'static str, &'static str)> {
        let mut rules = Vec::new();
        let topology = &self.mesh.topology;
        // the rule makes no difference to a closed mesh, whose bytes are then those of any other
        let boundary = if topology.n_boundary() > 0 { self.plan.boundary } else { Boundary::default() };
        rules.push(("interpolateBoundary", tokens::boundary(boundary)));
        let has_triangle = || (0..topology.n_faces()).any(|f| topology.face(f).len() == 3);
        if self.plan.rules.triangles == TriangleRule::Smooth && has_triangle() {
            rules.push(("triangleSubdivisionRule", "smooth"));
        }
        if let Some(uvs) = &self.mesh.attachments.uvs {
            rules.push(("faceVaryingLinearInterpolation", tokens::interpolation(uvs.seams.interpolation(topology))));
        }
        rules
    }

    /// The channels of corners whose rule of interpolation is not that of the texture coordinates, by name: USD has
    /// one rule for all values of corners.
    pub(super) fn otherwise(&self) -> Vec<&str> {
        let carried = &self.mesh.attachments;
        let word = |seams: &Seams| seams.interpolation(&self.mesh.topology);
        let of_uvs = carried.uvs.as_ref().map_or(Interpolation::CornersPlus1, |uvs| word(&uvs.seams));
        let differs = |seams: &Option<Seams>| seams.as_ref().is_some_and(|seams| word(seams) != of_uvs);
        carried.channels.iter().filter(|channel| differs(&channel.seams)).map(|channel| channel.name.as_str()).collect()
    }

    /// The hidden faces, ascending.
    pub(super) fn holes(&self) -> &[u32] {
        &self.mesh.holes
    }
}

impl MeshSource for Cage<'_> {
    fn n_vertices(&self) -> usize {
        self.mesh.topology.n_vertices()
    }

    fn n_faces(&self) -> usize {
        self.mesh.topology.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.mesh.topology.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.extend_from_slice(&self.mesh.positions.as_chunks().0[range]);
    }

    fn held_positions(&self) -> Option<&[[f64; 3]]> {
        Some(self.mesh.positions.as_chunks().0)
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        range.for_each(|f| out.push(self.mesh.topology.face(f)));
    }
}

impl CarriedSource for Cage<'_> {
    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        let uvs = self.mesh.attachments.uvs.as_ref()?;
        Some(Box::new(CagePlaces { seams: &uvs.seams, values: &uvs.values, width: 2 }))
    }

    fn channel_places(&self, channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        let channel = &self.mesh.attachments.channels[channel];
        let (values, width) = (&channel.values, channel.width);
        Some(Box::new(CagePlaces { seams: channel.seams.as_ref()?, values, width }))
    }

    fn attachments(&self) -> &Attachments {
        &self.mesh.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        let channel = &self.mesh.attachments.channels[channel];
        if channel.seams.is_none() {
            out.extend_from_slice(&channel.values[range.start * channel.width..range.end * channel.width]);
        }
    }

    fn tags(&self) -> Tags {
        self.mesh.tags()
    }
}

impl OriginSource for Cage<'_> {
    fn input_cells(&self) -> [usize; 3] {
        let topology = &self.mesh.topology;
        [topology.n_vertices(), topology.n_edges(), topology.n_faces()]
    }
}

/// Values of the corners of a control mesh.
struct CagePlaces<'a> {
    seams: &'a Seams,
    values: &'a [f64],
    width: usize,
}

impl PlaceSource for CagePlaces<'_> {
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
