//! The operators of a cycle on closed polygons as exact matrices, in the limit alpha = 0.

use num_traits::Zero;

use super::exact_cycle::ImpulseResponse;
use crate::math::exact::{Exact, ExactSequence};
use crate::scheme::operator::Role;
use crate::scheme::plan::Plan;

/// An operator on a closed polygon as exact matrices with one row per new point: the new points are `points` times the
/// points before the operator plus `coarse` times the points that entered the last upsampling.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactStep {
    /// Weights of the points before the operator.
    pub points: Vec<Vec<Exact>>,
    /// Weights of the points that entered the last upsampling; push-backs only.
    pub coarse: Option<Vec<Vec<Exact>>>,
}

/// Returns the operators of one application of a cycle to a closed polygon of `n` points; `None` if some weight is not
/// known as a fraction.
pub fn exact_steps(plan: &Plan, n: usize) -> Option<Vec<ExactStep>> {
    let settled = Plan { alpha: 0.0, compensation_alpha: None, ..plan.clone() };
    let steps = settled.schedule(1).ok()?;
    let mut state = ImpulseResponse::new();
    let mut coarse = n;
    let mut found = Vec::new();
    for step in steps.iter().filter(|step| step.level == 1) {
        let mut next = state.clone();
        next.apply(plan, step)?;
        let [before, after] = [&state, &next].map(|state| usize::try_from(state.arity).ok()?.checked_mul(n));
        let (before, after) = (before?, after?);
        let column = |points: ExactSequence, anchor: ExactSequence| {
            let mut state = state.clone();
            (state.points, state.anchor) = (points, anchor);
            state.apply(plan, step)?;
            Some(folded(&state.points, after))
        };
        let index = |i: usize| i64::try_from(i).unwrap_or(0);
        let points = (0..before)
            .map(|i| column(ExactSequence::impulse(index(i)), ExactSequence::zero()))
            .collect::<Option<Vec<_>>>()?;
        let of_coarse = if step.letter.facts().role == Role::PushBack {
            let columns = (0..coarse).map(|i| column(ExactSequence::zero(), ExactSequence::impulse(index(i))));
            Some(turned(&columns.collect::<Option<Vec<_>>>()?, after))
        } else {
            None
        };
        found.push(ExactStep { points: turned(&points, after), coarse: of_coarse });
        if after > before {
            coarse = before;
        }
        state = next;
    }
    Some(found)
}

/// Wraps a sequence around a closed polygon of `n` points; values at the same point are added.
fn folded(points: &ExactSequence, n: usize) -> Vec<Exact> {
    let mut closed = vec![Exact::zero(); n];
    for (i, x) in (points.first..).zip(&points.values) {
        let place = i.rem_euclid(i64::try_from(n).unwrap_or(1));
        closed[usize::try_from(place).unwrap_or(0)] += x;
    }
    closed
}

/// Transposes columns into rows.
fn turned(columns: &[Vec<Exact>], rows: usize) -> Vec<Vec<Exact>> {
    (0..rows).map(|r| columns.iter().map(|column| column[r].clone()).collect()).collect()
}
