//! Samples of the limit surface around a vertex, ring by ring, and the corresponding foot points on the planar cap.

use super::bezier::{BezierNet, bernstein};
use super::join::SectorPatch;
use super::rings::{LEAVES, Rings};
use crate::math::functions::real;
use crate::math::planar::cross;
use crate::math::vector::minus;

/// Number of Newton steps for one foot point. Five reach rounding errors from the parameters of the sample itself; half
/// as many leave visible errors, twice as many change nothing.
const SAMPLE_NEWTON_STEPS: usize = 10;

/// Returns the parameter in the sector of leaf coordinates (x, y) in the ring `depth`; 1 is the outermost.
pub(super) fn in_sector(depth: usize, lower: [usize; 2], x: [f64; 2]) -> [f64; 2] {
    let size = (0..depth).fold(1.0, |size, _| size / 2.0);
    [(real(lower[0]) + x[0]) * size, (real(lower[1]) + x[1]) * size]
}

/// Returns the parameters in the unit square at which a planar patch has the given point.
pub(super) fn foot(patch: &SectorPatch<2>, point: [f64; 2], start: [f64; 2]) -> [f64; 2] {
    let mut at = start;
    for _ in 0..SAMPLE_NEWTON_STEPS {
        let miss = minus(point, patch.at(at));
        let [u, v] = patch.slopes(at);
        let area = cross(u, v);
        let step = [cross(miss, v) / area, cross(u, miss) / area];
        at = [(at[0] + step[0]).clamp(0.0, 1.0), (at[1] + step[1]).clamp(0.0, 1.0)];
    }
    at
}

/// Corresponding pairs of parameters, the same in all sectors.
#[derive(Debug)]
pub(super) struct CapSamples {
    depth: usize,
    /// Bernstein values of the parameters along one side of a leaf.
    within: Vec<[f64; 4]>,
    /// Bernstein values of foot points, in the order of [`CapSamples::limits`].
    feet: Vec<[[f64; 6]; 2]>,
}

impl CapSamples {
    /// Creates samples of `depth` rings, at the given parameters along each side of a leaf.
    pub(super) fn of(characteristic: &Rings<2>, plane: &SectorPatch<2>, depth: usize, within: &[f64]) -> Self {
        let mut samples = Self { depth, within: within.iter().map(|x| bernstein(*x)).collect(), feet: Vec::new() };
        let places = LEAVES.iter().flat_map(|lower| {
            within.iter().flat_map(move |x| within.iter().map(move |y| (*lower, [*x, *y]))) //
        });
        let mut feet = Vec::new();
        let mut rings = characteristic.clone();
        for ring in 1..=depth {
            rings = rings.refined();
            for (lower, x) in places.clone() {
                let at = foot(plane, rings.leaf(0, lower).at(x), in_sector(ring, lower, x));
                feet.push([bernstein(at[0]), bernstein(at[1])]);
            }
        }
        samples.feet = feet;
        samples
    }

    /// Returns the number of samples in one sector.
    pub(super) fn len(&self) -> usize {
        self.feet.len()
    }

    /// Returns the ring of a sample; 0 is the outermost.
    pub(super) fn ring(&self, sample: usize) -> usize {
        sample / (LEAVES.len() * self.within.len() * self.within.len())
    }

    /// Visits the limit surface of each sector at each sample: sector, sample, point.
    pub(super) fn limits<const D: usize>(&self, rings: &Rings<D>, mut visit: impl FnMut(usize, usize, [f64; D])) {
        let mut rings = rings.clone();
        let mut first = 0;
        for _ in 0..self.depth {
            rings = rings.refined();
            for lower in LEAVES {
                for s in 0..rings.valence() {
                    self.leaf(&rings.leaf(s, lower), |k, point| visit(s, first + k, point));
                }
                first += self.within.len() * self.within.len();
            }
        }
    }

    fn leaf<const D: usize>(&self, leaf: &BezierNet<D, 4>, mut visit: impl FnMut(usize, [f64; D])) {
        for (i, x) in self.within.iter().enumerate() {
            for (j, y) in self.within.iter().enumerate() {
                visit(i * self.within.len() + j, leaf.blend(x, y));
            }
        }
    }

    /// Returns the point of a patch at the foot point of a sample.
    pub(super) fn on<const D: usize>(&self, patch: &SectorPatch<D>, sample: usize) -> [f64; D] {
        let [along, across] = &self.feet[sample];
        patch.blend(along, across)
    }
}
