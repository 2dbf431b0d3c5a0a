//! Local subdivision matrices: the rows of the points around a child over the points around its parent.

use std::cell::RefCell;

use super::error::Unlimited;
use crate::math::rows::{Rows, collect};
use crate::scheme::step::{Action, Source};
use crate::shape::topology::index;

/// Whether weights count, or only where they stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) enum Weights {
    /// As they are.
    Exact,
    /// All as 1, so that none cancels another: what could have a weight at other numbers.
    Structural,
}

/// The actions of one application of a cycle. Of their rows those are made that someone asks for, each once.
#[derive(Debug)]
pub(in crate::analysis) struct Record {
    actions: Vec<Recorded>,
    weights: Weights,
}

/// An action with a table, and the rows of it that were made.
#[derive(Debug)]
struct Recorded {
    action: Action,
    /// For each row where it stands among those made so far, counted from 1, or 0; and these.
    made: RefCell<(Vec<u32>, Rows)>,
}

impl Recorded {
    /// The weights with which a point is made.
    fn weights(&self, point: u32, each: impl FnMut(Source, f64)) {
        let (places, rows) = &mut *self.made.borrow_mut();
        let (row, place) = (point as usize, &mut places[point as usize]);
        if *place == 0 {
            self.action.table().expect("only actions with a table are recorded").make(row..row + 1, rows);
            *place = index(rows.len());
        }
        self.action.weights(point, rows.row(*place as usize - 1), each);
    }
}

impl Record {
    /// Nothing yet.
    pub(in crate::analysis) fn new(weights: Weights) -> Self {
        Self { actions: Vec::new(), weights }
    }

    /// Writes down an action.
    ///
    /// # Errors
    /// [`Unlimited::NotLinear`].
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

    /// Of which old points each new one was made in the last action, where that was a blend.
    pub(super) fn last(&self) -> Option<Rows> {
        self.actions.last()?.action.rows().map(collect)
    }

    /// The product of a row with the matrix of the `wanted` points after the last action over the points before the
    /// first, those of `origins` taken together; `n_columns` of them are kept. `None` where another one has a weight.
    pub(super) fn times_row(&self, row: &[f64], wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Vec<f64>> {
        let mut trace = Trace::default();
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

    /// For each of the `wanted` points after the last action its weights over the points before the first, those of
    /// `origins` taken together; `n_columns` of them are kept. `None` where another one has a weight.
    pub(in crate::analysis) fn matrix(&self, wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Rows> {
        let mut matrix = Rows::default();
        let mut trace = Trace::default();
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for &point in wanted {
            trace.now.add(point, 1.0);
            self.actions.iter().rev().for_each(|action| trace.back(action, self.weights));
            let Trace { now, before, .. } = &mut trace;
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

/// Weights of one point, followed back through the actions.
#[derive(Default)]
struct Trace {
    /// Over the points after the action that is next.
    now: Tally,
    /// Over the points that entered the last upsampling.
    anchor: Tally,
    before: Tally,
}

impl Trace {
    /// From weights over the points after an action to weights over those before it.
    fn back(&mut self, recorded: &Recorded, weights: Weights) {
        let weigh = |weight: f64| if weights == Weights::Structural { 1.0 } else { weight };
        let Self { now, anchor, before } = self;
        now.drain(|point, factor| {
            recorded.weights(point, |source, weight| match source {
                Source::Point(point) => before.add(point, factor * weigh(weight)),
                Source::Anchor(point) => anchor.add(point, factor * weigh(weight)),
                // whoever needs it has no weights
                Source::Lost => before.add(point, f64::NAN),
            });
        });
        if recorded.action.sets_anchor() {
            anchor.drain(|point, factor| before.add(point, factor));
        }
        std::mem::swap(&mut self.now, &mut self.before);
    }
}

/// Sums by number, for few numbers at a time.
#[derive(Default)]
struct Tally {
    sums: Vec<Option<f64>>,
    touched: Vec<u32>,
}

impl Tally {
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

    /// Hands out all sums in the order of their first addition, and forgets them.
    fn drain(&mut self, mut each: impl FnMut(u32, f64)) {
        for number in self.touched.drain(..) {
            if let Some(sum) = self.sums[number as usize].take() {
                each(number, sum);
            }
        }
    }
}
