//! The cost of a solid, before anything is refined.

use super::caps::{VALENCES, cost};
use super::request::{Continuity, SolidRequest};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::mesh::Mesh;

/// The properties of a control mesh that decide about the size of its solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CageCounts {
    /// Number of faces.
    pub faces: u128,
    /// Number of face corners at possibly extraordinary vertices, and of corners of faces that are not quads.
    pub extraordinary: u128,
    /// Number of faces that remain along semi-sharp edges and corners until these are smooth.
    pub semi_sharp: u128,
}

/// Upper bounds of the size of a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SolidForecast {
    /// Number of bicubic faces before packing.
    pub leaves: u128,
    /// Number of faces of the result.
    pub faces: u128,
}

/// Memory of a bicubic face in bytes: its net (384), indices and edges on its level and the one before (200), edge data
/// for packing and joining (100), its share of the control points of a packed face (4 points) and of boundary curves.
/// Half of it is exceeded by solids whose faces are not packed.
const LEAF_BYTES: u128 = 1_000;
/// Memory of a face of the result in bytes: 36 control points of 24 bytes, four curves with lists of their own.
const SOLID_FACE_BYTES: u128 = 4_000;

impl CageCounts {
    /// Returns the properties of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let topology = &mesh.topology;
        let mut is_tagged = vec![false; topology.n_vertices()];
        let creased = mesh.creases.iter().flat_map(|&(e, _)| topology.ends(e as usize));
        let vertices = mesh.semi_sharp_corners.iter().map(|&(v, _)| v);
        creased.chain(vertices).chain(mesh.corners.iter().copied()).for_each(|v| is_tagged[v as usize] = true);
        let at_vertices = (0..topology.n_vertices()).map(|v| {
            let n = topology.ring(v).count();
            let regular = if topology.boundary_edges(v).is_some() { 2 } else { 4 };
            if n == regular && !is_tagged[v] { 0 } else { n as u128 }
        });
        let of_faces = (0..topology.n_faces()).map(|f| topology.face(f).len() as u128).filter(|&n| n != 4);
        let all = mesh.creases.iter().chain(&mesh.semi_sharp_corners).map(|&(_, sharpness)| sharpness);
        let semi_sharp = all.filter(|&sharpness| sharpness < INFINITE_SHARPNESS);
        Self {
            faces: topology.n_faces() as u128,
            extraordinary: at_vertices.sum::<u128>() + of_faces.sum::<u128>(),
            // both sides of an edge; twice as many on each level, and all levels together twice the last
            semi_sharp: semi_sharp
                .map(|sharpness| 16_u128 << (1..10).filter(|&s| sharpness > f64::from(s)).count())
                .sum(),
        }
    }

    /// Returns upper bounds of the size of the solid. A face at an extraordinary vertex leaves up to sixteen faces on
    /// the first two levels, and three on each later level; these become one face each.
    pub fn forecast(&self, request: &SolidRequest) -> SolidForecast {
        let levels = u128::from(request.max_level);
        let most = request.max_faces as u128;
        let rings = self.extraordinary.saturating_mul(3 * levels).min(most.saturating_mul(6));
        let first = self.extraordinary.saturating_mul(16).saturating_add(self.semi_sharp);
        let leaves = self.faces.saturating_add(first).saturating_add(rings);
        SolidForecast { leaves, faces: leaves.saturating_add(4 * self.extraordinary).min(most) }
    }
}

impl SolidForecast {
    /// Returns the memory in bytes, without that of the mesh and of the output.
    pub fn bytes(&self) -> u128 {
        self.leaves.saturating_mul(LEAF_BYTES).saturating_add(self.faces.saturating_mul(SOLID_FACE_BYTES))
    }
}

/// Operations per bicubic face: the split of its parent, its net, its area and volume. Measured: 5 us. Half or twice of
/// it predicts half or twice the time.
const LEAF_OPERATIONS: f64 = 6e3;
/// Number of levels on which distances are estimated before one is small enough; a tolerance of 1e-9 takes more at
/// valences above 6, a tolerance of 1e-5 half as many.
const ESTIMATED_LEVELS: f64 = 10.0;
/// Operations per face to sample four levels around a vertex: 150 points with their feet. Half or twice of it predicts
/// half or twice the time.
const SAMPLE_OPERATIONS: f64 = 1e6;

/// Returns the number of operations for the solid of a mesh, each about a nanosecond.
pub fn operations(mesh: &Mesh, request: &SolidRequest) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a forecast")]
    let leaves = CageCounts::of(mesh).forecast(request).leaves as f64;
    let topology = &mesh.topology;
    let mut known = [false; *VALENCES.end() + 1];
    let mut of_valence = |n: usize| {
        if n == 4 {
            return 0.0;
        }
        if request.continuity == Continuity::Bicubic || !VALENCES.contains(&n) {
            return ESTIMATED_LEVELS * SAMPLE_OPERATIONS * f64::from(u32::try_from(n).unwrap_or(u32::MAX));
        }
        let cost = cost(n);
        let tables = if std::mem::replace(&mut known[n], true) { 0.0 } else { 1.0 };
        tables * (cost.table_operations + cost.proof_operations)
            + ESTIMATED_LEVELS * cost.estimate_operations
            + cost.bound_operations
            + cost.cap_operations
    };
    let vertices: f64 = (0..topology.n_vertices()).map(|v| of_valence(topology.ring(v).count())).sum();
    let faces: f64 = (0..topology.n_faces()).map(|f| of_valence(topology.face(f).len())).sum();
    leaves * LEAF_OPERATIONS + vertices + faces
}
