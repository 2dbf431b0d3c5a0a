//! Colours of files, which have them in linear light or as sRGB.

use crate::math::functions::pow;

/// A component of a colour in linear light, as sRGB; full light is 1 without rounding. Source: IEC 61966-2-1 (1999),
/// section 5.2.
pub(super) fn encoded(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.0 - 1.055 * (1.0 - pow(x, 1.0 / 2.4)) }
}
