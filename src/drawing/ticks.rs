//! Round numbers along an axis.

use super::font::Weight;
use super::label::Label;

/// A round number and how it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The number.
    pub value: f64,
    /// How it is written.
    pub label: Label,
}

/// Digits before or after the point up to which numbers are written out; beyond it stands a power of ten. Twice of it
/// does not fit beside an axis, half of it writes thousands as powers.
const WRITTEN_OUT: i32 = 5;

/// The multiples of 1, 2 or 5 times a power of ten between two numbers: at most `most` of them, which is 2 or more,
/// with the smallest such step. A range without extent, or one that is not finite, has at most its first end.
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let most = most.max(2);
    if !(low.is_finite() && high.is_finite() && low < high && (high - low).is_finite()) {
        return Vec::new();
    }
    #[expect(clippy::cast_precision_loss, reason = "a few ticks")]
    let least = (high - low) / most as f64;
    let exponent = exponent(least);
    let steps = (exponent - 1..=exponent + 2).flat_map(|e| [(1, e), (2, e), (5, e)]);
    for (digit, exponent) in steps {
        let step = number(digit, exponent);
        // the ends count where they are off by rounding alone
        let slack = 1e-9 * step;
        let [first, last] = [((low - slack) / step).ceil(), ((high + slack) / step).floor()];
        #[expect(clippy::cast_precision_loss, reason = "a few ticks")]
        let fits = step > 0.0 && last - first < most as f64 && first.abs().max(last.abs()) < 1e15;
        if fits {
            #[expect(clippy::cast_possible_truncation, reason = "checked to be below 1e15")]
            let multiples = first as i64..=last as i64;
            return multiples.filter_map(|i| tick(i * digit, exponent)).collect();
        }
    }
    Vec::new()
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

fn tick(digits: i64, exponent: i32) -> Option<Tick> {
    let value = number(digits, exponent);
    let text = written(digits, exponent);
    Some(Tick { value, label: Label::parse(&text.replace('-', "\u{2212}"), Weight::Regular).ok()? })
}

/// The number as decimals, or with a power of ten.
fn written(mut digits: i64, mut exponent: i32) -> String {
    if digits == 0 {
        return "0".into();
    }
    if (-WRITTEN_OUT..0).contains(&exponent) {
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        let unit = 10_i64.pow(exponent.unsigned_abs());
        let sign = if digits < 0 { "-" } else { "" };
        let (whole, rest) = (digits.abs() / unit, digits.abs() % unit);
        return format!("{sign}{whole}.{rest:0decimals$}");
    }
    if (0..=WRITTEN_OUT).contains(&exponent) && digits.abs() < 100_000 {
        return (digits * 10_i64.pow(exponent.unsigned_abs())).to_string();
    }
    while digits % 10 == 0 {
        digits /= 10;
        exponent += 1;
    }
    let lead = match digits {
        1 => String::new(),
        -1 => "-".into(),
        digits => format!("{digits}×"),
    };
    format!("{lead}10^{{{exponent}}}")
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
        assert_eq!(labels(-3.2, 7.9, 6), "−2 0 2 4 6");
        assert_eq!(labels(0.12, 0.13, 5), "0.120 0.125 0.130");
        assert_eq!(labels(0.0, 4e7, 5), "0 107 2×107 3×107 4×107");
        assert_eq!(labels(-1e-9, 1e-9, 3), "−10−9 0 10−9");
        assert_eq!(labels(0.0, 30_000.0, 4), "0 10000 20000 30000");
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
