//! Certificates of smoothness by norms of difference schemes.
//!
//! With the mask c of `(1/d) S_(k+1)` and `c^[L](z) = c(z) c(z^d) ... c(z^(d^(L-1)))`, the limit is C^k if for some L
//! the norm `max over i of sum over j of |c^[L][i - d^L j]|` is below 1.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), theorem 4.8.

use super::symbol::Symbol;
use crate::math::exact::{Exact, rounded};
use crate::math::functions::real;

/// Maximum number of entries of an iterated mask in the search for a certificate. Certificates are meant to be checked
/// by hand, and few need more than four steps. With half of it schemes near the end of their range lose their
/// certificate, though not the proof by the joint spectral radius; twice of it takes twice as long.
const MAX_CERTIFICATE_ENTRIES: usize = 1 << 15;
/// Twice the largest relative error of one operation in f64.
pub(super) const ROUNDING_UNIT: f64 = f64::EPSILON;

/// A proof that limits are C^k. On a lattice there are two difference schemes for each derivative of order k, and the
/// largest numbers are given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothnessCertificate {
    /// The order of the derivative that is proved to be continuous.
    pub k: usize,
    /// The number L of steps of the difference scheme.
    pub l: u32,
    /// The norm of L steps, below 1 by more than its rounding error.
    pub norm: f64,
}

/// Returns the certificate with the fewest steps for each k that has one.
pub(super) fn certificates(symbol: &Symbol) -> Vec<SmoothnessCertificate> {
    (0..symbol.order).filter_map(|k| certificate(k, &symbol.difference(k)?, symbol.arity)).collect()
}

fn certificate(k: usize, mask: &[Exact], arity: i64) -> Option<SmoothnessCertificate> {
    let d = usize::try_from(arity).ok()?;
    let one: Vec<f64> = mask.iter().map(rounded).collect();
    let mut iterated = vec![1.0];
    let mut sizes = vec![1.0];
    let mut step = 1;
    for l in 1.. {
        let width = (one.len() - 1).checked_mul(step)?.checked_add(iterated.len())?;
        if width.max(step) > MAX_CERTIFICATE_ENTRIES {
            return None;
        }
        iterated = times(&iterated, one.iter().copied(), step, width);
        sizes = times(&sizes, one.iter().map(|c| c.abs()), step, width);
        step *= d;
        let norm = greatest_sum(&iterated, step);
        // every entry is a sum of at most this many products of l rounded numbers
        let roundings = real(l as usize * (one.len() + 2) + width / step + 2);
        let error = 2.0 * roundings * ROUNDING_UNIT * greatest_sum(&sizes, step);
        if norm + error < 1.0 {
            return Some(SmoothnessCertificate { k, l, norm });
        }
    }
    None
}

/// Returns the product of the polynomials `mask(z)` and `other(z^step)`.
fn times(mask: &[f64], other: impl Iterator<Item = f64>, step: usize, width: usize) -> Vec<f64> {
    let mut product = vec![0.0; width];
    for (j, c) in other.enumerate() {
        for (k, a) in mask.iter().enumerate() {
            product[j * step + k] += c * a;
        }
    }
    product
}

/// Returns the greatest sum of absolute values of entries whose indices are congruent modulo `step`.
fn greatest_sum(mask: &[f64], step: usize) -> f64 {
    let sum = |i: usize| mask[i..].iter().step_by(step).map(|c| c.abs()).sum::<f64>();
    (0..step.min(mask.len())).map(sum).fold(0.0, f64::max)
}
