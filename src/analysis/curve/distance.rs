//! Bounds the distance of a polygon from its limit curve by its second differences.
//!
//! A scheme that reproduces linear functions moves a polygon only by what bends it. With the polygon `p` after some
//! levels, its piecewise linear curve `f`, the limit curve `F` in the same parameter and `D = max |p[i-1] - 2 p[i] +
//! p[i+1]|`: `F - f = sum over i of w[i] (p[i-1] - 2 p[i] + p[i+1])`, so that `|F - f| <= max sum |w| D`. The sum is
//! taken exactly where `n` more levels put their points, and for what follows by `B D' / (1 - N)` with the second
//! differences `D'` then, the greatest sum of one level `B` and the norm `N < 1` by which a block of levels multiplies
//! second differences.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), section 3, on difference schemes; Nairn, Peters and Lutterkort,
//! CAGD 16 (1999), 613-631, on second differences as a measure of the distance.

use std::ops::Range;

use super::cycle::{Cycle, NoMask, real};
use crate::scheme::plan::Plan;
use crate::watch::{Stopped, Watch};

/// Most points for each old one of the levels that are followed at once.
/// It is eight binary levels. Half of it follows seven, which may bound less sharply; twice of it follows nine, whose
/// masks are twice as long.
const MAX_BLOCK: i64 = 256;
/// Most units of work of a search, one being a row of a table or as many products of weights as take 100 ns: 13 s.
/// Words of U and 63 C, whose masks are the longest of those in use, take a 16th of it.
/// Half and twice of it halve and double the time after which a search is refused.
pub const MAX_WORK: u64 = 1 << 27;
/// What rounding leaves of sums that are 0.
/// It is relative to the weights, so that masks written with nine digits pass. Half of it refuses some of these; twice
/// of it admits masks that miss lines by twice as much.
const ROUNDING: f64 = 1e-9;
/// Most levels that are looked at.
/// A plan has no more. Half of it would refuse tolerances that schemes of slow contraction meet later; twice of it
/// finds levels that no plan may have.
const MAX_LEVELS: usize = 64;

/// The reason for which second differences give no bound of the distance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoBound {
    /// The plan is not one mask a level.
    #[error("{0}, so that no distance to the limit is known in advance")]
    Plan(NoMask),
    /// Straight polygons with equal edges do not stay what they are.
    #[error("the scheme does not reproduce linear functions, so that second differences do not bound its distance")]
    NotLinear,
    /// Second differences need not vanish.
    #[error("second differences need not vanish under the scheme, so that they do not bound its distance")]
    NotContractive,
    /// The masks of several levels are too long.
    #[error(
        "the distance to the limit takes more than {MAX_WORK} steps to bound, which is the most that is done; give \
         \"levels\" as a number, or a shorter word"
    )]
    TooLong,
    /// It was asked to stop.
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
    changing: Vec<Cycle>,
    settled: Cycle,
    /// Asked while levels are taken together.
    watch: Watch,
    /// Work that was done before.
    start: u64,
}

/// Some levels taken together, with the place that they give to point 0.
#[derive(Debug, Clone)]
struct Block {
    cycle: Cycle,
    twice_centre: i64,
}

