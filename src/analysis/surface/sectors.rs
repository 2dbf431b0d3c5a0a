//! Sector coordinates around a vertex or a face of any valence, and how they unfold onto a regular lattice.
//!
//! Around a vertex of valence n the sector s lies between the rays s and s + 1; its points are (i, j), i steps along
//! the ray s and j along the ray s + 1, with i >= 1 and j >= 0. Around a face with n corners the sector s is the
//! quadrant beyond the corner s, with i >= 0 and j >= 0 steps along its sides.

use crate::math::functions::{cos, real, sin};

/// What lies around the middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Quads around a vertex, regular with four.
    Quads,
    /// Triangles around a vertex, regular with six.
    Triangles,
    /// Quads around a face, regular with four corners: what dual schemes have.
    Dual,
}

/// By how much a row near the middle may differ from that of the regular net and count as equal: rounding.
/// Other rules differ by a hundredth at least. Half and twice of it decide alike.
pub(super) const SAME: f64 = 1e-12;
/// Points in the plane, and faces by the numbers of their points.
pub type PlaneNet = (Vec<[f64; 2]>, Vec<Vec<usize>>);

/// A point of one sector, and the ends of a cell.
pub(super) type Point = [i32; 2];

impl Kind {
    /// The valence that the scheme has everywhere in a regular net.
    pub fn regular(self) -> usize {
        if self == Self::Triangles { 6 } else { 4 }
    }

    /// Whether the middle is a point.
    pub(super) fn has_centre(self) -> bool {
        self != Self::Dual
    }

    /// How many rings of faces a point is away from the middle.
    pub(super) fn radius(self, [i, j]: Point) -> i32 {
        if self == Self::Triangles { i + j } else { i.max(j) }
    }

    /// The points of one sector up to a radius, the nearest first.
    pub(super) fn points(self, radius: i32) -> Vec<Point> {
        let from = i32::from(self.has_centre());
        let all = (from..=radius).flat_map(|i| (0..=radius).map(move |j| [i, j]));
        let mut points: Vec<Point> = all.filter(|&p| self.radius(p) <= radius).collect();
        points.sort_by_key(|&p| (self.radius(p), p));
        points
    }

    /// The point in whose place a reflection puts one, within the sector or, for points on rays, from sector s to -s.
    pub(super) fn mirrored(self, [i, j]: Point) -> Point {
        if self.has_centre() && j == 0 { [i, 0] } else { [j, i] }
    }

    /// The angle of a point of sector 0 as a fraction of a sector, as far as symmetry tells: 0 on the ray, 1/2 within.
    pub(super) fn turn(self, [_, j]: Point) -> f64 {
        if self.has_centre() && j > 0 { 0.5 } else { 0.0 }
    }

    /// A lattice point turned by one sector about the middle of the regular net.
    fn turned(self, [x, y]: Point) -> Point {
        match self {
            Self::Quads => [-y, x],
            Self::Triangles => [-y, x + y],
            Self::Dual => [-y - 1, x],
        }
    }

    /// A lattice point turned by so many sectors, forwards or backwards.
    pub(super) fn rotated(self, point: Point, sectors: i32) -> Point {
        let turns = sectors.rem_euclid(if self == Self::Triangles { 6 } else { 4 });
        (0..turns).fold(point, |point, _| self.turned(point))
    }

    /// The sector, as an offset from sector 0, and the point there of a lattice point near sector 0; `None` for the
    /// middle and for points on the far side.
    pub(super) fn unfolded(self, point: Point) -> Option<(i32, Point)> {
        let from = i32::from(self.has_centre());
        [0, -1, 1, -2, 2].into_iter().find_map(|sector| {
            let [i, j] = self.rotated(point, -sector);
            (i >= from && j >= 0).then_some((sector, [i, j]))
        })
    }

    /// A place in the plane for a point of a sector, around a middle with n sectors, by which directions are told
    /// apart.
    pub(super) fn direction(self, n: usize, sector: usize, [i, j]: Point) -> [f64; 2] {
        let (a, b) = if self.has_centre() { (0.0, 1.0) } else { (-0.25, 0.25) };
        let shift = if self.has_centre() { 0.0 } else { 0.5 };
        let [p, q] = [a, b].map(|part| {
            let angle = std::f64::consts::TAU * (real(sector) + part) / real(n);
            [cos(angle), sin(angle)]
        });
        let (i, j) = (f64::from(i) + shift, f64::from(j) + shift);
        [i * p[0] + j * q[0], i * p[1] + j * q[1]]
    }
}
