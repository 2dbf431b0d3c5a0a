//! Local subdivision matrices: the rows of the points around a child over the points around its parent.

use std::cell::RefCell;

use super::error::Unlimited;
use crate::math::rows::{Rows, collect};
use crate::scheme::step::{Action, TermKind};
use crate::shape::topology::index;

/// Whether a record uses the weights or only their positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) enum WeightMode {
    /// The weights themselves.
    Exact,
    /// Every weight replaced by 1, so that none cancels: finds what could have a weight for other parameter values.
    Structural,
}

/// The actions of one application of a cycle. Their rows are made on demand, each once.
#[derive(Debug)]
pub(in crate::analysis) struct CycleRecord {
    actions: Vec<Recorded>,
    weights: WeightMode,
}

/// An action with a table, and the rows of the table that were made so far.
#[derive(Debug)]
struct Recorded {
    action: Action,
    /// For each row its position among those made so far, counted from 1, or 0 if it is not made; and the rows made.
    made: RefCell<(Vec<u32>, Rows)>,
}

impl Recorded {
    /// Calls `each` with the sources and weights of a point.
    fn weights(&self, point: u32, each: impl FnMut(TermKind, f64)) {
        let (places, rows) = &mut *self.made.borrow_mut();
        let (row, place) = (point as usize, &mut places[point as usize]);
        if *place == 0 {
            self.action.table().expect("only actions with a table are recorded").make(row..row + 1, rows);
            *place = index(rows.len());
        }
        self.action.weights(point, rows.row(*place as usize - 1), each);
    }
}

impl CycleRecord {
    /// Creates an empty record.
    pub(in crate::analysis) fn new(weights: WeightMode) -> Self {
        Self { actions: Vec::new(), weights }
    }

    /// Appends an action; actions without a table are left out.
    ///
    /// # Errors
    /// [`Unlimited::NotLinear`] for a map.
    pub(in crate::analysis) fn add(&mut self, action: Action) -> Result<(), Unlimited> {
        match action {
            Action::Sequence(actions) => return actions.into_iter().try_for_each(|action| self.add(action)),
            Action::Map(_) => return Err(Unlimited::NotLinear),
            action => {
                if let Some(table) = action.table() {
                    let made = RefCell::new((vec![0; table.n_rows()], Rows::default()));
                    self.actions.push(Recorded { action, made });
                }
            }
        }
        Ok(())
    }

    /// Returns the rows of the last action, if it was a blend.
    pub(super) fn last(&self) -> Option<Rows> {
        self.actions.last()?.action.rows().map(collect)
    }

    /// Multiplies a row by the matrix from the points before the first action to the `wanted` points after the last
    /// one. Points with the same entry in `origins` share a column. Returns `None` if a column beyond `n_columns` has a
    /// weight.
    pub(super) fn times_row(&self, row: &[f64], wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Vec<f64>> {
        let mut trace = TracedWeights::default();
        wanted.iter().zip(row).for_each(|(&point, &factor)| trace.now.add(point, factor));
        self.actions.iter().rev().for_each(|action| trace.back(action, self.weights));
        let mut product = vec![0.0; n_columns];
        let mut others = 0.0;
        trace.now.drain(|column, weight| match product.get_mut(origins[column as usize] as usize) {
            Some(sum) => *sum += weight,
            None => others += weight.abs(),
        });
        (others == 0.0).then_some(product)
    }

    /// Returns the matrix from the points before the first action to the `wanted` points after the last one. Points
    /// with the same entry in `origins` share a column. Returns `None` if a column beyond `n_columns` has a weight.
    pub(in crate::analysis) fn matrix(&self, wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Rows> {
        let mut matrix = Rows::default();
        let mut trace = TracedWeights::default();
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for &point in wanted {
            trace.now.add(point, 1.0);
            self.actions.iter().rev().for_each(|action| trace.back(action, self.weights));
            let TracedWeights { now, before, .. } = &mut trace;
            now.drain(|column, weight| before.add(origins[column as usize], weight));
            before.drain(|column, weight| entries.push((column, weight)));
            entries.sort_unstable_by_key(|entry| entry.0);
            for (column, weight) in entries.drain(..).filter(|entry| entry.1 != 0.0) {
                if column as usize >= n_columns {
                    return None;
                }
                matrix.add(column, weight);
            }
            matrix.end_row();
        }
        Some(matrix)
    }
}

/// The weights of one point or row, traced back through the actions.
#[derive(Default)]
struct TracedWeights {
    /// Weights over the points after the action that is traced back next.
    now: SparseSums,
    /// Weights over the points that entered the last upsampling.
    anchor: SparseSums,
    before: SparseSums,
}

impl TracedWeights {
    /// Turns weights over the points after an action into weights over the points before it.
    fn back(&mut self, recorded: &Recorded, weights: WeightMode) {
        let weigh = |weight: f64| if weights == WeightMode::Structural { 1.0 } else { weight };
        let Self { now, anchor, before } = self;
        now.drain(|point, factor| {
            recorded.weights(point, |source, weight| match source {
                TermKind::Point(point) => before.add(point, factor * weigh(weight)),
                TermKind::Anchor(point) => anchor.add(point, factor * weigh(weight)),
                // a NaN marks every point that needs the lost one
                TermKind::Lost => before.add(point, f64::NAN),
            });
        });
        if recorded.action.sets_anchor() {
            anchor.drain(|point, factor| before.add(point, factor));
        }
        std::mem::swap(&mut self.now, &mut self.before);
    }
}

/// Sums by number, in memory that is reused.
#[derive(Default)]
struct SparseSums {
    sums: Vec<Option<f64>>,
    touched: Vec<u32>,
}

impl SparseSums {
    fn add(&mut self, number: u32, weight: f64) {
        let at = number as usize;
        if at >= self.sums.len() {
            self.sums.resize(at + 1, None);
        }
        match &mut self.sums[at] {
            Some(sum) => *sum += weight,
            none => {
                *none = Some(weight);
                self.touched.push(number);
            }
        }
    }

    /// Calls `each` with all sums in the order of their first addition, and clears them.
    fn drain(&mut self, mut each: impl FnMut(u32, f64)) {
        for number in self.touched.drain(..) {
            if let Some(sum) = self.sums[number as usize].take() {
                each(number, sum);
            }
        }
    }
}
