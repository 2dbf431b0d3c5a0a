//! Facts about all caps of one valence, computed once: how the planar cap runs under the leaves of each ring, and how
//! much it stretches distances.

use super::bezier::BezierNet;
use super::characteristic::rings_until;
use super::composed::{Composed, Path, SHORT_TERMS, part_of_cubic, raised_whole};
use super::join::SectorPatch;
use super::rings::{LEAVES, Rings};
use super::samples::{foot, in_sector};
use super::stretch::{Area, Slopes, StretchWeights, weights};
use crate::math::functions::{cos, ratio, real, sin};

/// A cell of a leaf of one ring; the same in all sectors.
#[derive(Debug)]
pub(super) struct LeafCell {
    /// The index of the leaf among the three of the ring.
    pub(super) leaf: usize,
    /// The weights that map a leaf's coefficients to those of the cell, of degree 5, in both directions.
    pub(super) part: [[[f64; 4]; 6]; 2],
    /// The Bernstein polynomials of a patch along the path of foot points of this cell.
    pub(super) composed: Composed,
    /// Bound of the distance, in parameters, of the path from the true foot points.
    pub(super) off: f64,
    /// Weights of the coefficients over an area that contains the path and the true foot points.
    pub(super) around: StretchWeights,
}

/// Facts about one valence that hold for all its caps.
#[derive(Debug)]
pub(super) struct ValenceProof {
    /// The cells of each ring, the outermost first.
    pub(super) rings: Vec<Vec<LeafCell>>,
    /// Bound of the parameters of foot points inside all rings.
    pub(super) inside: f64,
}

/// Returns the factor to which the part inside all examined rings must have shrunk. It is bounded by the hulls of its
/// nets alone, which overestimates up to a thousand times. At twice of it, this outweighs the rings of valence 5; half
/// of it takes one ring more. Around regular vertices nothing else is left.
fn shrunk(n: usize) -> f64 {
    if n == 4 { 1e-10 } else { 1.5e-4 }
}

/// Returns the number of rings of leaves that are examined one by one.
pub(super) fn n_rings(n: usize) -> usize {
    rings_until(n, shrunk(n))
}

/// Returns the number of cells along each side of a leaf of a ring, 1 for the outermost. The error of paths of foot
/// points is proportional to the cube of a cell's size, which matters most at valence 3, whose caps are nearest to
/// their surfaces. With these numbers bounds are at most 1.4 times what samples find; with one less in the outermost
/// rings 1.5 times, with one more 1.2 times.
pub(super) fn n_cells(n: usize, ring: usize) -> usize {
    match (n, ring) {
        (3, 1..=3) => 6 - ring,
        (5.., 1) => 3,
        (3, 4) | (5.., 2..=4) => 2,
        _ => 1,
    }
}

impl ValenceProof {
    /// Returns the facts of a valence; `None` if the planar cap cannot be shown to be one-to-one.
    pub(super) fn of(characteristic: &Rings<2>, plane: &SectorPatch<2>) -> Option<Self> {
        let n = characteristic.valence();
        let plane_cap = PlaneCap::of(plane, n);
        if plane_cap.stretch <= 0.0 {
            return None;
        }
        let mut net = characteristic.clone();
        let (mut rings, mut inside) = (Vec::new(), 0.0_f64);
        for ring in 1..=n_rings(n) {
            net = net.refined();
            inside = 0.0;
            let mut cells = Vec::new();
            for (leaf, lower) in LEAVES.into_iter().enumerate() {
                let surface = net.leaf(0, lower);
                let n_cells = n_cells(n, ring);
                for at in (0..n_cells * n_cells).map(|k| [k / n_cells, k % n_cells]) {
                    let sides = at.map(|i| [ratio(i, n_cells), ratio(i + 1, n_cells)]);
                    let path = path(plane, &surface, |x| in_sector(ring, lower, x), sides);
                    let cell = LeafCell::of(leaf, &surface, sides, &path, &plane_cap);
                    inside = inner_side(leaf, at, &path).into_iter().fold(inside, |most, x| most.max(x + cell.off));
                    cells.push(cell);
                }
            }
            rings.push(cells);
        }
        Some(Self { rings, inside: inside.min(1.0) })
    }
}

impl LeafCell {
    /// Creates the cell of a leaf of the characteristic surface between the given sides, with its path of foot points.
    fn of(leaf: usize, surface: &BezierNet<2, 4>, sides: [[f64; 2]; 2], path: &Path, plane: &PlaneCap) -> Self {
        let composed = Composed::along(path);
        let part = sides.map(part_of_cubic);
        let target = surface.mapped(&part[0], &part[1]);
        let target = [0, 1].map(|d| {
            let flat: Vec<f64> = target.0.iter().flatten().map(|point| point[d]).collect();
            raised_whole(5, &flat)
        });
        let miss = composed.distance(&target, &plane.points) + PLANAR_DISTANCE_ROUNDING;
        let off = plane.off(path, miss);
        Self { leaf, part, composed: composed.without_exact(), off, around: weights(around(path, off)) }
    }
}

