//! Pixels and their encoding.

use std::sync::LazyLock;

use crate::math::functions::pow;

/// A picture: rows from the top, four bytes per pixel (red, green, blue, alpha; sRGB, straight alpha).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixmap {
    /// Number of pixels per row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// `width x height x 4` bytes.
    pub bytes: Vec<u8>,
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
pub(super) struct SrgbTable(Vec<u8>);

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
        Self((0..).take(LINEAR_LIGHT_STEPS).map(byte).collect())
    }

    /// Returns the byte of a linear light; values outside 0 to 1 are clamped, and NaN gives 0.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "the cast saturates and the table is short"
    )]
    pub(super) fn byte(&self, light: f32) -> u8 {
        let i = (light * (LINEAR_LIGHT_STEPS - 1) as f32 + 0.5) as usize;
        self.0[i.min(LINEAR_LIGHT_STEPS - 1)]
    }

    /// Returns the straight sRGB bytes of a linear colour premultiplied by its alpha.
    pub(super) fn pixel(&self, [r, g, b, a]: [f32; 4]) -> [u8; 4] {
        if a >= 0.9999 {
            return [self.byte(r), self.byte(g), self.byte(b), 255];
        }
        if a <= 0.0 {
            return [0; 4];
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a is in 0..=1")]
        let alpha = (a * 255.0 + 0.5) as u8;
        [self.byte(r / a), self.byte(g / a), self.byte(b / a), alpha]
    }
}

/// Returns the linear, premultiplied light of straight sRGB bytes.
pub(super) fn premultiplied([r, g, b, a]: [u8; 4]) -> [f32; 4] {
    let alpha = f32::from(a) / 255.0;
    [linear(r) * alpha, linear(g) * alpha, linear(b) * alpha, alpha]
}
