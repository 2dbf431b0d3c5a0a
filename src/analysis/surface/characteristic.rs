//! The characteristic map, which is the limit of the net whose points are an eigenvector of the subdominant eigenvalue
//! with Fourier index 1, and the proof that it is regular and injective.
//!
//! On a ring of cells around the centre the limit is that of the regular scheme. Its derivatives are limits of the
//! differences, each within a disc around their mean. The determinant is proved to be positive on a cell if all vectors
//! in the discs of both derivatives have positive cross products; other cells are refined. A regular ring whose scaled
//! copies fit together covers the plane without the centre as often as it goes around the centre. That is once if half
//! a sector, or a sector of triangles, stays within a half plane.
//!
//! Source: Reif, CAGD 12 (1995), 153-174; Peters and Reif, SIAM Journal on Numerical Analysis 35 (1998), 728-748.

use std::collections::BTreeMap;

use super::blocks::phase;
use super::convergence::{derivative, lebesgue_bound};
use super::regular::{Polynomial, RegularMask};
use super::sectors::{LatticePoint, NetKind};
use crate::math::distinct::distinct;
use crate::math::functions::{cos, real, sin};
use crate::math::planar::cross;
use crate::math::vector::{length, minus};
use crate::watch::{Stopped, Watch};

/// Maximum number of cells examined for one valence. Splines need some hundred, interpolating schemes some thousand.
/// Half of it leaves schemes open whose derivatives have large bounds; twice of it takes twice as long to leave others
/// open.
const MAX_EXAMINED_CELLS: usize = 16_000;
/// Maximum number of levels at which a ring is examined. Discs shrink by about half at each level, to 1/1000 after ten.
/// Half of it leaves schemes open; twice of it would examine rounding errors only.
const MAX_RING_LEVELS: u32 = 10;
/// Least determinant that is regarded as positive, relative to the product of the lengths of both derivatives. It
/// exceeds what roundings and the error of the eigenvector can change. Determinants of schemes in use are at least a
/// hundredth of that product. Half or twice of it only matters to schemes whose determinants nearly vanish.
pub(super) const LEAST_DETERMINANT: f64 = 1e-4;

/// The net of an eigenvector around a centre with n sectors.
#[derive(Debug, Clone)]
pub(super) struct CharacteristicNet {
    /// The number of sectors.
    pub(super) n: usize,
    /// The value u of each point: the point lies at `u exp(2 pi i (s + t) / n)`.
    pub(super) values: BTreeMap<LatticePoint, [f64; 2]>,
}

/// A disc in the plane.
#[derive(Debug, Clone, Copy)]
struct PlanarDisc {
    middle: [f64; 2],
    radius: f64,
}

/// The result of the examination of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RingVerdict {
    /// The map is proved to be regular and injective.
    Proved,
    /// The determinant is negative somewhere, although the map is counter-clockwise on the whole.
    Folded,
    /// The map is neither proved to be regular and injective nor found to be folded.
    Open,
}

impl CharacteristicNet {
    /// Returns the position of a point of a sector.
    pub(super) fn place(&self, kind: NetKind, sector: i32, point: LatticePoint) -> Option<[f64; 2]> {
        let [re, im] = *self.values.get(&point)?;
        let n = i32::try_from(self.n).unwrap_or(i32::MAX);
        let sector = usize::try_from(sector.rem_euclid(n)).unwrap_or(0);
        let [c, s] = phase(real(sector) + kind.turn(point), self.n);
        Some([re * c - im * s, re * s + im * c])
    }

    /// Returns the position of a lattice point near sector 0.
    fn at(&self, kind: NetKind, point: LatticePoint) -> Option<[f64; 2]> {
        if kind.has_centre() && point == [0, 0] {
            return Some([0.0; 2]);
        }
        let (sector, point) = kind.unfolded(point)?;
        self.place(kind, sector, point)
    }

    /// Returns the least sine of the corner angles of the faces of half of sector 0 up to a radius that do not touch
    /// the centre.
    pub(super) fn least_sine(&self, kind: NetKind, radius: i32) -> f64 {
        let mut least = f64::INFINITY;
        for cell in cells(kind, i32::from(kind.has_centre()), radius) {
            let corners: Vec<Option<[f64; 2]>> = cell.corners(kind).map(|p| self.at(kind, p)).collect();
            let Some(corners) = corners.into_iter().collect::<Option<Vec<_>>>() else { continue };
            let n = corners.len();
            for i in 0..n {
                least = least.min(sine([corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]]));
            }
        }
        least
    }
}

