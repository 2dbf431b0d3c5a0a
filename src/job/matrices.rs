//! The matrices of one step, as a request asks for them.

use super::codec::Item;
use crate::analysis::Study;
use crate::analysis::matrices::{MAX_ENTRIES, Matrix, NoMatrices, StepMatrices, StepMatrix};
use crate::analysis::smoothness::{Powers, Report};
use crate::fault::Fault;
use crate::scheme::plan::Plan;

/// Most points of the polygon.
/// Matrices of more are not read by anybody. Half of it is enough for masks of up to nine entries only; twice of it
/// makes answers four times as long.
pub(super) const MAX_POINTS: u32 = 16;
/// Most powers of the local matrix.
/// The eighth of a smooth scheme differs from the limit by 1/256. Half of it shows less of how they get there; twice of
/// it has fractions of many digits.
pub(super) const MAX_POWERS: u32 = 8;

/// Of which polygon matrices are asked for, and how many powers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MatricesWish {
    /// Points of the polygon.
    pub points: u32,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Powers of the local matrix.
    pub powers: u32,
}

/// Matrices that belong to a question.
#[derive(Debug, Clone)]
pub(super) struct AskedMatrices {
    wish: MatricesWish,
    of_steps: StepMatrices,
}

/// Matrices that were found.
#[derive(Debug, Clone)]
pub struct FoundMatrices<'a> {
    /// Points of the polygon.
    pub points: u32,
    /// Whether it is closed.
    pub closed: bool,
    /// Those of the operators, and their product.
    pub of_steps: &'a StepMatrices,
    /// The powers of the local one.
    pub powers: Powers,
}

impl AskedMatrices {
    /// The matrices of the operators.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub(super) fn of(plan: &Plan, study: &Study, wish: MatricesWish) -> Result<Self, Vec<Fault>> {
        let MatricesWish { points, closed, powers } = wish;
        let bounds = [("points", points, MAX_POINTS), ("powers", powers, MAX_POWERS)];
        let faults = bounds.into_iter().filter(|(_, n, most)| !(1..=*most).contains(n)).map(|(name, n, most)| {
            Fault::new(format!("/matrices/{name}"), format!("{n} {name}; write a whole number from 1 to {most}"))
        });
        let faults: Vec<Fault> = faults.collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let fault = |error: NoMatrices| vec![Fault::new("/matrices", error.to_string())];
        if Powers::size(&study.settled).pow(2) * (powers as usize + 1) > MAX_ENTRIES {
            return Err(fault(NoMatrices::TooLarge));
        }
        let of_steps = StepMatrices::of(plan, points as usize, closed, study.levels.is_empty()).map_err(fault)?;
        Ok(Self { wish, of_steps })
    }

    /// What they are for a report on the scheme.
    pub(super) fn found(&self, report: &Report) -> FoundMatrices<'_> {
        let powers = Powers::of(&report.symbol, report.limit_mask.as_ref(), self.wish.powers);
        let MatricesWish { points, closed, .. } = self.wish;
        FoundMatrices { points, closed, of_steps: &self.of_steps, powers }
    }

    /// What of them enters a key.
    pub(super) fn item(&self) -> Item<'static> {
        let Self { wish: MatricesWish { points, closed, powers }, of_steps: StepMatrices { steps, product: _ } } = self;
        let of_one = |step: &StepMatrix| {
            let StepMatrix { letter: _, name, role: _, points, coarse } = step;
            Item::List([Item::text(name), matrix(points)].into_iter().chain(coarse.as_ref().map(matrix)).collect())
        };
        let head = [*points, u32::from(*closed), *powers].map(|n| Item::Integer(u64::from(n)));
        Item::List(head.into_iter().chain(steps.iter().map(of_one)).collect())
    }
}

fn matrix(Matrix { rows, exact }: &Matrix) -> Item<'static> {
    match exact {
        Some(exact) => Item::List(exact.iter().flatten().map(|x| Item::text(&x.to_string())).collect()),
        None => Item::Numbers(rows.concat().into()),
    }
}
