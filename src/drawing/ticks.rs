//! Round numbers along an axis.

use super::font::FontWeight;
use super::label::Label;

/// A round number and how it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The number.
    pub value: f64,
    /// How it is written.
    pub label: Label,
}

/// Digits before the point, and after it, up to which numbers are written out; beyond them stands a power of ten,
/// unless that is longer. Twice of it does not fit beside an axis, half of it writes thousands as powers.
const WRITTEN_OUT: [i32; 2] = [6, 5];
/// Digits of the longest number. Where a range is so small beside its numbers that these need more, as where they
/// differ by rounding alone, one of them says it; twice of it would print all digits that a number has.
const MAX_TICK_DIGITS: u32 = 10;
/// Digits of a number that stands alone, which are exact.
const DIGITS_ALONE: u32 = 15;
/// Share of a step by which an end of an axis may miss a tick, for rounding. Half and twice of it show the same ticks;
/// a share that is seen would show ticks beyond the axis.
const TICK_SLACK: f64 = 1e-9;

/// The multiples of 1, 2 or 5 times a power of ten between two numbers: at most `most` of them, which is 2 or more,
/// with the smallest such step, all written in one form. A range without extent, or one that is not finite, has none.
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let most = most.max(2);
    if !(low.is_finite() && high.is_finite() && low < high && (high - low).is_finite()) {
        return Vec::new();
    }
    #[expect(clippy::cast_precision_loss, reason = "a few ticks")]
    let least = exponent((high - low) / most as f64);
    let greatest = exponent(low.abs().max(high.abs()));
    let steps = || (least - 1..=greatest.max(least) + 2).flat_map(|e| [(1, e), (2, e), (5, e)]);
    let within = |(digit, exponent): (i64, i32), digits: u32| {
        let step = number(digit, exponent);
        // the ends count where they are off by rounding alone
        let slack = TICK_SLACK * step;
        let [first, last] = [((low - slack) / step).ceil(), ((high + slack) / step).floor()];
        #[expect(clippy::cast_precision_loss, reason = "a few ticks, and powers of ten that are exact")]
        let (few, longest) = (last - first < most as f64, 10_i64.pow(digits) as f64);
        let fits = step > 0.0 && few && first <= last && first.abs().max(last.abs()) < longest / number(digit, 0);
        #[expect(clippy::cast_possible_truncation, reason = "checked to be below a power of ten")]
        let multiples = || ((first as i64..=last as i64).map(|i| i * digit).collect(), exponent);
        fits.then(multiples)
    };
    let usual = steps().find_map(|step| within(step, MAX_TICK_DIGITS));
    let alone = || {
        let (multiples, exponent): (Vec<i64>, i32) = steps().find_map(|step| within(step, DIGITS_ALONE))?;
        Some((vec![multiples[multiples.len() / 2]], exponent))
    };
    let Some((multiples, exponent)) = usual.or_else(alone) else { return Vec::new() };
    let tick = |(multiple, text): (&i64, String)| {
        let label = Label::parse(&text.replace('-', "\u{2212}"), FontWeight::Regular).ok()?;
        Some(Tick { value: number(*multiple, exponent), label })
    };
    multiples.iter().zip(written(&multiples, exponent)).filter_map(tick).collect()
}

/// The decimal exponent of a positive number.
fn exponent(x: f64) -> i32 {
    let text = format!("{x:e}");
    text.split_once('e').and_then(|(_, digits)| digits.parse().ok()).unwrap_or(0)
}

/// `digits 10^exponent`, correctly rounded.
fn number(digits: i64, exponent: i32) -> f64 {
    format!("{digits}e{exponent}").parse().unwrap_or(0.0)
}

/// Returns the texts of multiples of a power of ten: all as decimals, or all with the same power of ten and as many
/// decimals.
fn written(multiples: &[i64], exponent: i32) -> Vec<String> {
    let zeros = (0..18).take_while(|&n| multiples.iter().all(|m| m % 10_i64.pow(n + 1) == 0)).count();
    let is_zero = multiples.iter().all(|m| *m == 0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "at most 18")]
    let zeros = if is_zero { 0 } else { zeros as i32 };
    let unit = 10_i64.pow(zeros.unsigned_abs());
    let greatest = multiples.iter().map(|m| (m / unit).abs()).max().unwrap_or(0);
    #[expect(clippy::cast_possible_wrap, reason = "at most 19 digits")]
    let (n_digits, last) = (greatest.checked_ilog10().unwrap_or(0) as i32 + 1, exponent + zeros);
    // the power of ten of the first digit of the greatest number
    let power = last + n_digits - 1;
    let [before, after] = [(power + 1).max(1), (-last).max(0)];
    let are_short = before <= WRITTEN_OUT[0] && after <= WRITTEN_OUT[1];
    let is_plain = is_zero || are_short || before + after <= n_digits + 4;
    let text = |multiple: &i64| match multiple / unit {
        0 => "0".to_owned(),
        digits if is_plain => decimals(digits, last),
        1 if n_digits == 1 => format!("10^{{{power}}}"),
        -1 if n_digits == 1 => format!("-10^{{{power}}}"),
        digits => format!("{}×10^{{{power}}}", decimals(digits, 1 - n_digits)),
    };
    multiples.iter().map(text).collect()
}

