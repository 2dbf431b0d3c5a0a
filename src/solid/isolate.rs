//! Feature-adaptive refinement: faces with a bicubic surface are taken as they are; those around other vertices are
//! split until a cap is close enough.
//!
//! Source: M. Niessner, C. Loop, M. Meyer, T. DeRose, ACM TOG 31 (2012), 6:1-6:11.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::cap::{Capped, caps};
use super::caps::DeviationMethod;
use super::edges::Edges;
use super::error::SolidError;
use super::level::{Level, Refiner, Sharpened};
use super::net::BicubicNet;
use super::request::SolidRequest;
use super::rounding::Rounding;
use super::sector::{Sector, SectorKind};
use super::spline::BSplineSurface;
use crate::math::vector::{Vector, cross, length};
use crate::shape::topology::index;

/// A face of some level that represents a part of the surface: corner 0 at (0, 0), side 0 along u.
#[derive(Debug, Clone)]
pub(super) struct FaceCell {
    /// Its vertices and the edges from each to the next, by their indices on all levels.
    pub(super) corners: [u32; 4],
    pub(super) sides: [u32; 4],
    /// The input face from which it arose.
    pub(super) input: u32,
}

/// A face with a bicubic surface, with its control net.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    pub(super) cell: FaceCell,
    pub(super) net: BicubicNet,
}

/// A face at an extraordinary vertex.
#[derive(Debug, Clone)]
pub(super) struct ExtraordinaryCap {
    pub(super) cell: FaceCell,
    pub(super) surface: BSplineSurface,
}

/// An extraordinary vertex, as seen from one of its sectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isolated {
    /// Its limit, in model units.
    pub at: Vector,
    /// Number of faces of the sector.
    pub faces: usize,
    /// The kind of the surface there.
    pub kind: SectorKind,
    /// Number of levels of refinement before its caps.
    pub level: u32,
    /// Distance of the caps from the limit surface including rounding, in model units.
    pub deviation: f64,
    /// How the deviation was determined.
    pub known: DeviationMethod,
    /// Whether tangent planes agree across the edges between its caps.
    pub is_tangent: bool,
}

/// The parts of a surface.
#[derive(Debug, Default)]
pub(super) struct SurfacePieces {
    pub(super) leaves: Vec<Leaf>,
    pub(super) caps: Vec<ExtraordinaryCap>,
    pub(super) vertices: Vec<Isolated>,
    pub(super) edges: Edges,
    /// The last level from which faces were taken.
    pub(super) depth: u32,
}

/// The state of the isolation, to which each level adds pieces.
struct Isolation<'a> {
    request: &'a SolidRequest,
    /// Largest permitted deviation, in model units.
    tolerance: f64,
    rounding: Rounding,
    refiner: &'a Refiner<'a>,
    /// Maximum number of leaves.
    most: usize,
    pieces: SurfacePieces,
}

/// Smallest sine of the angle between the tangents at a smooth vertex. Half or twice of it matters only for meshes that
/// are flat to nine digits, where normals are lost in rounding.
const LEAST_VERTEX_SINE: f64 = 1e-9;

/// Refuses a smooth vertex whose tangents do not span a plane.
fn check_normal(sector: &Sector, surfaces: &[BSplineSurface]) -> Result<(), SolidError> {
    let [at, along_u, along_v] = surfaces[0].at([0.0; 2]);
    let longest = length(along_u).max(length(along_v));
    if sector.kind != SectorKind::Smooth || length(cross(along_u, along_v)) > LEAST_VERTEX_SINE * longest * longest {
        return Ok(());
    }
    let [x, y, z] = at;
    let remedy = match sector.spokes.len() {
        2 => "only two faces meet there; split one of them from that vertex, or leave the vertex out",
        _ => "send a mesh that does not fold there",
    };
    let detail =
        format!("the limit surface has no tangent plane at its vertex near ({x:.4}, {y:.4}, {z:.4}): {remedy}");
    Err(SolidError::at("", detail))
}

/// Splits a mesh until all of its surface is bicubic or capped within the tolerance in model units, with a maximum
/// number of bicubic faces.
///
/// # Errors
/// If that takes too many levels or faces, or the watch says stop.
pub(super) fn isolate(
    (mut level, edges): (Level, Edges),
    request: &SolidRequest,
    (tolerance, rounding, most): (f64, Rounding, usize),
    refiner: &Refiner<'_>,
) -> Result<SurfacePieces, SolidError> {
    let pieces = SurfacePieces { edges, ..SurfacePieces::default() };
    let mut isolation = Isolation { request, tolerance, rounding, refiner, most, pieces };
    for depth in 0..=request.max_level {
        refiner.watch.check()?;
        isolation.check_rounding(depth)?;
        isolation.pieces.depth = depth;
        let (split, farthest) = isolation.take(&level, depth)?;
        if split.is_empty() {
            return Ok(isolation.pieces);
        }
        if depth == request.max_level {
            return Err(isolation.unreachable(farthest));
        }
        for e in split.iter().flat_map(|&f| level.topology.half_edges(f as usize)) {
            isolation.pieces.edges.split(level.edges[level.topology.edge(e) as usize]);
        }
        level = level.refined(&split, refiner, &mut isolation.pieces.edges)?;
    }
    Ok(isolation.pieces)
}

