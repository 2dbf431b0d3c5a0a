//! Decides whether the integer shifts of the basic limit function are stable, as upper bounds of smoothness require.
//!
//! Shifts are stable if two conditions hold. The sub-symbols `sum over j of a[r + d j] z^j` have no common zero except
//! 0. For no cycle of roots of unity under `z -> z^d` does the symbol vanish at all d-th roots of its elements that lie
//! outside of the cycle. With m = d^l - 1 these roots are zeros of `1 + z^m + ... + z^(m (d-1))`, and a cycle of l
//! elements takes `(d-1) l` zeros of the residual. Both conditions are decided by greatest common divisors modulo a
//! prime; polynomials without a common divisor modulo the prime have none over the rationals either.
//!
//! Source: Jia and Wang, Proceedings of the AMS 117 (1993), 1115-1124, here for every arity.

use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};

use super::symbol::Symbol;
use crate::math::exact::Exact;

/// The prime modulo which polynomials are computed, `2^61 - 1`.
const PRIME: u64 = (1 << 61) - 1;

/// Returns whether the shifts are proved to be stable.
pub(super) fn is_stable(symbol: &Symbol) -> bool {
    let known = || Some(have_no_common_zero(symbol)? && vanishes_on_no_cycle(symbol)?);
    symbol.order > 0 && known() == Some(true)
}

fn have_no_common_zero(symbol: &Symbol) -> Option<bool> {
    let d = usize::try_from(symbol.arity).ok()?;
    let mut common = Vec::new();
    for r in 0..d {
        let part: Vec<Exact> = symbol.mask.iter().skip(r).step_by(d).cloned().collect();
        let part = polynomial(&part)?;
        common = if common.is_empty() { part } else { divisor(common, part) };
    }
    Some(common.len() == 1)
}

fn vanishes_on_no_cycle(symbol: &Symbol) -> Option<bool> {
    let residual = polynomial(&symbol.residual)?;
    let (degree, d) = (residual.len() - 1, u64::try_from(symbol.arity).ok()?);
    let longest = u64::try_from(degree).ok()? / (d - 1);
    let sigma = vec![1; usize::try_from(d).ok()?];
    for length in 1..=u32::try_from(longest).ok()? {
        let order = u128::from(d).checked_pow(length)?.checked_sub(1)?;
        // the d-th roots of cycle elements outside of their cycle are zeros of 1 + z^m + ... + z^(m (d-1))
        let power = power_of_z(order, &residual);
        let mut sum = vec![1];
        for _ in 1..d {
            sum = product(&sum, &power);
            sum.resize(sum.len().max(1), 0);
            sum[0] = less(sum[0], PRIME - 1);
            sum = remainder(sum, &residual);
        }
        let mut common = divisor(residual.clone(), sum);
        // the d-th roots of 1 are zeros of sigma, and belong to the sum rules
        loop {
            let of_one = divisor(common.clone(), sigma.clone());
            if of_one.len() <= 1 {
                break;
            }
            common = quotient(common, &of_one);
        }
        if common.len() > 1 {
            return Some(false);
        }
    }
    Some(true)
}

/// Returns the polynomial modulo the prime, without zeros at its ends, the highest coefficient last; `None` if the
/// prime divides a denominator or a coefficient at an end.
fn polynomial(coefficients: &[Exact]) -> Option<Vec<u64>> {
    let from = coefficients.iter().position(|c| !c.is_zero()).unwrap_or(coefficients.len());
    let to = coefficients.iter().rposition(|c| !c.is_zero()).map_or(from, |to| to + 1);
    let found: Option<Vec<u64>> = coefficients[from..to].iter().map(reduced).collect();
    found.filter(|found| found.last() != Some(&0) && found.first() != Some(&0))
}

fn reduced(x: &Exact) -> Option<u64> {
    let prime = BigInt::from(PRIME);
    let part = |n: &BigInt| (((n % &prime) + &prime) % &prime).to_u64();
    let below = part(x.denom()).filter(|below| *below != 0)?;
    Some(times(part(x.numer())?, inverse(below)))
}

fn times(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b) % u128::from(PRIME);
    u64::try_from(product).unwrap_or(0)
}

/// Returns `a - b` modulo the prime. Sums use it too, with the prime minus a number as the negative number.
fn less(a: u64, b: u64) -> u64 {
    let b = if b == PRIME { 0 } else { b };
    if a >= b { a - b } else { a + PRIME - b }
}

fn inverse(a: u64) -> u64 {
    let (mut result, mut square, mut rest) = (1, a, PRIME - 2);
    while rest > 0 {
        if rest % 2 == 1 {
            result = times(result, square);
        }
        square = times(square, square);
        rest /= 2;
    }
    result
}

/// Returns the remainder of a division by a nonzero polynomial.
fn remainder(mut a: Vec<u64>, b: &[u64]) -> Vec<u64> {
    let Some(last) = b.last() else { return a };
    let scale = inverse(*last);
    while a.len() >= b.len() {
        let factor = times(a.pop().unwrap_or(0), scale);
        let shift = a.len() + 1 - b.len();
        for (x, y) in a[shift..].iter_mut().zip(b) {
            *x = less(*x, times(factor, *y));
        }
    }
    while a.last() == Some(&0) {
        a.pop();
    }
    a
}

/// Returns the greatest common divisor up to a constant factor; that of 0 and a polynomial is the polynomial.
fn divisor(mut a: Vec<u64>, mut b: Vec<u64>) -> Vec<u64> {
    while !b.is_empty() {
        (a, b) = (b.clone(), remainder(a, &b));
    }
    a
}

/// Returns the quotient, without the remainder.
fn quotient(mut a: Vec<u64>, b: &[u64]) -> Vec<u64> {
    let Some(last) = b.last() else { return a };
    let scale = inverse(*last);
    let mut found = Vec::new();
    while a.len() >= b.len() {
        let factor = times(a.pop().unwrap_or(0), scale);
        let shift = a.len() + 1 - b.len();
        a[shift..].iter_mut().zip(b).for_each(|(x, y)| *x = less(*x, times(factor, *y)));
        found.push(factor);
    }
    found.reverse();
    found
}

fn product(a: &[u64], b: &[u64]) -> Vec<u64> {
    let mut product = vec![0; a.len() + b.len()];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] = less(product[i + j], PRIME - times(*x, *y));
        }
    }
    product
}

/// Returns `z^n` modulo a polynomial.
fn power_of_z(n: u128, modulus: &[u64]) -> Vec<u64> {
    let mut result = remainder(vec![1], modulus);
    for bit in (0..128 - n.leading_zeros()).rev() {
        let mut square = product(&result, &result);
        if n >> bit & 1 == 1 {
            square.insert(0, 0);
        }
        result = remainder(square, modulus);
    }
    result
}
