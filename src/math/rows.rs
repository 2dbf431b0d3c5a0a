//! Weights as rows: which old points make each new one, and in what proportion. No coordinate is ever seen here.

use std::fmt;
use std::ops::Range;

use rayon::prelude::*;

use crate::watch::{Stopped, Watch};

/// Rows made and applied at a time: small enough for the cache, large enough to share among threads.
const BLOCK: usize = 4096;

/// Periods from which on rows that repeat themselves are worth looking for.
const MIN_PERIODS: usize = 64;

/// A table of weights in flat sparse form: row `r` has the entries `starts[r]..starts[r + 1]`.
///
/// Entries of one row are summed in the order they were added; an index may occur more than once.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    starts: Vec<usize>,
    indices: Vec<u32>,
    weights: Vec<f64>,
}

impl Default for Rows {
    fn default() -> Self {
        Self { starts: vec![0], indices: Vec::new(), weights: Vec::new() }
    }
}

impl Rows {
    /// Number of complete rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops all rows, keeps the memory.
    pub fn clear(&mut self) {
        self.starts.truncate(1);
        self.indices.clear();
        self.weights.clear();
    }

    /// Adds an entry to the row being made.
    #[inline]
    pub fn add(&mut self, index: u32, weight: f64) {
        self.indices.push(index);
        self.weights.push(weight);
    }

    /// Completes the row being made.
    #[inline]
    pub fn end_row(&mut self) {
        self.starts.push(self.indices.len());
    }

    /// Indices and weights of row `r`.
    #[inline]
    pub fn row(&self, r: usize) -> (&[u32], &[f64]) {
        let range = self.starts[r]..self.starts[r + 1];
        (&self.indices[range.clone()], &self.weights[range])
    }

    /// `out[r] = sum of weight x points[index]`, for points of `W` coordinates each.
    fn apply<const W: usize>(&self, points: &[[f64; W]], out: &mut [[f64; W]]) {
        for (r, target) in out.iter_mut().enumerate() {
            let (indices, weights) = self.row(r);
            *target = weighted(weights.iter().zip(indices.iter().map(|&index| &points[index as usize])));
        }
    }
}

/// Rows that repeat themselves: row `first + period q + r` has the weights `residues[r].1` of consecutive old points from
/// `residues[r].0 + q` on.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// The rows that it describes: whole periods.
    rows: Range<usize>,
    residues: Vec<(usize, Vec<f64>)>,
}

impl Pattern {
    /// The rows of `make` from `margin` on, as far as `margin` before the end, if they repeat themselves with the period
    /// and each has consecutive points. Both ends of the range are looked at.
    fn find(n_rows: usize, period: usize, margin: usize, make: impl Fn(usize, &mut Rows)) -> Option<Self> {
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
        let (start, end) = (sample(0), sample(periods - 1));
        let mut residues = Vec::with_capacity(period);
        for r in 0..period {
            let ((indices, weights), (last_indices, last_weights)) = (start.row(r), end.row(r));
            let first = *indices.first()?;
            let shift = u32::try_from(periods - 1).ok()?;
            let consecutive = (first..).zip(indices).all(|(expected, &index)| expected == index);
            let repeated = indices.len() == last_indices.len()
                && indices.iter().zip(last_indices).all(|(&a, &b)| b.checked_sub(a) == Some(shift))
                && weights.iter().zip(last_weights).all(|(a, b)| a.to_bits() == b.to_bits());
            if !consecutive || !repeated {
                return None;
            }
            residues.push((first as usize, weights.to_vec()));
        }
        Some(Self { rows: margin..margin + periods * period, residues })
    }

    /// The rows `start .. start + out.len()`, all of them within the pattern, applied to `points`; each sum is made in the
    /// order in which the rows themselves would be.
    fn apply<const W: usize>(&self, start: usize, points: &[[f64; W]], out: &mut [[f64; W]]) {
        let period = self.residues.len();
        for (r, (first, weights)) in self.residues.iter().enumerate() {
            let offset = start - self.rows.start;
            // the first row of this residue that is not before the start
            let q = (offset + period - 1 - r) / period;
            let Some(targets) = out.get_mut(q * period + r - offset..) else { continue };
            let targets = targets.iter_mut().step_by(period);
            let sources = &points[first + q..];
            match weights.as_slice() {
                &[a] => sweep([a], sources, targets),
                &[a, b] => sweep([a, b], sources, targets),
                &[a, b, c] => sweep([a, b, c], sources, targets),
                &[a, b, c, d] => sweep([a, b, c, d], sources, targets),
                &[a, b, c, d, e] => sweep([a, b, c, d, e], sources, targets),
                &[a, b, c, d, e, f] => sweep([a, b, c, d, e, f], sources, targets),
                weights => {
                    for (points, target) in sources.windows(weights.len()).zip(targets) {
                        *target = weighted(weights.iter().zip(points));
                    }
                }
            }
        }
    }
}

