//! Bounds the distance of a cap from the limit surface.

use super::bezier::{restriction, weighted};
use super::composed::SHORT_TERMS;
use super::join::SectorPatch;
use super::proof::{LeafCell, ValenceProof};
use super::rings::{LEAVES, Rings};
use super::stretch::Slopes;
use super::table::{CapTable, Residual};
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, dot, length, minus};

/// How a deviation was determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeviationMethod {
    /// The deviation is a proven bound, for caps of the distance between corresponding points.
    Certified,
    /// The deviation is the largest one of some samples, for fitted caps times 1.1.
    Sampled,
}

impl DeviationMethod {
    /// Returns the name in certificates.
    pub fn name(self) -> &'static str {
        match self {
            Self::Certified => "certified",
            Self::Sampled => "sampled",
        }
    }
}

/// The two-sided distance between a cap and the limit surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// The distance, in the units of the net.
    pub bound: f64,
    /// How the distance was determined.
    pub method: DeviationMethod,
}

/// The rounding allowance of a bound, as a fraction of the largest distance of the net from the limit point: 2^-38.
/// Values pass through fewer than 40 refinements with fewer than 100 roundings each, which are means, and through sums
/// of fewer than 200 terms whose absolute weights add up to less than 50: fewer than 2^14 roundings of 2^-53, with a
/// factor of 2 to spare. Half of it would leave no margin; twice of it would not be noticed.
const CAP_BOUND_ROUNDING: f64 = 1.0 / 274_877_906_944.0;

impl CapTable {
    /// Returns the distance between the cap of a two-ring and the limit surface: a bound for valences up to 12, an
    /// estimate from samples for higher ones.
    ///
    /// With the plane net that the tangents span taken off, the surface S over each cell of a ring and the cap P along
    /// the path of foot points are polynomials, whose coefficients bound `|S - P|`; the path misses the true foot
    /// points by so much that P changes by at most its greatest slope times that. Inside the last ring S is in the hull
    /// of its net and P in that of a part of its own.
    ///
    /// # Panics
    ///
    /// Panics if the two-ring does not have as many points as the valence asks for.
    pub fn bound(&self, two_ring: &[Vector]) -> Deviation {
        let Some(proof) = self.proof() else {
            return Deviation { bound: self.estimate(two_ring), method: DeviationMethod::Sampled };
        };
        let residual = self.residual(two_ring);
        let slopes: Vec<Slopes<3>> = residual.patches.iter().map(Slopes::of).collect();
        let mut most = 0.0_f64;
        let mut rings = residual.rings.clone();
        for cells in &proof.rings {
            rings = rings.refined();
            for (s, patch) in residual.patches.iter().zip(&slopes).enumerate() {
                most = ring(&rings, s, cells, patch, most);
            }
        }
        let bound = most.max(inside(proof, &rings, &residual)) + rounding(two_ring, residual.limit);
        Deviation { bound, method: DeviationMethod::Certified }
    }
}

fn rounding(two_ring: &[Vector], limit: Vector) -> f64 {
    let far = two_ring.iter().map(|point| length(minus(*point, limit))).fold(0.0, f64::max);
    CAP_BOUND_ROUNDING * far + 4.0 * f64::EPSILON * length(limit)
}

/// Returns the maximum of `most` and of the distances over the cells of one ring in one sector.
fn ring(
    rings: &Rings<3>,
    s: usize,
    cells: &[LeafCell],
    (patch, slopes): (&SectorPatch<3>, &Slopes<3>),
    mut most: f64,
) -> f64 {
    let steepest = slopes.most();
    let leaves = LEAVES.map(|lower| rings.leaf(s, lower));
    let flat: Vec<Vector> = patch.0.iter().flatten().copied().collect();
    let flat: [Vector; SHORT_TERMS] = std::array::from_fn(|k| flat[k]);
    let lengths = flat.map(length);
    for cell in cells {
        let surface = leaves[cell.leaf].mapped(&cell.part[0], &cell.part[1]);
        let mut square = 0.0_f64;
        for (point, weights) in surface.0.iter().flatten().zip(&cell.composed.short) {
            let apart = minus(*point, weighted(weights, &flat));
            square = square.max(dot(apart, apart));
        }
        let neglected: f64 = cell.composed.neglected.iter().zip(&lengths).map(|(part, length)| part * length).sum();
        let along = sqrt(square) + neglected;
        // slopes near the path are only computed if those of the whole patch do not suffice
        if along + steepest * cell.off > most {
            most = most.max(along + slopes.over(&cell.around).most() * cell.off);
        }
    }
    most
}

/// Returns the greatest distance inside the last ring.
fn inside(proof: &ValenceProof, rings: &Rings<3>, residual: &Residual) -> f64 {
    let net = rings.two_ring().into_iter().map(length).fold(0.0, f64::max);
    let part = restriction([0.0, proof.inside]);
    let cap = residual.patches.iter().map(|patch| patch.mapped(&part, &part).hull()).fold(0.0, f64::max);
    net + cap
}
