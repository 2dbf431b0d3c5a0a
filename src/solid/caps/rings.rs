//! The two-ring of a smooth vertex among quads, its refinement, and the bicubic nets of the limit surface around it.

use super::bezier::BezierNet;
use crate::math::functions::real;
use crate::math::vector::{plus, times};

/// Number of points of the two-ring in one sector, in the order of [`SECTOR_PLACES`].
pub(super) const PER_SECTOR: usize = 6;
/// Places of the points of one sector: steps along its first and along its second spoke.
const SECTOR_PLACES: [[usize; 2]; PER_SECTOR] = [[1, 0], [1, 1], [2, 0], [2, 1], [2, 2], [1, 2]];
/// Number of steps stored along each spoke, as many as refined two-rings reach.
const SPOKE_STEPS: usize = 3;
/// Number of places stored per sector: 1 to [`SPOKE_STEPS`] steps along the first spoke, 0 to [`SPOKE_STEPS`] along the
/// second.
const STORED_PLACES: usize = SPOKE_STEPS * (SPOKE_STEPS + 1);
/// The lower corners of the three exact leaves of one ring, in steps of the refined net.
pub(super) const LEAVES: [[usize; 2]; 3] = [[1, 0], [0, 1], [1, 1]];

/// Points around a vertex of a quad mesh, of any number of coordinates: sector `s` lies between spokes `s` and `s + 1`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rings<const D: usize> {
    /// The vertex.
    pub(super) centre: [f64; D],
    /// `STORED_PLACES` points per sector; for a given two-ring, those beyond two steps are zero and never read.
    sectors: Vec<[[f64; D]; STORED_PLACES]>,
}

fn slot(u: usize, v: usize) -> usize {
    (u - 1) * (SPOKE_STEPS + 1) + v
}

impl<const D: usize> Rings<D> {
    /// Creates the rings from a function that returns the point at steps (u, v) of sector s.
    fn of(centre: [f64; D], n: usize, point: impl Fn(usize, usize, usize) -> [f64; D]) -> Self {
        let sector = |s| {
            let mut held = [[0.0; D]; STORED_PLACES];
            for u in 1..=SPOKE_STEPS {
                for v in 0..=SPOKE_STEPS {
                    held[slot(u, v)] = point(s, u, v);
                }
            }
            held
        };
        Self { centre, sectors: (0..n).map(sector).collect() }
    }

    /// Creates the rings of a two-ring: the vertex, then six points per sector.
    pub(super) fn of_two_ring(points: &[[f64; D]]) -> Self {
        let n = points.len() / PER_SECTOR;
        assert_eq!(points.len(), PER_SECTOR * n + 1, "a two-ring has a vertex and six points a sector");
        let find = |s: usize, u, v| {
            let place = SECTOR_PLACES.iter().position(|place| *place == [u, v]);
            place.map_or([0.0; D], |place| points[1 + PER_SECTOR * s + place])
        };
        Self::of(points[0], n, find)
    }

    /// Returns the two-ring, in the order of [`Self::of_two_ring`].
    pub(super) fn two_ring(&self) -> Vec<[f64; D]> {
        let sector = |held: &[[f64; D]; STORED_PLACES]| SECTOR_PLACES.map(|[u, v]| held[slot(u, v)]);
        std::iter::once(self.centre).chain(self.sectors.iter().flat_map(sector)).collect()
    }

    /// Returns the valence of the vertex.
    pub(super) fn valence(&self) -> usize {
        self.sectors.len()
    }

    /// Returns the point u steps along spoke s and v along the next; each is at least -1, and not both are -1.
    pub(super) fn at(&self, s: usize, [u, v]: [isize; 2]) -> [f64; D] {
        let n = self.valence();
        match (usize::try_from(u), usize::try_from(v)) {
            (Ok(0), Ok(0)) => self.centre,
            (Ok(0), Ok(v)) => self.sectors[(s + 1) % n][slot(v, 0)],
            (Ok(u), Ok(v)) => self.sectors[s % n][slot(u, v)],
            (Err(_), _) => self.at(s + 1, [v, 1]),
            (Ok(_), Err(_)) => self.at(s + n - 1, [1, u]),
        }
    }

