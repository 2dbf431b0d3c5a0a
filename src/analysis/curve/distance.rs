//! Bounds the distance of a polygon from its limit curve by its second differences.
//!
//! A scheme that reproduces linear functions moves a polygon only by its second differences. Let `p` be the polygon
//! after some levels, `f` its piecewise linear curve, `F` the limit curve in the same parameter and `D = max |p[i-1] -
//! 2 p[i] + p[i+1]|`. Then `F - f = sum over i of w[i] (p[i-1] - 2 p[i] + p[i+1])`, so that `|F - f| <= max sum |w| D`.
//! The sum is exact for the points after `n` more levels. The levels after these add at most `B D' / (1 - N)`, with the
//! second differences `D'` after the `n` levels, the bound `B` of one block of levels over `D'`, and the norm `N < 1`
//! by which a block multiplies second differences.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), section 3, on difference schemes; Nairn, Peters and Lutterkort, CAGD
//! 16 (1999), 613-631, on second differences as a measure of the distance.

use std::ops::Range;

use super::cycle::{CycleMask, NoMask};
use crate::math::number::Number;
use crate::scheme::plan::Plan;
use crate::watch::{Stopped, Watch};

/// Maximum number of new points per old point of the levels that are combined into a block: eight binary levels. Half
/// of it combines seven, which may bound less sharply; twice of it combines nine, whose masks are twice as long.
const MAX_BLOCK: i64 = 256;
/// Maximum work of a search in units of 100 ns, each a row of a table or as many products of weights: 13 s. Words of U
/// and 63 C, whose masks are the longest of those in use, take a 16th of it. Half or twice of it halves or doubles the
/// time after which a search is refused.
pub const MAX_CURVE_WORK: u64 = 1 << 27;
/// Largest sum, relative to the weights, that is regarded as 0; masks written with nine digits pass. Half of it would
/// refuse some of these; twice of it would admit masks that miss linear functions by twice as much.
const MASK_SUM_ROUNDING: f64 = 1e-9;
/// Maximum level that is tried; a plan has no more levels. Half of it would refuse tolerances that slowly contracting
/// schemes meet later; twice of it would find levels that no plan may have.
const MAX_TRIED_LEVEL: usize = 64;

/// The reason why second differences give no bound of the distance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoBound {
    /// The plan is not one mask per level.
    #[error("{0}, so that no distance to the limit is known in advance")]
    Plan(NoMask),
    /// The scheme does not preserve straight polygons with equal edges.
    #[error("the scheme does not reproduce linear functions, so that second differences do not bound its distance")]
    NotLinear,
    /// Second differences are not known to converge to 0.
    #[error("second differences need not vanish under the scheme, so that they do not bound its distance")]
    NotContractive,
    /// Combining the masks of several levels takes too much work.
    #[error(
        "the distance to the limit takes more than {MAX_CURVE_WORK} steps to bound, which is the most that is done; \
         give \"levels\" as a number, or a shorter word"
    )]
    TooLong,
    /// The watch stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<NoMask> for NoBound {
    fn from(error: NoMask) -> Self {
        if let NoMask::Stopped(stopped) = error { Self::Stopped(stopped) } else { Self::Plan(error) }
    }
}

/// The effect of the levels of a plan on second differences.
#[derive(Debug)]
pub struct Distances {
    changing: Vec<CycleMask>,
    settled: CycleMask,
    /// Checked while levels are combined.
    watch: Watch,
    /// The work that the watch had recorded before the search began.
    start: u64,
}

/// Several levels combined into one cycle, with twice the new index of the place of point 0.
#[derive(Debug, Clone)]
struct CombinedCycle {
    cycle: CycleMask,
    twice_centre: i64,
}

