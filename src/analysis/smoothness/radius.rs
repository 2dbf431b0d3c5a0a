//! Bounds of the joint spectral radius of arbitrary exact matrices, for schemes other than curve schemes.

use num_traits::Zero;

use super::lower::{self, Lower, LowerSearch};
use super::matrices::ExactMatrix;
use super::upper::{self, Upper};
use crate::math::exact::Exact;
use crate::watch::{Stopped, Watch};

/// Bounds of a joint spectral radius.
#[derive(Debug, Clone, PartialEq)]
pub struct RadiusBounds {
    /// The lower bound; `None` if no eigenvalue of a product is proved.
    pub lower: Option<Lower>,
    /// The upper bound.
    pub upper: Upper,
}

/// Computes bounds with at most `budget` matrix products; the search for the upper bound also attempts values just
/// below the `thresholds`.
///
/// # Errors
/// [`Stopped`].
pub(in crate::analysis) fn radius_bounds(
    matrices: &[ExactMatrix],
    thresholds: &[Exact],
    budget: u64,
    watch: &Watch,
) -> Result<RadiusBounds, Stopped> {
    let LowerSearch { first, best: lower, nodes } = lower::search(matrices, budget, watch)?;
    watch.check()?;
    // without a proved eigenvalue, the ladder of bounds depends on the thresholds alone
    let least = thresholds.iter().min().cloned().unwrap_or_else(Exact::zero);
    let known = first.unwrap_or_else(|| Lower::of_one(least / Exact::from_integer(4.into())));
    let upper = upper::bound(matrices, &known, thresholds, budget - nodes, watch)?;
    Ok(RadiusBounds { lower, upper: upper.after(nodes) })
}