/// `digits 10^exponent` without a power.
fn decimals(digits: i64, exponent: i32) -> String {
    let sign = if digits < 0 { "-" } else { "" };
    let digits = digits.abs();
    if exponent >= 0 {
        let zeros = if digits == 0 { 0 } else { usize::try_from(exponent).unwrap_or(0) };
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let after = usize::try_from(-exponent).unwrap_or(0);
    let text = format!("{digits:0>width$}", width = after + 1);
    let (whole, rest) = text.split_at(text.len() - after);
    format!("{sign}{whole}.{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, most: usize) -> String {
        let texts: Vec<String> = ticks(low, high, most).iter().map(|tick| tick.label.text()).collect();
        texts.join(" ")
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(0.0, 1.0, 6), "0 0.2 0.4 0.6 0.8 1.0");
        assert_eq!(labels(0.0, 1.2e-6, 4), "0 0.5×10−6 1.0×10−6");
        assert_eq!(labels(-3.2, 7.9, 6), "−2 0 2 4 6");
        assert_eq!(labels(0.12, 0.13, 5), "0.120 0.125 0.130");
        assert_eq!(labels(0.0, 4e7, 5), "0 107 2×107 3×107 4×107");
        assert_eq!(labels(-1e-9, 1e-9, 3), "−10−9 0 10−9");
        assert_eq!(labels(0.0, 30_000.0, 4), "0 10000 20000 30000");
    }

    #[test]
    fn numbers_that_differ_by_rounding_are_written_once() {
        assert_eq!(labels(1.0, 1.0 + 4e-16, 6), "1");
        assert_eq!(labels(0.25 - 1e-13, 0.25 + 1e-13, 6), "0.25");
        assert_eq!(labels(99_999.999_9, 100_000.000_1, 3), "99999.9999 100000.0000 100000.0001");
        assert_eq!(labels(1_000_000.001, 1_000_000.002, 4), "1000000.001 1000000.002");
    }

    /// The number that a text stands for.
    fn read(text: &str) -> f64 {
        let text = text.replace("×10^{", "e").replace("-10^{", "-1e").replace("10^{", "1e").replace('}', "");
        text.parse().expect("a number")
    }

    proptest::proptest! {
        #[test]
        fn ticks_are_distinct_and_mean_what_they_say(
            (digit, exponent) in (-9.999_f64..9.999, -280_i32..300), share in -14_i32..3, most in 2_usize..12,
        ) {
            let low: f64 = format!("{digit}e{exponent}").parse().expect("a number");
            let high: f64 = low + low.abs() * format!("1e{share}").parse::<f64>().expect("a number");
            let found = ticks(low, high, most);
            proptest::prop_assert!(found.len() <= most);
            proptest::prop_assert!(found.is_sorted_by(|a, b| a.value < b.value));
            proptest::prop_assert!(high <= low || !found.is_empty() || share < -13, "{low:e} {high:e}");
            let mut texts: Vec<String> = found.iter().map(|tick| tick.label.text()).collect();
            proptest::prop_assert!(texts.iter().all(|text| text.chars().count() <= 24), "{texts:?}");
            texts.sort();
            texts.dedup();
            proptest::prop_assert_eq!(texts.len(), found.len());
            // multiples are counted in f64, to one in 10^15
            let slack = 1e-8 * (high - low) + 1e-15 * low.abs();
            for tick in &found {
                proptest::prop_assert!(low - slack <= tick.value && tick.value <= high + slack);
            }
        }

        #[test]
        fn texts_say_the_multiples(first in -99_999_i64..99_999, step in 1_i64..500, exponent in -300_i32..290) {
            let multiples = [first, first + step, first + 2 * step];
            let texts = written(&multiples, exponent);
            for (multiple, text) in multiples.into_iter().zip(&texts) {
                proptest::prop_assert_eq!(read(text).to_bits(), (number(multiple, exponent) + 0.0).to_bits());
                proptest::prop_assert!(text.chars().count() <= 18, "{}", text);
            }
            // in one form: all with the same power, and as many decimals
            let form = |text: &String| {
                let (number, power) = text.split_once('×').unwrap_or((text, ""));
                (number.split_once('.').map_or(0, |(_, after)| after.len()), power.to_owned())
            };
            let forms: Vec<_> = texts.iter().filter(|text| *text != "0" && text.contains('×')).map(form).collect();
            proptest::prop_assert!(forms.windows(2).all(|pair| pair[0] == pair[1]), "{texts:?}");
        }
    }

    #[test]
    fn there_are_no_more_ticks_than_asked_for() {
        for (low, high) in [(0.0, 1.0), (1e6, 1e6 + 1e-3), (-1e300, 1e300), (3e-310, 4e-310), (1.0, 1.0 + 4e-16)] {
            for most in 2..12 {
                let found = ticks(low, high, most);
                assert!(found.len() <= most, "{low} {high} {most}: {}", found.len());
            }
        }
        assert!(ticks(1.0, 1.0, 5).is_empty() && ticks(f64::NAN, 1.0, 5).is_empty());
        assert!(ticks(f64::MIN, f64::MAX, 5).is_empty());
    }
}
