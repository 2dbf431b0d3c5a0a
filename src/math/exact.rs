//! Exact fractions: what a written number means before it is rounded.

use num_bigint::BigInt;
use num_rational::Ratio;
use num_traits::{Pow, Signed, ToPrimitive, Zero};

use crate::math::number::Number;

/// A fraction of whole numbers of any size, in lowest terms.
pub type Exact = Ratio<BigInt>;

/// Most bits of numerator and denominator together of a number that counts as exactly known.
/// Masks of 129 entries with 17 digits each come to a few hundred. Half of it calls long expressions inexact earlier,
/// twice of it lets a request take four times as long with its fractions.
pub const MAX_BITS: u64 = 4096;
/// Largest exponent of a power of ten, or of an exact power.
/// Numbers of JSON have at most 308. Half of it leaves tiny ones inexact; twice of it has no numbers to serve.
const MAX_EXPONENT: i64 = 320;

impl Number for Exact {
    fn ratio(a: i64, b: i64) -> Self {
        Self::new(a.into(), b.into())
    }

    fn real(&self) -> f64 {
        rounded(self)
    }
}

/// The fraction, unless it has too many digits.
pub fn bounded(x: Exact) -> Option<Exact> {
    (x.numer().bits() + x.denom().bits() <= MAX_BITS).then_some(x)
}

/// A decimal number as it is written: `12`, `0.05`, `1.5e-3`; `None` for anything else.
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

/// The number that the shortest decimal of `x` writes: 1/20 for 0.05. `None` unless finite.
pub fn written(x: f64) -> Option<Exact> {
    if x.is_finite() { decimal(&format!("{x:?}")) } else { None }
}

/// The number that `x` is, a fraction over a power of two; 0 unless finite.
pub fn binary(x: f64) -> Exact {
    Exact::from_float(x).unwrap_or_else(Exact::zero)
}

/// The f64 next to a fraction.
pub fn rounded(x: &Exact) -> f64 {
    x.to_f64().unwrap_or(0.0)
}

/// The largest f64 that is not above a fraction.
pub fn below(x: &Exact) -> f64 {
    let near = rounded(x);
    if binary(near) > *x { near.next_down() } else { near }
}

/// The smallest f64 that is not below a fraction.
pub fn above(x: &Exact) -> f64 {
    let near = rounded(x);
    if binary(near) < *x { near.next_up() } else { near }
}

/// A whole power.
pub fn power(x: &Exact, n: i64) -> Option<Exact> {
    if n.abs() > MAX_EXPONENT || (x.is_zero() && n < 0) || x.numer().bits() * n.unsigned_abs() > MAX_BITS {
        return None;
    }
    bounded(x.pow(i32::try_from(n).ok()?))
}

/// The square root, where it is a fraction itself.
pub fn square_root(x: &Exact) -> Option<Exact> {
    if x.is_negative() {
        return None;
    }
    let root = Exact::new(x.numer().sqrt(), x.denom().sqrt());
    (&root * &root == *x).then_some(root)
}

/// The fraction with the least denominator up to 10^6 that lies within `1e-11 |x|` of `x`, by continued fractions.
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
