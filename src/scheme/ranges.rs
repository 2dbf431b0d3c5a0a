//! Recognises schemes with a parameter by their masks, and tells where they have the smoothness they are known for.

use crate::math::mask::Mask;

/// Entries that differ by less count as equal. It is 4,500 times the rounding error of 1 and far below the precision
/// with which the ranges are known; half or twice the value matters only that close to an end of a range.
const ENTRY_TOLERANCE: f64 = 1e-12;
/// The tension at which the four-point scheme ceases to be C1: the real root of `32 w^3 + 4 w - 1`.
///
/// Source: Hechler, Moessner and Reif, Constructive Approximation 30 (2009).
const FOUR_POINT_C1: f64 = 0.192_729_249_264_812;

/// Returns the range of the scheme with this mask, if it is one of those known here.
pub fn of(arity: u32, mask: &Mask) -> Option<Range> {
    match arity {
        2 => four_point(mask),
        3 => ternary_three_point(mask).or_else(|| ternary_four_point(mask)).or_else(|| ternary_c4(mask)),
        _ => None,
    }
}

/// A parameter of a known scheme, and the range in which the scheme has the smoothness it is known for.
#[derive(Debug)]
pub struct Range {
    scheme: &'static str,
    parameter: &'static str,
    value: f64,
    least: f64,
    most: f64,
    /// The range and what holds in it, in words.
    says: &'static str,
}

impl Range {
    /// Returns whether the parameter lies in the range, ends included.
    pub fn holds(&self) -> bool {
        self.least - ENTRY_TOLERANCE <= self.value && self.value <= self.most + ENTRY_TOLERANCE
    }

    /// Returns a sentence that names the range if the parameter lies outside it.
    pub fn warning(&self) -> Option<String> {
        let Self { scheme, parameter, says, .. } = self;
        // the mask determines the value up to rounding
        let value = (self.value * 1e12).round() / 1e12;
        (!self.holds()).then(|| format!("{scheme}: {parameter} = {value} lies outside {says}"))
    }
}

/// Returns whether the mask is symmetric about 0 with these entries from the middle outwards.
fn is(mask: &Mask, entries: &[f64]) -> bool {
    let reach = i32::try_from(entries.len()).unwrap_or(0);
    let inside = mask.first > -reach && mask.last() < reach;
    let equal = |(k, entry): (isize, &f64)| {
        [k, -k].iter().all(|&k| (mask.at(k) - entry).abs() <= ENTRY_TOLERANCE * entry.abs().max(1.0))
    };
    inside && (0..).zip(entries).all(equal)
}

fn four_point(mask: &Mask) -> Option<Range> {
    let value = 0.0 - mask.at(3);
    is(mask, &[1.0, 0.5 + value, 0.0, -value]).then_some(Range {
        scheme: "the four-point scheme",
        parameter: "w",
        value,
        least: 0.0,
        most: FOUR_POINT_C1,
        says: "0 < w < 0.19273, where its limit is C1; it is known to converge for -1/4 < w < 1/4",
    })
}

fn ternary_three_point(mask: &Mask) -> Option<Range> {
    let value = mask.at(2);
    is(mask, &[1.0, 4.0 / 3.0 - 2.0 * value, value, 0.0, value - 1.0 / 3.0]).then_some(Range {
        scheme: "the ternary three-point scheme",
        parameter: "alpha",
        value,
        least: 2.0 / 9.0,
        most: 1.0 / 3.0,
        says: "2/9 < alpha < 1/3, where its limit is C1",
    })
}

fn ternary_four_point(mask: &Mask) -> Option<Range> {
    let value = 6.0 * (-mask.at(4) - 1.0 / 18.0);
    let (inner, outer) = (13.0 / 18.0 + value / 2.0, value / 6.0);
    is(mask, &[1.0, inner, 10.0 / 9.0 - inner, 0.0, -1.0 / 18.0 - outer, -1.0 / 18.0 + outer]).then_some(Range {
        scheme: "the ternary four-point scheme",
        parameter: "mu",
        value,
        least: 1.0 / 15.0,
        most: 1.0 / 9.0,
        says: "1/15 < mu < 1/9, where its limit is C2",
    })
}

fn ternary_c4(mask: &Mask) -> Option<Range> {
    let eta = mask.at(6);
    // (1 + z + z^2)^5 (eta + (1/81 - 2 eta) z + eta z^2) from the middle outwards
    let quintic = [51.0, 45.0, 30.0, 15.0, 5.0, 1.0, 0.0];
    let at = |k: isize| quintic[usize::try_from(k.abs()).unwrap_or(0)];
    let wide = |k: isize| if k.abs() < 6 { at(k) } else { 0.0 };
    let entry = |k: isize| eta * (wide(k - 1) + wide(k + 1)) + (1.0 / 81.0 - 2.0 * eta) * wide(k);
    let entries: Vec<f64> = (0..=6).map(entry).collect();
    is(mask, &entries).then_some(Range {
        scheme: "the ternary C4 scheme",
        parameter: "eta",
        value: eta,
        least: 0.0,
        most: 1.0 / 81.0,
        says: "0 < eta < 1/81, where its limit is C4",
    })
}