impl Isolation<'_> {
    /// Takes the leaves and caps of a level; returns the remaining faces, and the deviation of the worst caps there.
    fn take(&mut self, level: &Level, depth: u32) -> Result<(Vec<u32>, f64), SolidError> {
        let mut left = Vec::new();
        for f in (0..index(level.topology.n_faces())).filter(|&f| level.wanted[f as usize]) {
            if f % 4096 == 0 {
                self.refiner.watch.check()?;
            }
            let half_edge = level.topology.half_edges(f as usize).start;
            if level.is_leaf(f) {
                let leaf = Leaf { cell: self.cell(level, half_edge), net: level.net(half_edge) };
                self.pieces.leaves.push(leaf);
            } else {
                left.push(f);
            }
        }
        if self.pieces.leaves.len() > self.most {
            let detail = format!(
                "level {depth} of isolation has more than {} bicubic faces; ask for a coarser tolerance, or make \
                 semi-sharp edges sharp (10) or less sharp",
                self.most
            );
            return Err(SolidError::at("tolerance", detail));
        }
        if depth == 0 {
            return Ok((left, f64::INFINITY));
        }
        let farthest = self.cap(level, depth, &mut left)?;
        Ok((left, farthest))
    }

    /// Caps the remaining faces of a level where caps are close enough; returns the deviation of the worst of the
    /// others.
    fn cap(&mut self, level: &Level, depth: u32, left: &mut Vec<u32>) -> Result<f64, SolidError> {
        let mut seen = BTreeSet::new();
        let sectors: Vec<Sector> = left
            .iter()
            .filter_map(|&f| Some(level.sector(level.lone_extraordinary(f)?)))
            .filter(|sector| seen.insert(sector.spokes.iter().copied().min()) && is_ready(level, sector))
            .collect();
        let rounding = self.rounding.after(depth);
        let asked = (self.request.continuity, self.tolerance - rounding);
        let found: Vec<_> = sectors.par_iter().map(|sector| caps(level, sector, asked, self.refiner)).collect();
        let mut farthest = 0.0_f64;
        let mut capped = BTreeSet::new();
        for (sector, found) in sectors.iter().zip(found) {
            match found? {
                Err(deviation) => farthest = farthest.max(deviation + rounding),
                Ok(found) => {
                    check_normal(sector, &found.surfaces)?;
                    self.put(level, depth, (sector, found), &mut capped);
                }
            }
        }
        left.retain(|f| !capped.contains(f));
        Ok(farthest)
    }

    /// Adds the caps of a sector, and its faces to the capped ones.
    fn put(&mut self, level: &Level, depth: u32, (sector, found): (&Sector, Capped), capped: &mut BTreeSet<u32>) {
        let Capped { surfaces, deviation, known, is_tangent } = found;
        self.pieces.vertices.push(Isolated {
            at: surfaces[0].points[0][0],
            faces: sector.spokes.len(),
            kind: sector.kind,
            level: depth,
            deviation: deviation + self.rounding.after(depth),
            known,
            is_tangent,
        });
        for (&spoke, surface) in sector.spokes.iter().zip(surfaces) {
            let face = index(level.topology.face_of(spoke));
            if level.wanted[face as usize] {
                let cell = self.cell(level, spoke);
                self.pieces.caps.push(ExtraordinaryCap { cell, surface });
                capped.insert(face);
            }
        }
    }

    fn cell(&mut self, level: &Level, half_edge: u32) -> FaceCell {
        let sides: [u32; 4] = std::array::from_fn(|s| level.after(half_edge, s));
        for side in sides {
            let e = level.topology.edge(side);
            if level.edge_sharpened(e) == Sharpened::Ever {
                self.pieces.edges.sharpen(level.edges[e as usize]);
            }
        }
        FaceCell {
            corners: sides.map(|side| level.vertices[level.topology.vertex(side) as usize]),
            sides: sides.map(|side| level.edges[level.topology.edge(side) as usize]),
            input: level.inputs[level.topology.face_of(half_edge)],
        }
    }

    /// Refuses a tolerance that rounding errors alone exceed.
    fn check_rounding(&self, depth: u32) -> Result<(), SolidError> {
        let (rounding, tolerance) = (self.rounding.after(depth), self.tolerance);
        if rounding < tolerance {
            return Ok(());
        }
        let detail = format!(
            "coordinates as large as these are rounded by up to {rounding:.1e} on level {depth}, {tolerance:.1e} is \
             asked for (model units); move the mesh to the origin or ask for a coarser tolerance"
        );
        Err(SolidError::at("tolerance", detail))
    }

    fn unreachable(&self, farthest: f64) -> SolidError {
        let (levels, tolerance) = (self.request.max_level, self.tolerance);
        SolidError::at(
            "tolerance",
            format!(
                "after {levels} levels of isolation caps are {farthest:.1e} from the limit surface, {tolerance:.1e} is \
                 asked for (model units); ask for a coarser tolerance or a higher max_level"
            ),
        )
    }
}

/// Returns whether caps are possible in all faces of a sector.
fn is_ready(level: &Level, sector: &Sector) -> bool {
    let lone = |&spoke: &u32| level.lone_extraordinary(index(level.topology.face_of(spoke))) == Some(spoke);
    sector.kind != SectorKind::Undecided && sector.spokes.iter().all(lone)
}
