//! The differences of two pictures of equal size, pixel by pixel.
//!
//! Pictures that should be the same to the bit are compared by equality. Others are compared as they are seen: by the
//! distance of colours in YIQ (Y. Kotsarenko, F. Ramos, Programación Matemática y Software 2 (2010), 27-43), where
//! pixels that smooth an edge do not count (V. Vyšniauskas, Elektronika ir Elektrotechnika 6 (2009), 27-30). Thresholds
//! mean what they mean to the program pixelmatch.

use rayon::prelude::*;

use crate::math::functions::sqrt;
use crate::watch::{Stopped, Watch};

/// A picture: rows from the top, colours with straight alpha.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Width and height.
    pub size: [usize; 2],
    /// `width * height` pixels.
    pub rgba: Vec<[u8; 4]>,
}

/// The measure of a difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// Any difference of bytes.
    Equality,
    /// Colours whose distance exceeds this fraction, 0 to 1, of that of black and white; anti-aliased edges are
    /// ignored.
    Seen(f64),
}

/// The differences of two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Number of pixels that differ.
    pub different: u64,
    /// Number of pixels beyond the threshold that belong to anti-aliased edges.
    pub smoothed: u64,
    /// The largest distance of colours as a fraction of that of black and white, including anti-aliased edges.
    pub largest: f64,
    /// A picture of the differences: grey where equal, red where different, yellow at anti-aliased edges.
    pub picture: Vec<[u8; 3]>,
}

/// The squared distance of black and white, weighted as [`apart`] does.
const BLACK_TO_WHITE: f64 = 35215.0;
/// Visibility of the first picture where nothing differs. Half of it is hardly visible; twice of it hides faint yellow.
const UNCHANGED_VISIBILITY: f64 = 0.1;
const DIFFERENCE_COLOR: [u8; 3] = [255, 0, 0];
const SMOOTHING_COLOR: [u8; 3] = [255, 255, 0];

/// Compares two pictures of equal size.
///
/// # Errors
/// [`Stopped`] when the watch says so.
///
/// # Panics
/// When the sizes differ.
pub fn difference(a: &Pixels, b: &Pixels, measure: Measure, watch: &Watch) -> Result<Difference, Stopped> {
    assert_eq!(a.size, b.size, "only pictures of one size are compared");
    let width = a.size[0].max(1);
    let mut picture = vec![[0; 3]; a.rgba.len()];
    let rows = picture.par_chunks_mut(width).enumerate().map(|(y, shown)| {
        watch.check()?;
        let row = row([a, b], y, measure, shown);
        watch.advance(1);
        Ok(row)
    });
    let sum = |a: RowDifference, b: RowDifference| RowDifference {
        different: a.different + b.different,
        smoothed: a.smoothed + b.smoothed,
        largest: a.largest.max(b.largest),
    };
    let RowDifference { different, smoothed, largest } =
        rows.try_reduce(RowDifference::default, |a, b| Ok(sum(a, b)))?;
    Ok(Difference { different, smoothed, largest: sqrt(largest / BLACK_TO_WHITE), picture })
}

#[derive(Debug, Clone, Copy, Default)]
struct RowDifference {
    different: u64,
    smoothed: u64,
    /// The largest squared distance.
    largest: f64,
}

fn row([a, b]: [&Pixels; 2], y: usize, measure: Measure, shown: &mut [[u8; 3]]) -> RowDifference {
    let mut found = RowDifference::default();
    for (x, out) in shown.iter_mut().enumerate() {
        let [before, after] = [a, b].map(|picture| picture.at([x, y]));
        let square = if before == after { 0.0 } else { apart(before, after) };
        found.largest = found.largest.max(square);
        let differs = match measure {
            Measure::Equality => before != after,
            Measure::Seen(threshold) => square > BLACK_TO_WHITE * threshold * threshold,
        };
        let is_smoothed = || a.smooths([x, y], b) || b.smooths([x, y], a);
        *out = if !differs {
            faint(before)
        } else if measure != Measure::Equality && is_smoothed() {
            found.smoothed += 1;
            SMOOTHING_COLOR
        } else {
            found.different += 1;
            DIFFERENCE_COLOR
        };
    }
    found
}

