//! Boundary vertices with any number of faces: eigenvalues, masks and the characteristic map onto a half plane.
//!
//! A reflection exchanges the two outer rays. It decomposes the local matrix into the block of vectors that it keeps
//! (even) and the block of vectors that it negates (odd). Limits have a tangent plane at the vertex if the eigenvalue 1
//! is followed by a real positive eigenvalue in each block and the eigenvectors of both map the faces around the vertex
//! onto a half plane.
//!
//! Source: Zorin, Constructive Approximation 16 (2000), 359-397; Biermann, Levin and Zorin, SIGGRAPH 2000, 113-120.

use std::collections::BTreeMap;

use super::characteristic::{ring, sine};
use super::fan::{FanBoundary, FanPlace, FanRows, faces, mirrored, places, radius};
use super::local::{Applied, closed};
use super::regular::RegularMask;
use super::sectors::{LatticePoint, NetKind, PlaneNet, WEIGHT_ROUNDING};
use super::spectrum::{EQUAL_EIGENVALUES, PointWeight, listed_digits};
use super::verdict::{Criterion, REGULAR_NETS, SIMPLE_EIGENVALUE_ONE, Status};
use crate::analysis::limit::Unlimited;
use crate::math::dense::Dense;
use crate::math::spectrum::{Eigenvalue, eigenvalues};
use crate::watch::Watch;

/// Largest sine of a corner angle that is regarded as 0. Corners of schemes in use have sines of at least a hundredth,
/// or of 1e-13 if they are flat. Half or twice of it decides alike.
const FLAT_CORNER_SINE: f64 = 1e-9;
/// Largest difference of coordinates of an eigenvector, whose largest is 1, at which they count as equal, so that of
/// equal points the first sets the scale whatever rounding says. Coordinates are wrong by some 1e-13; half or twice of
/// it decides alike unless a net has points as near as that.
const EQUAL_COORDINATES: f64 = 1e-9;
/// The statement about the two eigenvalues after 1.
const NEXT_EIGENVALUES: &str = "the next two eigenvalues are real and positive, one of vectors that are even under \
                    the reflection and one of odd ones, and all others are smaller";
/// The statement about the characteristic map.
const HALF_CHARACTERISTIC_MAP: &str = "the characteristic map is regular and injective, and covers half a plane";

/// An eigenvalue with the parity of its eigenvector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sided {
    /// The eigenvalue.
    pub value: Eigenvalue,
    /// Whether the eigenvector is odd under the reflection.
    pub is_odd: bool,
}

/// The report on boundary vertices with some number of faces.
#[derive(Debug, Clone)]
pub struct BoundaryReport {
    /// The number of faces at the vertex.
    pub faces: usize,
    /// Whether the report also applies to one side, with as many faces, of a crease that stays sharp.
    pub is_side_of_crease: bool,
    /// The eigenvalues, the largest first.
    pub eigenvalues: Vec<Sided>,
    /// The weights of the limit position: one per ray for points on rays, one per face for other points.
    pub limit_mask: Vec<PointWeight>,
    /// The weights of the tangent along the boundary and of one across it; `None` if there is no tangent plane.
    pub tangent_masks: Option<[Vec<PointWeight>; 2]>,
    /// The net of the characteristic map: points and faces.
    pub net: Option<PlaneNet>,
    /// The least sine of the corner angles of the net.
    pub least_sine: Option<f64>,
    /// The criteria for C^1.
    pub criteria: Vec<Criterion>,
}

/// The block of even or of odd vectors; each component has a place in the first half of the fan and its mirror image.
struct ParityBlock {
    components: Vec<(FanPlace, FanPlace)>,
    matrix: Dense,
    values: Vec<Eigenvalue>,
    /// 1 for even vectors, -1 for odd vectors.
    sign: f64,
}

impl ParityBlock {
    fn of(rows: &FanRows, kind: NetKind, farthest: i32, sign: f64) -> Option<Self> {
        let all = places(kind, rows.faces, farthest).into_iter().map(|place| (place, mirrored(rows.faces, place)));
        let components: Vec<_> = all.filter(|(p, q)| p < q || p == q && sign > 0.0).collect();
        let mut matrix = Dense::zero(components.len());
        for (i, (place, _)) in components.iter().enumerate() {
            let row = &rows.rows[place];
            for (j, (p, q)) in components.iter().enumerate() {
                let at = |place| row.get(place).copied().unwrap_or(0.0);
                *matrix.at_mut(i, j) = if p == q { at(p) } else { at(p) + sign * at(q) };
            }
        }
        let values = eigenvalues(&matrix.a, matrix.n)?;
        Some(Self { components, matrix, values, sign })
    }

    /// Returns the eigenvalue at index `after` if it is real and positive.
    fn leading(&self, after: usize) -> Option<f64> {
        self.values.get(after).filter(|value| value.im == 0.0 && value.re > 0.0).map(|value| value.re)
    }

