//! Expresses schemes with unstable shifts by the basic limit function of a scheme with stable shifts.
//!
//! If `a(z) = a~(z) q(z^d) / q(z)` with `q(1) = 1`, the products of the symbols along `z, z^(1/d), ...` telescope: the
//! basic limit function of a is `sum of q[j] phi~(x - j)` with the basic limit function phi~ of a~. Shifts of phi~ can
//! be recovered from this combination step by step from one end of the support to the other, so that both functions are
//! C^k for the same k. Two kinds of q make shifts unstable: common divisors of the sub-symbols, and cyclotomic
//! polynomials whose order m > 1 is coprime to d and whose zeros are cycles of roots of unity under `z -> z^d`. They
//! are divided out until none is left.
//!
//! Source: Jia and Wang, Proceedings of the AMS 117 (1993), 1115-1124, on what makes shifts unstable.

use num_integer::Integer;
use num_traits::{One, Zero};

use super::stability::is_stable;
use super::symbol::Symbol;
use crate::math::exact::Exact;

/// Maximum number of entries of masks that are reduced. The schemes known here with unstable shifts have 13 entries at
/// most. Half of it leaves some masks from clients undecided; twice of it takes some ten times as long, because the
/// numbers of the divisions grow.
const MAX_REDUCED_ENTRIES: usize = 64;

/// A scheme with stable shifts, and the basic limit function of another scheme as a combination of its shifts.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduction {
    /// The scheme a~ with stable shifts.
    pub symbol: Symbol,
    /// The coefficients q from index 0 on, which sum to 1.
    pub combination: Vec<Exact>,
}

impl Reduction {
    /// Returns the reduction of a scheme whose shifts are not stable, if it is found.
    pub(super) fn of(symbol: &Symbol) -> Option<Self> {
        if !symbol.is_exact || symbol.order == 0 || symbol.mask.len() > MAX_REDUCED_ENTRIES {
            return None;
        }
        let d = usize::try_from(symbol.arity).ok()?;
        let (mut mask, mut combination) = (symbol.mask.clone(), vec![Exact::one()]);
        while let Some(q) = common_divisor(&mask, d).or_else(|| cycle(&mask, d)) {
            mask = quotient(&times(&mask, &q), &spread(&q, d))?;
            combination = times(&combination, &q);
        }
        let reduced = Symbol::exact(symbol.arity, symbol.first, &mask)?;
        let sum: Exact = combination.iter().sum();
        let is_reduced = combination.len() > 1 && !sum.is_zero() && is_stable(&reduced);
        let combination = combination.iter().map(|q| q / &sum).collect();
        is_reduced.then_some(Self { symbol: reduced, combination })
    }
}

/// Returns the greatest common divisor of all sub-symbols, unless it is constant.
fn common_divisor(mask: &[Exact], d: usize) -> Option<Vec<Exact>> {
    let part = |r: usize| trimmed(&mask.iter().skip(r).step_by(d).cloned().collect::<Vec<_>>());
    let found = (1..d).fold(part(0), |common, r| divisor(common, part(r)));
    (found.len() > 1).then_some(found)
}

/// Returns the cyclotomic polynomial of the least order whose zeros make shifts unstable.
fn cycle(mask: &[Exact], d: usize) -> Option<Vec<Exact>> {
    let most = (mask.len() - 1) / (d - 1);
    // for orders within the limit of masks, the degree of the cyclotomic polynomial of order m is m / 6 at least
    let orders = (2..=6 * most).filter(|m| m.gcd(&d) == 1 && totient(*m) <= most);
    orders.map(cyclotomic).find(|q| {
        let factor = quotient(&spread(q, d), q);
        factor.is_some_and(|factor| quotient(mask, &factor).is_some())
    })
}

fn totient(m: usize) -> usize {
    (1..=m).filter(|n| n.gcd(&m) == 1).count()
}

/// Returns the cyclotomic polynomial of order m: `z^m - 1` without the cyclotomic polynomials of all proper divisors of
/// m.
fn cyclotomic(m: usize) -> Vec<Exact> {
    let mut whole = vec![Exact::zero(); m + 1];
    (whole[0], whole[m]) = (-Exact::one(), Exact::one());
    let divisors = (1..m).filter(|n| m.is_multiple_of(*n));
    divisors.fold(whole, |rest, n| quotient(&rest, &cyclotomic(n)).expect("cyclotomic polynomials divide z^m - 1"))
}

