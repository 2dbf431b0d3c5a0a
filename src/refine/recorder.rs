//! Records the weights of a refinement instead of applying them to points.

use super::apply::AtLevel;
use super::error::RefineError;
use crate::math::rows::{RowSource, Rows};
use crate::scheme::step::{Action, Operand, PointMap};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, index};
use crate::watch::Watch;

/// Number of rows made at a time. Half as many would query the watch twice as often; twice as many would only take more
/// memory.
const RECORDED_ROWS: usize = 4096;

/// The values of a refinement: the points of the input, then rows over earlier values. A row that only copies a value
/// is not stored; its point takes the index of that value.
///
///
/// The rows are those that [`Points::act`](super::Points::act) applies, in the same groups, so that their sums have the
/// same bits up to the sign of zeros.
#[derive(Debug)]
pub struct Recorder {
    columns: usize,
    rows: Rows,
    /// The index of the first row of the last table.
    last: usize,
    now: Vec<u32>,
    anchor: Vec<u32>,
    /// The rows of the results, which no other row refers to.
    results: Rows,
}

impl Recorder {
    /// Creates a recorder over `columns` points of the input.
    pub fn new(columns: usize) -> Self {
        let (rows, results) = (Rows::default(), Rows::default());
        Self { columns, rows, last: 0, now: Vec::new(), anchor: Vec::new(), results }
    }

    /// Starts a net whose `n` points are the input points `first..first + n`.
    pub fn begin(&mut self, first: usize, n: usize) {
        self.now = (first..first + n).map(index).collect();
        self.last = self.rows.len();
    }

    /// Applies one action of a level.
    ///
    /// # Errors
    /// Fails if the watch says stop, if the action is not a weighted sum, or if there are more rows than 32 bits can
    /// index.
    pub fn act(&mut self, action: &Action, level: u32, watch: &Watch) -> Result<(), RefineError> {
        action.apply(&mut AtLevel { of: self, level, watch })
    }

    /// Returns the index of the value that the next row makes.
    fn next(&self, level: u32) -> Result<u32, RefineError> {
        let many = || StepError::new("there are more rows of weights than 32 bits number; ask for fewer levels");
        u32::try_from(self.columns + self.rows.len()).map_err(|_| RefineError::Step { level, error: many() })
    }

    fn blend(&mut self, source: &dyn RowSource, level: u32, watch: &Watch) -> Result<(), RefineError> {
        self.last = self.rows.len();
        let mut made = Vec::with_capacity(source.n_rows());
        let mut block = Rows::default();
        for start in (0..source.n_rows()).step_by(RECORDED_ROWS) {
            watch.check()?;
            block.clear();
            source.make(start..source.n_rows().min(start + RECORDED_ROWS), &mut block);
            for r in 0..block.len() {
                if let (&[at], &[1.0]) = block.row(r) {
                    made.push(self.now[at as usize]);
                    continue;
                }
                made.push(self.next(level)?);
                self.rows.copy_row(&block, r, |at| self.now[at as usize]);
                self.rows.end_row();
            }
            watch.advance(block.len() as u64);
        }
        self.now = made;
        Ok(())
    }

    /// Records `points + rows x (anchor - children)` in three tables: the differences, their weighted sums where these
    /// have several terms, and the points.
    fn push_back(
        &mut self,
        source: &dyn RowSource,
        children: &[u32],
        level: u32,
        watch: &Watch,
    ) -> Result<(), RefineError> {
        let mut differences = Vec::with_capacity(children.len());
        for (&from, &child) in self.anchor.iter().zip(children) {
            differences.push(self.next(level)?);
            if child == NONE {
                // a point without a child contributes no difference
                self.rows.add(from, 0.0);
            } else {
                self.rows.add(from, 1.0);
                self.rows.add(self.now[child as usize], -1.0);
            }
            self.rows.end_row();
        }
        let mut moves = Rows::default();
        source.make(0..source.n_rows(), &mut moves);
        let mut sums = vec![NONE; moves.len()];
        for (r, sum) in sums.iter_mut().enumerate().filter(|(r, _)| moves.terms(*r).nth(1).is_some()) {
            *sum = self.next(level)?;
            self.rows.copy_row(&moves, r, |at| differences[at as usize]);
            self.rows.end_row();
        }
        watch.check()?;
        self.last = self.rows.len();
        for (r, &sum) in sums.iter().enumerate().filter(|(r, _)| !moves.row(*r).0.is_empty()) {
            let made = self.next(level)?;
            self.rows.add(self.now[r], 1.0);
            match sum {
                NONE => self.rows.copy_row(&moves, r, |at| differences[at as usize]),
                sum => self.rows.add(sum, 1.0),
            }
            self.rows.end_row();
            self.now[r] = made;
        }
        watch.advance(3 * moves.len() as u64);
        Ok(())
    }

    /// Reorders the points of the net: the new point `i` is the old point `order[i]`.
    pub fn arrange(&mut self, order: impl Iterator<Item = usize>) {
        self.now = order.map(|at| self.now[at]).collect();
    }

    /// Turns the points of the net into results; afterwards the net has no points.
    pub fn end(&mut self) {
        let first = index(self.columns + self.last);
        let last = self.rows.split_off(self.last);
        for value in std::mem::take(&mut self.now) {
            match value.checked_sub(first) {
                Some(row) => self.results.copy_row(&last, row as usize, |at| at),
                None => self.results.add(value, 1.0),
            }
            self.results.end_row();
        }
    }

    /// Adds a result: row `r` of a table over the points of the net, or the value `instead` if that row is empty.
    pub fn add(&mut self, rows: &Rows, r: usize, instead: Option<u32>) {
        match instead.filter(|_| rows.row(r).0.is_empty()) {
            Some(value) => self.results.add(value, 1.0),
            None => self.results.copy_row(rows, r, |at| self.now[at as usize]),
        }
        self.results.end_row();
    }

    /// Returns the index of the value of each point of the net.
    pub fn points(&self) -> &[u32] {
        &self.now
    }

    /// Returns the number of results.
    pub fn n_results(&self) -> usize {
        self.results.len()
    }

    /// Returns all rows; those of the results come last.
    pub fn finish(mut self) -> Rows {
        self.rows.append(&self.results);
        self.rows
    }
}

impl Operand for AtLevel<'_, Recorder> {
    type Error = RefineError;

    fn blend(&mut self, rows: &dyn RowSource, anchor: bool) -> Result<(), RefineError> {
        if anchor {
            self.of.anchor.clone_from(&self.of.now);
        }
        self.of.blend(rows, self.level, self.watch)
    }

    fn push_back(&mut self, rows: &dyn RowSource, children: &[u32]) -> Result<(), RefineError> {
        self.of.push_back(rows, children, self.level, self.watch)
    }

    fn map(&mut self, _: &dyn PointMap) -> Result<(), RefineError> {
        let error = StepError::new("points are turned here, not weighed");
        Err(RefineError::Step { level: self.level, error })
    }
}