    /// Returns the absolute value of the eigenvalue at index `after`; 0 if there is none.
    fn size(&self, after: usize) -> f64 {
        self.values.get(after).map_or(0.0, |value| value.modulus())
    }

    /// Expands a vector of the block to the values of all places.
    fn spread(&self, vector: &[f64]) -> BTreeMap<FanPlace, f64> {
        let both = |((p, q), x): (&(FanPlace, FanPlace), &f64)| [(*p, *x), (*q, self.sign * x)];
        self.components.iter().zip(vector).rev().flat_map(both).collect()
    }

    /// Expands a row of the block to the weights of all places: a pair shares the weight of its component.
    fn shared(&self, row: &[f64]) -> BTreeMap<FanPlace, f64> {
        let halved = |((p, q), x): (&(FanPlace, FanPlace), &f64)| if p == q { *x } else { x / 2.0 };
        let row: Vec<f64> = self.components.iter().zip(row).map(halved).collect();
        self.spread(&row)
    }
}

/// Returns the sum of the products of weights and values.
fn dot(weights: &BTreeMap<FanPlace, f64>, values: &BTreeMap<FanPlace, f64>) -> f64 {
    weights.iter().map(|(place, w)| w * values.get(place).copied().unwrap_or(0.0)).sum()
}

/// An eigenvector of a block as values, and the left eigenvector as weights, scaled to the product 1.
struct EigenvectorPair {
    value: f64,
    values: BTreeMap<FanPlace, f64>,
    weights: BTreeMap<FanPlace, f64>,
}

impl EigenvectorPair {
    fn of(block: &ParityBlock, value: f64) -> Self {
        let values = block.spread(&block.matrix.eigenvector(value));
        // scale: along the boundary the first point of ray 0 lies at 1, across it the farthest of the nearest points
        let near = |point: &LatticePoint| point.iter().all(|x| (0..=1).contains(x));
        let nearest = values.iter().filter(|(place, _)| place.is_some_and(|(_, point)| near(&point)));
        let largest =
            nearest.fold(0.0, |most: f64, (_, x)| if x.abs() > most.abs() + EQUAL_COORDINATES { *x } else { most });
        let ray = values.get(&Some((0, [1, 0]))).copied().unwrap_or(0.0);
        let scale = if block.sign < 0.0 && ray.abs() > EQUAL_COORDINATES { ray } else { largest };
        let values: BTreeMap<FanPlace, f64> = values.into_iter().map(|(place, x)| (place, x / scale)).collect();
        let weights = block.shared(&block.matrix.transposed().eigenvector(value));
        let product = dot(&weights, &values);
        let weights = weights.into_iter().map(|(place, w)| (place, w / product)).collect();
        Self { value, values, weights }
    }

    /// Returns the value of a place by the row of its child, on the scale of `values`; `None` for a place without a
    /// row.
    fn at(&self, rows: &FanRows, place: FanPlace) -> Option<f64> {
        let row = rows.rows.get(&place)?;
        Some(dot(row, &self.values) / self.value)
    }
}

impl Applied {
    /// Analyses boundary vertices with m faces.
    ///
    /// # Errors
    /// [`Unlimited`].
    pub(super) fn boundary(
        &self,
        m: usize,
        regular: &RegularMask,
        smooth: Status,
        watch: &Watch,
    ) -> Result<BoundaryReport, Unlimited> {
        let (kind, (_, farthest)) = (self.kind, ring(regular));
        if kind == NetKind::Dual {
            return Err(Unlimited::NoVertex);
        }
        let rows = self.fan(m, farthest, FanBoundary::Nothing, watch)?;
        let is_side_of_crease = self.is_side_of_crease(&rows, farthest, watch)?;
        let closed = closed(farthest, rows.reach_of(kind, farthest), |radius| rows.reach_of(kind, radius))?;
        if !is_mirrored(&rows) {
            return Err(Unlimited::Lopsided);
        }
        let block = |sign: f64| ParityBlock::of(&rows, kind, closed, sign).ok_or(Unlimited::NoEigenvalues);
        let (even, odd) = (block(1.0)?, block(-1.0)?);
        watch.advance((even.matrix.n + odd.matrix.n) as u64);
        let limit = even.shared(&even.matrix.transposed().eigenvector(1.0));
        let sum: f64 = limit.values().sum();
        let limit = limit.into_iter().map(|(place, w)| (place, w / sum)).collect();
        let rest = even.size(2).max(odd.size(1)) * (1.0 + EQUAL_EIGENVALUES);
        let next = odd.leading(0).zip(even.leading(1)).filter(|(a, b)| a.min(*b) > rest);
        let directions = next.map(|(a, b)| [EigenvectorPair::of(&odd, a), EigenvectorPair::of(&even, b)]);
        let place = |both: &[EigenvectorPair; 2], place| Some([both[0].at(&rows, place)?, both[1].at(&rows, place)?]);
        let points: Option<BTreeMap<FanPlace, [f64; 2]>> =
            directions.as_ref().and_then(|both| rows.rows.keys().map(|&at| Some((at, place(both, at)?))).collect());
        let least_sine = points.as_ref().map(|points| least_sine(kind, m, points));
        let first = |x: Option<&Eigenvalue>| x.is_some_and(|x| (x.re - 1.0).abs() < EQUAL_EIGENVALUES && x.im == 0.0);
        let one = first(even.values.first()) && even.size(1).max(odd.size(0)) < 1.0 - EQUAL_EIGENVALUES;
        let seen = |holds: bool| if holds { Status::Supported } else { Status::Open };
        let criteria = [
            (REGULAR_NETS, smooth),
            (SIMPLE_EIGENVALUE_ONE, seen(one)),
            (NEXT_EIGENVALUES, seen(next.is_some())),
            (HALF_CHARACTERISTIC_MAP, seen(least_sine.is_some_and(|sine| sine > FLAT_CORNER_SINE))),
        ];
        Ok(BoundaryReport {
            faces: m,
            is_side_of_crease,
            eigenvalues: sorted(&even, &odd),
            limit_mask: mask(m, &limit),
            tangent_masks: directions.map(|both| both.map(|direction| mask(m, &direction.weights))),
            net: points.map(|points| net(kind, m, &points)),
            least_sine,
            criteria: criteria.map(|(statement, status)| Criterion { statement, status }).into(),
        })
    }
}