impl Distances {
    /// Prepares the bounds for a plan.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn of(plan: &Plan, watch: &Watch) -> Result<Self, NoBound> {
        let start = watch.done();
        let (changing, settled) = CycleMask::from_level(plan, 0, watch)?;
        Ok(Self { changing, settled, watch: watch.clone(), start })
    }

    fn cycle(&self, level: usize) -> &CycleMask {
        self.changing.get(level).unwrap_or(&self.settled)
    }

    /// Combines the levels of a range; an empty range gives the identity.
    fn block(&self, levels: Range<usize>) -> Result<CombinedCycle, NoBound> {
        let mut block = CombinedCycle { cycle: CycleMask::identity(), twice_centre: 0 };
        for cycle in levels.map(|level| self.cycle(level)) {
            let done = self.watch.done().saturating_sub(self.start);
            if done.saturating_add(block.cycle.work_with(cycle)) > MAX_CURVE_WORK {
                return Err(NoBound::TooLong);
            }
            block.twice_centre = cycle.arity * block.twice_centre + cycle.twice_centre();
            block.cycle = block.cycle.then(cycle, &self.watch)?;
        }
        Ok(block)
    }

    /// Returns the number of levels in a block.
    fn block_length(&self) -> usize {
        let (mut length, mut arity) = (1, self.settled.arity);
        while arity * self.settled.arity <= MAX_BLOCK {
            arity *= self.settled.arity;
            length += 1;
        }
        length
    }

    /// Returns an upper bound of the factor by which the levels from `before` to `after` multiply the greatest second
    /// difference.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn contraction(&self, before: usize, after: usize) -> Result<f64, NoBound> {
        let length = self.block_length();
        let mut factor = 1.0;
        for start in (before..after).step_by(length) {
            let end = after.min(start + length);
            factor *= self.block(start..end)?.second_differences()?;
        }
        Ok(factor)
    }

    /// Returns an upper bound of the distance of the polygon after `level` levels from the limit, divided by its
    /// greatest second difference.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn factor(&self, level: usize) -> Result<f64, NoBound> {
        let length = self.block_length();
        let first = self.block(level..level + length)?;
        let mut sum = first.deviation()?;
        let mut left = first.second_differences()?;
        let mut start = level + length;
        while start < self.changing.len() {
            let (deviations, contraction) = self.following(start, length)?;
            sum += left * deviations;
            left *= contraction;
            start += length;
        }
        let (deviations, contraction) = self.following(start, length)?;
        if contraction < 1.0 { Ok(sum + left * deviations / (1.0 - contraction)) } else { Err(NoBound::NotContractive) }
    }

    /// Returns two factors of the greatest second difference before the block of levels that begins at `start`: a bound
    /// of the sum of the movements of all its levels, and the factor by which the block multiplies the second
    /// difference.
    fn following(&self, start: usize, length: usize) -> Result<(f64, f64), NoBound> {
        let mut sum = 0.0;
        for level in start..start + length {
            let left = self.block(start..level)?.second_differences()?;
            sum += left * self.block(level..level + 1)?.deviation()?;
        }
        let all = self.block(start..start + length)?;
        Ok((sum, all.second_differences()?))
    }

    /// Returns the first level at which the distance is proved to be at most `tolerance`, with the bound of the
    /// distance. `second_differences[l]` is the greatest second difference after `l` levels, as far as known (at least
    /// one entry).
    ///
    /// # Errors
    /// [`NoBound`]; `Ok(None)` if no level meets the tolerance.
    pub fn level(&self, second_differences: &[f64], tolerance: f64) -> Result<Option<(u32, f64)>, NoBound> {
        let (known, last) = (second_differences.len() - 1, second_differences.last().copied().unwrap_or(0.0));
        let mut settled = None;
        for level in 0..=MAX_TRIED_LEVEL {
            let bends = match second_differences.get(level) {
                Some(&bends) => bends,
                None => last * self.contraction(known, level)?,
            };
            let factor = match settled {
                Some(factor) => factor,
                None => self.factor(level)?,
            };
            if level >= self.changing.len() {
                settled = Some(factor);
            }
            if factor * bends <= tolerance {
                return Ok(Some((u32::try_from(level).unwrap_or(u32::MAX), factor * bends)));
            }
        }
        Ok(None)
    }
}

impl CombinedCycle {
    /// Returns the index of the first old point that enters new point `j`, and the weights of the old points from it
    /// on.
    fn row(&self, j: i64) -> (i64, Vec<f64>) {
        let (d, mask) = (self.cycle.arity, &self.cycle.mask);
        let first = -(i64::from(mask.last()) - j).div_euclid(d);
        let last = (j - i64::from(mask.first)).div_euclid(d);
        (first, (first..=last).map(|i| self.cycle.at(j - d * i)).collect())
    }

    /// Returns the greatest sum of absolute weights of old second differences in the distance of new points from the
    /// old polygon.
    fn deviation(&self) -> Result<f64, NoBound> {
        let d = self.cycle.arity;
        let mut most: f64 = 0.0;
        for j in 0..d {
            // twice the place of new point j in units of new edges, from old point 0
            let place = 2 * j - self.twice_centre;
            let (before, part) = (place.div_euclid(2 * d), f64::ratio(place.rem_euclid(2 * d), 2 * d));
            most = most.max(bend(&[(1.0, self.row(j)), (-1.0, (before, vec![1.0 - part, part]))])?);
        }
        // old points also count, as vertices of the old polygon; dual schemes place them halfway between new points
        let low = self.twice_centre.div_euclid(2);
        let high = low + self.twice_centre.rem_euclid(2);
        Ok(most.max(bend(&[(0.5, self.row(low)), (0.5, self.row(high)), (-1.0, (0, vec![1.0]))])?))
    }

    /// Returns the greatest sum of absolute weights of old second differences in new second differences.
    fn second_differences(&self) -> Result<f64, NoBound> {
        let of = |j: i64| bend(&[(1.0, self.row(j - 1)), (-2.0, self.row(j)), (1.0, self.row(j + 1))]);
        (0..self.cycle.arity).try_fold(0.0, |most: f64, j| Ok(most.max(of(j)?)))
    }
}

/// Returns the sum of absolute weights of a combination of rows when it is written in second differences: the running
/// sums of its running sums. Each row has a factor, the index of its first point, and weights.
fn bend(rows: &[(f64, (i64, Vec<f64>))]) -> Result<f64, NoBound> {
    let least = rows.iter().map(|(_, (first, _))| *first).min().unwrap_or(0);
    let mut weights: Vec<f64> = Vec::new();
    for (factor, (first, row)) in rows {
        let start = usize::try_from(first - least).unwrap_or(0);
        weights.resize(weights.len().max(start + row.len()), 0.0);
        weights[start..].iter_mut().zip(row).for_each(|(sum, weight)| *sum += factor * weight);
    }
    let (mut once, mut twice, mut sum) = (0.0, 0.0, 0.0_f64);
    let size: f64 = weights.iter().map(|w| w.abs()).sum();
    for weight in &weights {
        once += weight;
        twice += once;
        sum += f64::abs(twice);
    }
    // weights with a nonzero sum or first moment are no combination of second differences
    let remainder = f64::abs(once).max(f64::abs(twice));
    if remainder <= MASK_SUM_ROUNDING * size.max(1.0) { Ok(sum) } else { Err(NoBound::NotLinear) }
}