/// The planar cap of one sector.
struct PlaneCap {
    points: [[f64; 2]; SHORT_TERMS],
    slopes: Slopes<2>,
    /// Lower bound of the factor by which it stretches distances.
    stretch: f64,
}

impl PlaneCap {
    fn of(plane: &SectorPatch<2>, n: usize) -> Self {
        let points: Vec<[f64; 2]> = plane.0.into_iter().flatten().collect();
        let slopes = Slopes::of(plane);
        Self { points: std::array::from_fn(|k| points[k]), slopes, stretch: least_stretch(&slopes, n) }
    }

    /// Returns a bound, in parameters, of the distance of a path from the true foot points if its image is off by
    /// `miss`. The least stretch anywhere locates them; the least stretch there gives a better bound.
    fn off(&self, path: &Path, miss: f64) -> f64 {
        let off = miss / self.stretch;
        let near = self.slopes.over(&weights(around(path, off)));
        miss / self.stretch.max(near.least_straightened() - PLANAR_DISTANCE_ROUNDING)
    }
}

/// Returns the part of the unit square within a distance of the points of a path.
fn around(path: &Path, off: f64) -> Area {
    path.map(|coordinate| {
        let all = || coordinate.into_iter().flatten();
        let (low, high) = (all().fold(1.0, f64::min), all().fold(0.0, f64::max));
        [(low - off).max(0.0), (high + off).min(1.0)]
    })
}

/// Bound of all rounding errors of a planar distance: its coefficients are below 4, and each passes through fewer than
/// 2000 roundings of 2^-53, including the products of [`Composed`].
const PLANAR_DISTANCE_ROUNDING: f64 = 1e-12;

/// Returns the coefficients of the path of foot points under a part of a leaf: it interpolates nine of them, and is
/// clamped to the unit square.
fn path(
    plane: &SectorPatch<2>,
    surface: &BezierNet<2, 4>,
    start: impl Fn([f64; 2]) -> [f64; 2],
    [along, across]: [[f64; 2]; 2],
) -> Path {
    let between = |[a, b]: [f64; 2], k: usize| a + (b - a) * real(k) / 2.0;
    let feet: [[[f64; 2]; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let x = [between(along, i), between(across, j)];
            foot(plane, surface.at(x), start(x))
        })
    });
    let through = |[a, b, c]: [f64; 3]| [a, 2.0 * b - 0.5 * (a + c), c];
    [0, 1].map(|d| {
        let rows = feet.map(|row| through(row.map(|foot| foot[d])));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|j| through(rows.map(|row| row[j])));
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i].clamp(0.0, 1.0)))
    })
}

/// Returns the coefficients of a path along the part of a cell's boundary that bounds the region further inside.
fn inner_side(leaf: usize, [i, j]: [usize; 2], path: &Path) -> Vec<f64> {
    let coefficients = |side: &dyn Fn(usize) -> [usize; 2]| {
        let points = (0..3).map(side);
        points.flat_map(|[a, b]| [path[0][a][b], path[1][a][b]]).collect()
    };
    match (leaf, i, j) {
        (0, 0, _) => coefficients(&|k| [0, k]),
        (1, _, 0) => coefficients(&|k| [k, 0]),
        _ => Vec::new(),
    }
}

/// Number of parts along each side of the domain on which the stretch is bounded. Bounds over larger parts are looser:
/// half of it gives a smaller least stretch, and with it larger bounds of distances; twice of it takes four times as
/// long for a stretch that is little larger.
const DOMAIN_PARTS: usize = 8;

/// Returns a lower bound of the factor by which the planar cap of one sector stretches distances, rotated so that the
/// middle of the sector is the diagonal of the square.
fn least_stretch(slopes: &Slopes<2>, n: usize) -> f64 {
    let angle = std::f64::consts::PI * (0.25 - ratio(1, n));
    let turn = [cos(angle), sin(angle)];
    let part = |i: usize| [ratio(i, DOMAIN_PARTS), ratio(i + 1, DOMAIN_PARTS)];
    let parts = (0..DOMAIN_PARTS * DOMAIN_PARTS)
        .map(|k| slopes.over(&weights([part(k / DOMAIN_PARTS), part(k % DOMAIN_PARTS)])).least(turn));
    parts.fold(f64::INFINITY, f64::min) - PLANAR_DISTANCE_ROUNDING
}