/// Returns a colour channel of a pixel in front of white, 0 to 255.
fn on_white(value: u8, alpha: u8) -> f64 {
    255.0 + (f64::from(value) - 255.0) * f64::from(alpha) / 255.0
}

fn seen([r, g, b, alpha]: [u8; 4]) -> [f64; 3] {
    [r, g, b].map(|value| on_white(value, alpha))
}

/// Returns the brightness of a colour, 0 to 255.
fn brightness([r, g, b]: [f64; 3]) -> f64 {
    r * 0.298_895_31 + g * 0.586_622_47 + b * 0.114_482_23
}

/// Returns the squared distance of two colours on white, `0.5053 Y^2 + 0.299 I^2 + 0.1957 Q^2`, 0 to
/// [`BLACK_TO_WHITE`].
fn apart(a: [u8; 4], b: [u8; 4]) -> f64 {
    let (a, b) = (seen(a), seen(b));
    let [r, g, b] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let y = brightness([r, g, b]);
    let i = r * 0.595_977_99 - g * 0.274_176_10 - b * 0.321_801_89;
    let q = r * 0.211_470_17 - g * 0.522_617_11 + b * 0.311_146_94;
    0.505_3 * y * y + 0.299 * i * i + 0.195_7 * q * q
}

fn faint(pixel: [u8; 4]) -> [u8; 3] {
    let [r, g, b, alpha] = pixel;
    let bright = brightness([r, g, b].map(f64::from));
    let grey = 255.0 + (bright - 255.0) * UNCHANGED_VISIBILITY * f64::from(alpha) / 255.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    let grey = grey as u8;
    [grey; 3]
}

impl Pixels {
    fn at(&self, [x, y]: [usize; 2]) -> [u8; 4] {
        self.rgba[y * self.size[0] + x]
    }

