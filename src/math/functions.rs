//! The elementary functions, from a pure-Rust libm only, so that every machine computes the same bits.

pub use libm::{acos, asin, atan, atan2, cos, cosh, exp, log as ln, pow, sin, sinh, tan, tanh};

/// The square root, correctly rounded by IEEE 754 and therefore equal everywhere: processors have it.
#[inline]
pub fn sqrt(x: f64) -> f64 {
    x.sqrt()
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^52")]
pub const fn real(n: usize) -> f64 {
    n as f64
}

/// One whole number over another.
pub fn ratio(a: usize, b: usize) -> f64 {
    real(a) / real(b)
}
