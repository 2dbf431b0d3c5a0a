//! Limit rows: the weights of the points around a place that give the limit point and the tangent there.
//!
//! A place is a point or the middle between two points. A cycle of arity d and centre c maps the place x of a polygon
//! to the place `d x + c` of the next polygon, so that the limit row of a place is the limit row of its image times the
//! matrix of the cycle.

use super::cycle::{CycleMask, NoMask, SUM_TOLERANCE};
use crate::math::number::Number;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Maximum number of repetitions of a static cycle. Each repetition multiplies the error by the second eigenvalue:
/// 4,000 are enough for 0.99. Half as many are enough for 0.98, and report schemes in between as divergent; twice as
/// many are enough for 0.995 in twice the time.
const MAX_ROUNDS: u32 = 4_000;
/// Largest change per repetition at which rows have converged; rows that change by less than [`ROUNDING_CHANGE`] have
/// also converged if their changes no longer shrink. It is about one unit in the last place of 1. Half of it leaves the
/// decision to [`ROUNDING_CHANGE`], some repetitions later; twice of it may end a repetition earlier, with a last digit
/// that differs.
const CONVERGED_CHANGE: f64 = 3e-16;
/// Largest change per repetition that may be rounding, if it no longer shrinks. It is 45 units in the last place of 1,
/// because long rows keep changing by a few units. Half of it leaves the longest rows less room to converge; twice of
/// it ends slow changes that stall once earlier.
const ROUNDING_CHANGE: f64 = 1e-14;
/// Largest difference at which tangent rows of both sides are regarded as equal. It is far above what
/// [`ROUNDING_CHANGE`] leaves and far below the difference of the sides of a kink, a fraction of 1, so that half or
/// twice of it decides alike.
const TANGENT_TOLERANCE: f64 = 1e-9;
/// Largest change of a row in a repetition; a change beyond it shows that the rows grow without bound. Rows that
/// converge have weights of some units. Half or twice of it notices growth a repetition earlier or later.
const MAX_ROW_CHANGE: f64 = 1e9;
/// Minimum slope of a row of a tangent, as a share of the sum of its absolute weights, by which the row is divided. A
/// row whose slope vanishes has a share of some roundings of 1. At this value ten digits are left; half of it leaves a
/// third of a digit less, twice of it more.
const LEAST_SLOPE_SHARE: f64 = 1e-6;

/// Weights of the points around a place: weight k belongs to the point at the offset `(first + 2 k) / 2`.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightRow {
    /// Twice the first offset: even around a point, odd around a midpoint.
    pub first: i64,
    /// Weights.
    pub weights: Vec<f64>,
}

/// The row around a point and the row around a midpoint.
pub(super) type Pair = [WeightRow; 2];

/// Rows of the limit points and, if the limit has tangents, of the tangents of a polygon after some levels.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitRows {
    /// The weights of limit points, which sum to 1.
    pub position: Pair,
    /// The weights of tangents of any length, which sum to 0.
    pub tangent: Option<Pair>,
}

impl WeightRow {
    fn new(first: i64, weights: &[f64]) -> Self {
        Self { first, weights: weights.to_vec() }
    }

    /// Returns twice the offset of each weight, with the weight.
    pub fn entries(&self) -> impl Iterator<Item = (i64, f64)> + '_ {
        (0..).map(|k| self.first + 2 * k).zip(self.weights.iter().copied())
    }

    /// Returns the row over the points before a cycle, around a point (`parity` 0) or a midpoint (`parity` 1).
    pub(super) fn before(&self, cycle: &CycleMask, parity: i64) -> Self {
        let (d, c) = (cycle.arity, cycle.twice_centre());
        let (low, high) = (i64::from(cycle.mask.first), i64::from(cycle.mask.last()));
        let last = self.first + 2 * (i64::try_from(self.weights.len()).unwrap_or(1) - 1);
        // d o = c + o' - 2 j for twice the offsets o, o' and the indices j of the mask
        let mut least = (c + self.first - 2 * high).div_euclid(d);
        least += (least - parity).rem_euclid(2);
        let most = (c + last - 2 * low).div_euclid(d);
        let mut weights = Vec::new();
        let mut offset = least;
        while offset <= most {
            let weight = |(o, w): (i64, f64)| w * cycle.at((c + o - d * offset) / 2);
            weights.push(self.entries().map(weight).sum());
            offset += 2;
        }
        Self { first: least, weights }.trimmed()
    }

    fn trimmed(mut self) -> Self {
        while self.weights.len() > 1 && self.weights.last() == Some(&0.0) {
            self.weights.pop();
        }
        let zeros = self.weights.iter().take_while(|w| **w == 0.0).count().min(self.weights.len() - 1);
        self.first += 2 * i64::try_from(zeros).unwrap_or(0);
        self.weights.drain(..zeros);
        self
    }

    fn sum(&self) -> f64 {
        self.weights.iter().sum()
    }

    fn at(&self, offset: i64) -> f64 {
        let place = usize::try_from((offset - self.first) / 2).ok().filter(|_| offset >= self.first);
        place.and_then(|k| self.weights.get(k)).copied().unwrap_or(0.0)
    }

    /// Returns `self - factor x other`; both rows have the same parity.
    fn less(&self, factor: f64, other: &Self) -> Self {
        let end = |row: &Self| row.first + 2 * i64::try_from(row.weights.len()).unwrap_or(0);
        let (first, end) = (self.first.min(other.first), end(self).max(end(other)));
        let count = usize::try_from((end - first) / 2).unwrap_or(0);
        let offsets = (0..count).map(|k| first + 2 * i64::try_from(k).unwrap_or(0));
        Self { first, weights: offsets.map(|o| self.at(o) - factor * other.at(o)).collect() }
    }

    fn distance(&self, other: &Self) -> f64 {
        self.less(1.0, other).weights.iter().fold(0.0, |most: f64, w| most.max(w.abs()))
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { first: self.first, weights: self.weights.iter().map(|w| w * factor).collect() }
    }

    /// Returns the value of the row for points whose positions are their offsets.
    fn slope(&self) -> f64 {
        self.entries().map(|(o, w)| f64::whole(o) / 2.0 * w).sum()
    }
}

