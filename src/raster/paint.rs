//! Paint: colours that vary over a surface, given by vertices, triangles, corners, patterns or textures.

#![expect(clippy::cast_possible_truncation, reason = "colours need no more than the precision of f32")]
#![expect(clippy::cast_sign_loss, reason = "numbers of swatches are not negative")]

use super::shade::{Vec3f, spread};
use super::texels::Cover;

/// The colours of a surface, in linear light from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint<'a> {
    /// One colour per vertex, interpolated over each triangle.
    Vertices(&'a [Vec3f]),
    /// One colour per triangle.
    Triangles(&'a [Vec3f]),
    /// One colour per triangle corner, interpolated over each triangle.
    Corners {
        /// The list of colours.
        colors: &'a [Vec3f],
        /// For each triangle, the indices of the colours of its corners.
        corners: &'a [[u32; 3]],
    },
    /// Colours of a table, selected by numbers from 0 (its first colour) to 1 (its last), which are interpolated over
    /// each triangle before the lookup; numbers outside are clamped.
    Scale {
        /// The numbers; their absolute values are at most a hundred.
        shares: &'a [f32],
        /// For each triangle, the indices of the numbers of its corners; if `None`, those of its vertices.
        corners: Option<&'a [[u32; 3]]>,
        /// The colour table, with at least one colour.
        table: &'a [Vec3f],
    },
    /// A checkerboard of unit squares in the plane of `places`: the first colour where both coordinates, rounded down,
    /// are even or both are odd.
    Squares {
        /// The positions of corners in the plane.
        places: &'a [[f64; 2]],
        /// For each triangle, the indices of the positions of its corners.
        corners: &'a [[u32; 3]],
        /// The two colours.
        colors: [Vec3f; 2],
    },
    /// Textures.
    Covers {
        /// Texture coordinates of corners.
        places: &'a [[f64; 2]],
        /// For each triangle, the indices of the texture coordinates of its corners.
        corners: &'a [[u32; 3]],
        /// For each triangle, the index of its swatch.
        numbers: &'a [u32],
        /// The list of swatches, fewer than 2^24.
        swatches: &'a [Swatch],
    },
}

/// A colour, with an optional texture that it is multiplied with.
#[derive(Debug, Clone, PartialEq)]
pub struct Swatch {
    /// The colour, in linear light from 0 to 1.
    pub color: Vec3f,
    /// The opacity, from 0 to 1; multiplied by the alpha of the texture, if it has one.
    pub alpha: f32,
    /// The alpha from which the surface is opaque; below, it is invisible. Applies only to textures with alpha.
    pub cutoff: Option<f32>,
    /// Metalness, from 0 (as plastic) to 1 (as metal).
    pub metal: f32,
    /// Roughness, from 0 (as polished) to 1 (as chalk); if `None`, highlights are those of plastic.
    pub roughness: Option<f32>,
    /// The texture.
    pub cover: Option<Cover>,
}

impl Swatch {
    /// Returns whether the alpha varies from place to place.
    fn is_patterned(&self) -> bool {
        self.cover.as_ref().is_some_and(|cover| cover.texels.has_alpha())
    }
}

/// How a triangle hides what lies behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hiding {
    /// The triangle is opaque.
    Wholly,
    /// The triangle has a constant alpha.
    Partly,
    /// The alpha varies with the texture.
    InPlaces,
    /// The triangle is invisible.
    Never,
}

/// The variation of paint over one triangle in a tile: of the position for patterns and textures, else of the colour.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tint {
    /// Weighted sums over the corners at pixel (0, 0) of the tile, and their increments to the right and down.
    sums: [Vec3f; 3],
    weights: Vec3f,
    /// The minimum and maximum over the corners, to which values are clamped.
    low: Vec3f,
    high: Vec3f,
}

