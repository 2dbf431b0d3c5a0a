//! A plan as a curve scheme: one mask, or the masks of its levels and the mask to which they converge.

use crate::analysis::curve::{Cycle, ExactCycle, NoMask, is_static};
use crate::analysis::smoothness::Symbol;
use crate::math::functions::{cos, sin, sqrt};
use crate::math::mask::Mask;
use crate::math::number::Number;
use crate::scheme::operator::Role;
use crate::scheme::plan::Plan;
use crate::watch::Watch;

/// Longest masks that are analysed.
/// Those of clients have 129 entries at most. Half of it refuses cycles of three upsamplings and many averages; twice
/// of it takes eight times as long.
const MAX_ENTRIES: usize = 512;
/// Most levels that are listed.
/// Cosines of an angle that is halved come four times as close at each level, 16 of them to 1e-9 of where they were.
/// Half of it shows less of how they do; twice of it lists masks that differ in their last digits.
const MAX_LEVELS: u32 = 16;
/// Masks that differ by less count as equal.
/// It is some five roundings of 1; half of it lists levels that differ by rounding, twice of it leaves out one that
/// does not.
const SAME: f64 = 1e-15;
/// What a symbol may leave at a zero, over the sum of its coefficients' sizes.
/// It is some thousand roundings; half of it misses zeros of long masks, twice of it takes one for a zero that is twice
/// as far away.
const ZERO: f64 = 1e-12;
/// Levels whose distances from the settled scheme tell how these go on.
/// Half of it takes one pair for a rule; twice of it counts levels of angles that are not small yet.
const LAST: usize = 3;
/// Below what a factor of distances, times powers of the arity, counts as below 1.
/// Distances of functions with derivatives at 0 shrink by powers of 1/d, so that it is 1/2 at most, or 1 at least, up
/// to the terms of higher order; roots of alpha come to 0.71. Half of it refuses the latter C^k at the first k beyond
/// the sum rules; twice of it would let 1 count.
const SHRINKS: f64 = 0.9;

/// A plan as a curve scheme.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The scheme, or the one that those of the levels come close to.
    pub settled: Symbol,
    /// The schemes of the levels, where they change.
    pub levels: Vec<Level>,
}

/// The scheme of one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// The parameter spacing that entered its upsampling, radians.
    pub alpha: f64,
    /// Its mask.
    pub mask: Mask,
    /// The order of its sum rules.
    pub order: usize,
    /// The norm of its difference from the settled scheme.
    pub distance: f64,
    /// Whether cosine and sine with this spacing are refined to combinations of themselves.
    pub keeps_circles: bool,
}

