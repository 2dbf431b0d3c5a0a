//! Caps around extraordinary vertices, and their distance from the limit surface.

use super::caps::{CapTable, DeviationMethod};
use super::distance::farthest;
use super::error::SolidError;
use super::interpolated::interpolated;
use super::level::{Level, Refiner, Spot};
use super::request::Continuity;
use super::sector::{Sector, SectorKind};
use super::spline::BSplineSurface;
use crate::math::functions::real;
use crate::math::vector::{Vector, plus, times};

/// The caps of one sector, one per face.
#[derive(Debug, Clone)]
pub(super) struct Capped {
    pub(super) surfaces: Vec<BSplineSurface>,
    /// Distance from the limit surface, in model units.
    pub(super) deviation: f64,
    pub(super) known: DeviationMethod,
    /// Whether tangent planes agree across the edges between the caps.
    pub(super) is_tangent: bool,
}

/// Returns the caps of a sector, or their distance from the limit surface if it exceeds the tolerance.
///
/// # Errors
/// If the watch says stop.
pub(super) fn caps(
    level: &Level,
    sector: &Sector,
    (continuity, tolerance): (Continuity, f64),
    refiner: &Refiner<'_>,
) -> Result<Result<Capped, f64>, SolidError> {
    let smooth = sector.kind == SectorKind::Smooth;
    if let (true, Continuity::Tangent, Some(table)) = (smooth, continuity, CapTable::of(sector.spokes.len())) {
        return Ok(fitted(table, &level.two_ring(sector), tolerance));
    }
    let (nearer, mut edges, spot) = level.alone(&Spot::of(level, &sector.spokes))?;
    let next = nearer.closer(&spot, refiner, &mut edges)?;
    let nets = if smooth { approximate(level, sector) } else { interpolated(level, sector, &next) };
    let surfaces: Vec<BSplineSurface> = nets.iter().map(BSplineSurface::bezier).collect();
    let deviation = farthest(&surfaces, sector.is_closed, next, refiner, &mut edges)?;
    let capped = Capped { surfaces, deviation, known: DeviationMethod::Sampled, is_tangent: false };
    Ok(if deviation <= tolerance { Ok(capped) } else { Err(deviation) })
}

/// Returns fitted caps of bidegree 5.
fn fitted(table: &CapTable, ring: &[Vector], tolerance: f64) -> Result<Capped, f64> {
    let estimate = table.estimate(ring);
    if estimate > tolerance {
        return Err(estimate);
    }
    let found = table.bound(ring);
    if found.bound > tolerance {
        return Err(found.bound);
    }
    let surfaces = table.cap(ring).iter().map(BSplineSurface::bezier).collect();
    Ok(Capped { surfaces, deviation: found.bound, known: found.method, is_tangent: true })
}

/// Returns bicubic patches with the exact data on the outside, and with Catmull-Clark limits and tangents at the
/// vertex.
///
/// Source: C. Loop, S. Schaefer, ACM TOG 27 (2008), 8:1-8:11.
fn approximate(level: &Level, sector: &Sector) -> Vec<super::net::BicubicNet> {
    let (spokes, n) = (&sector.spokes, sector.spokes.len());
    let [own, limit] = [level.start(spokes[0]), level.limit(spokes[0])];
    let at = |i: usize, steps| level.start(level.after(spokes[i % n], steps));
    let (edge, face) = (|i| at(i, 1), |i| at(i, 2));
    let valence = real(n);
    let along = |i: usize| {
        let sum = [
            times(2.0 * valence, own),
            times(4.0, edge(i)),
            times(2.0, plus(edge(i + 1), edge(i + n - 1))),
            plus(face(i), face(i + n - 1)),
        ];
        times(1.0 / (2.0 * (valence + 5.0)), sum.into_iter().fold([0.0; 3], plus))
    };
    let inner = |i: usize| {
        let sum = plus(plus(times(valence, own), times(2.0, plus(edge(i), edge(i + 1)))), face(i));
        times(1.0 / (valence + 5.0), sum)
    };
    let net = |i: usize| {
        let mut net = super::net::bezier(&level.net(spokes[i]));
        (net[0][0], net[1][0], net[0][1], net[1][1]) = (limit, along(i), along(i + 1), inner(i));
        net
    };
    (0..n).map(net).collect()
}

impl Level {
    /// Returns the vertex of a closed sector and its two-ring: the vertex, then for each face its second and third
    /// corner and the four vertices beyond them, starting at the spoke.
    fn two_ring(&self, sector: &Sector) -> Vec<Vector> {
        let faces = sector.spokes.iter().flat_map(|&spoke| {
            let [beside, diagonal, before] = self.around(spoke);
            [
                self.start(beside),
                self.start(diagonal),
                self.start(self.after(beside, 1)),
                self.start(self.after(beside, 2)),
                self.start(self.after(diagonal, 2)),
                self.start(self.after(before, 2)),
            ]
        });
        std::iter::once(self.start(sector.spokes[0])).chain(faces).collect()
    }

    /// Returns the three faces beyond a face at an isolated vertex: those across its second and third side and the one
    /// between them, each as the half-edge that starts at the corner nearest to the vertex, along u.
    pub(super) fn around(&self, spoke: u32) -> [u32; 3] {
        let beside = self.topology.next(self.topology.twin(self.after(spoke, 1)));
        let diagonal = self.topology.twin(self.after(beside, 2));
        let before = self.topology.twin(self.after(spoke, 2));
        [beside, diagonal, before]
    }
}
