//! The symbol of a scheme of arity d, `a(z) = sum a[j] z^j`, and its factors: `a = d (sigma/d)^K b` with
//! `sigma = 1 + z + ... + z^(d-1)` and a residual b without a further factor sigma.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), sections 2 and 4; Conti and Hormann, Journal of Approximation Theory
//! 163 (2011), 413-437, on reproduction.

use num_traits::{One, Signed, Zero};

use crate::math::exact::{Exact, binary, rounded};
use crate::math::mask::Mask;
use crate::math::number::Number;

/// Largest remainder of a division of a rounded mask that is regarded as 0, relative to the sum of the absolute values
/// of its entries; some thousand roundings. With half of it long masks may lose sum rules; with twice of it the scheme
/// that is analysed instead may be twice as far away.
const DIVISION_REMAINDER: f64 = 1e-12;
/// Largest difference of moments of rounded masks that is regarded as 0, relative to the sum of the absolute values of
/// their terms; some ten thousand roundings, because moments cancel. Half or twice of it only matters to masks that
/// nearly reproduce polynomials.
const MOMENT_TOLERANCE: f64 = 1e-11;

/// A scheme `q[j] = sum over i of a[j - d i] p[i]` and the factors of its symbol.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// The arity d, at least 2.
    pub arity: i64,
    /// The index of the first entry.
    pub first: i64,
    /// The mask a; its first and last entries are not 0.
    pub mask: Vec<Exact>,
    /// Whether the mask is that of the scheme itself. If not, the weights are known only up to rounding, and the mask
    /// is that of a nearby scheme that satisfies the sum rules exactly.
    pub is_exact: bool,
    /// The order K of the sum rules; 0 if not even the weights of each new point sum to 1.
    pub order: usize,
    /// The coefficients of the residual b.
    pub residual: Vec<Exact>,
    /// The first and the last index within the reach of the operators, including weights of 0.
    pub reach: [i64; 2],
}

impl Symbol {
    /// Returns the symbol of a mask that is known exactly; `None` if all entries are 0.
    pub fn exact(arity: i64, first: i64, mask: &[Exact]) -> Option<Self> {
        let (first, mask) = trimmed(first, mask)?;
        let d = Exact::whole(arity);
        let mut residual: Vec<Exact> = mask.iter().map(|a| a / &d).collect();
        let mut order = 0;
        while residual.iter().sum::<Exact>().is_one()
            && let Some(quotient) = divided(&residual, arity, |rest, _| rest.is_zero())
        {
            (residual, order) = (quotient, order + 1);
        }
        Some(Self::of_parts(arity, first, mask, true, order, residual))
    }

    /// Returns the symbol of a scheme near a rounded mask that satisfies the sum rules of the mask exactly.
    pub fn beside(arity: i64, mask: &Mask) -> Option<Self> {
        let (first, mask) = (mask.first.into(), &mask.values);
        let exactly: Vec<Exact> = mask.iter().map(|&a| binary(a)).collect();
        let (first, exactly) = trimmed(first, &exactly)?;
        let d = f64::whole(arity);
        let mut residual: Vec<f64> = exactly.iter().map(|a| rounded(a) / d).collect();
        let mut order = 0;
        while (residual.iter().sum::<f64>() - 1.0).abs() <= DIVISION_REMAINDER
            && let Some(quotient) = divided(&residual, arity, |rest, size| rest.abs() <= DIVISION_REMAINDER * size)
        {
            (residual, order) = (quotient, order + 1);
        }
        if order == 0 {
            let residual = exactly.iter().map(|a| a / Exact::whole(arity)).collect();
            return Some(Self::of_parts(arity, first, exactly, false, order, residual));
        }
        let mut residual: Vec<Exact> = residual.into_iter().map(binary).collect();
        // the middle coefficient compensates for the rounding of the sum
        let (missing, middle) = (Exact::one() - residual.iter().sum::<Exact>(), residual.len() / 2);
        residual[middle] += missing;
        let mut mask: Vec<Exact> = residual.iter().map(|b| b * Exact::whole(arity)).collect();
        (0..order).for_each(|_| mask = averaged(&mask, arity));
        Some(Self::of_parts(arity, first, mask, false, order, residual))
    }

    fn of_parts(arity: i64, first: i64, mask: Vec<Exact>, is_exact: bool, order: usize, residual: Vec<Exact>) -> Self {
        let last = first + i64::try_from(mask.len()).unwrap_or(1) - 1;
        Self { arity, first, mask, is_exact, order, residual, reach: [first, last] }
    }

    /// Replaces the reach of the operators by `width` indices from `first` on.
    #[must_use]
    pub fn reaching(self, first: i64, width: usize) -> Self {
        let last = first + i64::try_from(width).unwrap_or(1) - 1;
        Self { reach: [first, last], ..self }
    }

