//! Caps at extraordinary vertices, fitted once per valence.

use std::ops::RangeInclusive;
use std::sync::OnceLock;

use super::bezier::spaced;
use super::characteristic::{characteristic_net, rings_until};
use super::join::{FREE_COEFFICIENTS, Free, SectorPatch, first_leg, join, limit, tangents};
use super::least::least_squares;
use super::proof::ValenceProof;
use super::rings::{PER_SECTOR, Rings};
use super::samples::CapSamples;
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, dot, minus, plus, times};

/// The valences for which there are caps. Memory and time of a table grow with the square of the valence: at twice the
/// greatest, it would take seconds, and angles between spokes become so small that isolation no longer shrinks
/// deviations by more than a third per level.
pub const VALENCES: RangeInclusive<usize> = 3..=32;

/// The greatest valence whose deviations are bounded; those of higher ones are sampled. More rings would have to be
/// examined for higher ones, and it was not studied whether their planar caps can be shown to be one-to-one.
pub(super) const MAX_PROVED_VALENCE: usize = 12;

/// The Bezier points of a cap's patch: `patch[a][b]`, a along u and b along v.
pub type CapPatch = [[Vector; 6]; 6];

/// Number of points of a two-ring whose effects are fitted: those of sector 0, and the vertex. Others follow by
/// rotation.
const FITTED_POINTS: usize = PER_SECTOR + 1;

/// Samples along each side of a leaf for the fit, including the ends. With three, deviations grow by a tenth; nine take
/// three times the time and gain less than a hundredth.
pub(super) const FIT_SAMPLES: usize = 5;

/// The weight of the squared errors of a ring relative to the next outer ring. Half or twice of it increases the
/// largest deviation of most valences by up to a quarter.
const RING_WEIGHT: f64 = 0.5;

/// Samples along each side of a leaf for estimates, including the ends. Four underestimate by up to a sixth; thirteen
/// take four times the time and find at most three hundredths more.
pub(super) const ESTIMATE_SAMPLES: usize = 7;

/// The factor by which estimates are multiplied, since they consider samples only. On random vertices of valence 3 to
/// 32, the largest deviation of 17 x 17 samples per leaf is at most 1.05 times theirs. With half of the margin nothing
/// is spare; with twice of it deviations are stated a fifth too large.
const ESTIMATE_MARGIN: f64 = 1.1;

/// The free parameters of the caps of one valence as functions of the two-ring, and the cap of the characteristic net.
#[derive(Debug)]
pub struct CapTable {
    pub(super) valence: usize,
    pub(super) characteristic: Rings<2>,
    pub(super) sigma: f64,
    /// The cap of the characteristic net.
    pub(super) plane: Vec<SectorPatch<2>>,
    /// The free parameters of sector s, as sums over the sources: `fit[s][parameter][source]`.
    fit: Vec<[[f64; FITTED_POINTS]; FREE_COEFFICIENTS]>,
    samples: CapSamples,
    proof: OnceLock<Option<ValenceProof>>,
}

/// A two-ring minus the planar net that its tangents span, with the cap of this residual.
pub(super) struct Residual {
    /// The limit point of the vertex.
    pub(super) limit: Vector,
    /// The tangents at the vertex.
    pub(super) tangents: [Vector; 2],
    /// The residual of the two-ring.
    pub(super) rings: Rings<3>,
    /// The cap of the residual.
    pub(super) patches: Vec<SectorPatch<3>>,
}

static CAP_TABLES: [OnceLock<CapTable>; 33] = [const { OnceLock::new() }; 33];

