//! Colours of vertices in sRGB from 0 to 1, and their conversions for formats.

use crate::math::functions::{cos, pow, sin};
use crate::output::numbers::rounded;

/// Returns component `k` of a colour in linear light, 0 to 1; alpha (the fourth) is linear already.
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

/// Returns the component in sRGB, from 0 to 1, of linear light `x`: the inverse of [`linear`].
pub(super) fn encoded(x: f64) -> f64 {
    let x = within(x);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * pow(x, 1.0 / 2.4) - 0.055 }
}

/// Returns a component as a byte.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number is rounded, within 0 to 255")]
pub(super) fn byte(x: f64) -> u8 {
    (within(x) * 255.0 + 0.5) as u8
}

/// Clamps a component to 0 to 1: negative weights of some schemes reach beyond.
pub(super) fn within(x: f64) -> f64 {
    x.clamp(0.0, 1.0) + 0.0
}

/// Returns the colour of a number from 0 to 1, in linear light: from dark blue over green to yellow.
///
/// In CIELAB lightness grows evenly from 22 to 91, so that equal steps look equal and remain in grey prints; the hue
/// turns from 300 to 95 degrees, at a chroma that screens can show. Formula: `L = 22 + 69 t`, `h = 300 - 205 t`
/// degrees, `C = 44 (1 - 1.9 t (1 - t))`.
pub(super) fn scale(t: f64) -> [f32; 3] {
    let t = within(t);
    lab(22.0 + 69.0 * t, 44.0 * (1.0 - 1.9 * t * (1.0 - t)), 300.0 - 205.0 * t)
}

/// Returns the colour of a number with a sign, from 0 (blue) over a half (pale, for zero) to 1 (red), in linear light.
///
/// In CIELAB, with s from -1 to 1, `L = 94 - 50 |s|`, `C = 64 |s|`, `h` 285 degrees below and 30 above: both sides grow
/// alike, and stay distinct for readers who cannot tell red from green.
pub(super) fn signed(t: f64) -> [f32; 3] {
    let s = 2.0 * within(t) - 1.0;
    lab(94.0 - 50.0 * s.abs(), 64.0 * s.abs(), if s < 0.0 { 285.0 } else { 30.0 })
}

/// Returns the colour of item `number` in a list, in linear light: hues a golden angle apart, of two lightnesses.
pub(super) fn mark(number: usize) -> [f32; 3] {
    #[expect(clippy::cast_precision_loss, reason = "there are few names")]
    let turned = 40.0 + GOLDEN_ANGLE_DEG * number as f64;
    lab(if number.is_multiple_of(2) { 60.0 } else { 74.0 }, 44.0, turned)
}

/// The angle that divides the circle in the golden ratio, degrees: multiples of it stay apart.
const GOLDEN_ANGLE_DEG: f64 = 137.507_764_050_037_85;

/// Returns the colour of a lightness (0 to 100), a chroma and a hue (degrees) in CIELAB under D65, in linear light of
/// sRGB; components that screens cannot show are clamped to 0 to 1.
///
/// Sources: CIE 15 (2004), section 8.2.1; IEC 61966-2-1 (1999), section 5.2.
fn lab(lightness: f64, chroma: f64, hue_deg: f64) -> [f32; 3] {
    const LAB_LINEAR_BELOW: f64 = 6.0 / 29.0;
    let hue = hue_deg * (std::f64::consts::PI / 180.0);
    let middle = (lightness + 16.0) / 116.0;
    let light = |f: f64| {
        if f > LAB_LINEAR_BELOW { f * f * f } else { 3.0 * LAB_LINEAR_BELOW * LAB_LINEAR_BELOW * (f - 4.0 / 29.0) }
    };
    let x = 0.950_47 * light(middle + chroma * cos(hue) / 500.0);
    let y = light(middle);
    let z = 1.088_83 * light(middle - chroma * sin(hue) / 200.0);
    let red = 3.240_6 * x - 1.537_2 * y - 0.498_6 * z;
    let green = -0.968_9 * x + 1.875_8 * y + 0.041_5 * z;
    let blue = 0.055_7 * x - 0.204 * y + 1.057 * z;
    [red, green, blue].map(|c| rounded(within(c)))
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

    /// Returns the luminance relative to white.
    fn luminance([r, g, b]: [f32; 3]) -> f64 {
        0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
    }

    #[test]
    fn the_scale_grows_evenly_in_lightness() {
        let lightness = |t: f64| 116.0 * pow(luminance(scale(t)), 1.0 / 3.0) - 16.0;
        for i in 0..=50 {
            let t = f64::from(i) / 50.0;
            // except for colours that screens cannot show
            assert!((lightness(t) - (22.0 + 69.0 * t)).abs() < 1.5, "{t}: {}", lightness(t));
        }
        assert_eq!(scale(-1.0).map(f32::to_bits), scale(0.0).map(f32::to_bits));
        assert_eq!(scale(2.0).map(f32::to_bits), scale(1.0).map(f32::to_bits));
        let [dark, light] = [scale(0.0), scale(1.0)];
        assert!(dark[2] > 3.0 * dark[0] && light[0] > 3.0 * light[2], "{dark:?} {light:?}");
    }

    #[test]
    fn neutral_colours_are_grey_and_marks_are_apart() {
        for lightness in [1.0, 5.0, 50.0, 100.0] {
            let [r, g, b] = lab(lightness, 0.0, 77.0);
            assert!((r - g).abs() < 1e-3 && (b - g).abs() < 1e-3, "{lightness}: {r} {g} {b}");
        }
        assert!((luminance(lab(100.0, 0.0, 0.0)) - 1.0).abs() < 1e-3);
        for i in 0..12 {
            for j in 0..i {
                let apart: f32 = mark(i).iter().zip(mark(j)).map(|(a, b)| (a - b).abs()).sum();
                assert!(apart > 0.1, "{i} {j}: {apart}");
            }
        }
    }
}