impl Distances {
    /// Bounds the distances of a plan.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn of(plan: &Plan, watch: &Watch) -> Result<Self, NoBound> {
        let start = watch.done();
        let (changing, settled) = Cycle::from_level(plan, 0, watch)?;
        Ok(Self { changing, settled, watch: watch.clone(), start })
    }

    fn cycle(&self, level: usize) -> &Cycle {
        self.changing.get(level).unwrap_or(&self.settled)
    }

    /// Levels one after another; none at all leave everything as it is.
    fn block(&self, levels: Range<usize>) -> Result<Block, NoBound> {
        let mut block = Block { cycle: Cycle::identity(), twice_centre: 0 };
        for cycle in levels.map(|level| self.cycle(level)) {
            let done = self.watch.done().saturating_sub(self.start);
            if done.saturating_add(block.cycle.work_with(cycle)) > MAX_WORK {
                return Err(NoBound::TooLong);
            }
            block.twice_centre = cycle.arity * block.twice_centre + cycle.twice_centre();
            block.cycle = block.cycle.then(cycle, &self.watch)?;
        }
        Ok(block)
    }

    /// Levels from `level` on that are followed at once.
    fn block_length(&self) -> usize {
        let (mut length, mut arity) = (1, self.settled.arity);
        while arity * self.settled.arity <= MAX_BLOCK {
            arity *= self.settled.arity;
            length += 1;
        }
        length
    }

    /// By what `after - before` levels multiply the greatest second difference, at most.
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

    /// The distance of the polygon after `level` levels from the limit, over its greatest second difference, at most.
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

    /// Of the block of levels that begins at `start`: the sum of what each level moves, over the greatest second
    /// difference before it, and what becomes of that.
    fn following(&self, start: usize, length: usize) -> Result<(f64, f64), NoBound> {
        let mut sum = 0.0;
        for level in start..start + length {
            let left = self.block(start..level)?.second_differences()?;
            sum += left * self.block(level..level + 1)?.deviation()?;
        }
        let all = self.block(start..start + length)?;
        Ok((sum, all.second_differences()?))
    }

    /// The first level at which the distance is known to be at most `tolerance`, and that distance, where
    /// `second_differences[l]` is the greatest second difference after `l` levels, as far as known (at least one
    /// entry).
    ///
    /// # Errors
    /// [`NoBound`]; `Ok(None)` when no level does.
    pub fn level(&self, second_differences: &[f64], tolerance: f64) -> Result<Option<(u32, f64)>, NoBound> {
        let (known, last) = (second_differences.len() - 1, second_differences.last().copied().unwrap_or(0.0));
        let mut settled = None;
        for level in 0..=MAX_LEVELS {
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

impl Block {
    /// Weights of the old points in new point `j`, and the index of the first of them.
    fn row(&self, j: i64) -> (i64, Vec<f64>) {
        let (d, mask) = (self.cycle.arity, &self.cycle.mask);
        let first = -(i64::from(mask.last()) - j).div_euclid(d);
        let last = (j - i64::from(mask.first)).div_euclid(d);
        (first, (first..=last).map(|i| self.cycle.at(j - d * i)).collect())
    }

    /// The greatest sum of absolute weights of second differences in the new points less the old polygon.
    fn deviation(&self) -> Result<f64, NoBound> {
        let d = self.cycle.arity;
        let mut most: f64 = 0.0;
        for j in 0..d {
            // twice the place of new point j in units of new edges, from old point 0
            let place = 2 * j - self.twice_centre;
            let (before, part) = (place.div_euclid(2 * d), real(place.rem_euclid(2 * d)) / real(2 * d));
            most = most.max(bend(&[(1.0, self.row(j)), (-1.0, (before, vec![1.0 - part, part]))])?);
        }
        // where the old points stand, halfway between new ones in dual schemes
        let low = self.twice_centre.div_euclid(2);
        let high = low + self.twice_centre.rem_euclid(2);
        Ok(most.max(bend(&[(0.5, self.row(low)), (0.5, self.row(high)), (-1.0, (0, vec![1.0]))])?))
    }

    /// The greatest sum of absolute weights of old second differences in new ones.
    fn second_differences(&self) -> Result<f64, NoBound> {
        let of = |j: i64| bend(&[(1.0, self.row(j - 1)), (-2.0, self.row(j)), (1.0, self.row(j + 1))]);
        (0..self.cycle.arity).try_fold(0.0, |most: f64, j| Ok(most.max(of(j)?)))
    }
}

/// The sum of absolute weights of a combination of rows when it is written in second differences: the running sums of
/// its running sums. Each row has a factor, the index of its first point, and weights.
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
    // what neither sums to 0 nor is balanced is no combination of second differences
    let remainder = f64::abs(once).max(f64::abs(twice));
    if remainder <= ROUNDING * size.max(1.0) { Ok(sum) } else { Err(NoBound::NotLinear) }
}
