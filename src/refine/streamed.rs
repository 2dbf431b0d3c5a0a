//! A refined mesh whose points are computed on demand, so that its memory does not grow with the level.

use std::ops::Range;

use super::act::act_on;
use super::apply::Points;
use super::error::RefineError;
use super::mesh::carrying;
use super::refined::RefinedMesh;
use super::start::mesh_net;
use super::sweep::{OnDemand, Sweep, SweepOutline};
use super::vertex_order::VertexOrder;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::attachments::Attachments;
use crate::shape::creases::CreaseTags;
use crate::shape::mesh::Mesh;
use crate::shape::source::{CarriedSource, FaceChunk, MeshSource, OnDemandSource, Origin, OriginSource};
use crate::shape::tile::Tile;
use crate::watch::{Stage, Watch};

/// A refined mesh that stores no points, and the sweep that computes them.
#[derive(Debug)]
pub struct StreamedMesh {
    shape: RefinedMesh,
    points: OnDemand,
}

/// Returns how many rounds of a mesh are refined as whole nets before its points can be computed on demand, and the
/// tile of its faces; `None` if they cannot be.
///
///
/// Meshes that carry channels, texture coordinates or frames are not streamed.
pub fn held_levels(mesh: &Mesh, plan: &Plan, steps: &[Scheduled]) -> Option<(usize, Tile)> {
    let attachments = &mesh.attachments;
    let carries = !attachments.channels.is_empty() || attachments.uvs.is_some() || !mesh.frames.is_empty();
    let net = mesh_net(mesh, plan);
    let outline = SweepOutline::of(&net, plan, steps).filter(|_| !carries)?;
    Some((outline.before(), outline.tile()))
}

impl StreamedMesh {
    /// Refines a mesh by the steps that precede the sweep; returns `None` if its points cannot be computed on demand.
    ///
    /// # Errors
    /// [`RefineError`].
    pub fn of(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<Option<Self>, RefineError> {
        if held_levels(mesh, plan, steps).is_none() {
            return Ok(None);
        }
        let net = mesh_net(mesh, plan);
        let Some(sweep) = Sweep::of(&net, plan, steps) else { return Ok(None) };
        watch.enter(Stage::Sweep);
        let points = vec![Points::new(mesh.positions.clone(), 3)];
        let (net, mut points) = act_on(net, points, plan, &steps[..sweep.steps_before()], watch)?;
        let start = VertexOrder::constructed(&net).ordered(points.swap_remove(0).now, 3);
        let net = net.after_splits(sweep.tile(), sweep.splits() - net.mesh.pieces.len());
        let shape = carrying(mesh, &net, RefinedMesh::documented, Vec::new(), Vec::new());
        Ok(Some(Self { shape, points: OnDemand::new(sweep, start, watch) }))
    }
}

impl MeshSource for StreamedMesh {
    fn n_vertices(&self) -> usize {
        self.points.n_points()
    }

    fn n_faces(&self) -> usize {
        self.shape.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.shape.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.points.points(range, out);
    }

    fn on_demand(&self) -> Option<&dyn OnDemandSource> {
        Some(self)
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.shape.faces(range, out);
    }
}

impl CarriedSource for StreamedMesh {
    fn attachments(&self) -> &Attachments {
        self.shape.attachments()
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        self.shape.sharp_edges()
    }

    fn tags(&self) -> CreaseTags {
        self.shape.tags()
    }
}

impl OnDemandSource for StreamedMesh {
    fn stretch(&self, vertex: usize) -> usize {
        self.points.stretch(vertex)
    }

    fn stretch_of_faces(&self, face: usize) -> usize {
        let shown = &self.shape.shown;
        shown.number(self.points.stretch_of_faces(shown.face(face)))
    }

    fn corners(&self, range: Range<usize>, out: &mut Vec<[[f64; 3]; 4]>) {
        self.points.corners(self.shape.shown.runs(range), out);
    }

    fn sums(&self, range: Range<usize>, of_face: &dyn Fn([[f64; 3]; 4]) -> [f64; 3], out: &mut Vec<[f64; 3]>) {
        self.points.sums(range, |face| self.shape.shown.has(face), of_face, out);
    }
}

impl OriginSource for StreamedMesh {
    fn input_cells(&self) -> [usize; 3] {
        self.shape.input_cells()
    }

    fn vertex_origin(&self, vertex: usize) -> Origin {
        self.shape.vertex_origin(vertex)
    }

    fn face_origin(&self, face: usize) -> u32 {
        self.shape.face_origin(face)
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        self.shape.faces_of(face)
    }

    fn isoline(&self, edge: usize, out: &mut Vec<u32>) -> bool {
        self.shape.isoline(edge, out)
    }
}