/// Returns the sine of the angle at corner b between the next point c and the previous point a.
pub(super) fn sine([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let (u, v) = (minus(c, b), minus(a, b));
    cross(u, v) / (length(u) * length(v))
}

/// A cell of the lattice: a square, or the lower or the upper triangle of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct LatticeCell {
    at: LatticePoint,
    /// Whether the cell is the upper triangle, away from the centre.
    upper: bool,
}

impl LatticeCell {
    fn corners(self, kind: NetKind) -> impl Iterator<Item = LatticePoint> {
        let [x, y] = self.at;
        kind.shapes()[usize::from(self.upper)].iter().map(move |[i, j]| [x + i, y + j])
    }

    /// Returns the cells of the next level that cover this cell.
    fn refined(self, kind: NetKind, d: i32) -> Vec<Self> {
        let [x, y] = self.at.map(|x| d * x);
        let squares = (0..d).flat_map(|i| (0..d).map(move |j| [i, j]));
        if kind != NetKind::Triangles {
            return squares.map(|[i, j]| Self { at: [x + i, y + j], upper: false }).collect();
        }
        let both = squares.flat_map(|[i, j]| [false, true].map(|upper| (i, j, upper)));
        let inside = |&(i, j, upper): &(i32, i32, bool)| ((i + j + i32::from(upper)) < d) != self.upper;
        both.filter(inside).map(|(i, j, upper)| Self { at: [x + i, y + j], upper }).collect()
    }

    /// Returns the ranges of x, y and x + y in the cell.
    fn ranges(self, kind: NetKind) -> [[i32; 2]; 3] {
        let [x, y] = self.at;
        let sum = match kind {
            NetKind::Triangles => [x + y + i32::from(self.upper), x + y + 1 + i32::from(self.upper)],
            _ => [x + y, x + y + 2],
        };
        [[x, x + 1], [y, y + 1], sum]
    }
}

/// Returns the cells of half a sector between two radii.
fn cells(kind: NetKind, from: i32, to: i32) -> Vec<LatticeCell> {
    let squares = (0..to).flat_map(|x| (0..=x).map(move |y| [x, y]));
    if kind == NetKind::Triangles {
        let both = squares.flat_map(|at| [false, true].map(|upper| LatticeCell { at, upper }));
        let range = |cell: &LatticeCell| cell.at[0] + cell.at[1] + i32::from(cell.upper);
        both.filter(|cell| (from..to).contains(&range(cell))).collect()
    } else {
        squares.filter(|[x, _]| (from..to).contains(x)).map(|at| LatticeCell { at, upper: false }).collect()
    }
}

/// Returns the points that influence the limit of a scheme on a cell.
fn influences(mask: &Polynomial, d: i32, kind: NetKind, cell: LatticeCell) -> Vec<LatticePoint> {
    let (ends, ranges) = (RegularMask::ends(mask), cell.ranges(kind));
    let bounds: [[i32; 2]; 3] = std::array::from_fn(|k| {
        // low - last / (d - 1) < c < high - first / (d - 1)
        let low = ranges[k][0] - ceil(ends[k][1], d - 1) + 1;
        let high = ranges[k][1] + ceil(-ends[k][0], d - 1) - 1;
        [low, high]
    });
    let [[a, b], [c, e], [f, g]] = bounds;
    let all = (a..=b).flat_map(|x| (c..=e).map(move |y| [x, y]));
    all.filter(|[x, y]| (f..=g).contains(&(x + y))).collect()
}

/// Returns the points that influence the square between (0, 0) and (1, 1).
pub(super) fn around_square(mask: &Polynomial, d: i32) -> Vec<LatticePoint> {
    influences(mask, d, NetKind::Quads, LatticeCell { at: [0, 0], upper: false })
}

fn ceil(a: i32, b: i32) -> i32 {
    -(-a).div_euclid(b)
}

