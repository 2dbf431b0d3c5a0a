//! Conversion of the colours of files, which are in linear light or sRGB.

use crate::math::functions::pow;

/// Converts a colour component from linear light to sRGB; 1 is mapped to exactly 1. Source: IEC 61966-2-1 (1999),
/// section 5.2.
pub(super) fn encoded(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.0 - 1.055 * (1.0 - pow(x, 1.0 / 2.4)) }
}
