//! Periodic rows, described by one period.

use std::ops::Range;

use super::table::{Rows, weighted};

/// Minimum number of periods for which a pattern pays: to find it two periods are made and compared, which must be
/// little beside the rest. Half of it searches for patterns where they save hardly more than that; twice of it makes
/// more rows one by one. Points have the same bits either way.
const MIN_PERIODS: usize = 64;

/// Periodic rows: row `first + period q + r` has the weights of residue `r` on consecutive old points, from
/// `start + stride q` on.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicRows {
    rows: Range<usize>,
    stride: usize,
    residues: Vec<Residue>,
}

/// The rows of one residue modulo the period.
#[derive(Debug, Clone, PartialEq)]
struct Residue {
    /// The first old point of the first of these rows.
    start: usize,
    weights: Vec<f64>,
}

impl Residue {
    /// Returns the common residue of the row `first` and the row `last`, which is `n` periods later, and the shift of
    /// old points per period; `None` if they do not match.
    fn of(first: (&[u32], &[f64]), last: (&[u32], &[f64]), n: usize) -> Option<(Self, usize)> {
        let ((indices, weights), (last_indices, last_weights)) = (first, last);
        let (&start, &last_start) = (indices.first()?, last_indices.first()?);
        let shift = last_start.checked_sub(start)?;
        let consecutive = (start..).zip(indices).all(|(expected, &index)| expected == index);
        let shifted = indices.iter().zip(last_indices).all(|(&a, &b)| b.checked_sub(a) == Some(shift));
        let equal = weights.iter().zip(last_weights).all(|(a, b)| a.to_bits() == b.to_bits());
        let whole = (shift as usize).is_multiple_of(n) && indices.len() == last_indices.len();
        (consecutive && shifted && equal && whole)
            .then(|| (Self { start: start as usize, weights: weights.to_vec() }, shift as usize / n))
    }
}

impl PeriodicRows {
    /// Finds the pattern of the rows of `make` without `margin` rows at each end, if they are periodic over consecutive
    /// points. The rows at both ends of the range are compared.
    pub(super) fn find(n_rows: usize, period: usize, margin: usize, make: impl Fn(usize, &mut Rows)) -> Option<Self> {
        let periods = n_rows.checked_sub(2 * margin)? / period;
        if periods < MIN_PERIODS {
            return None;
        }
        let sample = |q: usize| {
            let mut rows = Rows::default();
            for row in margin + q * period..margin + (q + 1) * period {
                make(row, &mut rows);
                rows.end_row();
            }
            rows
        };
        let (first, last) = (sample(0), sample(periods - 1));
        let both = (0..period).map(|r| Residue::of(first.row(r), last.row(r), periods - 1));
        let (residues, strides): (Vec<_>, Vec<_>) = both.collect::<Option<Vec<_>>>()?.into_iter().unzip();
        let stride = *strides.first()?;
        strides.iter().all(|&other| other == stride).then(|| {
            let rows = margin..margin + periods * period;
            Self { rows, stride, residues }.shortest()
        })
    }

    /// Returns the same pattern with period 1 if all residues are equal.
    fn shortest(mut self) -> Self {
        let first = &self.residues[0];
        let alike = |(r, other): (usize, &Residue)| {
            let equal = first.weights.iter().zip(&other.weights).all(|(a, b)| a.to_bits() == b.to_bits());
            equal && first.weights.len() == other.weights.len() && other.start == first.start + r
        };
        if self.stride == self.residues.len() && self.residues.iter().enumerate().all(alike) {
            self.residues.truncate(1);
            self.stride = 1;
        }
        self
    }

    /// Returns the part of `range` that the pattern covers; an empty range at its end if there is none.
    pub(super) fn part_of(&self, range: &Range<usize>) -> Range<usize> {
        let start = self.rows.start.clamp(range.start, range.end);
        let part = start..self.rows.end.clamp(start, range.end);
        if part.is_empty() { range.end..range.end } else { part }
    }

    /// Returns a range of old points that contains those needed by the rows of `range`, which must lie within the
    /// pattern.
    pub(super) fn needs(&self, range: &Range<usize>) -> Range<usize> {
        let period = self.residues.len();
        let (first, last) = ((range.start - self.rows.start) / period, (range.end - 1 - self.rows.start) / period);
        let start = self.residues.iter().map(|residue| residue.start).min().unwrap_or(0);
        let end = self.residues.iter().map(|residue| residue.start + residue.weights.len()).max().unwrap_or(0);
        start + first * self.stride..end + last * self.stride
    }

    /// Applies the rows from `start` on, which must lie within the pattern, to `points`, the first of which has index
    /// `offset`; each sum is in the order of the rows themselves.
    pub(super) fn apply<const W: usize>(&self, start: usize, points: &[[f64; W]], offset: usize, out: &mut [[f64; W]]) {
        let (period, stride) = (self.residues.len(), self.stride);
        let before = start - self.rows.start;
        for (r, residue) in self.residues.iter().enumerate() {
            // the first row of this residue at or after the start
            let q = (before + period - 1 - r) / period;
            let Some(targets) = out.get_mut(q * period + r - before..).filter(|rest| !rest.is_empty()) else {
                continue;
            };
            let targets = targets.iter_mut().step_by(period);
            let points = &points[residue.start + q * stride - offset..];
            match residue.weights.as_slice() {
                &[a] => apply_weights([a], points, stride, targets),
                &[a, b] => apply_weights([a, b], points, stride, targets),
                &[a, b, c] => apply_weights([a, b, c], points, stride, targets),
                &[a, b, c, d] => apply_weights([a, b, c, d], points, stride, targets),
                &[a, b, c, d, e] => apply_weights([a, b, c, d, e], points, stride, targets),
                &[a, b, c, d, e, f] => apply_weights([a, b, c, d, e, f], points, stride, targets),
                weights => {
                    for (points, target) in points.windows(weights.len()).step_by(stride).zip(targets) {
                        *target = weighted(weights.iter().zip(points));
                    }
                }
            }
        }
    }
}

/// Applies the same weights to runs of `K` points, `stride` apart, one for each target.
fn apply_weights<'a, const K: usize, const W: usize>(
    weights: [f64; K],
    points: &[[f64; W]],
    stride: usize,
    targets: impl Iterator<Item = &'a mut [f64; W]>,
) {
    // a loop of known length per coordinate stays in registers
    let sum = |points: &[[f64; W]; K], c: usize| (0..K).fold(-0.0, |sum, k| sum + weights[k] * points[k][c]);
    let fill = |(points, target): (&[[f64; W]; K], &mut [f64; W])| *target = std::array::from_fn(|c| sum(points, c));
    let runs = points.array_windows::<K>();
    // a stride that is known to be 1 makes the loop simple
    if stride == 1 { runs.zip(targets).for_each(fill) } else { runs.step_by(stride).zip(targets).for_each(fill) }
}