/// A regular scheme, prepared for the examination of rings of any valence.
#[derive(Debug)]
pub(super) struct RingProof {
    kind: NetKind,
    d: i32,
    /// The weights of new points by their residue modulo d: offsets to the old points, and their weights.
    rules: BTreeMap<LatticePoint, Vec<(LatticePoint, f64)>>,
    /// The positions, and the derivatives along x and y.
    followed: [BoundedQuantity; 3],
    /// The least and the greatest corner of the smallest box with all points that influence the positions or
    /// derivatives on a cell at (0, 0).
    span: [LatticePoint; 2],
    /// The radius at which the innermost ring begins.
    from: i32,
}

/// A quantity that is bounded on the cells of a ring: the position, or a derivative.
#[derive(Debug)]
struct BoundedQuantity {
    /// The points that influence a cell at (0, 0), for squares and lower triangles, and for upper triangles.
    around: [Vec<LatticePoint>; 2],
    /// An upper bound of the sum of absolute values of the basic limit functions.
    bound: f64,
}

impl BoundedQuantity {
    fn of(mask: &Polynomial, d: i32, kind: NetKind) -> Option<Self> {
        let around = [false, true].map(|upper| influences(mask, d, kind, LatticeCell { at: [0, 0], upper }));
        Some(Self { around, bound: lebesgue_bound(mask, d)? })
    }

    /// Returns the points that influence a cell.
    fn around(&self, LatticeCell { at: [x, y], upper }: LatticeCell) -> impl Iterator<Item = LatticePoint> {
        self.around[usize::from(upper)].iter().map(move |[i, j]| [x + i, y + j])
    }
}

impl RingProof {
    /// Prepares a regular scheme that converges to C^1 limits; `None` if no bounds of the derivatives are found.
    pub(super) fn new(regular: &RegularMask) -> Option<Self> {
        let (kind, d, (from, _)) = (regular.kind, regular.arity, ring(regular));
        let of = |mask: &Polynomial| BoundedQuantity::of(mask, d, kind);
        let along = |direction: usize| of(&derivative(regular, &[(direction, 1)])?);
        let followed = [of(&regular.mask)?, along(0)?, along(1)?];
        let mut rules: BTreeMap<LatticePoint, Vec<(LatticePoint, f64)>> = BTreeMap::new();
        for (k, &a) in &regular.mask {
            rules.entry(k.map(|x| x.rem_euclid(d))).or_default().push((k.map(|x| x.div_euclid(d)), a));
        }
        let mut span = [[i32::MAX; 2], [i32::MIN; 2]];
        // derivatives are differences of a point and the next one along an axis
        for (one, next) in followed.iter().zip([[0, 0], [1, 0], [0, 1]]) {
            for point in one.around.iter().flatten() {
                span[0] = [0, 1].map(|axis| span[0][axis].min(point[axis]));
                span[1] = [0, 1].map(|axis| span[1][axis].max(point[axis] + next[axis]));
            }
        }
        Some(Self { kind, d, rules, followed, span, from })
    }

    /// Examines the net of an eigenvector on the ring that begins `farther` rings outside of the innermost one.
    pub(super) fn of(&self, net: &CharacteristicNet, farther: i32, watch: &Watch) -> Result<RingVerdict, Stopped> {
        let (kind, d, from) = (self.kind, self.d, self.from + farther);
        let mut level: BTreeMap<LatticePoint, [f64; 2]> = BTreeMap::new();
        let mut open = cells(kind, from, d * from);
        for cell in &open {
            for point in self.followed[0].around(*cell) {
                match net.at(kind, point) {
                    Some(place) => level.insert(point, place),
                    None => return Ok(RingVerdict::Open),
                };
            }
        }
        let mut looked_at = 0;
        for _ in 0..MAX_RING_LEVELS {
            watch.check()?;
            looked_at += open.len();
            if looked_at > MAX_EXAMINED_CELLS {
                return Ok(RingVerdict::Open);
            }
            let mut failed = Vec::new();
            for cell in open {
                match self.cell(cell, &level, net.n) {
                    RingVerdict::Proved => {}
                    RingVerdict::Folded => return Ok(RingVerdict::Folded),
                    RingVerdict::Open => failed.push(cell),
                }
            }
            if failed.is_empty() {
                return Ok(RingVerdict::Proved);
            }
            open = failed.iter().flat_map(|cell| cell.refined(kind, d)).collect();
            level = self.refined(&level, &open);
        }
        Ok(RingVerdict::Open)
    }