    /// Returns the pixels around a pixel: eight, fewer at the border.
    fn around(&self, [x, y]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> + use<> {
        let near = |at: usize, n: usize| at.saturating_sub(1)..=(at + 1).min(n - 1);
        let (columns, rows) = (near(x, self.size[0]), near(y, self.size[1]));
        columns.flat_map(move |i| rows.clone().map(move |j| [i, j])).filter(move |other| *other != [x, y])
    }

    fn is_at_border(&self, [x, y]: [usize; 2]) -> bool {
        x == 0 || y == 0 || x + 1 == self.size[0] || y + 1 == self.size[1]
    }

    /// Returns whether a pixel smooths an edge: it is between darker and brighter ones, at most two around it are like
    /// it, and the darkest or the brightest one lies in an even region of both pictures.
    fn smooths(&self, at: [usize; 2], other: &Self) -> bool {
        let own = self.at(at);
        let mut alike = u32::from(self.is_at_border(at));
        let (mut darkest, mut brightest) = ((0.0, at), (0.0, at));
        for near in self.around(at) {
            let pixel = self.at(near);
            let by = if pixel == own { 0.0 } else { brightness(seen(own)) - brightness(seen(pixel)) };
            if by == 0.0 {
                alike += 1;
                if alike > 2 {
                    return false;
                }
            } else if by < darkest.0 {
                darkest = (by, near);
            } else if by > brightest.0 {
                brightest = (by, near);
            }
        }
        let is_even = |(_, at): (f64, [usize; 2])| self.is_even(at) && other.is_even(at);
        darkest.0 != 0.0 && brightest.0 != 0.0 && (is_even(darkest) || is_even(brightest))
    }

    /// Returns whether more than two pixels around a pixel have its colour; the border counts as one of them.
    fn is_even(&self, at: [usize; 2]) -> bool {
        let own = self.at(at);
        let same = self.around(at).filter(|&near| self.at(near) == own).count();
        same + usize::from(self.is_at_border(at)) > 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(a: &Pixels, b: &Pixels, measure: Measure) -> Difference {
        difference(a, b, measure, &Watch::new()).expect("nobody stops it")
    }

    fn of(width: usize, rgba: Vec<[u8; 4]>) -> Pixels {
        Pixels { size: [width, rgba.len() / width], rgba }
    }

    #[test]
    fn black_and_white_are_as_far_apart_as_colours_can_be_weighted() {
        let [black, white] = [0, 255].map(|v| of(1, vec![[v, v, v, 255]]));
        let found = compared(&black, &white, Measure::Seen(0.1));
        // 0.5053 * 255^2 of 35215
        assert!((found.largest - (0.505_3 * 255.0 * 255.0 / 35_215.0_f64).sqrt()).abs() < 1e-6, "{}", found.largest);
        assert_eq!((found.different, found.picture), (1, vec![DIFFERENCE_COLOR]));
        let clear = of(1, vec![[9, 9, 9, 0]]);
        assert_eq!(compared(&clear, &white, Measure::Seen(0.0)).different, 0, "on white nothing of it is seen");
        assert_eq!(compared(&clear, &white, Measure::Equality).different, 1);
    }

    #[test]
    fn a_faint_difference_counts_by_equality_and_not_by_sight() {
        let a = of(2, vec![[100, 100, 100, 255]; 4]);
        let mut b = a.clone();
        b.rgba[3] = [101, 100, 100, 255];
        assert_eq!(compared(&a, &b, Measure::Equality).different, 1);
        assert_eq!(compared(&a, &b, Measure::Seen(0.1)).different, 0);
    }

    #[test]
    fn a_pixel_that_smooths_an_edge_is_told_apart() {
        // black above white, with one grey pixel at the edge in the second picture
        let a = of(5, [[[0, 0, 0, 255]; 10].as_slice(), &[[255; 4]; 15]].concat());
        let mut b = a.clone();
        b.rgba[12] = [90, 90, 90, 255];
        let found = compared(&a, &b, Measure::Seen(0.1));
        assert_eq!((found.different, found.smoothed, found.picture[12]), (0, 1, SMOOTHING_COLOR));
        assert_eq!(compared(&a, &b, Measure::Equality).different, 1, "where the bits count nothing is forgiven");
    }

    const COMPARED_SIDE: usize = 64;

    /// A disc with a soft rim, shifted to the left by half of `shift` pixels.
    fn disc(shift: i64, green: i64) -> Pixels {
        let pixel = |at: usize| {
            let [column, row] = [at % COMPARED_SIDE, at / COMPARED_SIDE].map(|n| i64::try_from(n).expect("below 64"));
            let (x, y) = (2 * column - 63 + shift, 2 * row - 63);
            let v = (255 * (1936 - x * x - y * y) / 640).clamp(0, 255);
            [v, v * green / 255, 255 - v, 255].map(|v| u8::try_from(v).expect("up to 255"))
        };
        of(COMPARED_SIDE, (0..COMPARED_SIDE * COMPARED_SIDE).map(pixel).collect())
    }

    fn noise(mut state: u32) -> Pixels {
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            128 + u8::try_from((state >> 24) % 40).expect("below 40")
        };
        of(COMPARED_SIDE, (0..COMPARED_SIDE * COMPARED_SIDE).map(|_| [next(), next(), next(), 255]).collect())
    }

    #[test]
    fn as_many_pixels_differ_as_pixelmatch_counts() {
        // pixels that differ, and yellow ones, as the versions 5.3 and 7.1 of pixelmatch count them
        let cases = [
            (disc(0, 255), disc(1, 255), 0.05, [168, 190]),
            (disc(0, 255), disc(1, 255), 0.1, [96, 72]),
            (disc(0, 255), disc(1, 255), 0.3, [0, 0]),
            (disc(0, 100), disc(4, 120), 0.05, [1278, 246]),
            (disc(0, 100), disc(4, 120), 0.1, [302, 170]),
            (disc(0, 100), disc(4, 120), 0.3, [136, 0]),
            (noise(1), noise(2), 0.02, [3866, 0]),
            (noise(1), noise(2), 0.1, [138, 0]),
        ];
        for (a, b, threshold, counted) in cases {
            let found = compared(&a, &b, Measure::Seen(threshold));
            assert_eq!([found.different, found.smoothed], counted, "at {threshold}");
            let red = found.picture.iter().filter(|pixel| **pixel == DIFFERENCE_COLOR).count() as u64;
            assert_eq!(red, counted[0]);
        }
    }
}
