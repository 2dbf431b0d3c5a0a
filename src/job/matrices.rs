//! The matrices of one step that a client requests.

use super::codec::Item;
use crate::analysis::Study;
use crate::analysis::matrices::{MAX_MATRIX_ENTRIES, Matrix, NoMatrices, StepMatrices, StepMatrix};
use crate::analysis::smoothness::{Powers, SmoothnessReport};
use crate::fault::Fault;
use crate::scheme::plan::Plan;

/// Maximum number of points of the polygon; larger matrices are unreadable. Half as many would suffice only for masks
/// of up to nine entries; twice as many would make answers four times as long.
pub(super) const MAX_MATRIX_POINTS: u32 = 16;
/// Maximum number of powers of the local matrix. The eighth power of a smooth scheme differs from the limit by 1/256.
/// Half as many would show less of the convergence; twice as many would have fractions of many digits.
pub(super) const MAX_POWERS: u32 = 8;

/// The polygon whose matrices are requested, and the number of powers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RequestedMatrices {
    /// Number of points of the polygon.
    pub points: u32,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Number of powers of the local matrix.
    pub powers: u32,
}

/// The matrices of a request, checked.
#[derive(Debug, Clone)]
pub(super) struct AskedMatrices {
    requested: RequestedMatrices,
    of_steps: StepMatrices,
}

/// The matrices that were found.
#[derive(Debug, Clone)]
pub struct FoundMatrices<'a> {
    /// Number of points of the polygon.
    pub points: u32,
    /// Whether it is closed.
    pub closed: bool,
    /// The matrices of the operators, and their product.
    pub of_steps: &'a StepMatrices,
    /// The powers of the local matrix.
    pub powers: Powers,
}

impl AskedMatrices {
    /// Computes the matrices of the operators.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub(super) fn of(plan: &Plan, study: &Study, requested: RequestedMatrices) -> Result<Self, Vec<Fault>> {
        let RequestedMatrices { points, closed, powers } = requested;
        let bounds = [("points", points, MAX_MATRIX_POINTS), ("powers", powers, MAX_POWERS)];
        let faults = bounds.into_iter().filter(|(_, n, most)| !(1..=*most).contains(n)).map(|(name, n, most)| {
            Fault::new(format!("/matrices/{name}"), format!("{n} {name}; write a whole number from 1 to {most}"))
        });
        let faults: Vec<Fault> = faults.collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let fault = |error: NoMatrices| vec![Fault::new("/matrices", error.to_string())];
        if Powers::size(&study.settled).pow(2) * (powers as usize + 1) > MAX_MATRIX_ENTRIES {
            return Err(fault(NoMatrices::TooLarge));
        }
        let of_steps = StepMatrices::of(plan, points as usize, closed, study.levels.is_empty()).map_err(fault)?;
        Ok(Self { requested, of_steps })
    }

    /// Returns the matrices for a report on the scheme.
    pub(super) fn found(&self, report: &SmoothnessReport) -> FoundMatrices<'_> {
        let powers = Powers::of(&report.symbol, report.limit_mask.as_ref(), self.requested.powers);
        let RequestedMatrices { points, closed, .. } = self.requested;
        FoundMatrices { points, closed, of_steps: &self.of_steps, powers }
    }

    /// Returns the item of the request for a key.
    pub(super) fn item(&self) -> Item<'static> {
        let Self {
            requested: RequestedMatrices { points, closed, powers },
            of_steps: StepMatrices { steps, product: _ },
        } = self;
        let of_one = |step: &StepMatrix| {
            let StepMatrix { letter: _, name, role: _, sets_anchor: _, points, coarse } = step;
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
