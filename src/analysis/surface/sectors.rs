//! Sector coordinates around a vertex or a face of any valence, and their unfolding onto a regular lattice.
//!
//! Around a vertex of valence n the sector s lies between the rays s and s + 1; its points are (i, j), i steps along
//! the ray s and j along the ray s + 1, with i >= 1 and j >= 0. Around a face with n corners the sector s is the
//! quadrant beyond the corner s, with i >= 0 and j >= 0 steps along its sides.

use crate::math::functions::{cos, real, sin};

/// The kind of net around a centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NetKind {
    /// Quads around a vertex; valence 4 is regular.
    Quads,
    /// Triangles around a vertex; valence 6 is regular.
    Triangles,
    /// Quads around a face, as in dual schemes; four corners are regular.
    Dual,
}

/// Largest difference of weights that is regarded as rounding. Weights of different rules differ by at least a
/// hundredth. Half or twice of it decides alike.
pub(super) const WEIGHT_ROUNDING: f64 = 1e-12;
/// Points in the plane, and faces as indices of their points.
pub type PlaneNet = (Vec<[f64; 2]>, Vec<Vec<usize>>);

/// A point of one sector in sector coordinates, or of the lattice.
pub(super) type LatticePoint = [i32; 2];

impl NetKind {
    /// Returns the regular valence, or number of corners, of a net of this kind.
    pub fn regular(self) -> usize {
        if self == Self::Triangles { 6 } else { 4 }
    }

    /// Returns whether the centre is a point.
    pub(super) fn has_centre(self) -> bool {
        self != Self::Dual
    }

    /// Returns the number of rings of faces between a point and the centre.
    pub(super) fn radius(self, [i, j]: LatticePoint) -> i32 {
        if self == Self::Triangles { i + j } else { i.max(j) }
    }

    /// Returns the points of one sector up to a radius, the nearest first.
    pub(super) fn points(self, radius: i32) -> Vec<LatticePoint> {
        let from = i32::from(self.has_centre());
        let all = (from..=radius).flat_map(|i| (0..=radius).map(move |j| [i, j]));
        let mut points: Vec<LatticePoint> = all.filter(|&p| self.radius(p) <= radius).collect();
        points.sort_by_key(|&p| (self.radius(p), p));
        points
    }

    /// Returns the corners of the cells of a unit square, counter-clockwise: of the square itself, or of its lower and
    /// its upper triangle.
    pub(super) fn shapes(self) -> &'static [&'static [LatticePoint]] {
        match self {
            Self::Triangles => &[&[[0, 0], [1, 0], [0, 1]], &[[1, 0], [1, 1], [0, 1]]],
            Self::Quads | Self::Dual => &[&[[0, 0], [1, 0], [1, 1], [0, 1]]],
        }
    }

    /// Returns the faces of one sector up to a radius; the first corner of a square or a lower triangle is the one
    /// nearest to the centre.
    pub(super) fn faces(self, radius: i32) -> Vec<Vec<LatticePoint>> {
        let cells = (0..radius).flat_map(|i| (0..radius).map(move |j| [i, j]));
        let face = |[i, j]: LatticePoint, shape: &[LatticePoint]| shape.iter().map(|[x, y]| [i + x, j + y]).collect();
        let all = cells.flat_map(|cell| self.shapes().iter().map(move |shape| face(cell, shape)));
        all.filter(|face: &Vec<LatticePoint>| face.iter().all(|&point| self.radius(point) <= radius)).collect()
    }

    /// Returns the mirror image of a point: within its sector, except that the reflection maps points on rays from
    /// sector s to -s.
    pub(super) fn mirrored(self, [i, j]: LatticePoint) -> LatticePoint {
        if self.has_centre() && j == 0 { [i, 0] } else { [j, i] }
    }

    /// Returns the angle of a point of sector 0 as a fraction of a sector, as far as symmetry determines it: 0 on the
    /// ray, 1/2 within.
    pub(super) fn turn(self, [_, j]: LatticePoint) -> f64 {
        if self.has_centre() && j > 0 { 0.5 } else { 0.0 }
    }

    /// Rotates a lattice point by one sector about the centre of the regular net.
    fn turned(self, [x, y]: LatticePoint) -> LatticePoint {
        match self {
            Self::Quads => [-y, x],
            Self::Triangles => [-y, x + y],
            Self::Dual => [-y - 1, x],
        }
    }

    /// Rotates a lattice point by a number of sectors, which may be negative.
    pub(super) fn rotated(self, point: LatticePoint, sectors: i32) -> LatticePoint {
        let turns = sectors.rem_euclid(if self == Self::Triangles { 6 } else { 4 });
        (0..turns).fold(point, |point, _| self.turned(point))
    }

    /// Returns the sector, as an offset from sector 0, and the sector coordinates of a lattice point near sector 0;
    /// `None` for the centre and for points on the far side.
    pub(super) fn unfolded(self, point: LatticePoint) -> Option<(i32, LatticePoint)> {
        let from = i32::from(self.has_centre());
        [0, -1, 1, -2, 2].into_iter().find_map(|sector| {
            let [i, j] = self.rotated(point, -sector);
            (i >= from && j >= 0).then_some((sector, [i, j]))
        })
    }

    /// Returns a position in the plane for a point of a sector around a centre with n sectors, by which directions are
    /// distinguished.
    pub(super) fn direction(self, n: usize, sector: usize, [i, j]: LatticePoint) -> [f64; 2] {
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
