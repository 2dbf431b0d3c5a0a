//! The profile of a tube under refinement. On a regular tube a plan acts on each direction separately: around the axis
//! the first average multiplies by `cos(theta/2)` and each later one by `cos(theta/4)^2`; along the axis the plan is
//! the curve scheme.

use super::ring::TubeRing;
use crate::math::functions::cos;
use crate::math::vector::{Complex, cross, dot, length, times};
use crate::scheme::operator::Role;
use crate::scheme::plan::Scheduled;

/// Largest movement of a ring in a level, relative to its coordinates, at which it has settled: half of a unit in the
/// last place or one, which is rounding. Half of it may go on to the last level; twice of it stops up to a level
/// earlier, with a last digit that differs.
const SETTLED_RING_SHARE: f64 = 1e-16;

/// The first vertices of the rings around a line, from one end to the other.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Each as a complex number: the vertex in the plane perpendicular to the axis.
    rings: Vec<Complex>,
    /// The push-back factor of each ring.
    deltas: Vec<f64>,
    /// The index of the ring of the line.
    at: usize,
    /// The number of rings on each side that influence the line, at any level.
    reach: usize,
}

impl Profile {
    /// Creates the profile of rings on one axis around the line, ring `at`; rings beyond `reach` have no influence on
    /// the line.
    pub(super) fn of(rings: &[TubeRing], deltas: Vec<f64>, at: usize, reach: usize) -> Self {
        let complex = |ring: &TubeRing| {
            let Some((seen, axis)) = rings.iter().find_map(|ring| Some((ring.first, ring.axis?))) else {
                return [0.0; 2];
            };
            let x = times(1.0 / length(seen), seen);
            [dot(ring.first, x), dot(ring.first, cross(axis, x))]
        };
        Self { rings: rings.iter().map(complex).collect(), deltas, at, reach }
    }

    /// Returns whether any ring is pushed back.
    pub(super) fn is_pushed(&self) -> bool {
        self.deltas.iter().any(|&delta| delta != 0.0)
    }

    /// Returns the first vertex of the ring of the line.
    pub(super) fn here(&self) -> Complex {
        self.rings[self.at]
    }

    /// Returns the radius of the ring of the line.
    pub(super) fn radius(&self) -> f64 {
        length(self.here())
    }

    /// Returns whether the ring of the line has not moved from `before`, up to rounding.
    pub(super) fn has_settled(&self, before: Complex) -> bool {
        let [x, y] = self.here();
        (x - before[0]).abs() + (y - before[1]).abs() <= SETTLED_RING_SHARE * (x.abs() + y.abs())
    }

    /// Returns the profile after an upsampling and the steps up to the next one, with the kernel `along` the axis, for
    /// rings whose neighbouring vertices are the angle `theta` apart.
    pub(super) fn refined(&self, block: &[Scheduled], along: f64, theta: f64) -> Self {
        let n = self.rings.len();
        let halves = |j: usize| [self.rings[j / 2], self.rings[j.div_ceil(2)]];
        let mut fine: Vec<Complex> = (0..2 * n - 1).map(|j| mix(halves(j).map(|ring| (ring, 0.5)))).collect();
        let deltas: Vec<f64> =
            (0..2 * n - 1).map(|j| f64::midpoint(self.deltas[j / 2], self.deltas[j.div_ceil(2)])).collect();
        let quarter = cos(theta / 4.0);
        for step in block {
            match step.letter.facts().role {
                Role::Average if step.first => fine = averaged(&fine, along, cos(theta / 2.0)),
                Role::Average => fine = averaged(&fine, 1.0, quarter * quarter),
                Role::PushBack => self.displace(&mut fine),
                Role::Upsample | Role::Smooth => {}
            }
        }
        let low = (2 * self.at).saturating_sub(self.reach);
        let high = (2 * self.at + self.reach + 1).min(fine.len());
        Self { rings: fine[low..high].into(), deltas: deltas[low..high].into(), at: 2 * self.at - low, ..*self }
    }

    /// Pushes finer rings back towards these rings with the compensation 1, because vertices that turn with a ring also
    /// move with it.
    fn displace(&self, fine: &mut [Complex]) {
        let back = |(i, ring): (usize, &Complex)| mix([(*ring, self.deltas[i]), (fine[2 * i], -self.deltas[i])]);
        let moves: Vec<Complex> = self.rings.iter().enumerate().map(back).collect();
        for (j, point) in fine.iter_mut().enumerate() {
            *point = mix([(*point, 1.0), (moves[j / 2], 0.5), (moves[j.div_ceil(2)], 0.5)]);
        }
    }
}

/// Averages rings: even rings have the weight `f` along the axis, and all rings shrink by `factor`. The first and the
/// last ring are averaged around the axis only, as on boundaries.
fn averaged(fine: &[Complex], f: f64, factor: f64) -> Vec<Complex> {
    let weight = |j: usize| if j.is_multiple_of(2) { f } else { 1.0 };
    let average = |j: usize| {
        if j == 0 || j + 1 == fine.len() {
            return mix([(fine[j], factor)]);
        }
        let [a, b, c] = [j - 1, j, j + 1].map(weight);
        let (before, after) = (2.0 * (a + b), 2.0 * (b + c));
        mix([
            (fine[j - 1], factor * a / before),
            (fine[j], factor * (b / before + b / after)),
            (fine[j + 1], factor * c / after),
        ])
    };
    (0..fine.len()).map(average).collect()
}

fn mix<const N: usize>(terms: [(Complex, f64); N]) -> Complex {
    terms.iter().fold([0.0; 2], |sum, (p, w)| [sum[0] + w * p[0], sum[1] + w * p[1]])
}
