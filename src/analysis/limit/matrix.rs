//! Local subdivision matrices: how the points around a child come of the points around its parent.

use std::cell::RefCell;
use std::sync::Arc;

use super::Unlimited;
use crate::math::rows::{RowSource, Rows, collect};
use crate::scheme::step::Action;
use crate::shape::topology::{NONE, index};

/// A matrix in sparse rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
    n_columns: usize,
}

impl Matrix {
    /// `x M` for a row `x`: how a functional of the child's points reads its parent's.
    pub(super) fn times_row(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.n_columns];
        for (r, &factor) in x.iter().enumerate() {
            for k in self.starts[r]..self.starts[r + 1] {
                product[self.columns[k] as usize] += factor * self.values[k];
            }
        }
        product
    }

    /// `M y` for a column `y`: the child's points for the parent's.
    pub(super) fn times_column(&self, y: &[f64]) -> Vec<f64> {
        let value = |r: usize| {
            let range = self.starts[r]..self.starts[r + 1];
            range.map(|k| self.values[k] * y[self.columns[k] as usize]).sum()
        };
        (0..self.starts.len() - 1).map(value).collect()
    }
}

/// Whether weights count, or only where they stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weights {
    /// As they are.
    Exact,
    /// All as 1, so that none cancels another: what could have a weight at other numbers.
    Structural,
}

/// The actions of one application of a cycle. Of their rows those are made that someone asks for, each once.
#[derive(Debug)]
pub(super) struct Record {
    tables: Vec<Table>,
    weights: Weights,
}

#[derive(Debug)]
enum Table {
    Blend(Made),
    FromAnchor(Made),
    PushBack(Made, Arc<[u32]>),
    Keep,
}

/// Rows that are made when they are needed.
#[derive(Debug)]
struct Made {
    source: Box<dyn RowSource>,
    /// For each row where it stands among those made so far, counted from 1, or 0; and these.
    known: RefCell<(Vec<u32>, Rows)>,
}

impl Made {
    fn by(source: Box<dyn RowSource>) -> Self {
        let places = vec![0; source.n_rows()];
        Self { source, known: RefCell::new((places, Rows::default())) }
    }

    fn each(&self, row: u32, mut each: impl FnMut(u32, f64)) {
        let (places, rows) = &mut *self.known.borrow_mut();
        let (row, place) = (row as usize, &mut places[row as usize]);
        if *place == 0 {
            self.source.make(row..row + 1, rows);
            *place = index(rows.len());
        }
        let (indices, weights) = rows.row(*place as usize - 1);
        indices.iter().zip(weights).for_each(|(&column, &weight)| each(column, weight));
    }
}

impl Record {
    /// Nothing yet.
    pub(super) fn new(weights: Weights) -> Self {
        Self { tables: Vec::new(), weights }
    }

    /// Writes down an action.
    ///
    /// # Errors
    /// [`Unlimited::NotLinear`].
    pub(super) fn add(&mut self, action: Action) -> Result<(), Unlimited> {
        self.tables.push(match action {
            Action::Sequence(actions) => return actions.into_iter().try_for_each(|action| self.add(action)),
            Action::Map(_) => return Err(Unlimited::NotLinear),
            Action::Blend(rows) => Table::Blend(Made::by(rows)),
            Action::BlendFromAnchor(rows) => Table::FromAnchor(Made::by(rows)),
            Action::PushBack { rows, children } => Table::PushBack(Made::by(rows), children),
            Action::Keep => Table::Keep,
        });
        Ok(())
    }

    /// Of which old points each new one was made in the last action, where it made new ones.
    pub(super) fn last(&self) -> Option<Rows> {
        match self.tables.last() {
            Some(Table::Blend(rows) | Table::FromAnchor(rows)) => Some(collect(&*rows.source)),
            _ => None,
        }
    }

    /// The product of a row with the matrix of the `wanted` points after the last action over the points before the first,
    /// those of `origins` taken together; `n_columns` of them are kept. `None` where another one has a weight.
    pub(super) fn times_row(&self, row: &[f64], wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Vec<f64>> {
        let mut trace = Trace::default();
        wanted.iter().zip(row).for_each(|(&point, &factor)| trace.now.add(point, factor));
        self.tables.iter().rev().for_each(|table| trace.back(table, self.weights));
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
    pub(super) fn matrix(&self, wanted: &[u32], origins: &[u32], n_columns: usize) -> Option<Matrix> {
        let mut matrix = Matrix { starts: vec![0], columns: Vec::new(), values: Vec::new(), n_columns };
        let mut trace = Trace::default();
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for &point in wanted {
            trace.now.add(point, 1.0);
            for table in self.tables.iter().rev() {
                trace.back(table, self.weights);
            }
            let Trace { now, before, .. } = &mut trace;
            now.drain(|column, weight| before.add(origins[column as usize], weight));
            before.drain(|column, weight| entries.push((column, weight)));
            entries.sort_unstable_by_key(|entry| entry.0);
            for (column, weight) in entries.drain(..).filter(|entry| entry.1 != 0.0) {
                if column as usize >= n_columns {
                    return None;
                }
                matrix.columns.push(column);
                matrix.values.push(weight);
            }
            matrix.starts.push(matrix.columns.len());
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
    fn back(&mut self, table: &Table, weights: Weights) {
        let structural = weights == Weights::Structural;
        let weigh = |weight: f64| if structural { 1.0 } else { weight };
        let minus = if structural { 1.0 } else { -1.0 };
        let Self { now, anchor, before } = self;
        match table {
            Table::Keep => return,
            Table::Blend(rows) | Table::FromAnchor(rows) => {
                now.drain(|point, factor| rows.each(point, |column, w| before.add(column, factor * weigh(w))));
                if matches!(table, Table::FromAnchor(_)) {
                    anchor.drain(|point, factor| before.add(point, factor));
                }
            }
            Table::PushBack(rows, children) => now.drain(|point, factor| {
                before.add(point, factor);
                rows.each(point, |column, w| {
                    let push = factor * weigh(w);
                    anchor.add(column, push);
                    match children[column as usize] {
                        // lost at the rim of a patch: whoever needs it has no weights
                        NONE => before.add(point, f64::NAN),
                        child => before.add(child, minus * push),
                    }
                });
            }),
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
