//! Textures: sampled in linear light, with mipmaps.

#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sides of pictures are below 2^24, and places are brought into them"
)]

use std::sync::{Arc, LazyLock};

use rayon::prelude::*;

use super::pixmap::{ENCODING, linear};
use super::shade::Vec3f;

/// Linear light of every sRGB byte.
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|byte| linear(byte as u8)));

/// Texels within a pixel up to which a copy is shown; beyond it the next smaller one is.
/// Half of it blurs what is shown at its own size; twice of it lets fine patterns flicker.
const MAX_TEXELS_A_PIXEL: f32 = 1.5;

/// How a texture continues beyond its sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrapMode {
    /// The texture is repeated.
    Repeat,
    /// The texture is repeated, every other time mirrored.
    Mirror,
    /// The border pixels are extended.
    Edge,
}

/// A texture and its mipmaps, each half as wide and high as the one before.
#[derive(Debug, PartialEq)]
pub struct Texels(Vec<Copy>);

#[derive(Debug, PartialEq)]
struct Copy {
    size: [usize; 2],
    /// sRGB, row after row from the top.
    bytes: Vec<[u8; 3]>,
    /// The alpha of each pixel; empty where all are opaque.
    alphas: Vec<u8>,
}

impl Texels {
    /// Creates a texture of `width x height` pixels, at least one each, from sRGB bytes row after row from the top, and
    /// the alpha of each pixel, or nothing if all are opaque.
    pub fn new([width, height]: [usize; 2], bytes: Vec<[u8; 3]>, alphas: Vec<u8>) -> Self {
        let mut copies = vec![Copy { size: [width, height], bytes, alphas }];
        while let Some(smaller) = copies.last().and_then(Copy::halved) {
            copies.push(smaller);
        }
        Self(copies)
    }

    /// Returns whether any pixel is not opaque.
    pub fn has_alpha(&self) -> bool {
        self.0.iter().any(|copy| !copy.alphas.is_empty())
    }
}

impl Copy {
    /// Returns the picture half as wide and high, if that is smaller: each pixel is the mean of four, in linear light,
    /// weighted by their alpha.
    fn halved(&self) -> Option<Self> {
        let [width, height] = self.size;
        let size @ [columns, _] = [width.div_ceil(2), height.div_ceil(2)];
        if size == self.size {
            return None;
        }
        let four = |i: usize| {
            let (x, y) = (2 * (i % columns), 2 * (i / columns));
            [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(|[right, down]| [(x + right).min(width - 1), (y + down).min(height - 1)])
        };
        let pixel = |i: usize| {
            let four = four(i);
            let light = four.map(|[x, y]| self.at(x, y));
            let mut weights = [1.0; 4];
            if !self.alphas.is_empty() {
                let alphas = four.map(|[x, y]| self.alpha(x, y));
                weights = if alphas.iter().any(|alpha| *alpha > 0.0) { alphas } else { weights };
            }
            let all: f32 = weights.iter().sum();
            let weights = weights.map(|weight| weight / all);
            std::array::from_fn(|k| ENCODING.byte((0..4).map(|i| weights[i] * light[i][k]).sum()))
        };
        let alpha = |i: usize| {
            let sum: f32 = four(i).map(|[x, y]| self.alpha(x, y)).iter().sum();
            (0.25 * 255.0 * sum).round() as u8
        };
        let pixels = size[0] * size[1];
        let clear = if self.alphas.is_empty() { 0 } else { pixels };
        let bytes = (0..pixels).into_par_iter().map(pixel).collect();
        Some(Self { size, bytes, alphas: (0..clear).into_par_iter().map(alpha).collect() })
    }

    fn alpha(&self, x: usize, y: usize) -> f32 {
        self.alphas.get(y * self.size[0] + x).map_or(1.0, |alpha| f32::from(*alpha) / 255.0)
    }

    fn at(&self, x: usize, y: usize) -> Vec3f {
        self.bytes[y * self.size[0] + x].map(|byte| LIGHT[usize::from(byte)])
    }
}

/// A texture as it is mapped to a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Cover {
    /// The texture.
    pub texels: Arc<Texels>,
    /// The continuation of the texture beyond its sides: left and right, above and below.
    pub beyond: [WrapMode; 2],
    /// Whether the nearest pixel is shown instead of the mean of four.
    pub nearest: bool,
}

impl Cover {
    /// Returns the amount by which texture coordinates along an axis, of which `least` is the least, may be decreased
    /// so that they show the same and keep more digits: whole periods of the picture.
    pub(super) fn period(&self, axis: usize, least: f64) -> f64 {
        match self.beyond[axis] {
            WrapMode::Repeat => least.floor(),
            WrapMode::Mirror => 2.0 * (0.5 * least).floor(),
            WrapMode::Edge => 0.0,
        }
    }

