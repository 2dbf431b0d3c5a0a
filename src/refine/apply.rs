//! Applies the actions of refinement steps to the points of a net.

use rayon::prelude::*;

use super::error::RefineError;
use crate::math::rows::{MAX_RUN, RowSource, blend, blend_run};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::step::{Action, Operand, PointMap};
use crate::scheme::stepper::{Net, Stepper};
use crate::shape::topology::NONE;
use crate::watch::{Stopped, Watch};

/// Number of values that one thread processes at a time. Each takes one or two operations, so that smaller tasks cost
/// more switching than work; with twice of it threads are idle at smaller nets.
const VALUES_PER_TASK: usize = 1 << 16;

/// Applies the steps of a plan to a net and to all point sets that belong to it. If an operator fails, `net` is left as
/// the net that the operator could not be applied to.
///
/// # Errors
/// [`RefineError`].
pub fn advance<'a, N: Net>(
    net: &mut N,
    points: &mut [Points],
    plan: &Plan,
    steps: impl IntoIterator<Item = &'a Scheduled>,
    watch: &Watch,
) -> Result<(), RefineError> {
    for step in steps {
        let next = Stepper::new(plan).next(net, step).map_err(RefineError::at(step))?;
        points.iter_mut().try_for_each(|points| points.act(&next.action, step.level, watch))?;
        *net = next.net;
    }
    Ok(())
}

/// The operand of the actions of one level, with the watch that may stop the computation.
pub(super) struct AtLevel<'a, T> {
    pub(super) of: &'a mut T,
    pub(super) level: u32,
    pub(super) watch: &'a Watch,
}

fn ensure(finite: bool, level: u32) -> Result<(), RefineError> {
    if finite { Ok(()) } else { Err(RefineError::NotFinite { level }) }
}

/// The points of a net, `n x width`, together with the anchor: the points before the last upsampling.
#[derive(Debug, Clone)]
pub struct Points {
    /// Coordinates, point after point; `n x width`.
    pub now: Vec<f64>,
    anchor: Vec<f64>,
    /// Unit tangents, `n x width`; present only under plans that turn tangents.
    pub(super) tangents: Option<Vec<f64>>,
    /// Number of coordinates per point.
    pub width: usize,
}

impl Points {
    /// Creates the points of the input, before any step, with `width` coordinates each.
    pub fn new(now: Vec<f64>, width: usize) -> Self {
        Self { now, anchor: Vec::new(), tangents: None, width }
    }

    /// Applies one action of a level.
    ///
    /// # Errors
    /// Fails if the watch says stop or a coordinate is no longer finite.
    pub fn act(&mut self, action: &Action, level: u32, watch: &Watch) -> Result<(), RefineError> {
        action.apply(&mut AtLevel { of: self, level, watch })
    }

    /// Applies all actions of one level. Consecutive blends whose rows repeat a pattern are applied in one sweep,
    /// without storing the points between them.
    pub(super) fn act_all(&mut self, actions: &[Action], level: u32, watch: &Watch) -> Result<(), RefineError> {
        let repeat = |action: &Action| action.rows().is_some_and(|rows| rows.pattern().is_some());
        let runs = actions.chunk_by(|a, b| repeat(a) && repeat(b) && matches!(b, Action::Blend(_)));
        runs.flat_map(|run| run.chunks(MAX_RUN)).try_for_each(|run| match run {
            [action] => self.act(action, level, watch),
            run => {
                let rows: Vec<_> = run.iter().filter_map(Action::rows).collect();
                self.blend(matches!(run[0], Action::BlendFromAnchor(_)), &rows, level, watch)
            }
        })
    }

    /// Applies the row tables of a run in turn: `points <- rows x points`. If `anchor` is set, the points before the
    /// run become the anchor.
    fn blend(&mut self, anchor: bool, run: &[&dyn RowSource], level: u32, watch: &Watch) -> Result<(), RefineError> {
        let next = blend_run(run, &self.now, self.width, watch)?;
        let before = std::mem::replace(&mut self.now, next.points);
        if anchor {
            self.anchor = before;
        }
        ensure(next.finite, level)
    }

    fn ensure_finite(&self, level: u32) -> Result<(), RefineError> {
        let finite =
            |numbers: &[f64]| numbers.par_chunks(VALUES_PER_TASK).all(|chunk| chunk.iter().all(|x| x.is_finite()));
        ensure(finite(&self.now) && self.tangents.as_deref().is_none_or(finite), level)
    }

    /// Adds the push-back: `points <- points + rows x (anchor - children)`.
    fn push_back(&mut self, rows: &dyn RowSource, children: &[u32], watch: &Watch) -> Result<(), Stopped> {
        let w = self.width;
        let mut differences = self.anchor.clone();
        let chunks = differences.par_chunks_mut(VALUES_PER_TASK * w).zip(children.par_chunks(VALUES_PER_TASK));
        chunks.for_each(|(differences, children)| {
            for (difference, &child) in differences.chunks_exact_mut(w).zip(children) {
                if child == NONE {
                    difference.fill(0.0);
                    continue;
                }
                let child = child as usize * w;
                for (d, x) in difference.iter_mut().zip(&self.now[child..child + w]) {
                    *d -= x;
                }
            }
        });
        let moves = blend(rows, &differences, w, watch)?;
        self.now.par_chunks_mut(VALUES_PER_TASK).zip(moves.par_chunks(VALUES_PER_TASK)).for_each(|(points, moves)| {
            for (x, m) in points.iter_mut().zip(moves) {
                *x += m;
            }
        });
        Ok(())
    }
}

impl Operand for AtLevel<'_, Points> {
    type Error = RefineError;

    fn blend(&mut self, rows: &dyn RowSource, anchor: bool) -> Result<(), RefineError> {
        self.of.blend(anchor, &[rows], self.level, self.watch)
    }

    fn push_back(&mut self, rows: &dyn RowSource, children: &[u32]) -> Result<(), RefineError> {
        self.of.push_back(rows, children, self.watch)?;
        self.of.ensure_finite(self.level)
    }

    fn map(&mut self, map: &dyn PointMap) -> Result<(), RefineError> {
        let tangents = self.of.tangents.as_ref().expect("plans with such a step start with tangents");
        let (points, tangents) = map.apply(self.of.now.as_chunks().0, tangents.as_chunks().0, self.watch)?;
        (self.of.now, self.of.tangents) = (points.into_flattened(), Some(tangents.into_flattened()));
        self.of.ensure_finite(self.level)
    }
}
