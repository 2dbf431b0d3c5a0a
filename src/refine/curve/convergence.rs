//! What is worth knowing of a plan whose parameters lie where its scheme need not converge, or need not be smooth.

use super::cycle::Cycle;
use crate::scheme::ops::Role;
use crate::scheme::plan::Plan;

/// Most points for each old one of the levels that are followed.
const MAX_ARITY: i64 = 1 << 10;
/// Entries that differ by less count as equal.
const SAME: f64 = 1e-12;
/// Where the four-point scheme ceases to be C1: the real root of `32 w^3 + 4 w - 1`.
///
/// Source: Hechler, Moessner and Reif, Constructive Approximation 30 (2009).
const FOUR_POINT_C1: f64 = 0.192_729_249_264_812;

/// Warnings about the limit of a plan on polygons, in sentences; none for plans that are no masks.
///
/// They depend on what the plan comes to, not on how it was written: a preset and its word have the same.
pub fn warnings(plan: &Plan, levels: u32) -> Vec<String> {
    // a perturbation decays, so that the plan without it decides
    let Ok(cycle) = Cycle::settled(&Plan { perturbation: None, ..plan.clone() }) else { return Vec::new() };
    if levels == 0 {
        return Vec::new();
    }
    if let Some(sentence) = sums(&cycle) {
        return vec![sentence];
    }
    let range = four_point(&cycle).or_else(|| ternary_three_point(&cycle));
    let range = range.or_else(|| ternary_four_point(&cycle)).or_else(|| ternary_c4(&cycle));
    let mut warnings: Vec<String> = range.iter().filter_map(Range::warning).collect();
    let inside = range.as_ref().is_some_and(Range::holds);
    if !inside && !contracts(&cycle) {
        let mut sentence = "the scheme is not known to converge: its differences do not shrink within the levels that \
                            were looked at"
            .to_owned();
        if plan.word.cycle.iter().any(|letter| letter.operator.role() == Role::PushBack) {
            sentence += "; with one average and a push-back it converges for kernel > 0, -2 < compensation < 2 and \
                         0 <= delta <= 1 in the limit alpha = 0";
        }
        warnings.push(sentence);
    }
    warnings
}

/// The weights of every new point sum to 1 in a scheme that converges.
fn sums(cycle: &Cycle) -> Option<String> {
    let arity = u32::try_from(cycle.arity).ok()?;
    let sums = cycle.mask.residue_sums(arity);
    let (residue, sum) = sums.iter().enumerate().find(|(_, sum)| (*sum - 1.0).abs() > 1e-9)?;
    Some(format!(
        "the scheme does not converge: the entries of its mask at {residue} modulo {arity} sum to {sum}, and a scheme \
         converges only where every such sum is 1"
    ))
}

/// Whether some number of levels shrinks the greatest difference of neighbours.
fn contracts(cycle: &Cycle) -> bool {
    let mut block = cycle.clone();
    loop {
        if differences(&block) < 1.0 {
            return true;
        }
        if block.arity * cycle.arity > MAX_ARITY {
            return false;
        }
        block = block.then(cycle);
    }
}

/// By what a cycle multiplies the greatest difference of neighbours, at most: `p'[j+1] - p'[j]` in old differences.
fn differences(cycle: &Cycle) -> f64 {
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

/// A parameter of a known scheme, and where the scheme has the smoothness it is known for.
struct Range {
    scheme: &'static str,
    parameter: &'static str,
    value: f64,
    least: f64,
    most: f64,
    /// The range and what holds there, in words.
    says: &'static str,
}

impl Range {
    fn holds(&self) -> bool {
        self.least <= self.value && self.value <= self.most
    }

    fn warning(&self) -> Option<String> {
        let Self { scheme, parameter, value, says, .. } = self;
        (!self.holds()).then(|| format!("{scheme}: {parameter} = {value} lies outside {says}"))
    }
}

/// Whether the mask is symmetric about 0 with these entries from the middle outwards.
fn is(cycle: &Cycle, arity: i64, entries: &[f64]) -> bool {
    let reach = i64::try_from(entries.len()).unwrap_or(0);
    let inside = i64::from(cycle.mask.first) > -reach && i64::from(cycle.mask.last()) < reach;
    let equal =
        |(k, entry): (i64, &f64)| [k, -k].iter().all(|&k| (cycle.at(k) - entry).abs() <= SAME * entry.abs().max(1.0));
    cycle.arity == arity && inside && (0..).zip(entries).all(equal)
}

fn four_point(cycle: &Cycle) -> Option<Range> {
    let value = 0.0 - cycle.at(3);
    is(cycle, 2, &[1.0, 0.5 + value, 0.0, -value]).then_some(Range {
        scheme: "the four-point scheme",
        parameter: "w",
        value,
        least: 0.0,
        most: FOUR_POINT_C1,
        says: "0 < w < 0.19273, where its limit is C1; it is known to converge for -1/4 < w < 1/4",
    })
}

fn ternary_three_point(cycle: &Cycle) -> Option<Range> {
    let value = cycle.at(2);
    is(cycle, 3, &[1.0, 4.0 / 3.0 - 2.0 * value, value, 0.0, value - 1.0 / 3.0]).then_some(Range {
        scheme: "the ternary three-point scheme",
        parameter: "alpha",
        value,
        least: 2.0 / 9.0,
        most: 1.0 / 3.0,
        says: "2/9 < alpha < 1/3, where its limit is C1",
    })
}

fn ternary_four_point(cycle: &Cycle) -> Option<Range> {
    let value = 6.0 * (-cycle.at(4) - 1.0 / 18.0);
    let (inner, outer) = (13.0 / 18.0 + value / 2.0, value / 6.0);
    is(cycle, 3, &[1.0, inner, 10.0 / 9.0 - inner, 0.0, -1.0 / 18.0 - outer, -1.0 / 18.0 + outer]).then_some(Range {
        scheme: "the ternary four-point scheme",
        parameter: "mu",
        value,
        least: 1.0 / 15.0,
        most: 1.0 / 9.0,
        says: "1/15 < mu < 1/9, where its limit is C2",
    })
}

fn ternary_c4(cycle: &Cycle) -> Option<Range> {
    let eta = cycle.at(6);
    // (1 + z + z^2)^5 (eta + (1/81 - 2 eta) z + eta z^2) from the middle outwards
    let quintic = [51.0, 45.0, 30.0, 15.0, 5.0, 1.0, 0.0];
    let at = |k: i64| quintic[usize::try_from(k.abs()).unwrap_or(0)];
    let wide = |k: i64| if k.abs() < 6 { at(k) } else { 0.0 };
    let entry = |k: i64| eta * (wide(k - 1) + wide(k + 1)) + (1.0 / 81.0 - 2.0 * eta) * wide(k);
    let entries: Vec<f64> = (0..=6).map(entry).collect();
    is(cycle, 3, &entries).then_some(Range {
        scheme: "the ternary C4 scheme",
        parameter: "eta",
        value: eta,
        least: 0.0,
        most: 1.0 / 81.0,
        says: "0 < eta < 1/81, where its limit is C4",
    })
}
