//! A plan as a curve scheme: one mask, or the masks of its levels and the mask to which they converge.

use crate::analysis::curve::{CycleMask, ExactCycle, NoMask, is_static};
use crate::analysis::smoothness::Symbol;
use crate::math::functions::{cos, sin, sqrt};
use crate::math::mask::Mask;
use crate::math::number::Number;
use crate::scheme::operator::Role;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Maximum number of entries of the masks that are analysed. Masks from clients have 129 entries at most. Half of it
/// would refuse cycles of three upsamplings and many averages; twice of it would take eight times as long.
const MAX_STUDIED_ENTRIES: usize = 512;
/// Maximum number of levels that are listed. Cosines of an angle that is halved come four times as close to their limit
/// at each level, after 16 levels to within 1e-9. Half as many would show less of the convergence; twice as many would
/// list masks that differ only in their last digits.
const MAX_LISTED_LEVELS: u32 = 16;
/// Largest difference at which masks are regarded as equal, some five roundings of 1. Half of it would list levels that
/// differ by rounding only; twice of it would omit a level that differs.
const LISTED_MASK_DISTANCE: f64 = 1e-15;
/// Largest value of a symbol at a zero, relative to the sum of the absolute values of its coefficients; some thousand
/// roundings. Half of it would miss zeros of long masks; twice of it would accept zeros that are twice as far away.
const SYMBOL_ZERO: f64 = 1e-12;
/// Number of last levels whose distances from the limit scheme predict the distances that follow. Half of it would take
/// a single pair as a rule; twice of it would include levels at which angles are not small yet.
const PREDICTING_LEVELS: usize = 3;
/// Largest product of a decay factor and powers of the arity that is regarded as below 1. Distances of functions with
/// derivatives at 0 shrink by powers of 1/d, so that the product is 1/2 at most, or 1 at least, up to terms of higher
/// order; roots of alpha give 0.71. Half of it would refuse these roots C^k at the first k beyond the sum rules; twice
/// of it would admit 1.
const MAX_DECAY_PRODUCT: f64 = 0.9;
/// Distance from the limit scheme from which on it can be told from rounding: the rounding of masks leaves some six
/// digits of it. Half of it leaves a third of a digit less, and twice of it more; either counts a level more or less
/// where distances halve from level to level.
pub(super) const LEAST_SCHEME_DISTANCE: f64 = 1e-9;

/// A plan as a curve scheme.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The scheme, or the limit of the schemes of the levels if they change.
    pub settled: Symbol,
    /// The schemes of the levels, if they change.
    pub levels: Vec<LevelMask>,
}

/// The scheme of one level.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelMask {
    /// The parameter spacing that enters the upsampling, radians.
    pub alpha: f64,
    /// The mask of the level.
    pub mask: Mask,
    /// The order of the sum rules of the mask.
    pub order: usize,
    /// The norm of the difference between the mask and that of the limit scheme.
    pub distance: f64,
    /// Whether cosine and sine with the spacing `alpha` are refined to combinations of themselves.
    pub keeps_circles: bool,
}

