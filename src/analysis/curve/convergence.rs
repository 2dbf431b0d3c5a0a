//! Warnings for plans with parameters for which the scheme may not converge, or may not be smooth.

use super::cycle::{CycleMask, NoMask, SUM_TOLERANCE};
use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::Plan;
use crate::scheme::ranges::{self, Range};
use crate::watch::{Stopped, Watch};

/// Maximum number of new points per old point of the levels that are combined: ten binary levels. Half of it combines
/// nine and reports more schemes as not known to converge; twice of it combines eleven, whose masks are twice as long.
const MAX_ARITY: i64 = 1 << 10;

/// Returns warnings about the limit of a plan on polygons, as sentences; none for plans that are not one mask per
/// level.
///
/// The warnings depend on the mask of the plan, not on how it was written: a preset and its word get the same warnings.
///
/// # Errors
/// [`Stopped`].
pub fn warnings(plan: &Plan, levels: u32, watch: &Watch) -> Result<Vec<String>, Stopped> {
    if levels == 0 {
        return Ok(Vec::new());
    }
    // a perturbation decays, so that the plan without it decides
    let cycle = match CycleMask::settled(&Plan { perturbation: None, ..plan.clone() }, watch) {
        Ok(cycle) => cycle,
        Err(NoMask::Stopped(stopped)) => return Err(stopped),
        Err(_) => return Ok(Vec::new()),
    };
    if let Some(sentence) = sums(&cycle) {
        return Ok(vec![sentence]);
    }
    let range = u32::try_from(cycle.arity).ok().and_then(|arity| ranges::of(arity, &cycle.mask));
    // a cycle of several operators is judged by its contraction, not by the range of a single mask
    let alone = |letter: &Letter| letter.settings.mask().is_some() || cycle.arity == 2;
    let range = range.filter(|_| plan.word.cycle.first().is_some_and(alone));
    let mut warnings: Vec<String> = range.iter().filter_map(Range::warning).collect();
    let inside = range.as_ref().is_some_and(Range::holds);
    if !inside && !contracts(&cycle, watch)? {
        let mut sentence = "the scheme is not known to converge: its differences do not shrink within the levels that \
                            were looked at"
            .to_owned();
        // operators without a letter belong to presets, whose parameters differ from those of words
        let of_words = |letter: &Letter| letter.facts().role == Role::PushBack && letter.facts().letter.is_some();
        if plan.word.cycle.iter().any(of_words) {
            sentence += "; with one average and a push-back it converges for kernel > 0, -2 < compensation < 2 and \
                         0 <= delta <= 1 in the limit alpha = 0";
        }
        warnings.push(sentence);
    }
    Ok(warnings)
}

/// Returns a sentence if the weights of some new point do not sum to 1, as they do in every convergent scheme.
fn sums(cycle: &CycleMask) -> Option<String> {
    let arity = u32::try_from(cycle.arity).ok()?;
    let sums = cycle.mask.residue_sums(arity);
    let (residue, sum) = sums.iter().enumerate().find(|(_, sum)| (*sum - 1.0).abs() > SUM_TOLERANCE)?;
    Some(format!(
        "the scheme does not converge: the entries of its mask at {residue} modulo {arity} sum to {sum}, and a scheme \
         converges only where every such sum is 1"
    ))
}

/// Returns whether some number of levels shrinks the greatest difference of neighbouring points.
fn contracts(cycle: &CycleMask, watch: &Watch) -> Result<bool, Stopped> {
    let mut block = cycle.clone();
    loop {
        if differences(&block) < 1.0 {
            return Ok(true);
        }
        if block.arity * cycle.arity > MAX_ARITY {
            return Ok(false);
        }
        block = block.then(cycle, watch)?;
    }
}

/// Returns an upper bound of the factor by which a cycle multiplies the greatest difference of neighbouring points: the
/// norm of `p'[j+1] - p'[j]` written in old differences.
fn differences(cycle: &CycleMask) -> f64 {
    let (d, mask) = (cycle.arity, &cycle.mask);
    let (low, high) = (i64::from(mask.first), i64::from(mask.last()));
    let norm = |j: i64| {
        let first = -(high - j).div_euclid(d);
        let last = (j + 1 - low).div_euclid(d);
        let mut running = 0.0;
        let mut sum = 0.0;
        for i in first..=last {
            running += cycle.at(j + 1 - d * i) - cycle.at(j - d * i);
            sum += f64::abs(running);
        }
        sum
    };
    (0..d).map(norm).fold(0.0, f64::max)
}