/// Returns whether a row has converged whose last change is `change` and whose change before that was `last`.
fn arrived(change: f64, last: f64) -> bool {
    change <= CONVERGED_CHANGE || change <= ROUNDING_CHANGE && change >= last
}

/// Returns the rows of points and midpoints over the points before a cycle.
fn before(pair: &Pair, cycle: &CycleMask) -> Pair {
    [0, 1].map(|parity| {
        let image = (cycle.twice_centre() + cycle.arity * parity).rem_euclid(2);
        pair[usize::from(image == 1)].before(cycle, parity)
    })
}

impl LimitRows {
    /// Returns the rows for the polygon after `levels` levels of a plan: the rows of its static limit, times the
    /// matrices of the remaining levels. Tangents are those of the static limit at these places, if its one-sided
    /// differences agree there.
    ///
    /// Source: Dyn, Subdivision schemes in CAGD, 1992, section 2.3; limit rows are left eigenvectors for 1 and 1/d.
    ///
    /// # Errors
    /// [`NoMask`], also when the static limit does not converge.
    pub fn of(plan: &Plan, levels: u32) -> Result<Self, NoMask> {
        let (changing, settled) = CycleMask::from_level(plan, levels, &Watch::new())?;
        let mut position = settled_positions(&settled)?;
        let mut tangent = settled_tangents(&settled, &position);
        for cycle in changing.iter().rev() {
            position = before(&position, cycle);
            tangent = tangent
                .map(|pair| pure(&before(&pair, cycle), &position).map(|row| row.scaled(f64::whole(cycle.arity))));
        }
        Ok(Self { position, tangent })
    }
}

/// Removes from tangent rows the component of the eigenvalue 1 that rounding leaves in them, which would grow.
fn pure(tangent: &Pair, position: &Pair) -> Pair {
    [0, 1].map(|parity| tangent[parity].less(tangent[parity].sum(), &position[parity]))
}

/// Returns the left eigenvectors for the eigenvalue 1 of a static cycle.
fn settled_positions(cycle: &CycleMask) -> Result<Pair, NoMask> {
    let start = [WeightRow::new(0, &[1.0]), WeightRow::new(-1, &[0.5, 0.5])];
    let pair = settled(start, MAX_ROW_CHANGE, |pair| Some(before(pair, cycle))).ok_or(NoMask::Diverges)?;
    let complete = pair.iter().all(|row| (row.sum() - 1.0).abs() < SUM_TOLERANCE);
    if complete { Ok(pair) } else { Err(NoMask::Diverges) }
}

/// Returns the left eigenvectors for the eigenvalue 1/d, scaled to the value 1 for points whose positions are their
/// offsets; `None` if the differences on the two sides do not converge to the same rows.
fn settled_tangents(cycle: &CycleMask, position: &Pair) -> Option<Pair> {
    let after = settled_tangent(cycle, position, [WeightRow::new(0, &[-1.0, 1.0]), WeightRow::new(1, &[-1.0, 1.0])])?;
    let ahead = settled_tangent(cycle, position, [WeightRow::new(-2, &[-1.0, 1.0]), WeightRow::new(-3, &[-1.0, 1.0])])?;
    let agree = after.iter().zip(&ahead).all(|(a, b)| a.distance(b) < TANGENT_TOLERANCE);
    agree.then_some(after)
}

fn settled_tangent(cycle: &CycleMask, position: &Pair, start: Pair) -> Option<Pair> {
    settled(start, f64::INFINITY, |pair| {
        let mut next = pure(&before(pair, cycle), position);
        for row in &mut next {
            let slope = row.slope();
            if !slope.is_finite() || slope.abs() < LEAST_SLOPE_SHARE * row.weights.iter().map(|w| w.abs()).sum::<f64>()
            {
                return None;
            }
            *row = row.scaled(1.0 / slope).trimmed();
        }
        Some(next)
    })
}

/// Applies `next` until the rows converge; `None` if `next` fails, a change is larger than `most` or not finite, or the
/// rows do not converge.
fn settled(mut pair: Pair, most: f64, next: impl Fn(&Pair) -> Option<Pair>) -> Option<Pair> {
    let mut last = f64::INFINITY;
    for _ in 0..MAX_ROUNDS {
        let now = next(&pair)?;
        let change = now[0].distance(&pair[0]).max(now[1].distance(&pair[1]));
        pair = now;
        if arrived(change, last) {
            return Some(pair);
        }
        if !change.is_finite() || change > most {
            return None;
        }
        last = change;
    }
    None
}
