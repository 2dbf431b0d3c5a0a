//! Tables whose rows are made on demand.

use std::fmt;
use std::ops::Range;

use super::pattern::PeriodicRows;
use super::table::Rows;

/// Makes rows on demand, so that a table of a large net never has to be held as a whole.
pub trait RowSource: fmt::Debug + Send + Sync {
    /// Returns the number of new points.
    fn n_rows(&self) -> usize;
    /// Returns the number of old points.
    fn n_columns(&self) -> usize;
    /// Appends the rows of `range` to `out`.
    fn make(&self, range: Range<usize>, out: &mut Rows);
    /// Returns the pattern of the rows, if one is known.
    fn pattern(&self) -> Option<&PeriodicRows> {
        None
    }
}

/// The rows that `make(row, table)` adds, one row per call.
pub struct RowsBy<F> {
    n_rows: usize,
    n_columns: usize,
    pattern: Option<PeriodicRows>,
    make: F,
}

impl<F: Fn(usize, &mut Rows) + Send + Sync> RowsBy<F> {
    /// Creates a source of `n_rows` rows over `n_columns` old points.
    pub fn new(n_rows: usize, n_columns: usize, make: F) -> Self {
        Self { n_rows, n_columns, pattern: None, make }
    }

    /// Returns the source with the knowledge that all rows except `margin` at each end repeat every `period` rows, with
    /// indices shifted by a constant. If there are too few rows, or rows at either end do not match, they are made one
    /// by one.
    #[must_use]
    pub fn repeating(self, period: usize, margin: usize) -> Self {
        let pattern = PeriodicRows::find(self.n_rows, period, margin, &self.make);
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

    fn pattern(&self) -> Option<&PeriodicRows> {
        self.pattern.as_ref()
    }
}

/// Makes the whole table of a source.
pub fn collect(source: &dyn RowSource) -> Rows {
    let mut rows = Rows::default();
    source.make(0..source.n_rows(), &mut rows);
    rows
}