impl Study {
    /// What a plan on polygons comes to.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn of(plan: &Plan, watch: &Watch) -> Result<Self, NoMask> {
        let cycle = Cycle::settled(plan, watch)?;
        if cycle.mask.values.len() > MAX_ENTRIES {
            return Err(NoMask::TooWide);
        }
        let exact = ExactCycle::settled(plan);
        let pushes_back = plan.word.cycle.iter().any(|letter| letter.facts().role == Role::PushBack);
        let exact = exact.and_then(|cycle| {
            let symbol = Symbol::exact(cycle.arity, cycle.first, &cycle.mask)?;
            // a push-back reaches as far whatever its parameters are
            Some(if pushes_back { symbol.reaching(cycle.first, cycle.mask.len()) } else { symbol })
        });
        let settled = exact.or_else(|| Symbol::beside(cycle.arity, &cycle.mask)).ok_or(NoMask::Unsettled)?;
        let levels = if is_static(plan) { Vec::new() } else { levels(plan, &cycle, watch)? };
        Ok(Self { settled, levels })
    }

    /// The largest k for which limits are proved to be C^k, where those of the settled scheme are C^proved, and its
    /// differences shrink that prove C^contracts: C^proved where levels do not change. Else limits are C^k where masks
    /// come close to that of a scheme whose differences of order k + 1 shrink, and levels have approximate sum rules of
    /// order k + 1: derivatives of the symbol at the other d-th roots of 1, of order j and at level h, are `e(h, j)`,
    /// and the sum of `d^(h (k - j)) e(h, j)` over all levels is finite for j up to k. With r sum rules at every level
    /// these are 0 for j < r, and with distances that shrink by gamma the others are finite where `gamma d^(k - r)` is
    /// below 1.
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
            Ok(missing) => gamma.is_some_and(|gamma| (0..missing).fold(gamma, |x, _| x * d) < SHRINKS),
        };
        (0..=contracts).rev().find(|&k| has_rules(k)).unwrap_or(-1)
    }

    /// The least order of the sum rules of the levels and of the settled scheme.
    pub fn sum_rules(&self) -> i64 {
        let orders = self.levels.iter().map(|level| level.order).chain([self.settled.order]);
        orders.min().and_then(|order| i64::try_from(order).ok()).unwrap_or(0)
    }

    /// The largest factor by which distances shrink at the last few levels that can be told from rounding.
    fn slowest(&self) -> Option<f64> {
        self.rates().take(LAST).reduce(f64::max)
    }

    /// By what the distances of levels from the settled scheme are divided at the next, the last ones first, as far as
    /// they can be told from rounding.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let pairs = self.levels.windows(2).map(|pair| (pair[0].distance, pair[1].distance));
        pairs.rev().filter(|(_, next)| *next > 1e-9).map(|(before, next)| next / before)
    }

    /// By what the distance of a level from the settled scheme is divided at the next, as the last levels show that
    /// can be told from rounding.
    pub fn rate(&self) -> Option<f64> {
        self.rates().next()
    }
}

fn levels(plan: &Plan, settled: &Cycle, watch: &Watch) -> Result<Vec<Level>, NoMask> {
    let mut found = Vec::new();
    for level in 0..MAX_LEVELS {
        let cycle = Cycle::of(plan, level, watch)?;
        let steps = plan.schedule(level + 1).map_err(|fault| NoMask::NoValue(fault.detail))?;
        let alpha = steps.iter().find(|step| step.level == level + 1).map_or(0.0, |step| step.alpha);
        let distance = distance(&cycle, settled);
        let order = Symbol::beside(cycle.arity, &cycle.mask).map_or(0, |symbol| symbol.order);
        let keeps_circles = keeps_circles(&cycle, alpha);
        found.push(Level { alpha, mask: cycle.mask, order, distance, keeps_circles });
    }
    // only what comes after the last one that differs has settled
    found.truncate(found.iter().rposition(|level| level.distance > SAME).map_or(0, |last| last + 1));
    Ok(found)
}

/// The norm of the difference: the greatest sum of sizes in a residue class.
fn distance(a: &Cycle, b: &Cycle) -> f64 {
    let first = a.mask.first.min(b.mask.first);
    let last = a.mask.last().max(b.mask.last());
    let difference = |j: i32| (a.at(j.into()) - b.at(j.into())).abs();
    let class = |r: i64| (first..=last).filter(|&j| i64::from(j).rem_euclid(a.arity) == r).map(difference).sum::<f64>();
    (0..a.arity).map(class).fold(0.0, f64::max)
}

/// Whether the symbol vanishes at all other d-th roots that `exp(i alpha)` has beside `exp(i alpha / d)`.
fn keeps_circles(cycle: &Cycle, alpha: f64) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "arities are small")]
    let (d, count) = (cycle.arity as f64, cycle.arity);
    let size: f64 = cycle.mask.values.iter().map(|a| a.abs()).sum();
    (1..count).all(|turn| {
        #[expect(clippy::cast_precision_loss, reason = "arities are small")]
        let angle = (alpha + 2.0 * std::f64::consts::PI * turn as f64) / d;
        let part = |function: fn(f64) -> f64| -> f64 {
            (cycle.mask.first..).zip(&cycle.mask.values).map(|(j, a)| a * function(f64::from(j) * angle)).sum()
        };
        let (re, im) = (part(cos), part(sin));
        sqrt(re * re + im * im) <= ZERO * size
    })
}
