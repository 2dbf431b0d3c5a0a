//! Pixels and their encoding.

use std::sync::LazyLock;

use crate::kept::Kept;
use crate::math::functions::pow;

/// A picture: rows from the top, four bytes per pixel (red, green, blue, alpha; sRGB, straight alpha).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixmap {
    /// Number of pixels per row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// `width x height x 4` bytes.
    pub bytes: Kept<u8>,
}

/// Returns the linear light of an sRGB byte, 0 to 1. Source: IEC 61966-2-1 (1999).
pub(super) fn linear(byte: u8) -> f32 {
    let c = f64::from(byte) / 255.0;
    let light = if c <= 0.04045 { c / 12.92 } else { pow((c + 0.055) / 1.055, 2.4) };
    #[expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]
    let light = light as f32;
    light
}

/// Steps of linear light in the table: fewer than 3,295 would merge the darkest two bytes, so half is too few; twice as
/// many double the table and round a few greys better.
const LINEAR_LIGHT_STEPS: usize = 4096;

/// Table from linear light to sRGB bytes.
#[derive(Debug)]
pub(super) struct SrgbTable([u8; LINEAR_LIGHT_STEPS]);

/// The table, made once.
pub(super) static ENCODING: LazyLock<SrgbTable> = LazyLock::new(SrgbTable::new);

impl SrgbTable {
    fn new() -> Self {
        let last = f64::from(u32::try_from(LINEAR_LIGHT_STEPS - 1).expect("the table is short"));
        let byte = |i: u32| {
            let c = f64::from(i) / last;
            let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * pow(c, 1.0 / 2.4) - 0.055 };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "s is in 0..=1")]
            let byte = (255.0 * s + 0.5) as u8;
            byte
        };
        Self(std::array::from_fn(|i| byte(u32::try_from(i).expect("the table is short"))))
    }

    /// Returns the byte of a linear light; values outside 0 to 1 are clamped, and NaN gives 0.
    pub(super) fn byte(&self, light: f32) -> u8 {
        self.of_step(light_step(light))
    }

    /// Returns the byte of an entry of the table, counted by [`light_step`].
    pub(super) fn of_step(&self, step: u16) -> u8 {
        self.0[usize::from(step) % LINEAR_LIGHT_STEPS]
    }
}

/// Returns the entry of the table for a linear light; values outside 0 to 1 are clamped, and NaN gives 0.
#[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "the table is short")]
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn light_step(light: f32) -> u16 {
    let last = (LINEAR_LIGHT_STEPS - 1) as f32;
    let step = light * last + 0.5;
    let step = if step > 0.0 { step } else { 0.0 };
    rounded_down(if step < last { step } else { last }) as u16
}

/// Returns a number from 0 to 2^22, rounded down. There is no cast, which would be done one by one to saturate.
#[inline(always)]
pub(super) fn rounded_down(x: f32) -> u32 {
    // numbers from here on have no digits after the point
    const WHOLE: f32 = 8_388_608.0;
    let nearest = x + WHOLE;
    nearest.to_bits() - WHOLE.to_bits() - u32::from(nearest - WHOLE > x)
}

/// Doubles from here on have no digits after the point.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Returns a number from 0 to 2^51, rounded down, like [`rounded_down`].
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn whole_below(x: f64) -> f64 {
    let nearest = (x + WHOLE) - WHOLE;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// Returns a whole number from 0 to 2^32 - 1.
#[expect(clippy::cast_possible_truncation, reason = "the last bits are those of the number")]
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn whole_number(x: f64) -> u32 {
    (x + WHOLE).to_bits() as u32
}

/// Returns the linear, premultiplied light of straight sRGB bytes.
pub(super) fn premultiplied([r, g, b, a]: [u8; 4]) -> [f32; 4] {
    let alpha = f32::from(a) / 255.0;
    [linear(r) * alpha, linear(g) * alpha, linear(b) * alpha, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down_also_beside_whole_ones() {
        for whole in (0_u32..4096).chain([65_535, 65_536, 4_194_303]) {
            let from = f64::from(whole);
            #[expect(clippy::cast_possible_truncation, reason = "whole numbers below 2^24")]
            let x = from as f32;
            assert_eq!(rounded_down(x), whole);
            assert_eq!(rounded_down(x.next_up()), whole);
            assert_eq!(rounded_down((x + 1.0).next_down()), whole, "below {}", x + 1.0);
            for x in [from, from.next_up(), (from + 1.0).next_down()] {
                assert_eq!(whole_number(whole_below(x)), whole, "of {x}");
            }
        }
        assert_eq!(whole_number(f64::from(u32::MAX)), u32::MAX);
    }

    #[test]
    fn light_outside_zero_to_one_is_clamped() {
        for (light, step) in [(f32::NAN, 0), (-1.0, 0), (-0.0, 0), (1.0, 4095), (7.0, 4095), (f32::INFINITY, 4095)] {
            assert_eq!(light_step(light), step, "{light}");
        }
        let bytes: Vec<u8> = (0..4096).map(|step| ENCODING.of_step(step)).collect();
        assert!(bytes.is_sorted() && bytes[0] == 0 && bytes[4095] == 255);
        assert!((0..=255).all(|byte| ENCODING.byte(linear(byte)) == byte), "bytes come back from their light");
    }
}
