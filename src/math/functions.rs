//! The elementary functions, from a pure-Rust libm, so that every machine computes the same bits.

pub use libm::{acos, asin, atan, atan2, cos, cosh, exp, log as ln, pow, sin, sinh, tan, tanh};

/// Returns the square root, which IEEE 754 requires to be correctly rounded, so that it is the same on all processors.
#[inline]
pub fn sqrt(x: f64) -> f64 {
    x.sqrt()
}

/// Converts a count to f64.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^52")]
pub const fn real(n: usize) -> f64 {
    n as f64
}

/// Returns the quotient of two whole numbers.
pub fn ratio(a: usize, b: usize) -> f64 {
    real(a) / real(b)
}