impl Study {
    /// Resolves a plan on polygons to its curve scheme.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn of(plan: &Plan, watch: &Watch) -> Result<Self, NoMask> {
        let cycle = CycleMask::settled(plan, watch)?;
        if cycle.mask.values.len() > MAX_STUDIED_ENTRIES {
            return Err(NoMask::TooWide);
        }
        let exact = ExactCycle::settled(plan);
        let pushes_back = plan.word.cycle.iter().any(|letter| letter.facts().role == Role::PushBack);
        let exact = exact.and_then(|cycle| {
            let symbol = Symbol::exact(cycle.arity, cycle.first, &cycle.mask)?;
            // the reach of a push-back does not depend on its parameters
            Some(if pushes_back { symbol.reaching(cycle.first, cycle.mask.len()) } else { symbol })
        });
        let settled = exact.or_else(|| Symbol::beside(cycle.arity, &cycle.mask)).ok_or(NoMask::Unsettled)?;
        let levels = if is_static(plan) { Vec::new() } else { levels(plan, &cycle, watch)? };
        Ok(Self { settled, levels })
    }

    /// Returns the largest k for which limits are proved to be C^k, given that limits of the limit scheme are C^proved
    /// and that its contracting differences prove C^contracts. If the levels do not change, this is `proved`. Otherwise
    /// limits are C^k if the masks converge to that of a scheme whose differences of order k + 1 contract, and the
    /// levels have approximate sum rules of order k + 1: with `e(h, j)` the derivative of order j of the symbol of
    /// level h at the other d-th roots of 1, the sum of `d^(h (k - j)) e(h, j)` over all levels is finite for each j up
    /// to k. With r sum rules at every level `e(h, j)` is 0 for j < r; with distances that shrink by the factor gamma
    /// the other sums are finite if `gamma d^(k - r)` is below 1.
    ///
    /// Source: Charina, Conti, Guglielmi and Protasov, Numerische Mathematik 135 (2017), 639-678, theorem 2.
    pub fn concluded(&self, proved: i64, contracts: i64) -> i64 {
        if self.levels.is_empty() {
            return proved;
        }
        let gamma = self.slowest();
        if gamma.is_some_and(|gamma| gamma >= 1.0) {
            return -1;
        }
        let (rules, d) = (self.sum_rules(), f64::whole(self.settled.arity));
        let has_rules = |k: i64| match u32::try_from(k - rules) {
            Err(_) => true,
            Ok(missing) => gamma.is_some_and(|gamma| (0..missing).fold(gamma, |x, _| x * d) < MAX_DECAY_PRODUCT),
        };
        (0..=contracts).rev().find(|&k| has_rules(k)).unwrap_or(-1)
    }

    /// Returns the least order of the sum rules of the levels and of the limit scheme.
    pub fn sum_rules(&self) -> i64 {
        let orders = self.levels.iter().map(|level| level.order).chain([self.settled.order]);
        orders.min().and_then(|order| i64::try_from(order).ok()).unwrap_or(0)
    }

    /// Returns the largest of the last few factors of [`Self::rates`].
    fn slowest(&self) -> Option<f64> {
        self.rates().take(PREDICTING_LEVELS).reduce(f64::max)
    }

    /// Returns the ratios of the distances of consecutive levels from the limit scheme, the last level first, without
    /// distances that cannot be told from rounding.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let pairs = self.levels.windows(2).map(|pair| (pair[0].distance, pair[1].distance));
        pairs.rev().filter(|(_, next)| *next > LEAST_SCHEME_DISTANCE).map(|(before, next)| next / before)
    }

    /// Returns the ratio of the last two distances from the limit scheme that can be told from rounding.
    pub fn rate(&self) -> Option<f64> {
        self.rates().next()
    }
}

fn levels(plan: &Plan, settled: &CycleMask, watch: &Watch) -> Result<Vec<LevelMask>, NoMask> {
    let mut found = Vec::new();
    for level in 0..MAX_LISTED_LEVELS {
        let cycle = CycleMask::of(plan, level, watch)?;
        let steps = plan.schedule(level + 1).map_err(|fault| NoMask::NoValue(fault.detail))?;
        let alpha = steps.iter().find(|step| step.level == level + 1).map_or(0.0, |step| step.alpha);
        let distance = distance(&cycle, settled);
        let order = Symbol::beside(cycle.arity, &cycle.mask).map_or(0, |symbol| symbol.order);
        let keeps_circles = keeps_circles(&cycle, alpha);
        found.push(LevelMask { alpha, mask: cycle.mask, order, distance, keeps_circles });
    }
    // levels after the last one that differs have converged
    found.truncate(found.iter().rposition(|level| level.distance > LISTED_MASK_DISTANCE).map_or(0, |last| last + 1));
    Ok(found)
}

/// Returns the norm of the difference of two masks: the greatest sum of absolute values in a residue class.
fn distance(a: &CycleMask, b: &CycleMask) -> f64 {
    let first = a.mask.first.min(b.mask.first);
    let last = a.mask.last().max(b.mask.last());
    let difference = |j: i32| (a.at(j.into()) - b.at(j.into())).abs();
    let class = |r: i64| (first..=last).filter(|&j| i64::from(j).rem_euclid(a.arity) == r).map(difference).sum::<f64>();
    (0..a.arity).map(class).fold(0.0, f64::max)
}

/// Returns whether the symbol vanishes at all d-th roots of `exp(i alpha)` other than `exp(i alpha / d)`.
fn keeps_circles(cycle: &CycleMask, alpha: f64) -> bool {
    let (d, count) = (f64::whole(cycle.arity), cycle.arity);
    let size: f64 = cycle.mask.values.iter().map(|a| a.abs()).sum();
    (1..count).all(|turn| {
        let angle = (alpha + 2.0 * std::f64::consts::PI * f64::whole(turn)) / d;
        let part = |function: fn(f64) -> f64| -> f64 {
            (cycle.mask.first..).zip(&cycle.mask.values).map(|(j, a)| a * function(f64::from(j) * angle)).sum()
        };
        let (re, im) = (part(cos), part(sin));
        sqrt(re * re + im * im) <= SYMBOL_ZERO * size
    })
}
