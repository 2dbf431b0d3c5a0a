//! Certificates of smoothness by norms of difference schemes.
//!
//! With the mask c of `(1/d) S_(k+1)` and `c^[L](z) = c(z) c(z^d) ... c(z^(d^(L-1)))`, the limit is C^k when for some L
//! the norm `max over i of sum over j of |c^[L][i - d^L j]|` is below 1.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), theorem 4.8.

use super::symbol::Symbol;
use crate::math::exact::{Exact, rounded};

/// Most entries of an iterated mask that a certificate is looked for with.
/// Certificates are there to be checked by hand, and few need more than four steps. With half of it schemes near the
/// end of their range lose theirs, though not the proof by the joint spectral radius; twice of it takes twice as long.
const MAX_ENTRIES: usize = 1 << 15;
/// Relative error of one operation on f64, twice what it is at most.
const UNIT: f64 = f64::EPSILON;

/// A proof that limits are C^k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// The order of the derivative that is continuous.
    pub k: usize,
    /// Steps L of the difference scheme.
    pub l: u32,
    /// The norm of L steps, below 1 by more than its rounding.
    pub norm: f64,
}

/// For each k the first certificate, as far as there are any.
pub(super) fn certificates(symbol: &Symbol) -> Vec<Certificate> {
    (0..symbol.order).filter_map(|k| certificate(k, &symbol.difference(k)?, symbol.arity)).collect()
}

fn certificate(k: usize, mask: &[Exact], arity: i64) -> Option<Certificate> {
    let d = usize::try_from(arity).ok()?;
    let one: Vec<f64> = mask.iter().map(rounded).collect();
    let mut iterated = vec![1.0];
    let mut sizes = vec![1.0];
    let mut step = 1;
    for l in 1.. {
        let width = (one.len() - 1).checked_mul(step)?.checked_add(iterated.len())?;
        if width.max(step) > MAX_ENTRIES {
            return None;
        }
        iterated = times(&iterated, one.iter().copied(), step, width);
        sizes = times(&sizes, one.iter().map(|c| c.abs()), step, width);
        step *= d;
        let norm = greatest_sum(&iterated, step);
        // every entry is a sum of at most so many products of l rounded numbers
        #[expect(clippy::cast_precision_loss, reason = "both are small")]
        let roundings = (l as usize * (one.len() + 2) + width / step + 2) as f64;
        let error = 2.0 * roundings * UNIT * greatest_sum(&sizes, step);
        if norm + error < 1.0 {
            return Some(Certificate { k, l, norm });
        }
    }
    None
}

/// The product of a mask with one at every so many-th place.
fn times(mask: &[f64], other: impl Iterator<Item = f64>, step: usize, width: usize) -> Vec<f64> {
    let mut product = vec![0.0; width];
    for (j, c) in other.enumerate() {
        for (k, a) in mask.iter().enumerate() {
            product[j * step + k] += c * a;
        }
    }
    product
}

/// The greatest sum of sizes of entries that are a multiple of `step` apart.
fn greatest_sum(mask: &[f64], step: usize) -> f64 {
    let sum = |i: usize| mask[i..].iter().step_by(step).map(|c| c.abs()).sum::<f64>();
    (0..step.min(mask.len())).map(sum).fold(0.0, f64::max)
}
