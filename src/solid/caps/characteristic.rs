//! The characteristic net of a smooth vertex: the planar two-ring that a refinement scales by the factor lambda.
//! Source: J. Stam, SIGGRAPH 1998, 395-404.

use super::rings::Rings;
use crate::math::functions::{cos, ratio, sin, sqrt};
use crate::math::vector::{complex_product, dot, minus};

/// Number of refinements after which the net counts as the limit. The second eigenvalue of its block is less than 0.4
/// times the first, so that 40 reach rounding errors; half as many leave 1e-8, twice as many change nothing.
const LIMIT_REFINEMENTS: usize = 40;

/// Returns the cosine of `2 pi k / n`.
pub(super) fn turn_cos(k: usize, n: usize) -> f64 {
    cos(2.0 * std::f64::consts::PI * ratio(k % n, n))
}

/// Returns the sine of `2 pi k / n`.
pub(super) fn turn_sin(k: usize, n: usize) -> f64 {
    sin(2.0 * std::f64::consts::PI * ratio(k % n, n))
}

/// Returns the largest eigenvalue of the subdivision matrix of valence n at frequency k.
fn eigenvalue(k: usize, n: usize) -> f64 {
    let (c, half) = (turn_cos(k, n), turn_cos(k, 2 * n));
    (5.0 + c + half * sqrt(2.0 * (9.0 + c))) / 16.0
}

/// Returns lambda, the subdominant eigenvalue at valence n, by which distances around the vertex shrink in each
/// refinement.
pub(super) fn subdominant(n: usize) -> f64 {
    eigenvalue(1, n)
}

/// Returns mu, the largest eigenvalue after lambda, by which the deviation of a cap at valence n shrinks in each
/// refinement.
pub fn decay(n: usize) -> f64 {
    if n < 5 { 0.25 } else { eigenvalue(2, n).max(0.25) }
}

/// Returns the number of refinements, at least one, after which the deviation of a cap has shrunk to a fraction.
pub(super) fn rings_until(n: usize, fraction: f64) -> usize {
    let (mut rings, mut left) = (1, decay(n));
    while left > fraction {
        left *= decay(n);
        rings += 1;
    }
    rings
}

/// Extends sector 0 of a net to all sectors by rotation.
fn symmetric(sector: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
    let turns = (0..n).map(|s| [turn_cos(s, n), turn_sin(s, n)]);
    let all = turns.flat_map(|turn| sector.iter().map(move |point| complex_product(turn, *point)));
    std::iter::once([0.0; 2]).chain(all).collect()
}

/// Returns the characteristic net of valence n, whose first spoke runs from 0 to (1, 0).
pub(super) fn characteristic_net(n: usize) -> Rings<2> {
    let (c, s) = (turn_cos(1, n), turn_sin(1, n));
    let places = [[1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]];
    let mut sector = places.map(|[u, v]| [u + v * c, v * s]).to_vec();
    for _ in 0..LIMIT_REFINEMENTS {
        let refined = Rings::of_two_ring(&symmetric(&sector, n)).refined().two_ring();
        let first = minus(refined[1], refined[0]);
        let square = dot(first, first);
        let back = [first[0] / square, -first[1] / square];
        sector =
            refined[1..=sector.len()].iter().map(|point| complex_product(back, minus(*point, refined[0]))).collect();
    }
    Rings::of_two_ring(&symmetric(&sector, n))
}
