//! Evaluates limit positions and normals of meshes that were refined patch by patch.

use std::ops::RangeInclusive;

use multiversion::multiversion;

use super::normals::Normals;
use super::program::Program;
use super::refined::{RefinedChannel, RefinedMesh};
use super::sweep::{PointValues, Stencils, Sweep, ValueRule};
use crate::kept::Numbers;
use crate::math::functions::sqrt;
use crate::math::vector::{cross, direction, dot, is_zero, length, plus};
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
        let limits_wanted = limits.map(|stencils| (stencils, positions()));
        let wanted: Vec<_> = limits_wanted.into_iter().chain(normals.map(|stencils| (stencils, NORMAL_RULE))).collect();
        let mut found = sweep.evaluate(&refined.points, &wanted, watch)?.into_iter();
        let points = limits_wanted.and_then(|_| found.next());
        let normals = found.next();
        let is_missing =
            |normals: &PointValues<3>| normals.has_zero || normals.sides.iter().any(|(_, normal)| is_zero(normal));
        if normals.as_ref().is_some_and(is_missing) {
            return Ok(None);
        }
        let normals = normals.map(|found| Normals { of_vertices: found.values, sides: found.sides });
        let mut refined = refined.with_normals(normals);
        if let (Some(stencils), Some(points)) = (limits, points) {
            refined.points = points.values;
            for (refined, channel) in refined.channels.iter_mut().zip(&refined.attachments.channels) {
                // channels with seams keep their values
                if let RefinedChannel::Vertices(numbers) = refined {
                    *numbers = match channel.width {
                        1 => limits_of::<1>(sweep, numbers, stencils, watch),
                        2 => limits_of::<2>(sweep, numbers, stencils, watch),
                        3 => limits_of::<3>(sweep, numbers, stencils, watch),
                        _ => limits_of::<4>(sweep, numbers, stencils, watch),
                    }?;
                }
            }
        }
        Ok(Some(refined))
    }
}

/// Returns the limits of the numbers of a vertex channel.
fn limits_of<const W: usize>(
    sweep: &Sweep,
    numbers: &[f64],
    stencils: &Stencils,
    watch: &Watch,
) -> Result<Numbers, Stopped> {
    let mut found = sweep.evaluate::<W>(numbers, &[(stencils, positions())], watch)?;
    Ok(found.swap_remove(0).values)
}

/// The sine of the smallest angle between two tangents for which their cross product still gives a normal. The rounding
/// of tangents of length 1 turns such a normal by some 1e-7 radians; half of it doubles that; twice of it halves that,
/// and leaves vertices without a normal whose tangents are up to 2e-9 radians apart.
const LEAST_TANGENT_SINE: f64 = 1e-9;

fn first<const W: usize>(values: &[[f64; W]]) -> [f64; W] {
    values[0]
}

/// The rule for positions and vertex channels: a vertex without faces keeps its value.
fn positions<const W: usize>() -> ValueRule<W> {
    ValueRule { of: first, of_all: |_, _| {}, join: first, alone: |point| point }
}

/// The rule for normals, each from two tangents; zero where the tangents span no plane.
const NORMAL_RULE: ValueRule<3> =
    ValueRule { of: |tangents| normal(tangents[0], tangents[1]), of_all: normals, join: sum, alone: |_| [0.0; 3] };

/// Squared lengths for which no product of two of them has overflowed or lost digits to underflow.
const SAFE_PRODUCTS: RangeInclusive<f64> = 1e-100..=1e100;

/// Number of normals that are computed side by side, as many as the widest registers hold. Half of it leaves half of
/// them empty; twice of it takes more registers than there are.
const SIDE_BY_SIDE: usize = 8;

/// Replaces tangents by the normals of the planes that they span with those of `second`.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn normals(first: &mut [[f64; 3]], second: &[[f64; 3]]) {
    let (blocks, rest) = first.as_chunks_mut::<SIDE_BY_SIDE>();
    let (others, last) = second.as_chunks::<SIDE_BY_SIDE>();
    for (block, other) in blocks.iter_mut().zip(others) {
        let (mut t, mut u) = ([[0.0; SIDE_BY_SIDE]; 3], [[0.0; SIDE_BY_SIDE]; 3]);
        for k in 0..SIDE_BY_SIDE {
            for c in 0..3 {
                (t[c][k], u[c][k]) = (block[k][c], other[k][c]);
            }
        }
        let mut found = [[0.0; SIDE_BY_SIDE]; 3];
        let mut safe = [true; SIDE_BY_SIDE];
        for k in 0..SIDE_BY_SIDE {
            let x = t[1][k] * u[2][k] - t[2][k] * u[1][k];
            let y = t[2][k] * u[0][k] - t[0][k] * u[2][k];
            let z = t[0][k] * u[1][k] - t[1][k] * u[0][k];
            let square_t = t[0][k] * t[0][k] + t[1][k] * t[1][k] + t[2][k] * t[2][k];
            let square_u = u[0][k] * u[0][k] + u[1][k] * u[1][k] + u[2][k] * u[2][k];
            let square = x * x + y * y + z * z;
            let above = square > LEAST_TANGENT_SINE * LEAST_TANGENT_SINE * square_t * square_u;
            let length = if above { sqrt(square) } else { f64::INFINITY };
            (found[0][k], found[1][k], found[2][k]) = (x / length, y / length, z / length);
            let is_safe = |square: f64| (square >= *SAFE_PRODUCTS.start()) & (square <= *SAFE_PRODUCTS.end());
            safe[k] = is_safe(square_t) & is_safe(square_u) & is_safe(square);
        }
        if safe.contains(&false) {
            block.iter_mut().zip(other).for_each(|(t, u)| *t = normal(*t, *u));
        } else {
            for k in 0..SIDE_BY_SIDE {
                for c in 0..3 {
                    block[k][c] = found[c][k];
                }
            }
        }
    }
    rest.iter_mut().zip(last).for_each(|(t, u)| *t = normal(*t, *u));
}

/// Returns `t x u` scaled to length one, or zero if the sine of their angle is not above [`LEAST_TANGENT_SINE`].
#[inline]
fn normal(t: [f64; 3], u: [f64; 3]) -> [f64; 3] {
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

/// Returns the direction of the sum of the sector normals, or zero if any sector has no normal.
fn sum(sectors: &[[f64; 3]]) -> [f64; 3] {
    let none = sectors.iter().any(is_zero);
    let sum = || direction(sectors.iter().copied().fold([0.0; 3], plus));
    if none { [0.0; 3] } else { sum().unwrap_or_default() }
}
