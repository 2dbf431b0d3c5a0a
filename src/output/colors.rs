//! Colours of vertices: sRGB from 0 to 1, as they are given, and as formats store them.

use crate::math::functions::pow;

/// Component `k` of a colour in linear light, 0 to 1; alpha (the fourth) is linear already.
///
/// Source: IEC 61966-2-1 (1999), section 5.2.
pub(super) fn linear(k: usize, x: f64) -> f64 {
    let x = within(x);
    match k {
        3 => x,
        _ if x <= 0.040_45 => x / 12.92,
        _ => pow((x + 0.055) / 1.055, 2.4),
    }
}

/// A component as a byte.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number is rounded, within 0 to 255")]
pub(super) fn byte(x: f64) -> u8 {
    (within(x) * 255.0 + 0.5) as u8
}

/// A component brought into 0 to 1: negative weights of some schemes reach beyond.
pub(super) fn within(x: f64) -> f64 {
    x.clamp(0.0, 1.0) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_keep_their_ends_and_stay_within_them() {
        for (x, expected) in [(-1.0, 0), (0.0, 0), (0.5, 128), (1.0, 255), (7.0, 255)] {
            assert_eq!(byte(x), expected);
        }
        let found = [linear(0, 0.0), linear(1, 1.0), linear(2, 2.0), linear(3, 0.5)];
        assert_eq!(found.map(f64::to_bits), [0.0, 1.0, 1.0, 0.5_f64].map(f64::to_bits));
        assert!((linear(0, 0.5) - 0.214_041).abs() < 1e-6);
    }
}
