//! Colour maps: the colours of numbers.

use super::colors::{byte, encoded, linear, scale, signed};
use super::numbers::rounded;
use crate::math::parameter::{Parameter, ParameterKind, Values};

/// The colour map of numbers.
pub(super) const COLOR_MAP: Parameter = Parameter::optional(
    "color_map",
    ParameterKind::Choice(&[
        "even",
        "viridis",
        "magma",
        "inferno",
        "plasma",
        "cividis",
        "turbo",
        "greys",
        BLUE_RED,
        "purple-green",
        "brown-teal",
    ]),
    "The colours of numbers. \"even\" runs from dark blue over green to yellow, equal steps of lightness apart; \
     viridis, magma, inferno, plasma and cividis (for the colour-blind) are perceptually uniform too, turbo is a \
     rainbow, greys run from white to black; blue-red, purple-green and brown-teal are pale in the middle and \
     belong to numbers with a sign. Left out, blue-red for curvature, viridis for distances, even for channels.",
);

const BLUE_RED: &str = "blue-red";

/// Number of colours of a table. With half of it steps between neighbours are visible in smooth pictures; twice of it
/// are more than bytes can distinguish.
const TABLE_COLORS: u32 = 256;

/// A map of numbers to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ColorMap(&'static str);

impl ColorMap {
    /// The map from dark blue over green to yellow, in equal steps of lightness.
    pub(super) const EVEN: Self = Self("even");
    /// The map for distances.
    pub(super) const VIRIDIS: Self = Self("viridis");
    /// The map for numbers with a sign.
    pub(super) const SIGNED: Self = Self(BLUE_RED);

    /// Returns the map that the options name, or `otherwise`.
    pub(super) fn of(options: &Values, otherwise: Self) -> Self {
        options.choice(COLOR_MAP.name).map_or(otherwise, Self)
    }

    /// Returns whether the middle of the map stands for 0.
    pub(super) fn is_diverging(self) -> bool {
        [BLUE_RED, "purple-green", "brown-teal"].contains(&self.0)
    }

    /// Returns the colours at equal steps from the least to the greatest number, in linear light.
    pub(super) fn table(self) -> Vec<[f32; 3]> {
        self.bytes().iter().map(|color| color.map(|byte| rounded(linear(0, f64::from(byte) / 255.0)))).collect()
    }

    /// Returns the colours of [`ColorMap::table`] in sRGB.
    pub(super) fn bytes(self) -> Vec<[u8; 3]> {
        let share = |i| f64::from(i) / f64::from(TABLE_COLORS - 1);
        let shares = (0..TABLE_COLORS).map(share);
        let gradient = match self.0 {
            "viridis" => colorous::VIRIDIS,
            "magma" => colorous::MAGMA,
            "inferno" => colorous::INFERNO,
            "plasma" => colorous::PLASMA,
            "cividis" => colorous::CIVIDIS,
            "turbo" => colorous::TURBO,
            "greys" => colorous::GREYS,
            "purple-green" => colorous::PURPLE_GREEN,
            "brown-teal" => colorous::BROWN_GREEN,
            BLUE_RED => return shares.map(signed).map(in_bytes).collect(),
            _ => return shares.map(scale).map(in_bytes).collect(),
        };
        shares.map(|share| gradient.eval_continuous(share)).map(|color| [color.r, color.g, color.b]).collect()
    }
}

fn in_bytes(light: [f32; 3]) -> [u8; 3] {
    light.map(|light| byte(encoded(f64::from(light))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(name: &'static str) -> Vec<[f32; 3]> {
        ColorMap(name).table()
    }

    fn luminance([r, g, b]: [f32; 3]) -> f32 {
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn uniform_maps_grow_lighter_all_along() {
        for name in ["even", "viridis", "magma", "inferno", "plasma", "cividis"] {
            let lights: Vec<f32> = map(name).into_iter().map(luminance).collect();
            // bytes of colours are rounded
            assert!(lights.windows(2).all(|pair| pair[1] > pair[0] - 2e-3), "{name}");
            assert!(lights[255] > lights[0] + 0.4, "{name}");
        }
    }

    #[test]
    fn maps_with_a_middle_are_pale_there_and_apart_at_their_ends() {
        let ParameterKind::Choice(names) = COLOR_MAP.kind else { panic!("it is a choice") };
        for name in names.iter().copied().filter(|name| ColorMap(name).is_diverging()) {
            let table = map(name);
            let [low, middle, high] = [table[0], table[128], table[255]];
            assert!(luminance(middle) > 0.8 && luminance(low) < 0.2 && luminance(high) < 0.2, "{name}");
            let apart: f32 = low.iter().zip(high).map(|(a, b)| (a - b).abs()).sum();
            assert!(apart > 0.1, "{name}: {apart}");
        }
        let [low, high] = [map(BLUE_RED)[0], map(BLUE_RED)[255]];
        assert!(low[2] > 2.0 * low[0] && high[0] > 2.0 * high[2], "blue is low, red is high");
    }
}