/// Returns `p(z^d)`.
fn spread(p: &[Exact], d: usize) -> Vec<Exact> {
    let mut out = vec![Exact::zero(); (p.len() - 1) * d + 1];
    p.iter().enumerate().for_each(|(j, c)| out[j * d].clone_from(c));
    out
}

fn times(a: &[Exact], b: &[Exact]) -> Vec<Exact> {
    let mut out = vec![Exact::zero(); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        b.iter().enumerate().for_each(|(j, y)| out[i + j] += x * y);
    }
    out
}

/// Returns quotient and remainder; coefficients start at the constant, and the last coefficient of `b` is not 0.
fn divided(a: &[Exact], b: &[Exact]) -> (Vec<Exact>, Vec<Exact>) {
    let (mut rest, lead) = (a.to_vec(), &b[b.len() - 1]);
    let n = (a.len() + 1).saturating_sub(b.len());
    let mut quotient = vec![Exact::zero(); n];
    for k in (0..n).rev() {
        let factor = &rest[k + b.len() - 1] / lead;
        if !factor.is_zero() {
            b.iter().enumerate().for_each(|(j, y)| rest[k + j] -= &factor * y);
        }
        quotient[k] = factor;
    }
    rest.truncate(b.len() - 1);
    (quotient, rest)
}

/// Returns the quotient if the remainder is 0.
fn quotient(a: &[Exact], b: &[Exact]) -> Option<Vec<Exact>> {
    let (quotient, rest) = divided(a, b);
    (!quotient.is_empty() && rest.iter().all(Exact::is_zero)).then_some(quotient)
}

/// Returns the greatest common divisor with the last coefficient 1; that of 0 and a polynomial is the polynomial.
fn divisor(mut a: Vec<Exact>, mut b: Vec<Exact>) -> Vec<Exact> {
    while !b.is_empty() {
        let (_, rest) = divided(&a, &b);
        (a, b) = (b, monic(high_trimmed(rest)));
    }
    monic(a)
}

fn monic(p: Vec<Exact>) -> Vec<Exact> {
    let Some(lead) = p.last().cloned() else { return p };
    p.into_iter().map(|c| c / &lead).collect()
}

fn high_trimmed(mut p: Vec<Exact>) -> Vec<Exact> {
    while p.last().is_some_and(Exact::is_zero) {
        p.pop();
    }
    p
}

/// Removes zero coefficients at both ends of a polynomial, which only shift it.
fn trimmed(p: &[Exact]) -> Vec<Exact> {
    let from = p.iter().position(|c| !c.is_zero()).unwrap_or(p.len());
    high_trimmed(p[from..].to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::number::Number;

    fn whole(numbers: &[i64]) -> Vec<Exact> {
        numbers.iter().map(|n| Exact::whole(*n)).collect()
    }

    #[test]
    fn cyclotomic_polynomials_are_those_of_the_tables() {
        assert_eq!(cyclotomic(2), whole(&[1, 1]));
        assert_eq!(cyclotomic(6), whole(&[1, -1, 1]));
        assert_eq!(cyclotomic(15), whole(&[1, -1, 0, 1, -1, 1, 0, -1, 1]));
    }

    #[test]
    fn what_is_put_in_is_taken_out_again() {
        let spline = [1, 4, 6, 4, 1].map(|n| Exact::ratio(n, 8));
        for q in [whole(&[1, 1, 1]), whole(&[2, -1]), times(&cyclotomic(5), &whole(&[3, 0, 1]))] {
            // the cyclic factor q(z^2) / q(z) if it is a polynomial; otherwise q(z^2), which is common to the
            // sub-symbols
            let factor = quotient(&spread(&q, 2), &q).unwrap_or_else(|| spread(&q, 2));
            let mask = times(&spline, &factor);
            let sum: Exact = mask.iter().sum();
            let mask: Vec<Exact> = mask.iter().map(|a| a * Exact::whole(2) / &sum).collect();
            let reduction = Symbol::exact(2, 0, &mask).and_then(|symbol| Reduction::of(&symbol)).expect("a reduction");
            assert!(is_stable(&reduction.symbol));
            assert_eq!(reduction.combination.iter().sum::<Exact>(), Exact::one());
        }
        let stable = Symbol::exact(2, 0, &spline).expect("a mask");
        assert_eq!(Reduction::of(&stable), None);
    }
}