    /// Returns the index of the last entry.
    pub fn last(&self) -> i64 {
        self.first + i64::try_from(self.mask.len()).unwrap_or(1) - 1
    }

    /// Returns the entry `a[j]`, 0 outside of the mask.
    pub fn at(&self, j: i64) -> Exact {
        let place = usize::try_from(j - self.first).ok().and_then(|place| self.mask.get(place));
        place.cloned().unwrap_or_else(Exact::zero)
    }

    /// Returns the mask `(sigma/d)^(K-1-k) b` of the difference scheme `(1/d) S_(k+1)`, whose powers must contract for
    /// the limit to be C^k; `None` unless k is below K.
    pub fn difference(&self, k: usize) -> Option<Vec<Exact>> {
        let times = self.order.checked_sub(k + 1)?;
        Some((0..times).fold(self.residual.clone(), |mask, _| averaged(&mask, self.arity)))
    }

    /// Returns the parameter shift `tau = a'(1) / d`: 0 for primal schemes around index 0, 1/2 for dual schemes of
    /// arity 2.
    pub fn shift(&self) -> Exact {
        let moment: Exact = (self.first..).zip(&self.mask).map(|(j, a)| Exact::whole(j) * a).sum();
        moment / Exact::whole(self.arity)
    }

    /// Returns the largest degree of polynomials whose samples, at parameters shifted by [`Self::shift`], are refined
    /// to samples of the same polynomial: `a^(j)(1) = d (tau) (tau - 1) ... (tau - j + 1)` for all j up to this degree.
    /// -1 without sum rules.
    pub fn reproduction_degree(&self) -> i64 {
        let shift = self.shift();
        let mut wanted = Exact::whole(self.arity);
        for degree in 0..self.order {
            let j = i64::try_from(degree).unwrap_or(0);
            let falling = |m: i64| (0..j).fold(Exact::one(), |product, l| product * Exact::whole(m - l));
            let summands = || (self.first..).zip(&self.mask).map(|(m, a)| falling(m) * a);
            let off = (summands().sum::<Exact>() - &wanted).abs();
            let size: Exact = summands().map(|x| x.abs()).sum();
            if !off.is_zero() && (self.is_exact || rounded(&off) > MOMENT_TOLERANCE * rounded(&size)) {
                return j - 1;
            }
            wanted *= &shift - Exact::whole(j);
        }
        i64::try_from(self.order).unwrap_or(0) - 1
    }

    /// Returns the interval outside which the basic limit function is 0: `[first/(d-1), last/(d-1)]`.
    pub fn support(&self) -> [Exact; 2] {
        [self.first, self.last()].map(|end| Exact::ratio(end, self.arity - 1))
    }

    /// Returns the number of control points that influence a limit point between two others: the width of the support,
    /// rounded up.
    pub fn influence(&self) -> i64 {
        let [from, to] = self.support();
        i64::try_from((to - from).ceil().to_integer()).unwrap_or(i64::MAX)
    }
}

/// Removes zeros at the ends of a mask.
fn trimmed(first: i64, mask: &[Exact]) -> Option<(i64, Vec<Exact>)> {
    let from = mask.iter().position(|a| !a.is_zero())?;
    let to = mask.iter().rposition(|a| !a.is_zero())?;
    Some((first.checked_add(i64::try_from(from).ok()?)?, mask[from..=to].to_vec()))
}

/// Returns the quotient by `sigma / d` if there is no remainder; `fits` decides from a remainder and the sum of all
/// absolute values whether the remainder is regarded as 0.
fn divided<T: Number>(c: &[T], arity: i64, fits: impl Fn(&T, f64) -> bool) -> Option<Vec<T>> {
    let d = usize::try_from(arity).ok()?;
    let n = (c.len() + 1).checked_sub(d).filter(|&n| n > 0)?;
    let mut quotient: Vec<T> = Vec::with_capacity(c.len());
    // c[j] = q[j] + q[j-1] + ... + q[j-d+1]
    for j in 0..c.len() {
        let back = j + 1 - d.min(j + 1);
        let next = quotient[back..j].iter().fold(c[j].clone(), |rest, q| rest - q.clone());
        quotient.push(next);
    }
    let size = c.iter().map(|x| x.real().abs()).sum();
    if !quotient[n..].iter().all(|rest| fits(rest, size)) {
        return None;
    }
    quotient.truncate(n);
    Some(quotient.into_iter().map(|q| q * T::whole(arity)).collect())
}

/// Returns the product with `sigma / d`.
fn averaged(c: &[Exact], arity: i64) -> Vec<Exact> {
    let d = usize::try_from(arity).unwrap_or(1);
    let n = c.len() + d - 1;
    let sum = |j: usize| c[(j + 1).saturating_sub(d)..c.len().min(j + 1)].iter().sum::<Exact>();
    (0..n).map(|j| sum(j) / Exact::whole(arity)).collect()
}
