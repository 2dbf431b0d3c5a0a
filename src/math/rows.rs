//! Weights as rows: which old points make each new one, and in what proportion. No coordinate is ever seen here.

use std::fmt;
use std::ops::Range;

use rayon::prelude::*;

use crate::watch::{Stopped, Watch};

/// Rows made and applied at a time: small enough for the cache, large enough to share among threads.
const BLOCK: usize = 4096;

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
            let mut sum = [0.0; W];
            for (&index, &weight) in indices.iter().zip(weights) {
                let point = &points[index as usize];
                for (s, p) in sum.iter_mut().zip(point) {
                    *s += weight * p;
                }
            }
            *target = sum;
        }
    }
}

/// Makes rows on demand, so that a table of a large net never has to be held as a whole.
pub trait RowSource: fmt::Debug + Send + Sync {
    /// Number of new points.
    fn n_rows(&self) -> usize;
    /// Number of old points.
    fn n_columns(&self) -> usize;
    /// Appends the rows of `range` to `out`.
    fn make(&self, range: Range<usize>, out: &mut Rows);
}

/// The rows that `make(row, table)` adds, one call a row.
pub struct RowsBy<F> {
    n_rows: usize,
    n_columns: usize,
    make: F,
}

impl<F: Fn(usize, &mut Rows) + Send + Sync> RowsBy<F> {
    /// A source of `n_rows` rows over `n_columns` old points.
    pub fn new(n_rows: usize, n_columns: usize, make: F) -> Self {
        Self { n_rows, n_columns, make }
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
        rows.clear();
        source.make(block * BLOCK..block * BLOCK + out.len(), rows);
        rows.apply(points, out);
        watch.advance(out.len() as u64);
        Ok(())
    })?;
    Ok(out)
}
