//! Limits of vertices of a level.

use super::error::SolidError;
use super::level::{Level, Refiner, Spot};
use super::sector::Kind;
use crate::math::functions::real;
use crate::math::vector::{Vector, plus, times};

/// Levels after which a vertex at the end of a sharp edge counts as its limit: the distance shrinks by about four a
/// level, to 1e-10 of the edges there. Half of it would show in the gaps between faces; twice is below rounding.
const DART_LEVELS: usize = 17;

impl Level {
    /// The limit of the vertex that a half-edge starts at, around which all faces are quads.
    ///
    /// Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44; ends of sharp edges by following the refinement.
    ///
    /// # Errors
    /// When the watch says stop.
    pub(super) fn limit(&self, half_edge: u32, refiner: &Refiner<'_>) -> Result<Vector, SolidError> {
        let sector = self.sector(half_edge);
        let own = self.start(half_edge);
        Ok(match sector.kind {
            Kind::Corner | Kind::Cone | Kind::Undecided => own,
            Kind::Crease => {
                let v = self.topology.vertex(half_edge);
                let ends = self.sharp_edges_at(half_edge);
                let ends = ends.iter().map(|&e| self.points[self.topology.other_end(e as usize, v as usize) as usize]);
                times(1.0 / 6.0, ends.fold(times(4.0, own), plus))
            }
            Kind::Smooth => {
                let n = real(sector.spokes.len());
                let sum = |steps: usize| sector.spokes.iter().map(move |&spoke| self.start(self.after(spoke, steps)));
                let (edges, faces) = (sum(1).fold([0.0; 3], plus), sum(2).fold([0.0; 3], plus));
                times(1.0 / (n * (n + 5.0)), plus(plus(times(n * n, own), times(4.0, edges)), faces))
            }
            Kind::Dart => self.followed(half_edge, refiner)?,
        })
    }

    /// The vertex that a half-edge starts at, many levels on.
    fn followed(&self, half_edge: u32, refiner: &Refiner<'_>) -> Result<Vector, SolidError> {
        let (mut level, mut edges, mut spot) = self.alone(&Spot::of(self, &[half_edge]))?;
        for _ in 0..DART_LEVELS {
            (level, spot) = level.closer(&spot, refiner, &mut edges)?;
        }
        Ok(spot.half_edges(&level).first().map_or_else(|| self.start(half_edge), |&at| level.start(at)))
    }
}
