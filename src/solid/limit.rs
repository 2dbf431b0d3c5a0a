//! Limit positions of the vertices of a level.

use super::level::Level;
use super::sector::{Sector, SectorKind};
use crate::math::functions::real;
use crate::math::vector::{Vector, plus, times};

/// Number of levels after which a vertex at the end of a sharp edge counts as its limit. The distance shrinks by 0.62
/// per level with twelve faces and by 0.66 with any number: to 1e-17 of the edges there. Half as many leave 1e-9; twice
/// as many change nothing.
const DART_LEVELS: usize = 96;

impl Level {
    /// Returns the limit of the vertex at which a half-edge starts; all faces around it must be quads.
    ///
    /// Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44; at ends of sharp edges, by repeated refinement.
    pub(super) fn limit(&self, half_edge: u32) -> Vector {
        let sector = self.sector(half_edge);
        let own = self.start(half_edge);
        match sector.kind {
            SectorKind::Corner | SectorKind::Cone | SectorKind::Undecided => own,
            SectorKind::Crease => {
                let v = self.topology.vertex(half_edge);
                let ends = self.sharp_edges_at(half_edge);
                let ends = ends.iter().map(|&e| self.points[self.topology.other_end(e as usize, v as usize) as usize]);
                times(1.0 / 6.0, ends.fold(times(4.0, own), plus))
            }
            SectorKind::Smooth => {
                let n = real(sector.spokes.len());
                let sum = |steps: usize| sector.spokes.iter().map(move |&spoke| self.start(self.after(spoke, steps)));
                let (edges, faces) = (sum(1).fold([0.0; 3], plus), sum(2).fold([0.0; 3], plus));
                times(1.0 / (n * (n + 5.0)), plus(plus(times(n * n, own), times(4.0, edges)), faces))
            }
            SectorKind::Dart => self.end_of_sharp_edge(&sector),
        }
    }

    /// Returns the limit of a vertex at which one sharp edge ends, the first of its sector, by refining the vertex and
    /// the ring of its faces level by level; each level contains all that the next one needs.
    fn end_of_sharp_edge(&self, sector: &Sector) -> Vector {
        let (spokes, n) = (&sector.spokes, sector.spokes.len());
        let ring = |steps: usize| spokes.iter().map(|&spoke| self.start(self.after(spoke, steps))).collect();
        let mut own = self.start(spokes[0]);
        let [mut edges, mut faces]: [Vec<Vector>; 2] = [ring(1), ring(2)];
        let mean = |points: [Vector; 4]| times(0.25, points.into_iter().fold([0.0; 3], plus));
        for _ in 0..DART_LEVELS {
            for (i, face) in faces.iter_mut().enumerate() {
                *face = mean([own, edges[i], edges[(i + 1) % n], *face]);
            }
            let sum = edges.iter().chain(&faces).copied().fold([0.0; 3], plus);
            edges[0] = times(0.5, plus(own, edges[0]));
            for i in 1..n {
                edges[i] = mean([own, edges[i], faces[i - 1], faces[i]]);
            }
            let n = real(n);
            own = plus(times((n - 2.0) / n, own), times(1.0 / (n * n), sum));
        }
        own
    }
}
