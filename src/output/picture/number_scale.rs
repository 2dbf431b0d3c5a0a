//! Numbers as colours: the range of a scale, and the place of a number in it.

use rayon::prelude::*;

use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Value, Values};
use crate::output::color_maps::{COLOR_MAP, ColorMap};
use crate::output::numbers::rounded;

/// The range of numbers that colours cover.
pub(crate) const COLOR_RANGE: Parameter = Parameter::optional(
    "range",
    ParameterKind::Numbers { most: 2 },
    "The least and the greatest number that have a colour of their own, where colours are numbers; what is beyond \
     has the colour of the end. Curvature is in 1 / model units, Gaussian in 1 / model units squared, distance in \
     model units. Left out: of curvature, symmetric about 0, what 95 % of the surface keeps to; of distances 0 \
     to the largest; of channels the least to the greatest.",
);

/// Whether there is a legend.
pub(crate) const COLOR_BAR: Parameter = Parameter::optional(
    "color_bar",
    ParameterKind::Flag,
    "Whether a bar at the right says which colour stands for which number. Left out, it does where colours are \
     numbers and the picture is at least 320 x 200 pixels.",
);

/// Share of the surface whose curvature is within the default range. Curvature grows without bound towards
/// extraordinary vertices of many schemes, and is large on small details: at 97.5 % these pale the rest of meshes with
/// details, at 90 % a tenth of all surfaces has the colours of the ends.
const RANGE_SHARE: f64 = 0.95;

/// A mapping of numbers to colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NumberScale {
    /// The least number with a colour of its own.
    pub(super) low: f64,
    /// The greatest number with a colour of its own.
    pub(super) high: f64,
    /// Whether there are numbers below the least and above the greatest.
    pub(super) beyond: [bool; 2],
    /// The table of colours.
    pub(super) map: ColorMap,
}

impl NumberScale {
    /// Returns the scale of some numbers that the options give, with the map `map` and the range that `usual` makes of
    /// the least and the greatest number as defaults.
    pub(super) fn new(
        numbers: &[f64],
        options: &Values,
        map: ColorMap,
        usual: impl FnOnce([f64; 2]) -> [f64; 2],
    ) -> Self {
        let [least, greatest] = extent(numbers);
        let [low, high] = match *options.numbers(COLOR_RANGE.name) {
            [low, high] => [low, high],
            _ => usual([least, greatest]),
        };
        Self { low, high, beyond: [least < low, greatest > high], map: ColorMap::of(options, map) }
    }

    /// Returns the place of a number in the table of colours, from 0 to 1 over the range. In diverging maps the number
    /// 0 is in the middle, and only the end of the range that is farther from 0 reaches an end of the table.
    pub(super) fn share(&self, x: f64) -> f32 {
        // halved, so that the length of the range does not overflow
        let (x, low, high) = (0.5 * x.clamp(self.low, self.high), 0.5 * self.low, 0.5 * self.high);
        let (from, range) = if self.map.is_diverging() {
            let end = low.abs().max(high.abs());
            (-end, 2.0 * end)
        } else {
            (low, high - low)
        };
        rounded(if range > 0.0 { (x / range - from / range).clamp(0.0, 1.0) } else { 0.5 })
    }
}

/// Returns a range symmetric about 0, at least from `-least` to `least`, that contains [`RANGE_SHARE`] of the numbers
/// by weight. Weights are not negative.
pub(super) fn symmetric(numbers: &[f64], weights: &[f64], least: f64) -> [f64; 2] {
    let sizes = numbers.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    let mut sizes: Vec<[f64; 2]> = sizes.map(|(x, weight)| [x.abs(), *weight]).collect();
    // equal sizes are ordered by weight, so that sums do not depend on how threads sort
    sizes.par_sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let most = RANGE_SHARE * sizes.iter().map(|[_, weight]| weight).sum::<f64>();
    let mut sum = 0.0;
    let size = sizes.iter().find(|[_, weight]| {
        sum += weight;
        sum >= most
    });
    let size = size.map_or(0.0, |[size, _]| *size).max(least).min(f64::MAX);
    [-size, size]
}

/// Returns the least and the greatest of some numbers; two zeros for none.
fn extent(numbers: &[f64]) -> [f64; 2] {
    let first = numbers.first().copied().unwrap_or(0.0);
    numbers.iter().fold([first; 2], |[low, high], &x| [low.min(x), high.max(x)])
}

/// Refuses a range, a map or a legend if colours are not numbers, and malformed ranges.
pub(crate) fn check(options: &Values, are_numbers: bool) -> Result<(), Fault> {
    for option in [COLOR_RANGE.name, COLOR_MAP.name, COLOR_BAR.name] {
        if !are_numbers && *options.get(option) != Value::Absent {
            let detail = "colours are numbers under \"shading\" gaussian-curvature, mean-curvature and distance, and \
                          where \"color_by\" shows one component of a channel; leave it out";
            return Err(Fault::new(format!("/{option}"), detail));
        }
    }
    match *options.numbers(COLOR_RANGE.name) {
        [low, high] if low < high => Ok(()),
        _ if *options.get(COLOR_RANGE.name) == Value::Absent => Ok(()),
        _ => Err(Fault::new("/range", "a range is two numbers, the least before the greatest: [-1, 1]")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_run_from_end_to_end_and_are_half_at_zero_where_the_middle_is_pale() {
        let scale = |low, high, map| NumberScale { low, high, beyond: [false; 2], map };
        let plain = scale(1.0, 3.0, ColorMap::EVEN);
        let signed = scale(-1.0, 4.0, ColorMap::SIGNED);
        for (scale, x, expected) in [
            (plain, 1.0, 0.0),
            (plain, 2.0, 0.5),
            (plain, 9.0, 1.0),
            (plain, -9.0, 0.0),
            (signed, 0.0, 0.5),
            (signed, 4.0, 1.0),
            (signed, -1.0, 0.375),
            (signed, -2.0, 0.375),
            (scale(-f64::MAX, f64::MAX, ColorMap::EVEN), 0.0, 0.5),
            (scale(-f64::MAX, f64::MAX, ColorMap::SIGNED), f64::MAX, 1.0),
            (scale(2.0, 2.0, ColorMap::EVEN), 2.0, 0.5),
        ] {
            assert!((scale.share(x) - expected).abs() < 1e-6_f32, "{scale:?} {x}: {}", scale.share(x));
        }
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "ranges end at the numbers themselves")]
    fn a_few_wild_numbers_do_not_widen_a_range() {
        let mut numbers: Vec<f64> = (0..200).map(|i| f64::from(i % 100) / 100.0).collect();
        (numbers[7], numbers[11]) = (-1e300, f64::MAX);
        let [low, high] = symmetric(&numbers, &[1.0; 200], 0.0);
        assert!((0.9..1.0).contains(&high) && low.to_bits() == (-high).to_bits(), "{low} {high}");
        // numbers that cover little of the surface do not widen it either
        assert_eq!(symmetric(&[9.0, 2.0, 9.0], &[0.02, 1.0, 0.02], 0.0), [-2.0, 2.0]);
        assert_eq!(symmetric(&[], &[], 0.5), [-0.5, 0.5]);
        assert_eq!(symmetric(&[1e-17; 5], &[1.0; 5], 1e-6), [-1e-6, 1e-6]);
        assert_eq!(extent(&[]), [0.0, 0.0]);
    }
}
