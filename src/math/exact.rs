//! Exact fractions: the value of a written number before rounding.

use num_bigint::BigInt;
use num_rational::Ratio;
use num_traits::{One, Pow, Signed, ToPrimitive, Zero};

use crate::math::number::Number;

/// A fraction of whole numbers of any size, in lowest terms.
pub type Exact = Ratio<BigInt>;

/// Maximum number of bits of numerator and denominator together of an exactly known number. Masks of 129 entries with
/// 17 digits each need a few hundred. Half as many would treat long expressions as inexact earlier; twice as many let
/// the fractions of a request take four times as long.
pub const MAX_BITS: u64 = 4096;
/// Largest exponent of a power of ten, or of an exact power. Numbers in JSON have at most 308; half of it would leave
/// tiny ones inexact, and twice of it would serve no further numbers.
const MAX_EXPONENT: i64 = 320;

impl Number for Exact {
    fn ratio(a: i64, b: i64) -> Self {
        Self::new(a.into(), b.into())
    }

    fn real(&self) -> f64 {
        rounded(self)
    }
}

/// Returns the fraction, or `None` if it has too many digits.
pub fn bounded(x: Exact) -> Option<Exact> {
    (x.numer().bits() + x.denom().bits() <= MAX_BITS).then_some(x)
}

/// A sequence of values with indices; 0 outside.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactSequence {
    /// The index of the first value.
    pub first: i64,
    /// The values from `first` on.
    pub values: Vec<Exact>,
}

impl ExactSequence {
    /// Returns 1 at the index `first` and 0 elsewhere.
    pub fn impulse(first: i64) -> Self {
        Self { first, values: vec![Exact::one()] }
    }

    /// Returns 0 everywhere.
    pub fn zero() -> Self {
        Self { first: 0, values: vec![Exact::zero()] }
    }

    /// Returns the value with an index.
    pub fn at(&self, i: i64) -> Exact {
        let found = usize::try_from(i - self.first).ok().and_then(|place| self.values.get(place));
        found.cloned().unwrap_or_else(Exact::zero)
    }

    /// Returns the index of the last value.
    pub fn last(&self) -> i64 {
        self.first + i64::try_from(self.values.len()).unwrap_or(0) - 1
    }

    /// Computes the values from `first` to `last`; `None` if a fraction has too many digits.
    pub fn made(first: i64, last: i64, value: impl Fn(i64) -> Exact) -> Option<Self> {
        let values: Option<Vec<Exact>> = (first..=last).map(|j| bounded(value(j))).collect();
        Some(Self { first, values: values? })
    }
}

/// Parses a decimal number: `12`, `0.05`, `1.5e-3`; `None` for anything else.
pub fn decimal(text: &str) -> Option<Exact> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent: i64 = exponent.strip_prefix('+').unwrap_or(exponent).parse().ok()?;
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: BigInt = format!("{whole}{part}").parse().ok()?;
    let exponent = exponent.checked_sub(i64::try_from(part.len()).ok()?)?;
    if exponent.abs() > MAX_EXPONENT {
        return None;
    }
    bounded(Exact::from(digits) * Exact::from(BigInt::from(10)).pow(i32::try_from(exponent).ok()?))
}

/// Returns the value of the shortest decimal of `x`: 1/20 for 0.05. `None` unless `x` is finite.
pub fn written(x: f64) -> Option<Exact> {
    if x.is_finite() { decimal(&format!("{x:?}")) } else { None }
}

/// Returns the exact value of `x`, a fraction over a power of two; 0 unless `x` is finite.
pub fn binary(x: f64) -> Exact {
    Exact::from_float(x).unwrap_or_else(Exact::zero)
}

/// Returns the f64 nearest to a fraction.
pub fn rounded(x: &Exact) -> f64 {
    x.to_f64().unwrap_or(0.0)
}

/// Returns the largest f64 that is not above a fraction.
pub fn below(x: &Exact) -> f64 {
    let near = rounded(x);
    if binary(near) > *x { near.next_down() } else { near }
}

/// Returns the smallest f64 that is not below a fraction.
pub fn above(x: &Exact) -> f64 {
    let near = rounded(x);
    if binary(near) < *x { near.next_up() } else { near }
}

/// Returns an integer power of a fraction; `None` if it is undefined or too large.
pub fn power(x: &Exact, n: i64) -> Option<Exact> {
    if n.abs() > MAX_EXPONENT || (x.is_zero() && n < 0) || x.numer().bits() * n.unsigned_abs() > MAX_BITS {
        return None;
    }
    bounded(x.pow(i32::try_from(n).ok()?))
}

/// Returns the square root if it is a fraction.
pub fn square_root(x: &Exact) -> Option<Exact> {
    if x.is_negative() {
        return None;
    }
    let root = Exact::new(x.numer().sqrt(), x.denom().sqrt());
    (&root * &root == *x).then_some(root)
}

/// Returns the fraction with the smallest denominator up to 10^6 within `1e-11 |x|` of `x`, by continued fractions.
pub fn simple(x: f64) -> Option<Exact> {
    let (mut before, mut now) = ((0_i64, 1_i64), (1_i64, 0_i64));
    let mut rest = x.abs();
    for _ in 0..24 {
        let whole = rest.floor();
        #[expect(clippy::cast_possible_truncation, reason = "checked to be small")]
        let part = if whole < 1e9 { whole as i64 } else { return None };
        let next = (part.checked_mul(now.0)?.checked_add(before.0)?, part.checked_mul(now.1)?.checked_add(before.1)?);
        (before, now) = (now, next);
        if now.1 > 1_000_000 {
            return None;
        }
        let found = Exact::ratio(if x < 0.0 { -now.0 } else { now.0 }, now.1);
        if (rounded(&found) - x).abs() <= 1e-11 * x.abs() {
            return Some(found);
        }
        rest = 1.0 / (rest - whole);
    }
    None
}