/// Returns whether the reflection maps the rows to each other.
fn is_mirrored(rows: &FanRows) -> bool {
    let m = rows.faces;
    rows.rows.iter().all(|(&place, row)| {
        let Some(other) = rows.rows.get(&mirrored(m, place)) else { return false };
        let same = |(&at, weight): (&FanPlace, &f64)| {
            (other.get(&mirrored(m, at)).copied().unwrap_or(0.0) - weight).abs() <= WEIGHT_ROUNDING
        };
        row.iter().all(same)
    })
}

/// Returns the eigenvalues of both blocks, the largest first; of those with the same absolute value up to ten digits,
/// even ones come first.
fn sorted(even: &ParityBlock, odd: &ParityBlock) -> Vec<Sided> {
    let of = |block: &ParityBlock, is_odd: bool| -> Vec<Sided> {
        block.values.iter().map(|&value| Sided { value, is_odd }).collect()
    };
    let mut all = of(even, false);
    all.extend(of(odd, true));
    all.sort_by_key(|found| (-listed_digits(found.value.modulus()), found.is_odd, -listed_digits(found.value.re)));
    all
}

/// Groups weights by point: one value per ray, or per face.
fn mask(m: usize, weights: &BTreeMap<FanPlace, f64>) -> Vec<PointWeight> {
    let mut by_point: BTreeMap<Option<LatticePoint>, Vec<f64>> = BTreeMap::new();
    for (&place, &weight) in weights {
        let Some((s, point)) = place else {
            by_point.insert(None, vec![weight]);
            continue;
        };
        let n = if point[1] == 0 { m + 1 } else { m };
        by_point.entry(Some(point)).or_insert_with(|| vec![0.0; n])[s] = weight;
    }
    by_point.into_iter().map(|(point, values)| PointWeight { point, values }).collect()
}

/// Returns the least sine of the corner angles of all faces that do not touch the centre.
fn least_sine(kind: NetKind, m: usize, points: &BTreeMap<FanPlace, [f64; 2]>) -> f64 {
    let farthest = points.keys().map(|&place| radius(kind, place)).max().unwrap_or(0);
    let away = faces(kind, m, farthest).into_iter().filter(|face| !face.contains(&None));
    let least = away.map(|face| {
        let corners: Vec<[f64; 2]> = face.iter().map(|place| points[place]).collect();
        let n = corners.len();
        let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) > FLAT_CORNER_SINE;
        let angle = |i: usize| {
            let [a, b, c] = [corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]];
            // corners that coincide have no angle
            if apart(a, b) && apart(b, c) { sine([a, b, c]) } else { 0.0 }
        };
        (0..n).map(angle).fold(f64::INFINITY, f64::min)
    });
    least.fold(f64::INFINITY, f64::min)
}

/// Returns the points and faces of the characteristic net.
fn net(kind: NetKind, m: usize, points: &BTreeMap<FanPlace, [f64; 2]>) -> PlaneNet {
    let farthest = points.keys().map(|&place| radius(kind, place)).max().unwrap_or(0);
    let order = places(kind, m, farthest);
    let number: BTreeMap<FanPlace, usize> = order.iter().copied().zip(0..).collect();
    let faces = faces(kind, m, farthest).iter().map(|face| face.iter().map(|place| number[place]).collect()).collect();
    (order.iter().map(|place| points[place]).collect(), faces)
}
