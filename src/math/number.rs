//! Number types for weights: rounded numbers or exact fractions.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number type with the four operations, so that one formula yields weights of either kind.
pub trait Number:
    Clone
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Returns `a / b` for `b > 0`.
    fn ratio(a: i64, b: i64) -> Self;

    /// Returns the nearest f64.
    fn real(&self) -> f64;

    /// Returns a whole number.
    fn whole(n: i64) -> Self {
        Self::ratio(n, 1)
    }
}

impl Number for f64 {
    #[expect(clippy::cast_precision_loss, reason = "formulas have small whole numbers")]
    fn ratio(a: i64, b: i64) -> Self {
        a as Self / b as Self
    }

    fn real(&self) -> f64 {
        *self
    }
}