    /// Returns the points of the next level that influence some cells.
    fn refined(
        &self,
        level: &BTreeMap<LatticePoint, [f64; 2]>,
        cells: &[LatticeCell],
    ) -> BTreeMap<LatticePoint, [f64; 2]> {
        let d = self.d;
        let points = distinct(cells.iter().flat_map(|&cell| self.followed[0].around(cell)));
        let place = |point: LatticePoint| {
            let (old, residue) = (point.map(|x| x.div_euclid(d)), point.map(|x| x.rem_euclid(d)));
            let terms = self.rules.get(&residue).into_iter().flatten();
            terms.fold([0.0; 2], |sum, (k, a)| {
                let p = level.get(&[old[0] - k[0], old[1] - k[1]]).copied().unwrap_or([f64::NAN; 2]);
                [sum[0] + a * p[0], sum[1] + a * p[1]]
            })
        };
        points.into_iter().map(|point| (point, place(point))).collect()
    }

    fn cell(&self, cell: LatticeCell, level: &BTreeMap<LatticePoint, [f64; 2]>, n: usize) -> RingVerdict {
        let [from, to] = self.span.map(|p| [p[0] + cell.at[0], p[1] + cell.at[1]]);
        let number =
            |[x, y]: LatticePoint| usize::try_from((x - from[0]) * (to[1] - from[1] + 1) + y - from[1]).unwrap_or(0);
        let mut near = vec![[f64::NAN; 2]; number(to) + 1];
        for x in from[0]..=to[0] {
            level.range([x, from[1]]..=[x, to[1]]).for_each(|(&p, &place)| near[number(p)] = place);
        }
        let at = |p: LatticePoint| near[number(p)];
        let disc = |which: usize, value: &dyn Fn(LatticePoint) -> [f64; 2]| {
            let followed = &self.followed[which];
            PlanarDisc::around(&followed.around(cell).map(value).collect::<Vec<_>>(), followed.bound)
        };
        let along = |u: LatticePoint| move |p: LatticePoint| minus(at([p[0] + u[0], p[1] + u[1]]), at(p));
        let (x, y) = (disc(1, &along([1, 0])), disc(2, &along([0, 1])));
        let middle = cross(x.middle, y.middle);
        let (a, b) = (length(x.middle), length(y.middle));
        let off = x.radius * b + y.radius * a + x.radius * y.radius;
        let slack = LEAST_DETERMINANT * (a + x.radius) * (b + y.radius);
        if middle + off + slack < 0.0 {
            return RingVerdict::Folded;
        }
        let place = disc(0, &at);
        // the cells lie within the half of a sector after its ray, or before the corner of a face; those of triangles
        // reach from ray to ray
        let middle_of_cells = match self.kind {
            NetKind::Quads => 0.5,
            NetKind::Triangles => 1.0,
            NetKind::Dual => -0.5,
        };
        let half = middle_of_cells * std::f64::consts::PI / real(n);
        let ahead = place.middle[0] * cos(half) + place.middle[1] * sin(half);
        let proved = middle > off + slack && ahead > place.radius + LEAST_DETERMINANT * length(place.middle);
        if proved { RingVerdict::Proved } else { RingVerdict::Open }
    }
}

impl PlanarDisc {
    /// Returns a disc that contains all combinations of some points whose weights sum to 1 and have at most the sum
    /// `bound` of absolute values.
    fn around(points: &[[f64; 2]], bound: f64) -> Self {
        let n = real(points.len());
        let sum = points.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        let middle = sum.map(|x| x / n);
        // NaN must propagate, which f64::max would not do
        let radius = points
            .iter()
            .map(|&p| length(minus(p, middle)))
            .fold(0.0, |a: f64, b| if a.is_nan() || a >= b { a } else { b });
        Self { middle, radius: bound * radius }
    }
}

/// Returns the radius at which the innermost ring begins on which the rules of the regular net apply, and the radius of
/// the farthest point that influences it.
pub(super) fn ring(regular: &RegularMask) -> (i32, i32) {
    let (ends, d) = (RegularMask::ends(&regular.mask), regular.arity);
    // for squares, the range of x + y is implied by those of x and y
    let ends = if regular.kind == NetKind::Triangles { &ends[..] } else { &ends[..2] };
    let last = ends.iter().map(|end| ceil(end[1], d - 1)).max().unwrap_or(1);
    let first = ends.iter().map(|end| ceil(-end[0], d - 1)).max().unwrap_or(1);
    let from = (last - 1).max(1);
    (from, d * from + first - 1)
}