impl Paint<'_> {
    /// Returns the paint values at the corners of triangle `id`.
    pub(super) fn corners(&self, id: usize, triangle: [u32; 3]) -> [[f64; 3]; 3] {
        match self {
            Self::Vertices(colors) => triangle.map(|v| colors[v as usize].map(f64::from)),
            Self::Triangles(colors) => [colors[id].map(f64::from); 3],
            Self::Corners { colors, corners } => corners[id].map(|at| colors[at as usize].map(f64::from)),
            Self::Scale { shares, corners, .. } => {
                let places = corners.map_or(triangle, |corners| corners[id]);
                places.map(|at| [f64::from(shares[at as usize]), 0.0, 0.0])
            }
            Self::Squares { places, corners, .. } => {
                let places = corners[id].map(|place| places[place as usize]);
                // shifted by whole pairs of squares, to keep the precision of f32
                let near = |k: usize| {
                    let least = places.iter().map(|place| place[k]).fold(f64::INFINITY, f64::min);
                    2.0 * (least / 2.0).floor()
                };
                places.map(|place| [place[0] - near(0), place[1] - near(1), 0.0])
            }
            Self::Covers { places, corners, numbers, swatches } => {
                let number = f64::from(numbers[id]);
                let Some(cover) = &swatches[numbers[id] as usize].cover else { return [[0.0, 0.0, number]; 3] };
                let places = corners[id].map(|place| places[place as usize]);
                let least = |k: usize| places.iter().map(|place| place[k]).fold(f64::INFINITY, f64::min);
                let shift = [0, 1].map(|k| cover.period(k, least(k)));
                places.map(|place| [place[0] - shift[0], place[1] - shift[1], number])
            }
        }
    }

    /// Returns the swatch of triangle `id`, if there are swatches.
    fn swatch(&self, id: usize) -> Option<&Swatch> {
        let Self::Covers { numbers, swatches, .. } = self else { return None };
        swatches.get(numbers[id] as usize)
    }

    /// Returns how triangle `id` hides what lies behind it.
    pub(super) fn hiding(&self, id: usize) -> Hiding {
        let Some(swatch) = self.swatch(id) else { return Hiding::Wholly };
        match swatch.alpha {
            _ if swatch.is_patterned() => Hiding::InPlaces,
            alpha if alpha >= 1.0 => Hiding::Wholly,
            alpha if alpha > 0.0 => Hiding::Partly,
            _ => Hiding::Never,
        }
    }

    /// Returns the opacity of triangle `id` at a place in the tile, in pixels.
    pub(super) fn alpha(&self, id: usize, tint: &Tint, place: [f32; 2]) -> f32 {
        let Some(swatch) = self.swatch(id) else { return 1.0 };
        let Some(cover) = swatch.cover.as_ref().filter(|_| swatch.is_patterned()) else { return swatch.alpha };
        let at = tint.at(place);
        let alpha = swatch.alpha * cover.light([at[0], at[1]], tint.footprint(place)).1;
        match swatch.cutoff {
            Some(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            None => alpha,
        }
    }

    /// Returns the metalness of triangle `id`, from 0 to 1, and the width of its highlights.
    pub(super) fn finish(&self, id: usize) -> [f32; 2] {
        self.swatch(id).map_or([0.0, spread(None)], |swatch| [swatch.metal, spread(swatch.roughness)])
    }

    /// Returns whether any triangle is translucent.
    pub(super) fn has_clear(&self) -> bool {
        let is_clear = |swatch: &Swatch| swatch.alpha < 1.0 || swatch.is_patterned();
        matches!(self, Self::Covers { swatches, .. } if swatches.iter().any(is_clear))
    }

    /// Returns the colour at a place in the tile, in pixels.
    pub(super) fn color(&self, tint: &Tint, place: [f32; 2]) -> Vec3f {
        let at = tint.at(place);
        let colors = match self {
            Self::Vertices(_) | Self::Triangles(_) | Self::Corners { .. } => return at,
            Self::Scale { table, .. } => return looked_up(table, at[0]),
            Self::Covers { swatches, .. } => {
                // the number is the same at all corners, but for what blending them rounds
                let swatch = &swatches[((at[2] + 0.5) as usize).min(swatches.len() - 1)];
                let Some(cover) = &swatch.cover else { return swatch.color };
                let (light, _) = cover.light([at[0], at[1]], tint.footprint(place));
                return std::array::from_fn(|k| swatch.color[k] * light[k]);
            }
            Self::Squares { colors, .. } => colors,
        };
        let wide = tint.footprint(place);
        let share = 0.5 + 0.5 * stripes(at[0], wide[0]) * stripes(at[1], wide[1]);
        std::array::from_fn(|k| share * colors[0][k] + (1.0 - share) * colors[1][k])
    }
}

impl Tint {
    /// Creates the variation over a triangle from the values of its corners and their weights at pixel (0, 0), right
    /// and down.
    pub(super) fn new(values: &[[f64; 3]; 3], weights: &[Vec3f; 3]) -> Self {
        let values = values.map(|value| value.map(|x| x as f32));
        let mut tint = Self { low: values[0], high: values[0], ..Self::default() };
        for (value, weight) in values.iter().zip(weights) {
            for k in 0..3 {
                tint.low[k] = tint.low[k].min(value[k]);
                tint.high[k] = tint.high[k].max(value[k]);
                tint.weights[k] += weight[k];
                for (sums, weight) in tint.sums.iter_mut().zip(weight) {
                    sums[k] += weight * value[k];
                }
            }
        }
        tint
    }