impl CapTable {
    /// Returns the table of a valence, built on first use; `None` outside [`VALENCES`].
    pub fn of(valence: usize) -> Option<&'static Self> {
        let table = CAP_TABLES.get(valence).filter(|_| VALENCES.contains(&valence))?;
        Some(table.get_or_init(|| Self::fitted(valence)))
    }

    fn fitted(valence: usize) -> Self {
        let weight = |samples: &CapSamples, k| (0..samples.ring(k)).fold(1.0, |weight, _| weight * sqrt(RING_WEIGHT));
        Self::fitted_to(valence, rings_that_matter(valence), FIT_SAMPLES, weight)
    }

    /// Builds the table of a valence from samples of `depth` rings, with weighted errors.
    pub(super) fn fitted_to(
        valence: usize,
        depth: usize,
        side: usize,
        weight: impl Fn(&CapSamples, usize) -> f64,
    ) -> Self {
        let characteristic = characteristic_net(valence);
        let sigma = first_leg(&characteristic);
        let plane = join(&characteristic, sigma, &vec![[[0.0; 2]; FREE_COEFFICIENTS]; valence]);
        let samples = CapSamples::of(&characteristic, &plane[0], depth, &spaced(side));
        let fit = fit(valence, sigma, &samples, |k| weight(&samples, k));
        let within = spaced(ESTIMATE_SAMPLES);
        let samples = CapSamples::of(&characteristic, &plane[0], rings_that_matter(valence), &within);
        Self { valence, characteristic, sigma, plane, fit, samples, proof: OnceLock::new() }
    }

    /// The cap of a vertex whose two-ring are smooth quads: one patch a sector. `two_ring` holds the vertex, then for
    /// each sector s, between spokes s and s + 1 counter-clockwise, the points in steps (1,0), (1,1), (2,0), (2,1),
    /// (2,2), (1,2) along both: `6 N + 1` points. Patch s has u along spoke s and v along the next, starts at the limit
    /// of the vertex, and ends where the one-ring's limit points are. Neighbours share the points of their spoke.
    ///
    /// # Panics
    ///
    /// Panics if the two-ring does not have as many points as the valence asks for.
    pub fn cap(&self, two_ring: &[Vector]) -> Vec<CapPatch> {
        let residual = self.residual(two_ring);
        let plane = |p: [f64; 2]| plus(times(p[0], residual.tangents[0]), times(p[1], residual.tangents[1]));
        let point = |p: Vector, q: [f64; 2]| plus(residual.limit, plus(plane(q), p));
        let both = residual.patches.iter().zip(&self.plane);
        let patch = |(own, plane): (&SectorPatch<3>, &SectorPatch<2>)| {
            std::array::from_fn(|a| std::array::from_fn(|b| point(own.0[a][b], plane.0[a][b]))) //
        };
        both.map(patch).collect()
    }

    /// The largest distance found between the cap and the limit surface at samples, ring by ring, times 1.1: good to
    /// tell whether a vertex is far enough isolated, and no bound.
    ///
    /// # Panics
    ///
    /// Panics if the two-ring does not have as many points as the valence asks for.
    pub fn estimate(&self, two_ring: &[Vector]) -> f64 {
        let residual = self.residual(two_ring);
        let mut largest = 0.0_f64;
        self.samples.limits(&residual.rings, |s, k, point| {
            let apart = minus(point, self.samples.on(&residual.patches[s], k));
            largest = largest.max(dot(apart, apart));
        });
        ESTIMATE_MARGIN * sqrt(largest)
    }

    /// Returns the facts about all caps of this valence, computed on first use; `None` for valences beyond
    /// [`MAX_PROVED_VALENCE`].
    pub(super) fn proof(&self) -> Option<&ValenceProof> {
        let make = || {
            if self.valence <= MAX_PROVED_VALENCE {
                ValenceProof::of(&self.characteristic, &self.plane[0])
            } else {
                None
            }
        };
        self.proof.get_or_init(make).as_ref()
    }

    /// Decomposes a two-ring into its limit point, its tangent plane, and a residual with its cap.
    pub(super) fn residual(&self, two_ring: &[Vector]) -> Residual {
        assert_eq!(two_ring.len(), PER_SECTOR * self.valence + 1, "a two-ring of valence {}", self.valence);
        let rings = Rings::of_two_ring(two_ring);
        let limit = limit(&rings);
        let near: Vec<Vector> = two_ring.iter().map(|point| minus(*point, limit)).collect();
        let tangents = tangents(&Rings::of_two_ring(&near));
        let flat = self.characteristic.two_ring();
        let remains = |(point, flat): (&Vector, &[f64; 2])| {
            minus(*point, plus(times(flat[0], tangents[0]), times(flat[1], tangents[1]))) //
        };
        let remains: Vec<Vector> = near.iter().zip(&flat).map(remains).collect();
        let rings = Rings::of_two_ring(&remains);
        let patches = join(&rings, self.sigma, &self.free(&remains));
        Residual { limit, tangents, rings, patches }
    }

    /// Returns the free parameters of each sector.
    fn free(&self, two_ring: &[Vector]) -> Vec<Free<3>> {
        let n = self.valence;
        let sector = |s: usize| {
            let mut free = [[0.0; 3]; FREE_COEFFICIENTS];
            for (a, free) in free.iter_mut().enumerate() {
                *free = times(self.fit[s][a][PER_SECTOR], two_ring[0]);
                for t in 0..n {
                    let weights = &self.fit[(s + n - t) % n][a];
                    for (weight, point) in weights.iter().zip(&two_ring[1 + PER_SECTOR * t..][..PER_SECTOR]) {
                        *free = plus(*free, times(*weight, *point));
                    }
                }
            }
            free
        };
        (0..n).map(sector).collect()
    }
}

/// Returns the number of rings until the residual has shrunk to less than a fiftieth; samples further inside find
/// nothing new.
pub(super) fn rings_that_matter(valence: usize) -> usize {
    rings_until(valence, 0.02)
}

/// Returns the parameters for which caps of unit two-rings are nearest to their limit surfaces in the least-squares
/// sense.
fn fit(
    n: usize,
    sigma: f64,
    samples: &CapSamples,
    weight: impl Fn(usize) -> f64,
) -> Vec<[[f64; FITTED_POINTS]; FREE_COEFFICIENTS]> {
    let unit = |at: usize| std::array::from_fn(|k| if k == at { 1.0 } else { 0.0 });
    let mut sources = vec![[0.0; FITTED_POINTS]; PER_SECTOR * n + 1];
    sources[0] = unit(PER_SECTOR);
    (0..PER_SECTOR).for_each(|q| sources[1 + q] = unit(q));
    let sources = Rings::of_two_ring(&sources);
    let unfitted = join(&sources, sigma, &vec![[[0.0; FITTED_POINTS]; FREE_COEFFICIENTS]; n]);
    let mut missing = vec![[0.0; FITTED_POINTS]; n * samples.len()];
    samples.limits(&sources, |s, k, point| {
        missing[s * samples.len() + k] = times(weight(k), minus(point, samples.on(&unfitted[s], k)));
    });
    let mut free = vec![[[0.0; FREE_COEFFICIENTS]; FREE_COEFFICIENTS]; n];
    free[0] = std::array::from_fn(|a| std::array::from_fn(|k| if k == a { 1.0 } else { 0.0 }));
    let moved = join(&Rings::of_two_ring(&vec![[0.0; FREE_COEFFICIENTS]; PER_SECTOR * n + 1]), sigma, &free);
    let effects: Vec<[f64; FREE_COEFFICIENTS]> =
        moved.iter().flat_map(|patch| (0..samples.len()).map(|k| times(weight(k), samples.on(patch, k)))).collect();
    least_squares(n, &effects, &missing)
}
