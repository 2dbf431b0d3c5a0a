//! Evaluates limit positions and normals of meshes that were refined patch by patch.

use rayon::prelude::*;

use super::normals::Normals;
use super::program::Program;
use super::refined::{RefinedChannel, RefinedMesh};
use super::sweep::{Stencils, ValueRule};
use crate::math::functions::sqrt;
use crate::math::vector::{cross, direction, dot, length, plus};
use crate::watch::{Stopped, Watch};

impl Program {
    /// Replaces the points and vertex channels of a mesh that this program refined by their limits, and adds normals,
    /// for each of the two stencil tables that is given. Returns `None` if the mesh was not refined patch by patch, or
    /// if a vertex with faces has no normal.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(crate) fn at_limit(
        &self,
        refined: RefinedMesh,
        limits: Option<&Stencils>,
        normals: Option<&Stencils>,
        watch: &Watch,
    ) -> Result<Option<RefinedMesh>, Stopped> {
        let Some(sweep) = self.points().filter(|_| refined.order.is_documented()) else { return Ok(None) };
        let normals = match normals {
            Some(stencils) => {
                let found = sweep.evaluate(&refined.points, stencils, NORMAL_RULE, watch)?;
                let is_isolated = |v: usize| v < refined.base.n_vertices() && refined.base.is_isolated(v);
                let missing = |(v, normal): (usize, &[f64; 3])| is_zero(normal) && !is_isolated(v);
                let of_vertices = found.values.as_chunks().0;
                if of_vertices.par_iter().with_min_len(NORMALS_PER_TASK).enumerate().any(missing)
                    || found.sides.iter().any(|(_, normal)| is_zero(normal))
                {
                    return Ok(None);
                }
                Some(Normals { of_vertices: found.values, sides: found.sides })
            }
            None => None,
        };
        let mut refined = refined.with_normals(normals);
        if let Some(stencils) = limits {
            let limits_of = |numbers: &[f64], width: usize| match width {
                1 => sweep.evaluate::<1>(numbers, stencils, positions(), watch).map(|found| found.values),
                2 => sweep.evaluate::<2>(numbers, stencils, positions(), watch).map(|found| found.values),
                3 => sweep.evaluate::<3>(numbers, stencils, positions(), watch).map(|found| found.values),
                _ => sweep.evaluate::<4>(numbers, stencils, positions(), watch).map(|found| found.values),
            };
            refined.points = limits_of(&refined.points, 3)?;
            for (refined, channel) in refined.channels.iter_mut().zip(&refined.attachments.channels) {
                // channels with seams keep their values
                if let RefinedChannel::Vertices(numbers) = refined {
                    *numbers = limits_of(numbers, channel.width)?;
                }
            }
        }
        Ok(Some(refined))
    }
}

/// Minimum number of normals that one thread checks at a time. A check is three comparisons, so that smaller tasks cost
/// more switching than work; with twice of it threads are idle at smaller meshes.
const NORMALS_PER_TASK: usize = 4096;

/// The sine of the smallest angle between two tangents for which their cross product still gives a normal. The rounding
/// of tangents of length 1 turns such a normal by some 1e-7 radians; half of it doubles that; twice of it halves that,
/// and leaves vertices without a normal whose tangents are up to 2e-9 radians apart.
const LEAST_TANGENT_SINE: f64 = 1e-9;

fn first<const W: usize>(values: &[[f64; W]]) -> [f64; W] {
    values[0]
}

/// The rule for positions and vertex channels: a vertex without faces keeps its value.
fn positions<const W: usize>() -> ValueRule<W> {
    ValueRule { of: first, join: first, alone: |point| point }
}

/// The rule for normals, each from two tangents; zero where the tangents span no plane.
const NORMAL_RULE: ValueRule<3> =
    ValueRule { of: |tangents| normal(tangents[0], tangents[1]), join: sum, alone: |_| [0.0; 3] };

/// Returns `t x u` scaled to length one, or zero if the sine of their angle is not above [`LEAST_TANGENT_SINE`].
#[inline]
fn normal(t: [f64; 3], u: [f64; 3]) -> [f64; 3] {
    const SAFE_PRODUCTS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
    let product = cross(t, u);
    let squares = [dot(t, t), dot(u, u), dot(product, product)];
    if squares.iter().all(|square| SAFE_PRODUCTS.contains(square)) {
        let above = squares[2] > LEAST_TANGENT_SINE * LEAST_TANGENT_SINE * squares[0] * squares[1];
        let length = if above { sqrt(squares[2]) } else { f64::INFINITY };
        return product.map(|x| x / length);
    }
    let (Some(t), Some(u)) = (direction(t), direction(u)) else { return [0.0; 3] };
    let product = cross(t, u);
    if length(product) > LEAST_TANGENT_SINE { direction(product).unwrap_or_default() } else { [0.0; 3] }
}

/// Returns whether `normal` is the zero vector, which stands for "no normal".
fn is_zero(normal: &[f64; 3]) -> bool {
    normal.iter().all(|&x| x == 0.0)
}

/// Returns the direction of the sum of the sector normals, or zero if any sector has no normal.
fn sum(sectors: &[[f64; 3]]) -> [f64; 3] {
    let none = sectors.iter().any(is_zero);
    let sum = || direction(sectors.iter().copied().fold([0.0; 3], plus));
    if none { [0.0; 3] } else { sum().unwrap_or_default() }
}