/// As many windows of `K` points as there are targets, each with the same weights.
fn sweep<'a, const K: usize, const W: usize>(
    weights: [f64; K],
    points: &[[f64; W]],
    targets: impl Iterator<Item = &'a mut [f64; W]>,
) {
    for (points, target) in points.array_windows::<K>().zip(targets) {
        *target = weighted(weights.iter().zip(points));
    }
}

/// `sum of weight x point`, in order.
#[inline]
fn weighted<'a, const W: usize>(pairs: impl Iterator<Item = (&'a f64, &'a [f64; W])>) -> [f64; W] {
    let mut sum = [0.0; W];
    for (weight, point) in pairs {
        for (s, p) in sum.iter_mut().zip(point) {
            *s += weight * p;
        }
    }
    sum
}

/// Makes rows on demand, so that a table of a large net never has to be held as a whole.
pub trait RowSource: fmt::Debug + Send + Sync {
    /// Number of new points.
    fn n_rows(&self) -> usize;
    /// Number of old points.
    fn n_columns(&self) -> usize;
    /// Appends the rows of `range` to `out`.
    fn make(&self, range: Range<usize>, out: &mut Rows);
    /// Those of its rows that repeat themselves, if that is known.
    fn pattern(&self) -> Option<&Pattern> {
        None
    }
}

/// The rows that `make(row, table)` adds, one call a row.
pub struct RowsBy<F> {
    n_rows: usize,
    n_columns: usize,
    pattern: Option<Pattern>,
    make: F,
}

impl<F: Fn(usize, &mut Rows) + Send + Sync> RowsBy<F> {
    /// A source of `n_rows` rows over `n_columns` old points.
    pub fn new(n_rows: usize, n_columns: usize, make: F) -> Self {
        Self { n_rows, n_columns, pattern: None, make }
    }

    /// The same source, which knows that all rows but `margin` at each end repeat themselves every `period` rows, the
    /// indices 1 higher each time. Rows so few that it would not pay, or that do otherwise at either end of these, are made
    /// one by one.
    #[must_use]
    pub fn repeating(self, period: usize, margin: usize) -> Self {
        let pattern = Pattern::find(self.n_rows, period, margin, &self.make);
        Self { pattern, ..self }
    }
}

impl<F> fmt::Debug for RowsBy<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RowsBy({} x {})", self.n_rows, self.n_columns)
    }
}

impl<F: Fn(usize, &mut Rows) + Send + Sync> RowSource for RowsBy<F> {
    fn n_rows(&self) -> usize {
        self.n_rows
    }

    fn n_columns(&self) -> usize {
        self.n_columns
    }

    fn make(&self, range: Range<usize>, out: &mut Rows) {
        for row in range {
            (self.make)(row, out);
            out.end_row();
        }
    }

    fn pattern(&self) -> Option<&Pattern> {
        self.pattern.as_ref()
    }
}

/// The whole table of a source.
pub fn collect(source: &dyn RowSource) -> Rows {
    let mut rows = Rows::default();
    source.make(0..source.n_rows(), &mut rows);
    rows
}

/// `rows x points`: `points` is `n_columns x width`, the result `n_rows x width`, both point after point.
///
/// Blocks of rows are divided among threads; each sum is ordered, so any number of threads gives the same bits.
///
/// # Errors
/// [`Stopped`] when the watch says so.
///
/// # Panics
/// When `points` has not `n_columns x width` coordinates, or `width` is not 1 to 4.
pub fn blend(source: &dyn RowSource, points: &[f64], width: usize, watch: &Watch) -> Result<Vec<f64>, Stopped> {
    assert_eq!(points.len(), source.n_columns() * width, "the rows belong to another net");
    match width {
        1 => blend_points::<1>(source, points, watch),
        2 => blend_points::<2>(source, points, watch),
        3 => blend_points::<3>(source, points, watch),
        4 => blend_points::<4>(source, points, watch),
        _ => panic!("points have 1 to 4 coordinates, not {width}"),
    }
}

fn blend_points<const W: usize>(source: &dyn RowSource, points: &[f64], watch: &Watch) -> Result<Vec<f64>, Stopped> {
    let (points, _) = points.as_chunks::<W>();
    let mut out = vec![0.0; source.n_rows() * W];
    out.par_chunks_mut(BLOCK * W).enumerate().try_for_each_init(Rows::default, |rows, (block, out)| {
        watch.check()?;
        let (out, _) = out.as_chunks_mut::<W>();
        let start = block * BLOCK;
        let all = start..start + out.len();
        let repeated = source.pattern().map_or(all.end..all.end, |pattern| {
            let from = pattern.rows.start.clamp(all.start, all.end);
            from..pattern.rows.end.clamp(from, all.end)
        });
        for single in [all.start..repeated.start, repeated.end..all.end] {
            rows.clear();
            source.make(single.clone(), rows);
            rows.apply(points, &mut out[single.start - start..single.end - start]);
        }
        if let Some(pattern) = source.pattern().filter(|_| !repeated.is_empty()) {
            pattern.apply(repeated.start, points, &mut out[repeated.start - start..repeated.end - start]);
        }
        watch.advance(out.len() as u64);
        Ok(())
    })?;
    Ok(out)
}