    /// Returns the light and the alpha at texture coordinates, the second from the lower side upwards; `wide` is the
    /// width of a pixel of the picture in these coordinates. Light is weighted by alpha.
    pub(super) fn light(&self, [u, v]: [f32; 2], wide: [f32; 2]) -> (Vec3f, f32) {
        let [mut columns, mut rows] = [wide[0], wide[1]];
        let whole = self.texels.0[0].size;
        (columns, rows) = (columns * whole[0] as f32, rows * whole[1] as f32);
        let mut copy = 0;
        while columns.max(rows) > MAX_TEXELS_A_PIXEL && copy + 1 < self.texels.0.len() {
            (columns, rows, copy) = (0.5 * columns, 0.5 * rows, copy + 1);
        }
        let copy = &self.texels.0[copy];
        let [x, y] = [(0, u), (1, 1.0 - v)].map(|(axis, t)| t * copy.size[axis] as f32);
        let index = |axis: usize, i: f32| self.index(axis, i, copy.size[axis]);
        if self.nearest {
            let [x, y] = [index(0, x.floor()), index(1, y.floor())];
            return (copy.at(x, y), copy.alpha(x, y));
        }
        let ([left, above], [x, y]) = ([(x - 0.5).floor(), (y - 0.5).floor()], [x - 0.5, y - 0.5]);
        // places beyond the numbers have no share
        #[expect(clippy::manual_clamp, reason = "what is no number becomes 0 here, which clamp would keep")]
        let (x, y) = ((x - left).max(0.0).min(1.0), (y - above).max(0.0).min(1.0));
        let columns = [index(0, left), index(0, left + 1.0)];
        let rows = [index(1, above), index(1, above + 1.0)];
        let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| [columns[i], rows[j]]);
        let between = |[a, b, c, d]: [f32; 4]| {
            let (upper, lower) = (a + x * (b - a), c + x * (d - c));
            upper + y * (lower - upper)
        };
        let light = four.map(|[x, y]| copy.at(x, y));
        if copy.alphas.is_empty() {
            return (std::array::from_fn(|k| between(light.map(|light| light[k]))), 1.0);
        }
        let alphas = four.map(|[x, y]| copy.alpha(x, y));
        let alpha = between(alphas);
        let seen = |k: usize| between(std::array::from_fn(|i| alphas[i] * light[i][k])) / alpha;
        (if alpha > 0.0 { std::array::from_fn(seen) } else { light[0] }, alpha)
    }

    /// Returns the column or row of `n` that is shown at the whole number `i`; NaN shows the first.
    fn index(&self, axis: usize, i: f32, n: usize) -> usize {
        let last = n - 1;
        let period = |n: usize| {
            let n = n as f32;
            // rounding may lead to the end of the period, which is its start
            ((i - n * (i / n).floor()).max(0.0) as usize).min(n as usize - 1)
        };
        match self.beyond[axis] {
            WrapMode::Repeat => period(n),
            WrapMode::Edge => (i.max(0.0) as usize).min(last),
            WrapMode::Mirror => {
                let there = period(2 * n);
                there.min(2 * n - 1 - there)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns, black and white, over two rows of grey.
    fn texels() -> Arc<Texels> {
        Arc::new(Texels::new([2, 2], vec![[0; 3], [255; 3], [188; 3], [188; 3]], Vec::new()))
    }

    fn light(cover: &Cover, place: [f32; 2], wide: f32) -> f64 {
        f64::from(cover.light(place, [wide; 2]).0[0])
    }

    #[test]
    fn pixels_are_found_from_the_lower_left_and_blended_in_linear_light() {
        let cover = Cover { texels: texels(), beyond: [WrapMode::Edge; 2], nearest: false };
        let grey = f64::from(linear(188));
        for (place, expected) in
            [([0.25, 0.75], 0.0), ([0.75, 0.75], 1.0), ([0.25, 0.25], grey), ([0.5, 0.75], 0.5), ([0.0, 1.0], 0.0)]
        {
            assert!((light(&cover, place, 0.0) - expected).abs() < 1e-6, "{place:?}");
        }
        // the smallest copy is the mean of all
        let mean = 0.25 * (1.0 + 2.0 * grey);
        assert!((light(&cover, [0.9, 0.9], 7.0) - mean).abs() < 5e-3);
        assert!(light(&cover, [f32::NAN, f32::INFINITY], f32::NAN).is_finite());
    }

    #[test]
    fn what_is_not_seen_gives_no_light_to_what_is_beside_it() {
        // a clear black pixel beside an opaque white one
        let texels = Arc::new(Texels::new([2, 1], vec![[0; 3], [255; 3]], vec![0, 255]));
        let cover = Cover { texels, beyond: [WrapMode::Edge; 2], nearest: false };
        for (u, wide, expected) in [(0.75, 0.0, 1.0), (0.5, 0.0, 0.5), (0.25, 0.0, 0.0), (0.5, 4.0, 128.0 / 255.0)] {
            let (light, alpha) = cover.light([u, 0.5], [wide; 2]);
            assert!((alpha - expected).abs() < 1e-6, "{u} {wide}: {alpha}");
            assert!(alpha <= 0.0 || light.iter().all(|light| (light - 1.0).abs() < 1e-6), "{u} {wide}: {light:?}");
        }
    }

    #[test]
    fn beyond_its_sides_a_picture_repeats_is_mirrored_or_ends() {
        let column = |beyond, u: f32| {
            let cover = Cover { texels: texels(), beyond: [beyond, WrapMode::Edge], nearest: true };
            cover.light([u, 0.75], [0.0; 2]).0[0] > 0.5
        };
        for (beyond, expected) in [
            (WrapMode::Repeat, [true, false, true, false, true]),
            (WrapMode::Mirror, [false, false, true, true, false]),
            (WrapMode::Edge, [false, false, true, true, true]),
        ] {
            let found = [-0.25, 0.25, 0.75, 1.25, 1.75].map(|u| column(beyond, u));
            assert_eq!(found, expected, "{beyond:?}");
        }
    }
}