    /// Returns the value at a place in the tile, in pixels, clamped to the values of the corners, since narrow
    /// triangles exceed the precision of f32.
    fn at(&self, [x, y]: [f32; 2]) -> Vec3f {
        let weight = self.weights[0] + self.weights[1] * x + self.weights[2] * y;
        std::array::from_fn(|k| {
            let value = (self.sums[0][k] + self.sums[1][k] * x + self.sums[2][k] * y) / weight;
            // NaN becomes the minimum
            if value > self.low[k] { value.min(self.high[k]) } else { self.low[k] }
        })
    }

    /// Returns the extent of the first two values within a pixel.
    fn footprint(&self, place: [f32; 2]) -> [f32; 2] {
        let at = self.at(place);
        let weight = self.weights[0] + self.weights[1] * place[0] + self.weights[2] * place[1];
        std::array::from_fn(|k| {
            let slope = |axis: usize| ((self.sums[axis][k] - at[k] * self.weights[axis]) / weight).abs();
            slope(1) + slope(2)
        })
    }
}

/// Returns the colour at a fraction of a table, interpolated between the two nearest entries.
fn looked_up(table: &[Vec3f], share: f32) -> Vec3f {
    let last = table.len() - 1;
    #[expect(clippy::cast_precision_loss, reason = "a table has some hundred colours")]
    let place = share.clamp(0.0, 1.0) * last as f32;
    let below = (place as usize).min(last);
    let (a, b) = (table[below], table[(below + 1).min(last)]);
    let rest = place - place.floor();
    std::array::from_fn(|k| a[k] + rest * (b[k] - a[k]))
}

/// Returns the mean over `[at - wide / 2, at + wide / 2]` of 1 where the number, rounded down, is even, and of -1
/// elsewhere.
pub(super) fn stripes(at: f32, wide: f32) -> f32 {
    // the integral of the wave from 0: up to 1 and down to 0 again
    let integral = |t: f32| 1.0 - (t - 2.0 * (0.5 * t).floor() - 1.0).abs();
    if wide > 1e-3 {
        let mean = (integral(at + 0.5 * wide) - integral(at - 0.5 * wide)) / wide;
        if mean.is_nan() { 0.0 } else { mean }
    } else if (0.5 * at).fract().abs() < 0.5 {
        1.0
    } else {
        -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stripes_are_plus_and_minus_one_and_their_mean_over_a_period_is_zero() {
        for wide in [0.0, 0.25] {
            for (at, expected) in [(0.5, 1.0), (1.5, -1.0), (2.5, 1.0), (7.5, -1.0)] {
                assert!((stripes(at, wide) - expected).abs() < 1e-6_f32, "{at} {wide}");
            }
        }
        for at in [0.0, 0.3, 1.0, 5.9] {
            assert!(stripes(at, 2.0).abs() < 1e-6, "{at}");
            assert!(stripes(at, 1e9).abs() < 1e-6 && stripes(at, f32::INFINITY).abs() < 1e-6, "{at}");
        }
        assert!(stripes(1.0, 0.5).abs() < 1e-6, "half of each beside a border");
    }

    #[test]
    fn a_tint_has_the_values_of_its_corners_and_their_mean_in_the_middle() {
        // the corners (0, 0), (4, 0), (0, 4) of a tile and their barycentric coordinates
        let weights = [[1.0, -0.25, -0.25], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]];
        let values = [[0.0, 1.0, 0.5], [1.0, 0.0, 0.5], [0.5, 0.25, 0.5]];
        let tint = Tint::new(&values, &weights);
        let is = |tint: &Tint, place: [f32; 2], value: [f64; 3]| {
            let found = tint.at(place).map(f64::from);
            assert!(found.iter().zip(value).all(|(x, y)| (x - y).abs() < 1e-12), "{found:?} is not {value:?}");
        };
        for (place, value) in [([0.0, 0.0], values[0]), ([4.0, 0.0], values[1]), ([0.0, 4.0], values[2])] {
            is(&tint, place, value);
        }
        is(&tint, [2.0, 0.0], [0.5, 0.5, 0.5]);
        assert_eq!(tint.at([9.0, 9.0])[0].to_bits(), 1.0_f32.to_bits(), "never beyond the corners");
        let nowhere = Tint::new(&values, &[[0.0; 3]; 3]);
        is(&nowhere, [1.0, 1.0], [0.0, 0.0, 0.5]);
    }
}
