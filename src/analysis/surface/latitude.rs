//! The effect of a plan on points along and across latitude lines.

use super::local::Applied;
use super::regular::RegularMask;
use super::sectors::NetKind;
use super::smoothness::symbol;
use crate::analysis::limit::Unlimited;
use crate::analysis::smoothness::Symbol;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Returns the curve schemes along and across latitude lines, at alpha = 0, of a plan that uses latitude tags.
///
/// # Errors
/// [`Unlimited`] if a regular net cannot be refined.
pub fn latitude_curves(plan: &Plan, watch: &Watch) -> Result<[Symbol; 2], Unlimited> {
    let applied = Applied::new(plan, NetKind::Quads, watch)?;
    let regular = RegularMask::of(&applied, watch)?;
    let symbols = regular.curves().and_then(|curves| {
        let [along, across] = curves.map(|mask| symbol(regular.arity, &mask));
        Some([along?, across?])
    });
    symbols.ok_or(Unlimited::Unsettled)
}
