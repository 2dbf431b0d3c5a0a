//! Values at vertices around which the surface is not bicubic.

use std::f64::consts::PI;

use super::jet::{Jet, normal};
use crate::math::functions::{cos, real, sin, sqrt};
use crate::math::vector::{Vector, minus, plus, times};
use crate::solid::level::Level;
use crate::solid::sector::{Sector, SectorKind};

impl Level {
    /// Returns the limit of the vertex at which a half-edge starts, with the normal in its face. Derivatives along u
    /// and v do not exist there: nearby they grow without bound, or vanish.
    pub(super) fn vertex_jet(&self, half_edge: u32) -> Jet {
        let (at, normal) = (self.limit(half_edge), self.vertex_normal(half_edge));
        Jet { at, first: None, second: None, normal, principal: None }
    }

    /// Returns the normal at the vertex at which a half-edge starts, in its face, if it is known.
    pub(super) fn vertex_normal(&self, half_edge: u32) -> Option<Vector> {
        let sector = self.sector(half_edge);
        let [t, s] = match (sector.kind, sector.spokes.len()) {
            (SectorKind::Smooth, _) => self.tangents_around(&sector),
            // with other numbers of faces, the surface generally has no tangent plane there
            (SectorKind::Crease, 3) => self.tangents_at_crease(&sector),
            _ => return None,
        };
        normal(t, s)
    }

    /// Returns two tangents at a smooth vertex. Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44.
    fn tangents_around(&self, sector: &Sector) -> [Vector; 2] {
        let n = real(sector.spokes.len());
        let c = cos(2.0 * PI / n);
        let edges = 1.0 + c + cos(PI / n) * sqrt(2.0 * (9.0 + c));
        [cos, sin].map(|wave: fn(f64) -> f64| {
            let at = |i: usize| wave(2.0 * PI * real(i) / n);
            sector.spokes.iter().enumerate().fold([0.0; 3], |sum, (i, &spoke)| {
                let edge = times(edges * at(i), self.start(self.after(spoke, 1)));
                plus(sum, plus(edge, times(at(i) + at(i + 1), self.start(self.after(spoke, 2)))))
            })
        })
    }

    /// Returns the tangents at a vertex of a crease or a boundary: along its first edge, and into the sector.
    ///
    /// Weights of points across are the left eigenvector of the subdivision matrix of n faces for the eigenvalue
    /// `l = (5 + c + sqrt((9 + c)(1 + c))) / 16`, with `c = cos a`, `a = pi / n`: `(16 l - 4) sin(i a)` on inner edges,
    /// `sin(i a) + sin((i + 1) a)` on faces, `x` on both sharp edges, and what makes the sum 0 on the vertex. The
    /// column of a sharp edge gives `x (l - 1/4) = l sin a - (2 l - 1/4) cot(a / 2)`; with two faces it is that of the
    /// bicubic spline, `x = -1`.
    fn tangents_at_crease(&self, sector: &Sector) -> [Vector; 2] {
        let (spokes, n) = (&sector.spokes, sector.spokes.len());
        let angle = PI / real(n);
        let c = cos(angle);
        let eigenvalue = (5.0 + c + sqrt((9.0 + c) * (1.0 + c))) / 16.0;
        let cotangent = (1.0 + c) / sin(angle);
        let sharp = (eigenvalue * sin(angle) - (2.0 * eigenvalue - 0.25) * cotangent) / (eigenvalue - 0.25);
        let inner = 16.0 * eigenvalue - 4.0;
        let own = -2.0 * sharp - (inner + 2.0) * cotangent;
        let first = self.start(self.after(spokes[0], 1));
        let last = self.start(self.topology.previous(spokes[n - 1]));
        let wave = |i: usize| sin(real(i) * angle);
        let ends = plus(times(own, self.start(spokes[0])), times(sharp, plus(first, last)));
        let across = spokes.iter().enumerate().fold(ends, |sum, (i, &spoke)| {
            let edge = times(inner * wave(i), self.start(self.after(spoke, 1)));
            plus(sum, plus(edge, times(wave(i) + wave(i + 1), self.start(self.after(spoke, 2)))))
        });
        [minus(first, last), across]
    }
}
