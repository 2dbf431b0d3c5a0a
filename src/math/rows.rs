//! Weights as rows: which old points make each new one, and in what proportion. No coordinate is ever seen here.

mod blend;
mod pattern;

pub use blend::{Blended, MAX_RUN, blend, blend_run};
pub use pattern::Pattern;

use std::fmt;
use std::ops::Range;

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

    /// `x R` for a row `x`: the weights of the `n` old points in a functional that has the weights `x` over the new ones.
    pub fn times_row(&self, x: &[f64], n: usize) -> Vec<f64> {
        let mut product = vec![0.0; n];
        for (r, &factor) in x.iter().enumerate() {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).for_each(|(&index, &weight)| product[index as usize] += factor * weight);
        }
        product
    }

    /// `R y` for a column `y`: the new values for the old ones.
    pub fn times_column(&self, y: &[f64]) -> Vec<f64> {
        let value = |r: usize| {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).map(|(&index, &weight)| weight * y[index as usize]).sum()
        };
        (0..self.len()).map(value).collect()
    }

    /// `out[r] = sum of weight x points[index]`, for points of `W` coordinates each.
    fn apply<const W: usize>(&self, points: &[[f64; W]], out: &mut [[f64; W]]) {
        for (r, target) in out.iter_mut().enumerate() {
            let (indices, weights) = self.row(r);
            *target = weighted(weights.iter().zip(indices.iter().map(|&index| &points[index as usize])));
        }
    }
}

/// `sum of weight x point`, in order.
#[inline]
fn weighted<'a, const W: usize>(pairs: impl Iterator<Item = (&'a f64, &'a [f64; W])>) -> [f64; W] {
    let mut sum = [0.0; W];
    for (weight, point) in pairs {
        sum = std::array::from_fn(|c| sum[c] + weight * point[c]);
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
    /// indices higher by one number each time. Rows so few that it would not pay, or that do otherwise at either end of these, are made
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