    /// Returns the control points of the bicubic patch whose lower corner is at the given steps.
    fn control(&self, s: usize, [u, v]: [usize; 2]) -> [[[f64; D]; 4]; 4] {
        let step = |at: usize, i: usize| (at + i).cast_signed() - 1;
        let point = |i, j| if u + i + v + j == 0 { [0.0; D] } else { self.at(s, [step(u, i), step(v, j)]) };
        std::array::from_fn(|i| std::array::from_fn(|j| point(i, j)))
    }

    /// Returns the limit surface of one of the [`LEAVES`] of a refined net, as a bicubic net.
    pub(super) fn leaf(&self, s: usize, lower: [usize; 2]) -> BezierNet<D, 4> {
        BezierNet::of_spline(&self.control(s, lower))
    }

    /// Returns the exact data of the surface outside for sector s: all coefficients except the one at the vertex
    /// continue it with two derivatives.
    pub(super) fn outside(&self, s: usize) -> BezierNet<D, 4> {
        BezierNet::of_spline(&self.control(s, [0, 0]))
    }

    /// Returns the net after one refinement with the same centre vertex.
    pub(super) fn refined(&self) -> Self {
        Self::of(self.refined_centre(), self.valence(), |s, u, v| self.child(s, [u, v]))
    }

    fn refined_centre(&self) -> [f64; D] {
        let n = self.valence();
        let weight = 1.0 / (real(n) * real(n));
        let mut sum = times((real(n) - 2.0) / real(n), self.centre);
        for s in 0..n {
            sum = plus(sum, times(weight, self.at(s, [1, 0])));
            sum = plus(sum, times(weight, self.mean(s, [0, 0])));
        }
        sum
    }

    /// Returns the centroid of the face whose lower corner is at the given steps.
    fn mean(&self, s: usize, [u, v]: [isize; 2]) -> [f64; D] {
        let low = plus(self.at(s, [u, v]), self.at(s, [u + 1, v]));
        let high = plus(self.at(s, [u, v + 1]), self.at(s, [u + 1, v + 1]));
        times(0.25, plus(low, high))
    }

    /// Returns the point of the refined net at the given steps: a face point, an edge point, or a vertex of valence 4.
    fn child(&self, s: usize, at: [usize; 2]) -> [f64; D] {
        let [u, v] = at.map(|x| (x / 2).cast_signed());
        match at.map(|x| x % 2) {
            [1, 1] => self.mean(s, [u, v]),
            [1, _] => self.on_edge(s, [u, v], [1, 0]),
            [_, 1] => self.on_edge(s, [u, v], [0, 1]),
            _ => {
                let along = plus(self.at(s, [u + 1, v]), self.at(s, [u - 1, v]));
                let across = plus(self.at(s, [u, v + 1]), self.at(s, [u, v - 1]));
                let high = plus(self.at(s, [u + 1, v + 1]), self.at(s, [u - 1, v + 1]));
                let low = plus(self.at(s, [u + 1, v - 1]), self.at(s, [u - 1, v - 1]));
                let ring = plus(times(3.0 / 32.0, plus(along, across)), times(1.0 / 64.0, plus(high, low)));
                plus(times(9.0 / 16.0, self.at(s, [u, v])), ring)
            }
        }
    }

    /// Returns the edge point of the edge that leads from the given steps in the given direction.
    fn on_edge(&self, s: usize, [u, v]: [isize; 2], [du, dv]: [isize; 2]) -> [f64; D] {
        let ends = plus(self.at(s, [u, v]), self.at(s, [u + du, v + dv]));
        let left = plus(self.at(s, [u + dv, v + du]), self.at(s, [u + 1, v + 1]));
        let right = plus(self.at(s, [u - dv, v - du]), self.at(s, [u + du - dv, v + dv - du]));
        plus(times(3.0 / 8.0, ends), times(1.0 / 16.0, plus(left, right)))
    }
}
