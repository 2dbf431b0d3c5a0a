//! Cosines of the angles around a vertex or a face.

use std::f64::consts::PI;

use crate::math::functions::{cos, ratio};

/// Returns `cos(2 pi i / n)`, exact where it is rational.
pub(super) fn cosine(i: usize, n: usize) -> f64 {
    match (12 * (i % n)).checked_div(n).filter(|_| (12 * (i % n)).is_multiple_of(n)) {
        Some(0) => 1.0,
        Some(2 | 10) => 0.5,
        Some(3 | 9) => 0.0,
        Some(4 | 8) => -0.5,
        Some(6) => -1.0,
        _ => cos(2.0 * PI * ratio(i % n, n)),
    }
}
